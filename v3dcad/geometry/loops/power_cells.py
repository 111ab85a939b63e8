"""The convex power cells of weighted sites, with their sides moved inwards."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from v3dcad.geometry.compiled.arrays import (
    BoolArray,
    ConstFloatArray,
    ConstFloatRows,
    FloatRows,
    Int32Array,
    Int32Rows,
    IntArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.power_diagram.grid import Grid, curve_order
from v3dcad.geometry.power_diagram.regular_triangulation import triangulation
from v3dcad.geometry.power_diagram.triangle_mesh import ABSENT, ACROSS, SENTINELS, corner_at
from v3dcad.model import Floats, Ints


class PowerCells:
    """The cells of sites (n, 2), mm, with weights (n,), mm², inside a box `low` … `high` (2,).

    Who is whose neighbour comes from their regular triangulation.
    """

    def __init__(self, sites: Floats, weights: Floats, low: Floats, high: Floats) -> None:
        # Weights count only relative to each other; small ones leave the grid fine.
        self._weights = np.asarray(weights - (weights.min() + weights.max()) / 2)
        self._sites = np.array(sites, dtype=np.float64)
        self._corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]], np.float64)
        grid = Grid.around(
            np.minimum(sites.min(axis=0), low),
            np.maximum(sites.max(axis=0), high),
            float(np.abs(self._weights).max()),
        )
        places = grid.snap(sites)
        self._order = curve_order(places)
        self._mesh = triangulation(
            places[self._order], grid.snap_weights(self._weights[self._order]), self._order
        )

    def drawn_in(
        self, distance: float, present: NDArray[np.bool_] | None = None
    ) -> tuple[Floats, Ints]:
        """The cells with the sides between two sites moved inwards by a distance (mm).

        Corners (k, 2), counter-clockwise, those of cell c first[c] … first[c + 1]; and first
        (n + 1,). What is left of a cell is the box cut by half-planes; where nothing is, it has no
        corners. Where sites that have cells are not `present` (n,), all is as if they were absent.
        Time goes with the square of a cell's neighbours, of which there are few.
        """
        count = len(self._sites)
        points, first = np.empty((10 * count, 2)), np.empty(count + 1, np.int64)
        row_of = np.empty(count, np.int64)
        row_of[self._order] = np.arange(count)
        size = _draw_in(
            self._sites,
            self._weights,
            np.ones(count, np.bool_) if present is None else present,
            self._corners,
            self._order,
            row_of,
            self._mesh.triangles,
            self._mesh.triangle_of,
            distance,
            np.empty((count + 5, 2)),
            np.empty((count + 5, 2)),
            np.empty(count, np.int64),
            np.full(count, -1),
            points,
            first,
        )
        return points[:size].copy(), first


@compiled(INTERNAL)
def _cut_off(
    now: ConstFloatRows, size: int, dx: float, dy: float, most: float, left: FloatRows
) -> int:
    """What is `left` of a convex polygon where x · dx + y · dy is at most so much: its corners."""
    kept = 0
    for j in range(size):
        i = j - 1 if j > 0 else size - 1
        here = most - now[j, 0] * dx - now[j, 1] * dy
        before = most - now[i, 0] * dx - now[i, 1] * dy
        if (here < 0) != (before < 0):
            share = before / (before - here)
            left[kept, 0] = now[i, 0] + share * (now[j, 0] - now[i, 0])
            left[kept, 1] = now[i, 1] + share * (now[j, 1] - now[i, 1])
            kept += 1
        if here >= 0:
            left[kept, 0], left[kept, 1] = now[j, 0], now[j, 1]
            kept += 1
    return kept


@compiled(UNCOUNTED)
def _draw_in(
    sites: ConstFloatRows,
    weights: ConstFloatArray,
    present: BoolArray,
    box: ConstFloatRows,
    order: IntArray,
    row_of: IntArray,
    triangles: Int32Rows,
    triangle_of: Int32Array,
    distance: float,
    now: FloatRows,
    left: FloatRows,
    around: IntArray,
    stamp: IntArray,
    points: FloatRows,
    first: IntArray,
) -> int:
    """Write what is left of each cell to `points`; returns how many there are.

    A site that is absent leaves its room to its neighbours, who then have borders with each other:
    so whoever is beside it is asked in its place.
    """
    written = 0
    for site in range(len(sites)):
        first[site] = written
        if not present[site]:
            continue
        x, y = sites[site, 0], sites[site, 1]
        size = 0
        if triangle_of[row_of[site] + SENTINELS] != ABSENT:
            size = 4
            for k in range(4):
                now[k, 0], now[k, 1] = box[k, 0] - x, box[k, 1] - y
        stamp[site] = site
        around[0], asked, known = site, 0, 1
        while asked < known and size >= 3:
            point = row_of[around[asked]] + SENTINELS
            asked += 1
            start = triangle = triangle_of[point]
            while True:
                corner = corner_at(triangles, triangle, point)
                beside = triangles[triangle, (corner + 1) % 3]
                triangle = triangles[triangle, ACROSS + (corner + 1) % 3]
                if beside >= SENTINELS:
                    other = order[beside - SENTINELS]
                    new = stamp[other] != site
                    stamp[other] = site
                    if new and not present[other]:
                        around[known] = other
                        known += 1
                    elif new:
                        dx, dy = sites[other, 0] - x, sites[other, 1] - y
                        apart = math.sqrt(dx * dx + dy * dy)
                        dx, dy = dx / apart, dy / apart
                        most = (apart + (weights[site] - weights[other]) / apart) / 2 - distance
                        size = _cut_off(now, size, dx, dy, most, left)
                        now, left = left, now
                if size < 3 or triangle == start:
                    break
        if size >= 3:
            for k in range(size):
                points[written, 0], points[written, 1] = now[k, 0] + x, now[k, 1] + y
                written += 1
    first[len(sites)] = written
    return written
