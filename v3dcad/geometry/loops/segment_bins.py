"""Segments in a grid of square bins: which lie near each other, in linear time."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import ConstFloatRows, FloatArray, IntArray
from v3dcad.geometry.compiled.options import INLINED, UNCOUNTED, compiled
from v3dcad.model import Floats

MOST = 2**20
"""Bins, at most."""


class SegmentBins(NamedTuple):
    """Which segments come near each square of a grid."""

    frame: FloatArray
    """(4,) mm: x and y of the grid's lower corner, the side of a bin, how near is near"""
    shape: IntArray
    """(2,) bins along x and y"""
    first: IntArray
    """(bins + 1,) where each bin's segments begin"""
    items: IntArray
    """(i,) the segments"""


def segment_bins(start: Floats, stop: Floats, reach: float) -> SegmentBins:
    """Bins of segments from `start` (n, 2) to `stop` (n, 2), mm, in all bins within `reach` of one.

    Bins are about as large as a segment is long, on average, but not smaller than `reach`.
    """
    low = np.minimum(start, stop).min(axis=0) - reach
    size = np.maximum(start, stop).max(axis=0) + reach - low
    mean = float(np.hypot(*(stop - start).T).mean())
    side = max(mean, reach, math.sqrt(float(size.prod()) / MOST), float(size.max()) / MOST)
    shape = np.maximum(np.ceil(size / side), 1).astype(np.int64)
    frame = np.array([low[0], low[1], side, reach])
    counts = np.zeros(int(shape.prod()) + 1, np.int64)
    _fill(start, stop, frame, shape, counts, np.empty(0, np.int64))
    first = np.cumsum(counts) - counts
    items = np.empty(int(first[-1]), np.int64)
    _fill(start, stop, frame, shape, first.copy(), items)
    return SegmentBins(frame, shape, first, items)


@compiled(INLINED)
def bin_range(low: float, high: float, corner: float, side: float, count: int) -> tuple[int, int]:
    """The first and the last bin, along one axis, that low … high touches."""
    first = math.floor((low - corner) / side)
    last = math.floor((high - corner) / side)
    return max(first, 0), min(last, count - 1)


@compiled(INLINED)
def row_span(
    ax: float, ay: float, bx: float, by: float, low: float, high: float
) -> tuple[float, float]:
    """From where to where along x a segment a → b runs while y is in low … high."""
    if by == ay:
        return min(ax, bx), max(ax, bx)
    from_ = min(max((low - ay) / (by - ay), 0.0), 1.0)
    to = min(max((high - ay) / (by - ay), 0.0), 1.0)
    one, other = ax + from_ * (bx - ax), ax + to * (bx - ax)
    return min(one, other), max(one, other)


@compiled(UNCOUNTED)
def _fill(
    start: ConstFloatRows,
    stop: ConstFloatRows,
    frame: FloatArray,
    shape: IntArray,
    place: IntArray,
    items: IntArray,
) -> None:
    """Write each segment into its bins from `place` on; without room for items, only count."""
    side, reach = frame[2], frame[3]
    for k in range(len(start)):
        ax, ay, bx, by = start[k, 0], start[k, 1], stop[k, 0], stop[k, 1]
        below, above = bin_range(min(ay, by) - reach, max(ay, by) + reach, frame[1], side, shape[1])
        for row in range(below, above + 1):
            y = frame[1] + row * side
            left, right = row_span(ax, ay, bx, by, y - reach, y + side + reach)
            one, other = bin_range(left - reach, right + reach, frame[0], side, shape[0])
            for bin_ in range(row * shape[0] + one, row * shape[0] + other + 1):
                if len(items) > 0:
                    items[place[bin_]] = k
                place[bin_] += 1
