"""The steepest wall of a foam: the certificate of overhang, in whole numbers.

In the stretched space the wall between two sites leans from the vertical by the angle whose tangent
is |Δz| / |Δxy|, the same everywhere on it. With whole coordinates two walls are compared exactly.
Whether two sites share a wall is decided to the safe side: by cutting with loosened half-planes
(`wall.py`), over all pairs that a proven bound leaves (`reach.py`). A pair that stays undecided
counts.
"""

from __future__ import annotations

from fractions import Fraction
from math import sqrt
from typing import NamedTuple

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.compiled.arrays import FloatArray, FloatRows, IntArray
from v3dcad.geometry.compiled.intrinsics import sign_of_sum
from v3dcad.geometry.compiled.options import ENTRY, INLINED, compiled
from v3dcad.geometry.voronoi.bins import (
    CROWDED,
    ROOM,
    Bins,
    gather,
    near_first,
    too_uneven,
)
from v3dcad.geometry.voronoi.reach import cell_reaches
from v3dcad.geometry.voronoi.wall import (
    ROUNDING,
    Polygon,
    cut_by_box,
    polygon_room,
    wall,
)
from v3dcad.model import Ints

LARGEST = 1 << 50
"""Coordinates stay below it, so that floats hold them exactly."""

WIDEST = 1 << 30
"""Steps that a cell may reach, so that squares of offsets fit 62 bits."""


class SteepestWall(NamedTuple):
    """The wall that leans most, and its two sites."""

    sites: tuple[int, int]
    """their rows, ascending; (-1, -1) where no two sites share a wall"""
    rise: int
    """Δz², steps²"""
    run: int
    """Δx² + Δy², steps²; 0 for a wall that lies flat"""

    @property
    def tau(self) -> float:
        """|Δz| / |Δxy|: the stretch at which this wall leans 45°."""
        return sqrt(Fraction(self.rise, self.run)) if self.run else (np.inf if self.rise else 0.0)

    def within(self, tau_squared: Fraction | int) -> bool:
        """Whether τ² · Δxy² ≥ Δz², exactly."""
        return self.run * tau_squared >= self.rise


@compiled(INLINED)
def is_steeper(rise: int, run: int, worst: IntArray) -> int:
    """Whether rise / run is over that of the worst wall so far, exactly."""
    return sign_of_sum(rise, worst[3], -worst[2], run, 0, 0) > 0


@compiled(ENTRY)
def find_steepest(
    bins: Bins,
    places: FloatRows,
    reaches: FloatArray,
    low: FloatArray,
    high: FloatArray,
    polygon: Polygon,
    room: int,
    worst: IntArray,
) -> int:
    """Write the steepest wall in the box low … high into worst (4,): i, j, rise, run.

    Only pairs steeper than the worst wall so far are cut. Returns −1, or a site around which more
    than `room` sites are in reach.
    """
    names, offsets, squares = np.empty(room, np.int64), np.empty((room, 3)), np.empty(room)
    for site in range(len(places)):
        reach = reaches[site]
        if reach == 0:
            continue
        count = gather(bins, places, places[site], 2 * reach, names, offsets, squares)
        if count == CROWDED:
            return site
        near_first(count, 1.2 * reach, names, offsets, squares)
        for other in range(count):
            x, y, z = int(offsets[other, 0]), int(offsets[other, 1]), int(offsets[other, 2])
            if names[other] > site and is_steeper(z * z, x * x + y * y, worst):
                size = wall(offsets, count, other, reach, ROUNDING * reach * reach, polygon)
                if cut_by_box(polygon, size, places[site], low, high, ROUNDING * reach) > 0:
                    worst[0], worst[1], worst[2] = site, names[other], z * z
                    worst[3] = x * x + y * y
    return -1


def steepest_wall(sites: Ints, low: Ints, high: Ints) -> SteepestWall:
    """The steepest of the walls in the box low … high (3,) between sites (n, 3), in grid steps.

    Heights are those of the stretched space. No wall of the sites' Voronoi diagram that meets the
    box is steeper; time is linear in the number of sites. `GeometryError` for two sites in one
    place, and for coordinates beyond 2⁵⁰.
    """
    places = np.asarray(sites, np.float64)
    if len(sites) and np.abs(sites).max() > LARGEST:
        raise GeometryError("sites lie beyond 2⁵⁰ grid steps; use a coarser grid")
    order = np.lexsort(sites.T)
    twins = np.flatnonzero((np.diff(sites[order], axis=0) == 0).all(axis=1))
    if len(twins):
        raise GeometryError("it lies where another site lies", site=int(order[twins[0] + 1]))
    worst = np.array([-1, -1, 0, 1])
    if len(sites) > 1:
        lowest, highest = np.asarray(low, np.float64), np.asarray(high, np.float64)
        bins, reaches = cell_reaches(places, lowest, highest)
        if reaches.max() > WIDEST:
            raise GeometryError("cells reach over 2³⁰ grid steps; use a coarser grid")
        crowded = find_steepest(bins, places, reaches, lowest, highest, polygon_room(), ROOM, worst)
        if crowded >= 0:
            raise too_uneven(int(crowded))
    i, j, rise, run = worst.tolist()
    return SteepestWall((i, j), rise, run)
