"""Travels that stay inside the part, where there is a way."""

from __future__ import annotations

import heapq
from collections.abc import Iterator

import numpy as np
import shapely

from v3dcad.model import Floats
from v3dcad.toolpath.perimeters import inset

_Leg = tuple[float, int, int, float]
"""The least length of a way that takes it, mm; its end and its start; the length up to its end."""


class Traveller:
    """Finds ways over one layer: straight where that stays inside, else around the corners.

    The corners are those of the area drawn in by `margin` (mm) that stick into it; a shortest
    way bends nowhere else. The most promising leg is taken first (A*, Hart et al. 1968), and only
    then is it asked whether it stays inside (lazily: Cohen et al. 2014), which takes most time.
    """

    def __init__(self, area: shapely.Geometry, margin: float) -> None:
        shapely.prepare(area)
        self.area = area
        self.margin = margin
        self._corners: Floats | None = None

    def way(self, start: Floats, stop: Floats) -> Floats:
        """Points (k, 2), mm, from the first bend to `stop`; `stop` alone if no way is inside."""
        if self._sees(start, stop):
            return stop[None]
        # Without a common piece of area there is none.
        pieces = shapely.get_parts(self.area)
        both = shapely.intersects_xy(pieces, *start) & shapely.intersects_xy(pieces, *stop)
        return self._around(start, stop) if both.any() else stop[None]

    def _sees(self, start: Floats, stop: Floats) -> bool:
        return bool(shapely.covers(self.area, shapely.linestrings([start, stop])))

    def _around(self, start: Floats, stop: Floats) -> Floats:
        if self._corners is None:
            self._corners = _inward_corners(self.area, self.margin)
        points = np.vstack([self._corners, start, stop])
        first, last = len(points) - 2, len(points) - 1
        left = np.hypot(*(points - stop).T)
        before = np.full(len(points), -1)
        queue: list[tuple[float, int, int, float, Iterator[_Leg]]] = []

        def legs(here: int, length: float) -> Iterator[_Leg]:
            there = np.flatnonzero(before < 0)
            so_far = length + np.hypot(*(points[there] - points[here]).T)
            least = so_far + left[there]
            for k in np.argsort(least, kind="stable").tolist():
                yield float(least[k]), int(there[k]), here, float(so_far[k])

        def offer_next(of: Iterator[_Leg]) -> None:
            if leg := next(of, None):
                heapq.heappush(queue, (*leg, of))

        before[first] = first
        offer_next(legs(first, 0.0))
        while queue:
            _, there, here, length, others = heapq.heappop(queue)
            offer_next(others)
            if before[there] >= 0 or not self._sees(points[here], points[there]):
                continue
            before[there] = here
            if there == last:
                way = [last]
                while before[way[-1]] != first:
                    way.append(int(before[way[-1]]))
                return points[way[::-1]]
            offer_next(legs(there, length))
        return stop[None]


def _inward_corners(area: shapely.Geometry, margin: float) -> Floats:
    """(k, 2) corners of the area drawn in by `margin` that stick into it.

    Rings are thinned by half the margin, so that a round hole has few corners and the ways
    between them still keep off it.
    """
    drawn_in = inset(area, margin).simplify(margin / 2)
    found = [np.empty((0, 2))]
    for ring in shapely.get_rings(shapely.get_parts(shapely.normalize(drawn_in))):
        points = shapely.get_coordinates(ring)[:-1]
        arriving = points - np.roll(points, 1, axis=0)
        leaving = np.roll(points, -1, axis=0) - points
        turn = arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0]
        # `normalize` makes outer rings clockwise and holes counter-clockwise: the area is on
        # the right, and a left turn is a corner that sticks into it.
        found.append(points[turn > 0])
    return np.concatenate(found)
