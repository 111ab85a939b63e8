"""Convex cells cut by an area: chains of its contours inside a cell, linked along the cell's sides.

Each contour is followed from where it enters a cell to where it leaves it. From there the cell's
own sides lead, counter-clockwise, to where the next chain enters (Weiler and Atherton, "Hidden
surface removal using polygon area sorting", SIGGRAPH 1977; one of the two polygons is convex here).
"""

from __future__ import annotations

import math

import numpy as np
import shapely

from v3dcad.geometry.compiled.arrays import (
    BoolArray,
    ConstFloatRows,
    ConstIntArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled
from v3dcad.geometry.loops.convex_cells import (
    GRAZING,
    comes_near,
    crossing,
    look_inside,
    place_along,
)
from v3dcad.geometry.loops.loops import Loops
from v3dcad.geometry.loops.segments import Segments, bin_range
from v3dcad.model import Floats, Ints

SHORTEST = 1e-7
"""mm: a shorter chain is none."""
NUDGE = np.array([3.1, 1.7]) * 1e-11
"""mm by which contours are moved, so that none lies exactly along a cell's side or ends on it: such
ties would have to be told apart, and rounded numbers cannot (Edelsbrunner and Mücke, "Simulation
of simplicity", 1990, move points by amounts too small to compute with)."""


class Region:
    """An area, by its contours, that cells can be cut by; empty ones, too."""

    def __init__(self, area: shapely.Geometry, contours: list[Floats]) -> None:
        self.area = area
        self._loops = Loops.of([ring + NUDGE for ring in contours], [*range(len(contours))])
        self._after = self._loops.after()
        shapely.prepare(area)
        if len(contours):
            points = self._loops.points
            self._segments = Segments.of(points, points[self._after], GRAZING)

    def cut(self, corners: Floats, first: Ints, least_length: float, least_area: float) -> Loops:
        """What convex cells have of the area: the loops around it, each owned by a cell's number.

        Cell c has the corners first[c] … first[c + 1], counter-clockwise. The area is on the left
        of each loop; two of its points may be the same but for rounding. Loops shorter than
        `least_length` (mm), or around less than `least_area` (mm²), are left out.
        """
        if not len(self._loops.points) or not len(corners):
            return Loops.of([], [])
        seen = np.zeros((len(first) - 1, 2))
        look_inside(corners, first, seen)
        inside = shapely.contains_xy(self.area, seen)
        rooms = np.array([2 * len(corners) + 4 * len(self._loops.points), len(first) + 64])
        while True:
            points = np.empty((rooms[0], 2))
            starts, owner = np.empty(rooms[1] + 1, np.int64), np.empty(rooms[1], np.int64)
            count, used = _cut(
                corners, first, inside, self._loops.points,
                self._after, self._segments, least_length, least_area, points, starts, owner,
            )  # fmt: skip
            if used <= rooms[0] and count <= rooms[1]:
                return Loops(points[:used], starts[: count + 1], owner[:count])
            rooms = np.maximum(2 * rooms, [used, count])


@compiled(INTERNAL)
def _put(points: FloatRows, used: int, x: float, y: float) -> int:
    if used < len(points):
        points[used, 0], points[used, 1] = x, y
    return used + 1


@compiled(INTERNAL)
def _closed(
    points: FloatRows, start: int, used: int, least_length: float, least_area: float
) -> bool:
    """Whether the loop of the points start … used is one that counts."""
    if used > len(points):
        return True
    if used - start < 3:
        return False
    length, area = 0.0, 0.0
    for k in range(start, used):
        after = k + 1 if k + 1 < used else start
        dx, dy = points[after, 0] - points[k, 0], points[after, 1] - points[k, 1]
        length += math.sqrt(dx * dx + dy * dy)
        area += (points[k, 0] - points[start, 0]) * dy - (points[k, 1] - points[start, 1]) * dx
    return length >= least_length and abs(area) >= 2 * least_area


@compiled(ENTRY)
def _cut(
    corners: ConstFloatRows,
    first: ConstIntArray,
    inside: BoolArray,
    rim: ConstFloatRows,
    after: ConstIntArray,
    segments: Segments,
    least_length: float,
    least_area: float,
    points: FloatRows,
    starts: IntArray,
    owner: IntArray,
) -> tuple[int, int]:
    """Number of loops and of points; what there is no room for is only counted."""
    count, used = 0, 0
    starts[0] = 0
    frame, shape = segments.frame, segments.shape
    per_mm, bin_first, items = 1 / frame[2], segments.first, segments.items
    stamp, passed = np.full(len(rim), -1), np.full(len(rim), -1)
    near = np.empty(len(rim), np.int64)
    # Chains: where each enters and leaves, and its points.
    chain = np.empty((2 * len(rim) + 2, 2))
    chain_first = np.empty(len(rim) + 2, np.int64)
    enters_at, leaves_at = np.empty(len(rim) + 1), np.empty(len(rim) + 1)
    done = np.empty(len(rim) + 1, np.bool_)
    for cell in range(len(first) - 1):
        low, high = first[cell], first[cell + 1]
        if low == high:
            continue
        left, right = corners[low, 0], corners[low, 0]
        bottom, top = corners[low, 1], corners[low, 1]
        for k in range(low + 1, high):
            left, right = min(left, corners[k, 0]), max(right, corners[k, 0])
            bottom, top = min(bottom, corners[k, 1]), max(top, corners[k, 1])
        columns = bin_range(left, right, frame[0], per_mm, shape[0])
        rows = bin_range(bottom, top, frame[1], per_mm, shape[1])
        found = 0
        for row in range(rows[0], rows[1] + 1):
            for bin_ in range(row * shape[0] + columns[0], row * shape[0] + columns[1] + 1):
                for k in range(bin_first[bin_], bin_first[bin_ + 1]):
                    segment = items[k]
                    if stamp[segment] == cell:
                        continue
                    stamp[segment] = cell
                    near[found] = segment
                    found += comes_near(rim, segment, after[segment], left, bottom, right, top)
        chains, filled = 0, 0
        chain_first[0] = 0
        for k in range(found):
            segment = near[k]
            end = after[segment]
            a_in, b_in, enters, way_in, leaves, way_out = crossing(
                corners, low, high,
                rim[segment, 0], rim[segment, 1], rim[end, 0], rim[end, 1],
            )  # fmt: skip
            if a_in or (leaves <= enters and not b_in):
                continue
            x = rim[segment, 0] + enters * (rim[end, 0] - rim[segment, 0])
            y = rim[segment, 1] + enters * (rim[end, 1] - rim[segment, 1])
            chain[filled, 0], chain[filled, 1] = x, y
            filled += 1
            enters_at[chains] = place_along(corners, low, high, way_in, x, y)
            passed[segment] = cell
            while b_in:
                chain[filled, 0], chain[filled, 1] = rim[end, 0], rim[end, 1]
                filled += 1
                segment, end = end, after[end]
                passed[segment] = cell
                _, b_in, _, _, leaves, way_out = crossing(
                    corners, low, high,
                    rim[segment, 0], rim[segment, 1], rim[end, 0], rim[end, 1],
                )  # fmt: skip
            x = rim[segment, 0] + leaves * (rim[end, 0] - rim[segment, 0])
            y = rim[segment, 1] + leaves * (rim[end, 1] - rim[segment, 1])
            chain[filled, 0], chain[filled, 1] = x, y
            filled += 1
            length = 0.0
            for j in range(chain_first[chains] + 1, filled):
                dx, dy = chain[j, 0] - chain[j - 1, 0], chain[j, 1] - chain[j - 1, 1]
                length += math.sqrt(dx * dx + dy * dy)
            if length < SHORTEST:
                filled = chain_first[chains]
                continue
            leaves_at[chains] = place_along(corners, low, high, way_out, x, y)
            done[chains] = False
            chains += 1
            chain_first[chains] = filled

        for begin in range(chains):
            if done[begin]:
                continue
            start, current = used, begin
            while not done[current]:
                done[current] = True
                for j in range(chain_first[current], chain_first[current + 1]):
                    used = _put(points, used, chain[j, 0], chain[j, 1])
                # Along the sides to the next chain that enters.
                here, ahead, following = leaves_at[current], math.inf, -1
                for other in range(chains):
                    way = enters_at[other] - here
                    if way < 0:
                        way += high - low
                    if way < ahead:
                        ahead, following = way, other
                side = math.floor(here)
                for _ in range(math.floor(here + ahead) - side):
                    side += 1
                    corner = low + side % (high - low)
                    used = _put(points, used, corners[corner, 0], corners[corner, 1])
                current = following
            if _closed(points, start, used, least_length, least_area):
                if count < len(owner):
                    owner[count], starts[count + 1] = cell, used
                count += 1
            else:
                used = start
        if chains == 0 and inside[cell]:
            start = used
            for k in range(low, high):
                used = _put(points, used, corners[k, 0], corners[k, 1])
            if _closed(points, start, used, least_length, least_area):
                if count < len(owner):
                    owner[count], starts[count + 1] = cell, used
                count += 1
            else:
                used = start
        # Contours that lie inside the cell altogether.
        for k in range(found):
            segment = near[k]
            if passed[segment] == cell:
                continue
            start, current, whole = used, segment, True
            while passed[current] != cell:
                passed[current] = cell
                end = after[current]
                a_in, b_in, _, _, _, _ = crossing(
                    corners, low, high,
                    rim[current, 0], rim[current, 1], rim[end, 0], rim[end, 1],
                )  # fmt: skip
                if not (a_in and b_in):
                    whole = False
                    break
                used = _put(points, used, rim[current, 0], rim[current, 1])
                current = end
            if whole and _closed(points, start, used, least_length, least_area):
                if count < len(owner):
                    owner[count], starts[count + 1] = cell, used
                count += 1
            else:
                used = start
    return count, used
