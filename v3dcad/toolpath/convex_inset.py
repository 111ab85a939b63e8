"""Insets of many convex cells at once, by shifting their half-planes."""

from __future__ import annotations

import math

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatRows,
    ConstIntArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.model import Floats, Ints


def inset_cells(corners: Floats, first: Ints, distance: float) -> tuple[Floats, Ints]:
    """What of convex cells lies deeper than `distance` (mm) inside: corners (k, 2), first (c + 1,).

    Cell c has the corners first[c] … first[c + 1], counter-clockwise, and so have the insets; that
    of a cell too small has none. Each inset is the cell cut by the half-planes of its edges, moved
    inwards: time goes with the square of a cell's corners, of which there are few.
    """
    inset = np.empty((2 * len(corners) + 8, 2))
    begins = np.empty(len(first), np.int64)
    count = _inset_cells(np.array(corners), np.array(first), distance, inset, begins)
    return inset[:count].copy(), begins


@compiled(ENTRY)
def _inset_cells(
    corners: ConstFloatRows,
    first: ConstIntArray,
    distance: float,
    inset: FloatRows,
    begins: IntArray,
) -> int:
    most = 0
    for cell in range(len(first) - 1):
        most = max(most, first[cell + 1] - first[cell])
    now = np.empty((2 * most + 2, 2))
    cut = np.empty((2 * most + 2, 2))
    written = 0
    for cell in range(len(first) - 1):
        begins[cell] = written
        low, high = first[cell], first[cell + 1]
        size = high - low
        for k in range(size):
            now[k, 0], now[k, 1] = corners[low + k, 0], corners[low + k, 1]
        for k in range(low, high):
            after = k + 1 if k + 1 < high else low
            along_x = corners[after, 0] - corners[k, 0]
            along_y = corners[after, 1] - corners[k, 1]
            length = math.sqrt(along_x * along_x + along_y * along_y)
            if length < 1e-9:
                continue
            # Inside is where x · across_x + y · across_y is at least `least`.
            across_x, across_y = -along_y / length, along_x / length
            least = corners[k, 0] * across_x + corners[k, 1] * across_y + distance
            kept = 0
            for j in range(size):
                i = j - 1 if j > 0 else size - 1
                here = now[j, 0] * across_x + now[j, 1] * across_y - least
                before = now[i, 0] * across_x + now[i, 1] * across_y - least
                if (here < 0) != (before < 0):
                    share = before / (before - here)
                    cut[kept, 0] = now[i, 0] + share * (now[j, 0] - now[i, 0])
                    cut[kept, 1] = now[i, 1] + share * (now[j, 1] - now[i, 1])
                    kept += 1
                if here >= 0:
                    cut[kept, 0], cut[kept, 1] = now[j, 0], now[j, 1]
                    kept += 1
            now, cut = cut, now
            size = kept
            if size < 3:
                size = 0
                break
        for k in range(size):
            inset[written, 0], inset[written, 1] = now[k, 0], now[k, 1]
            written += 1
    begins[len(first) - 1] = written
    return written
