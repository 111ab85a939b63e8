"""Travels that stay inside the part, where there is a way."""

from __future__ import annotations

import heapq

import numpy as np
import shapely

from v3dcad.model import Floats
from v3dcad.toolpath.perimeters import inset


class Traveller:
    """Finds ways over one layer: straight where that stays inside, else around the corners.

    The corners are those of the area drawn in by `margin` (mm) that stick into it; a shortest
    way bends nowhere else. What a way sees from a corner is asked only when it gets there
    (A*, Hart et al. 1968).
    """

    def __init__(self, area: shapely.Geometry, margin: float) -> None:
        shapely.prepare(area)
        self.area = area
        self.margin = margin
        self._corners: Floats | None = None

    def way(self, start: Floats, stop: Floats) -> Floats:
        """Points (k, 2), mm, from the first bend to `stop`; `stop` alone if no way is inside."""
        if self._sees(start, stop[None])[0]:
            return stop[None]
        # Without a common piece of area there is none.
        pieces = shapely.get_parts(self.area)
        both = shapely.intersects_xy(pieces, *start) & shapely.intersects_xy(pieces, *stop)
        return self._around(start, stop) if both.any() else stop[None]

    def _sees(self, start: Floats, stops: Floats) -> Floats:
        lines = np.stack([np.broadcast_to(start, stops.shape), stops], axis=1)
        return np.asarray(shapely.covers(self.area, shapely.linestrings(lines)))

    def _around(self, start: Floats, stop: Floats) -> Floats:
        if self._corners is None:
            self._corners = _inward_corners(self.area, self.margin)
        points = np.vstack([self._corners, start, stop])
        first, last = len(points) - 2, len(points) - 1
        left = np.hypot(*(points - stop).T)
        cost = np.full(len(points), np.inf)
        cost[first] = 0
        before = np.full(len(points), -1)
        settled = np.zeros(len(points), dtype=bool)
        queue = [(left[first], first)]
        while queue:
            here = heapq.heappop(queue)[1]
            if here == last:
                break
            if settled[here]:
                continue
            settled[here] = True
            longer = cost[here] + np.hypot(*(points - points[here]).T)
            nearer = np.nonzero(longer < cost)[0]
            nearer = nearer[self._sees(points[here], points[nearer])]
            cost[nearer] = longer[nearer]
            before[nearer] = here
            for there in nearer.tolist():
                heapq.heappush(queue, (cost[there] + left[there], there))
        way = []
        while last >= 0 and last != first:
            way.append(last)
            last = int(before[last])
        return points[way[::-1]] if last == first else stop[None]


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
