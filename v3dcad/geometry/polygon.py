"""Rings of line segments: do any two of them cross?"""

from __future__ import annotations

import numpy as np
from numba import njit, types

from v3dcad.geometry.exact import COMPILED, INLINED, INTERNAL, WORD

FLOAT, FLOAT_ROWS, INTS = types.float64, types.float64[:, ::1], types.int64[::1]

FLAT = 1e-12
"""Three points whose triangle is flatter than this, relative to its sides, count as collinear."""


@njit(WORD(FLOAT_ROWS, *[WORD] * 3), **INLINED)
def _side(corners, a, b, c):  # type: ignore[no-untyped-def]
    """On which side of a → b point c lies: 1 left, −1 right, 0 on it but for rounding."""
    ux, uy = corners[b, 0] - corners[a, 0], corners[b, 1] - corners[a, 1]
    vx, vy = corners[c, 0] - corners[a, 0], corners[c, 1] - corners[a, 1]
    turn = ux * vy - uy * vx
    doubt = FLAT * (abs(ux) + abs(uy)) * (abs(ux) + abs(uy) + abs(vx) + abs(vy))
    return 0 if abs(turn) <= doubt else (1 if turn > 0 else -1)


@njit(types.boolean(FLOAT_ROWS, *[WORD] * 4), **INTERNAL)
def segments_cross(corners, a, b, c, d):  # type: ignore[no-untyped-def]
    """Whether a → b and c → d cross in the inside of both; touching is not crossing."""
    if (
        max(corners[a, 0], corners[b, 0]) < min(corners[c, 0], corners[d, 0])
        or max(corners[c, 0], corners[d, 0]) < min(corners[a, 0], corners[b, 0])
        or max(corners[a, 1], corners[b, 1]) < min(corners[c, 1], corners[d, 1])
        or max(corners[c, 1], corners[d, 1]) < min(corners[a, 1], corners[b, 1])
    ):
        return False
    return (
        _side(corners, a, b, c) * _side(corners, a, b, d) < 0
        and _side(corners, c, d, a) * _side(corners, c, d, b) < 0
    )


@njit(types.UniTuple(FLOAT, 2)(FLOAT, FLOAT), **INLINED)
def sorted_pair(p, q):  # type: ignore[no-untyped-def]
    """The two numbers, the smaller first."""
    return (p, q) if p < q else (q, p)


@njit(WORD(FLOAT_ROWS, INTS), **INTERNAL)
def _crossing_in(corners, starts):  # type: ignore[no-untyped-def]
    """A segment of one layer's rings that crosses another, or −1.

    Ring k is corners (r, 2) from starts[k] to starts[k + 1]. Segments are listed in the cells of
    a square grid that has about as many cells as there are segments, and compared within a cell.
    """
    count = len(corners)
    if count < 4:
        return -1
    after = np.arange(1, count + 1)
    for ring in range(len(starts) - 1):
        if starts[ring] < starts[ring + 1]:
            after[starts[ring + 1] - 1] = starts[ring]
    left = right = corners[0, 0]
    low = high = corners[0, 1]
    for corner in range(count):
        left, right = min(left, corners[corner, 0]), max(right, corners[corner, 0])
        low, high = min(low, corners[corner, 1]), max(high, corners[corner, 1])
    columns = int(np.sqrt(count)) + 1
    size = max(right - left, high - low) / columns
    if size == 0.0:
        return -1
    first = np.zeros(columns * columns + 1, np.int64)
    listed = np.empty(0, np.int64)
    for writing in range(2):  # count, then list
        for a in range(count):
            b = after[a]
            x0, x1 = sorted_pair((corners[a, 0] - left) / size, (corners[b, 0] - left) / size)
            y0, y1 = sorted_pair((corners[a, 1] - low) / size, (corners[b, 1] - low) / size)
            for row in range(min(int(y0), columns - 1), min(int(y1), columns - 1) + 1):
                for column in range(min(int(x0), columns - 1), min(int(x1), columns - 1) + 1):
                    cell = row * columns + column
                    if writing:
                        for other in listed[first[cell] : first[cell + 1]]:
                            if other < 0:
                                break
                            if segments_cross(corners, a, b, other, after[other]):
                                return a
                        place = first[cell]
                        while listed[place] >= 0:
                            place += 1
                        listed[place] = a
                    else:
                        first[cell + 1] += 1
        if not writing:
            for cell in range(columns * columns):
                first[cell + 1] += first[cell]
            listed = np.full(first[-1], -1, np.int64)
    return -1


@njit(WORD(FLOAT_ROWS, INTS, INTS), **COMPILED)
def crossing_segment(corners, starts, layers):  # type: ignore[no-untyped-def]
    """The first corner of a segment that crosses another of the same layer, or −1.

    Closed rings: layer l has rings layers[l] … layers[l + 1], and ring k is corners (r, 2) from
    starts[k] to starts[k + 1].
    """
    for layer in range(len(layers) - 1):
        rings = starts[layers[layer] : layers[layer + 1] + 1]
        first, count = rings[0], rings[-1] - rings[0]
        if layer > 0 and count == first - starts[layers[layer - 1]]:
            same = True
            for corner in range(first, first + count):
                for k in range(2):
                    same = same and corners[corner, k] == corners[corner - count, k]
            if same:  # as on the layer before
                continue
        found = _crossing_in(corners[first : first + count], rings - first)
        if found >= 0:
            return first + found
    return -1
