"""Segments in a grid of square bins: which lie near each other, in linear time."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, FloatRows, IntArray, IntRows
from v3dcad.geometry.compiled.options import INLINED, UNCOUNTED, compiled
from v3dcad.model import Floats

MOST = 2**20
"""Bins, at most."""
CROWDED = 8.0
"""Long segments side by side that a bin has, at most, on average."""
ROOM = 6
"""Bins of a segment, on average; where there are more, there is another try."""
LEVEL = 1e-3
"""mm: segments that rise less are level, as far as bins go."""


class Segments(NamedTuple):
    """Segments, and which of them come near each square of a grid."""

    ends: FloatRows
    """(n, 4) mm: x and y of where each begins, x and y of where it ends"""
    frame: FloatArray
    """(4,) mm: x and y of the grid's lower corner, the side of a bin, how near is near"""
    shape: IntArray
    """(2,) bins along x and y"""
    first: IntArray
    """(bins + 1,) where each bin's segments begin"""
    items: IntArray
    """(i,) the segments"""

    @classmethod
    def of(cls, start: Floats, stop: Floats, reach: float) -> Segments:
        """Segments from `start` (n, 2) to `stop` (n, 2), mm, as `along` makes them."""
        return cls.along(np.hstack([start, stop]), reach)

    @classmethod
    def along(cls, ends: FloatRows, reach: float) -> Segments:
        """Segments by their `ends` (n, 4), mm, in all bins within `reach` of each.

        Bins are about as large as a segment is long, on average; smaller, where many long ones lie
        side by side; but not smaller than `reach`.
        """
        frame, shape = np.array([0.0, 0, 1, reach]), np.ones(2, np.int64)
        if len(ends):
            _set_up(ends, frame, shape)
        room = ROOM * len(ends)
        while True:
            pairs = np.empty((room, 2), np.int64)
            first = np.zeros(int(shape[0] * shape[1]) + 2, np.int64)
            size = _pair(ends, frame, shape, pairs, first)
            if size <= room:
                break
            room = size
        items = np.empty(size, np.int64)
        _sort(pairs, first, items)
        return cls(ends, frame, shape, first[:-1], items)


@compiled(INLINED)
def bin_range(low: float, high: float, corner: float, per_mm: float, count: int) -> tuple[int, int]:
    """The first and the last bin, along one axis, that low … high touches, of so many `per_mm`."""
    first = math.floor((low - corner) * per_mm)
    last = math.floor((high - corner) * per_mm)
    return max(first, 0), min(last, count - 1)


@compiled(INLINED)
def _lean(ax: float, ay: float, bx: float, by: float) -> float:
    """How far a → b goes along x for each mm along y; infinity if it stays in about one row."""
    return (bx - ax) / (by - ay) if abs(by - ay) > LEVEL else math.inf


@compiled(INLINED)
def _row_span(
    ax: float, ay: float, bx: float, by: float, lean: float, low: float, high: float
) -> tuple[float, float]:
    """From where to where along x a segment a → b runs while y is in low … high."""
    left, right = min(ax, bx), max(ax, bx)
    if lean == math.inf:
        return left, right
    one, other = ax + lean * (low - ay), ax + lean * (high - ay)
    return max(left, min(one, other)), min(right, max(one, other))


@compiled(INLINED)
def beside(
    segments: Segments,
    ax: float,
    ay: float,
    bx: float,
    by: float,
    reach: float,
    stamp: IntArray,
    visit: int,
    found: IntArray,
) -> int:
    """How many segments may come within `reach` of a → b, mm; `found` (n + 1,) has them in front.

    They are all whose boxes come so near to that of a → b, and which share a bin with it. `stamp`
    holds for each segment the last visit at which it was looked at: give another number each time.
    """
    frame, shape, ends = segments.frame, segments.shape, segments.ends
    side, per_mm, beyond = frame[2], 1 / frame[2], max(reach - frame[3], 0.0)
    west, east = min(ax, bx) - reach, max(ax, bx) + reach
    south, north = min(ay, by) - reach, max(ay, by) + reach
    count = 0
    below, above = bin_range(min(ay, by) - beyond, max(ay, by) + beyond, frame[1], per_mm, shape[1])
    lean = _lean(ax, ay, bx, by)
    for row in range(below, above + 1):
        y = frame[1] + row * side
        left, right = _row_span(ax, ay, bx, by, lean, y - beyond, y + side + beyond)
        begin, end = bin_range(left - beyond, right + beyond, frame[0], per_mm, shape[0])
        if begin > end:
            continue
        # The bins of a row follow each other, and so do their segments.
        for k in range(
            segments.first[row * shape[0] + begin], segments.first[row * shape[0] + end + 1]
        ):
            other = segments.items[k]
            # No branches here: a processor would guess them wrong half of the time.
            new = stamp[other] != visit
            stamp[other] = visit
            cx, cy, dx, dy = ends[other, 0], ends[other, 1], ends[other, 2], ends[other, 3]
            across = (max(cx, dx) >= west) & (min(cx, dx) <= east)
            along = (max(cy, dy) >= south) & (min(cy, dy) <= north)
            found[count] = other
            count += new & across & along
    return count


@compiled(UNCOUNTED)
def _set_up(ends: FloatRows, frame: FloatArray, shape: IntArray) -> None:
    """Lay the grid around segments: its corner, the side of a bin, how many there are."""
    reach, length = frame[3], 0.0
    left, low, right, high = ends[0, 0], ends[0, 1], ends[0, 0], ends[0, 1]
    for k in range(len(ends)):
        ax, ay, bx, by = ends[k, 0], ends[k, 1], ends[k, 2], ends[k, 3]
        left, right = min(left, ax, bx), max(right, ax, bx)
        low, high = min(low, ay, by), max(high, ay, by)
        length += math.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
    left, low = left - reach, low - reach
    wide, tall = right + reach - left, high + reach - low
    side = min(length / len(ends), CROWDED * wide * tall / max(length, 1e-300))
    side = max(side, reach, math.sqrt(wide * tall / MOST), max(wide, tall) / MOST)
    frame[0], frame[1], frame[2] = left, low, side
    shape[0], shape[1] = max(math.ceil(wide / side), 1), max(math.ceil(tall / side), 1)


@compiled(UNCOUNTED)
def _pair(
    ends: FloatRows, frame: FloatArray, shape: IntArray, pairs: IntRows, counts: IntArray
) -> int:
    """How many pairs of a segment and a bin there are; those without room are only counted.

    `counts` has, two places on from each bin, how many segments it has.
    """
    size = 0
    side, per_mm, reach = frame[2], 1 / frame[2], frame[3]
    for k in range(len(ends)):
        ax, ay, bx, by = ends[k, 0], ends[k, 1], ends[k, 2], ends[k, 3]
        below, above = bin_range(
            min(ay, by) - reach, max(ay, by) + reach, frame[1], per_mm, shape[1]
        )
        lean = _lean(ax, ay, bx, by)
        for row in range(below, above + 1):
            y = frame[1] + row * side
            left, right = _row_span(ax, ay, bx, by, lean, y - reach, y + side + reach)
            one, other = bin_range(left - reach, right + reach, frame[0], per_mm, shape[0])
            for bin_ in range(row * shape[0] + one, row * shape[0] + other + 1):
                if size < len(pairs):
                    pairs[size, 0], pairs[size, 1] = k, bin_
                    counts[bin_ + 2] += 1
                size += 1
    return size


@compiled(UNCOUNTED)
def _sort(pairs: IntRows, first: IntArray, items: IntArray) -> None:
    """Write the segments bin by bin. `first` comes with counts, and goes with where each begins."""
    for bin_ in range(2, len(first)):
        first[bin_] += first[bin_ - 1]
    for k in range(len(items)):
        bin_ = pairs[k, 1] + 1
        items[first[bin_]] = pairs[k, 0]
        first[bin_] += 1
