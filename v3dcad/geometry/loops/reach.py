"""Which stretches of some segments lie far from others: exactly, and in linear time.

What lies within reach of a segment is a rectangle with half a disk at either end. It is convex, so
a line is in it from one place to one other. What all such stretches of a line leave is far.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from v3dcad.geometry.compiled.arrays import (
    BoolArray,
    ConstFloatRows,
    FloatArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import INLINED, UNCOUNTED, compiled
from v3dcad.geometry.loops.segments import Segments, beside
from v3dcad.model import Floats

PIECE = 40.0
"""Reaches: longer segments are looked at piece by piece, so that few others are near."""
ROUNDING = 1e-9
"""Shares of a piece: a shorter stretch is rounding."""
FIRST = 3
"""How many of those that follow each other are asked before all that are near."""


class Stretches(NamedTuple):
    """Stretches of segments, in order along each."""

    segment: IntArray
    """(k,) whose each is"""
    low: FloatArray
    """(k,) shares of the segment, 0 … 1, where each begins"""
    high: FloatArray
    """(k,) and ends"""


def far_from(
    ends: Floats, others: Segments, reach: float, asked: NDArray[np.bool_] | None = None
) -> Stretches:
    """What of segments lies farther than `reach` from others, mm.

    `ends` (n, 4) are x and y of where each begins, and of where it ends. A stretch may come in
    several that follow each other. Only segments `asked` (n,) are looked at, if that is given.
    """
    if asked is None:
        asked = np.ones(len(ends), np.bool_)
    count, room = len(others.ends), len(ends)
    near, spans = np.empty(count + 1, np.int64), np.empty((count, 2))
    while True:
        segment, low, high = np.empty(room, np.int64), np.empty(room), np.empty(room)
        size = _leave(
            ends, asked, others, reach, np.full(count, -1), near, spans, segment, low, high
        )
        if size <= room:
            return Stretches(segment[:size], low[:size], high[:size])
        room = size


@compiled(INLINED)
def _clipped(
    low: float, high: float, at: float, rise: float, least: float, most: float
) -> tuple[float, float]:
    """Where in low … high a value `at` + share · `rise` lies in least … most; 1, 0 if nowhere."""
    if rise == 0:
        return (low, high) if least <= at <= most else (1.0, 0.0)
    one, other = (least - at) / rise, (most - at) / rise
    low, high = max(low, min(one, other)), min(high, max(one, other))
    return (low, high) if low <= high else (1.0, 0.0)


@compiled(INLINED)
def within(
    ax: float, ay: float, bx: float, by: float, ends: ConstFloatRows, other: int, reach: float
) -> tuple[float, float]:
    """From where to where on a → b, in shares, it lies within reach of one of some segments.

    That has a row of `ends` (n, 4). 1, 0 if nowhere.
    """
    cx, cy, dx, dy = ends[other, 0], ends[other, 1], ends[other, 2], ends[other, 3]
    vx, vy, ex, ey = bx - ax, by - ay, dx - cx, dy - cy
    ux, uy = ax - cx, ay - cy
    length = math.sqrt(ex * ex + ey * ey)
    first, last = 1.0, 0.0
    if length > 0:
        # Not farther from its line; there, beside it and not before or after it.
        wide = reach * length
        at, rise = ex * uy - ey * ux, ex * vy - ey * vx
        if min(at, at + rise) > wide or max(at, at + rise) < -wide:
            return 1.0, 0.0
        low, high = _clipped(0.0, 1.0, at, rise, -wide, wide)
        if low > high:
            return 1.0, 0.0
        at, rise = ex * ux + ey * uy, ex * vx + ey * vy
        if min(at, at + rise) > length * length + wide or max(at, at + rise) < -wide:
            return 1.0, 0.0
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
    ends: ConstFloatRows,
    asked: BoolArray,
    others: Segments,
    reach: float,
    stamp: IntArray,
    near: IntArray,
    spans: FloatRows,
    segment: IntArray,
    begins: FloatArray,
    stops: FloatArray,
) -> int:
    """What others leave of segments: how many stretches; those without room are only counted.

    Stretches within reach are kept in order (`spans`) as they come. Where lines are laid much as
    those below, what a line ends on, or what follows that, is under the next one, too: these few
    are asked first.
    """
    size = visit = last = 0
    for one in range(len(ends)):
        if not asked[one]:
            continue
        x, y = ends[one, 0], ends[one, 1]
        dx, dy = ends[one, 2] - x, ends[one, 3] - y
        pieces = max(math.ceil(math.sqrt(dx * dx + dy * dy) / (PIECE * reach)), 1)
        for piece in range(pieces):
            ax, ay = x + piece / pieces * dx, y + piece / pieces * dy
            bx, by = x + (piece + 1) / pieces * dx, y + (piece + 1) / pieces * dy
            reached = 0.0
            for other in range(last, min(last + FIRST, len(others.ends))):
                low, high = within(ax, ay, bx, by, others.ends, other, reach)
                if low <= reached:
                    reached = max(reached, high)
                    if reached >= 1:
                        last = other
                        break
            if reached >= 1:
                continue
            visit += 1
            whole, count = False, 0
            for k in range(beside(others, ax, ay, bx, by, reach, stamp, visit, near)):
                low, high = within(ax, ay, bx, by, others.ends, near[k], reach)
                if low > high:
                    continue
                if low <= 0 and high >= 1:
                    whole, last = True, near[k]
                    break
                place = count
                while place > 0 and spans[place - 1, 0] > low:
                    spans[place, 0], spans[place, 1] = spans[place - 1, 0], spans[place - 1, 1]
                    place -= 1
                spans[place, 0], spans[place, 1] = low, high
                count += 1
                if high >= 1:
                    last = near[k]
            if whole:
                continue
            reached = 0.0
            for k in range(count + 1):
                low = spans[k, 0] if k < count else 1.0
                if low > reached + ROUNDING:
                    if size < len(segment):
                        segment[size] = one
                        begins[size] = (piece + reached) / pieces
                        stops[size] = (piece + low) / pieces
                    size += 1
                if k < count:
                    reached = max(reached, spans[k, 1])
    return size
