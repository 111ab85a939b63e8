"""Stretches along the way of the nozzle, and the spans of what hangs of it.

A span is a stretch that touches nothing, with what hangs of it at both ends: from the edge of what
it lies on to the next edge. Its length is the distance of its two places that are farthest apart.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import shapely

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstIntArray,
    FloatArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.reach import Stretches, far_from
from v3dcad.geometry.loops.segments import Segments
from v3dcad.geometry.loops.union_find import root
from v3dcad.model import Floats, Ints

ROUNDING = 1e-6
"""mm: stretches this near to each other are one."""
APART = 1.0
"""mm between two ways of the nozzle where they are put one after the other on one line."""


class Way(NamedTuple):
    """Beads put one after the other on one line; where the nozzle stops, with room between."""

    ends: FloatRows
    """(n, 4) mm: x and y of where each bead begins, x and y of where it ends"""
    kind: IntArray
    """(n,) number of each one's kind"""
    at: FloatArray
    """(n,) mm along the line where each begins"""
    length: FloatArray
    """(n,) mm"""

    def beads(self, at: Floats) -> Ints:
        """(k,) the beads that lie at some mm (k,) along the line, and go on from there."""
        return np.maximum(np.searchsorted(self.at, at + ROUNDING, side="right") - 1, 0)

    def corners(self, spans: Floats) -> tuple[Floats, Ints]:
        """(k, 2) mm: ends and corners of stretches (s, 2) of the line, and (k,) whose each is."""
        room = len(self.at) + 2 * len(spans)
        corners, owner = np.empty((room, 2)), np.empty(room, np.int64)
        count = _corners(self, spans, corners, owner)
        return corners[:count], owner[:count]


@compiled(UNCOUNTED)
def place_at(way: Way, at: float) -> tuple[float, float]:
    """The place at some mm along a way; corners to the last bit."""
    bead = max(int(np.searchsorted(way.at, at + ROUNDING, side="right")) - 1, 0)
    along, length = at - way.at[bead], way.length[bead]
    x, y, u, v = way.ends[bead, 0], way.ends[bead, 1], way.ends[bead, 2], way.ends[bead, 3]
    if along > length - ROUNDING:
        return u, v
    if along < ROUNDING:
        return x, y
    share = along / max(length, ROUNDING)
    return x + share * (u - x), y + share * (v - y)


@compiled(UNCOUNTED)
def _corners(way: Way, spans: ConstFloatRows, corners: FloatRows, owner: IntArray) -> int:
    """How many ends and corners stretches of a way have; they are written, and whose each is."""
    size = 0
    for span in range(len(spans)):
        begin, end = spans[span, 0], spans[span, 1]
        owner[size] = span
        corners[size, 0], corners[size, 1] = place_at(way, begin)
        size += 1
        bead = int(np.searchsorted(way.at, begin + ROUNDING, side="right"))
        while bead < len(way.at) and way.at[bead] < end - ROUNDING:
            owner[size] = span
            corners[size, 0], corners[size, 1] = way.ends[bead, 0], way.ends[bead, 1]
            size += 1
            bead += 1
        owner[size] = span
        corners[size, 0], corners[size, 1] = place_at(way, end)
        size += 1
    return size


def way_of(before: Floats, points: Floats, kind: Ints) -> Way:
    """Steps to points (n, 3) from the last one, the first of all from `before` (3,)."""
    way = Way(np.empty((len(points), 4)), kind, *np.empty((2, len(points))))
    _line_up(before, points, way)
    return way


@compiled(UNCOUNTED)
def _line_up(before: ConstFloatArray, points: ConstFloatRows, way: Way) -> None:
    x, y, passed = before[0], before[1], 0.0
    for step in range(len(points)):
        u, v = points[step, 0], points[step, 1]
        if step > 0 and way.kind[step] != way.kind[step - 1]:
            passed += APART
        way.ends[step, 0], way.ends[step, 1], way.ends[step, 2], way.ends[step, 3] = x, y, u, v
        way.at[step], way.length[step] = passed, math.sqrt((u - x) ** 2 + (v - y) ** 2)
        passed += way.length[step]
        x, y = u, v


def spans_of(
    way: Way, of: Ints, low: Floats, high: Floats, under: Segments, width: float
) -> Floats:
    """(s, 2) mm along the way, where spans begin and end.

    Stretches of beads `of` (k,) from `low` to `high` hang. What touches nothing is grown by what
    hangs at both ends, but by no more than the width of a bead: so far does the bead's edge come
    in after its middle, where it crosses an edge at 30° or more.
    """
    rows, places = np.empty((len(of), 4)), np.empty((len(of), 2))
    run, runs = np.empty(len(of), np.int64), np.empty((len(of), 2))
    _run(way, of, low, high, rows, places, run, runs)
    free = far_from(rows, under, width)
    spans = np.empty((len(free.segment), 2))
    return spans[: _grow(free, places, run, runs, width, spans)]


@compiled(INTERNAL)
def merged(begin: float, end: float, stretches: FloatRows, count: int) -> int:
    """How many stretches there are with one more, in order; those that meet are one."""
    if count == 0 or begin > stretches[count - 1, 1] + ROUNDING:
        stretches[count, 0], stretches[count, 1] = begin, end
        count += 1
    stretches[count - 1, 1] = max(stretches[count - 1, 1], end)
    return count


@compiled(UNCOUNTED)
def _run(
    way: Way,
    of: ConstIntArray,
    low: ConstFloatArray,
    high: ConstFloatArray,
    rows: FloatRows,
    places: FloatRows,
    run: IntArray,
    runs: FloatRows,
) -> None:
    """Where stretches lie, in the plane and along the way; and the runs of those that meet."""
    count = 0
    for k in range(len(of)):
        x, y = way.ends[of[k], 0], way.ends[of[k], 1]
        dx, dy = way.ends[of[k], 2] - x, way.ends[of[k], 3] - y
        rows[k, 0], rows[k, 1] = x + low[k] * dx, y + low[k] * dy
        rows[k, 2], rows[k, 3] = x + high[k] * dx, y + high[k] * dy
        begin, length = way.at[of[k]], way.length[of[k]]
        places[k, 0], places[k, 1] = begin + low[k] * length, begin + high[k] * length
        count = merged(places[k, 0], places[k, 1], runs, count)
        run[k] = count - 1


@compiled(UNCOUNTED)
def _grow(
    free: Stretches,
    places: ConstFloatRows,
    run: ConstIntArray,
    runs: ConstFloatRows,
    width: float,
    spans: FloatRows,
) -> int:
    """How many spans come of what is `free` of stretches, grown inside the runs of these."""
    count = 0
    for k in range(len(free.segment)):
        one = free.segment[k]
        begin, size = places[one, 0], places[one, 1] - places[one, 0]
        from_ = max(begin + free.low[k] * size - width, runs[run[one], 0])
        to = min(begin + free.high[k] * size + width, runs[run[one], 1])
        count = merged(from_, to, spans, count)
    return count


def longest(way: Way, spans: Floats) -> tuple[float, tuple[float, float]]:
    """The longest of some spans (s, 2), mm, and a place in its middle.

    Stretches that have a corner in common are one span, as on both sides of a seam. Their lengths
    along the bead bound what they span, so that few have to be measured.
    """
    if not len(spans):
        return 0.0, (0.0, 0.0)
    corners, owner = way.corners(spans)
    whole = np.arange(len(spans))
    _join(corners, np.lexsort(corners.T), owner, whole)
    length = spans[:, 1] - spans[:, 0]
    bound = np.bincount(whole, length)
    best, found = 0.0, 0
    for span in np.argsort(-bound, kind="stable").tolist():
        if bound[span] <= best:
            break
        apart = _diameter(corners[whole[owner] == span])
        if apart > best:
            best, found = apart, span
    middle = spans[np.argmax(np.where(whole == found, length, 0.0))].mean()
    return best, place_at(way, float(middle))


@compiled(UNCOUNTED)
def _join(
    corners: ConstFloatRows, order: ConstIntArray, owner: ConstIntArray, whole: IntArray
) -> None:
    """Fill in the first of the spans that each is one with: those that have a corner in common.

    `order` is one in which equal corners follow each other.
    """
    for k in range(1, len(order)):
        one, other = order[k - 1], order[k]
        if corners[one, 0] == corners[other, 0] and corners[one, 1] == corners[other, 1]:
            here, there = root(whole, owner[one]), root(whole, owner[other])
            whole[max(here, there)] = min(here, there)
    for span in range(len(whole)):
        whole[span] = root(whole, span)


def _diameter(points: Floats) -> float:
    """The distance of the farthest two of some points (k, 2), which are corners of their hull."""
    if len(points) > 2:
        points = shapely.get_coordinates(shapely.convex_hull(shapely.MultiPoint(points)))
    return float(np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1)).max())
