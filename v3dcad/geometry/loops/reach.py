"""Which stretches of some segments lie far from others: exactly, and in linear time.

What lies within reach of a segment is a rectangle with half a disk at either end. It is convex, so
a line is in it from one place to one other. What all such stretches of a line leave is far.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatRows,
    FloatArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.segment_bins import SegmentBins, bin_range, row_span, segment_bins
from v3dcad.model import Floats, Ints

PIECE = 40.0
"""Reaches: longer segments are looked at piece by piece, so that few others are near."""
ROUNDING = 1e-9
"""Shares of a piece: a shorter stretch is rounding."""


class Near(NamedTuple):
    """Segments from `start` (m, 2) to `stop` (m, 2), mm, found by where they are."""

    start: Floats
    stop: Floats
    bins: SegmentBins | None
    """None where there are no segments"""

    @classmethod
    def of(cls, start: Floats, stop: Floats, reach: float) -> Near:
        """Segments of which most are asked for what lies within `reach` mm."""
        return cls(start, stop, segment_bins(start, stop, reach) if len(start) else None)


class Stretches(NamedTuple):
    """Stretches of segments, in order along each."""

    segment: Ints
    """(k,) whose each is"""
    low: Floats
    """(k,) shares of the segment, 0 … 1, where each begins"""
    high: Floats
    """(k,) and ends"""


def far_from(start: Floats, stop: Floats, others: Near, reach: float) -> Stretches:
    """What of segments from `start` (n, 2) to `stop` (n, 2) lies farther than `reach` from others.

    All in mm. A stretch may come in several that follow each other.
    """
    every = np.arange(len(start))
    if others.bins is None or not len(start):
        return Stretches(every, np.zeros(len(start)), np.ones(len(start)))
    stamp, near = np.full(len(others.start), -1), np.empty((len(others.start), 2))
    found, room = np.empty(len(start), np.int64), len(start)
    while True:
        shares = np.empty((room, 2))
        stamp[:] = -1
        _leave(start, stop, others.start, others.stop, *others.bins, reach, stamp, near, found,
               shares)  # fmt: skip
        room = int(found.sum())
        if room <= len(shares):
            low, high = shares[:room].T.copy()
            return Stretches(np.repeat(every, found), low, high)


@compiled(INTERNAL)
def _clipped(
    low: float, high: float, at: float, rise: float, least: float, most: float
) -> tuple[float, float]:
    """Where in low … high a value `at` + share · `rise` lies in least … most; 1, 0 if nowhere."""
    if rise == 0:
        return (low, high) if least <= at <= most else (1.0, 0.0)
    one, other = (least - at) / rise, (most - at) / rise
    low, high = max(low, min(one, other)), min(high, max(one, other))
    return (low, high) if low <= high else (1.0, 0.0)


@compiled(INTERNAL)
def _within(
    ax: float,
    ay: float,
    bx: float,
    by: float,
    cx: float,
    cy: float,
    dx: float,
    dy: float,
    reach: float,
) -> tuple[float, float]:
    """From where to where on a → b, in shares, it lies within reach of c → d; 1, 0 if nowhere."""
    vx, vy, ex, ey = bx - ax, by - ay, dx - cx, dy - cy
    ux, uy = ax - cx, ay - cy
    length = math.sqrt(ex * ex + ey * ey)
    first, last = 1.0, 0.0
    if length > 0:
        # Not farther from its line; there, beside it and not before or after it.
        wide = reach * length
        at, rise = ex * uy - ey * ux, ex * vy - ey * vx
        low, high = _clipped(0.0, 1.0, at, rise, -wide, wide)
        if low > high:
            return 1.0, 0.0
        at, rise = ex * ux + ey * uy, ex * vx + ey * vy
        first, last = _clipped(low, high, at, rise, 0.0, length * length)
        if first == low and last == high:
            return first, last
    square = vx * vx + vy * vy
    for end in range(2):
        if end:
            ux, uy = ax - dx, ay - dy
        mixed, rest = ux * vx + uy * vy, ux * ux + uy * uy - reach * reach
        low, high = 0.0, 1.0
        if square > 0:
            root = mixed * mixed - square * rest
            if root < 0:
                continue
            root = math.sqrt(root)
            low, high = max((-mixed - root) / square, 0.0), min((-mixed + root) / square, 1.0)
        elif rest > 0:
            continue
        if low <= high:
            first, last = min(first, low), max(last, high)
    return first, last


@compiled(UNCOUNTED)
def _leave(
    start: ConstFloatRows,
    stop: ConstFloatRows,
    other_start: ConstFloatRows,
    other_stop: ConstFloatRows,
    frame: FloatArray,
    shape: IntArray,
    bin_first: IntArray,
    items: IntArray,
    reach: float,
    stamp: IntArray,
    near: FloatRows,
    found: IntArray,
    shares: FloatRows,
) -> None:
    """What others leave of segments: how often, and from where to where as long as there is room.

    Stretches within reach are kept in order (`near`) as they come.
    """
    side, beyond = frame[2], max(reach - frame[3], 0.0)
    size = visit = 0
    for one in range(len(start)):
        x, y = start[one, 0], start[one, 1]
        dx, dy = stop[one, 0] - x, stop[one, 1] - y
        pieces = max(math.ceil(math.sqrt(dx * dx + dy * dy) / (PIECE * reach)), 1)
        gaps = 0
        for piece in range(pieces):
            ax, ay = x + piece / pieces * dx, y + piece / pieces * dy
            bx, by = x + (piece + 1) / pieces * dx, y + (piece + 1) / pieces * dy
            west, east = min(ax, bx) - reach, max(ax, bx) + reach
            south, north = min(ay, by) - reach, max(ay, by) + reach
            visit += 1
            count = 0
            whole = False
            low, high = min(ay, by) - beyond, max(ay, by) + beyond
            below, above = bin_range(low, high, frame[1], side, shape[1])
            for row in range(below, above + 1):
                low = frame[1] + row * side
                left, right = row_span(ax, ay, bx, by, low - beyond, low + side + beyond)
                begin, end = bin_range(left - beyond, right + beyond, frame[0], side, shape[0])
                for bin_ in range(row * shape[0] + begin, row * shape[0] + end + 1):
                    if whole:
                        break
                    for k in range(bin_first[bin_], bin_first[bin_ + 1]):
                        other = items[k]
                        if stamp[other] == visit:
                            continue
                        stamp[other] = visit
                        cx, cy = other_start[other, 0], other_start[other, 1]
                        ex, ey = other_stop[other, 0], other_stop[other, 1]
                        if max(cx, ex) < west or min(cx, ex) > east:
                            continue
                        if max(cy, ey) < south or min(cy, ey) > north:
                            continue
                        low, high = _within(ax, ay, bx, by, cx, cy, ex, ey, reach)
                        if low > high:
                            continue
                        if low <= 0 and high >= 1:
                            whole = True
                            break
                        place = count
                        while place > 0 and near[place - 1, 0] > low:
                            near[place, 0], near[place, 1] = near[place - 1, 0], near[place - 1, 1]
                            place -= 1
                        near[place, 0], near[place, 1] = low, high
                        count += 1
            if whole:
                continue
            reached = 0.0
            for k in range(count + 1):
                low = near[k, 0] if k < count else 1.0
                if low > reached + ROUNDING:
                    if size < len(shares):
                        shares[size, 0] = (piece + reached) / pieces
                        shares[size, 1] = (piece + low) / pieces
                    size += 1
                    gaps += 1
                if k < count:
                    reached = max(reached, near[k, 1])
        found[one] = gaps
