"""The walls of all sites in a box, each as one polygon."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, FloatRows, IntArray, IntRows
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.geometry.voronoi.bins import (
    CROWDED,
    ROOM,
    Bins,
    gather,
    sort_by_distance,
    too_uneven,
)
from v3dcad.geometry.voronoi.reach import cell_reaches
from v3dcad.geometry.voronoi.wall import Polygon, cut_by_box, in_space, polygon_room, wall
from v3dcad.model import Floats, Ints

EXPECTED = 48
"""Corners to make room for, for each site, at first."""

FULL = -2
"""There is no room for more corners."""


class WallRows(NamedTuple):
    """Room for walls, one behind the other."""

    sites: IntRows
    """(w, 2) i < j"""
    sizes: IntArray
    """(w,) number of corners"""
    points: FloatRows
    """(c, 3) the corners, counter-clockwise seen from j"""


@compiled(ENTRY)
def write_walls(
    bins: Bins,
    places: FloatRows,
    reaches: FloatArray,
    low: FloatArray,
    high: FloatArray,
    polygon: Polygon,
    rows: WallRows,
) -> tuple[int, int, int]:
    """Write all walls in the box low … high.

    Returns how many walls and corners, and −1: or a site around which too many others are in
    reach, or `FULL`.
    """
    names, offsets, squares = np.empty(ROOM, np.int64), np.empty((ROOM, 3)), np.empty(ROOM)
    corners = np.empty((len(polygon.edges), 3))
    walls, filled = 0, 0
    for site in range(len(places)):
        reach = reaches[site]
        if reach == 0:
            continue
        count = gather(bins, places, places[site], 2 * reach, names, offsets, squares)
        if count == CROWDED:
            return walls, filled, site
        sort_by_distance(count, names, offsets, squares)
        for other in range(count):
            if names[other] <= site:
                continue
            size = wall(offsets, count, other, reach, 0.0, polygon)
            size = cut_by_box(polygon, size, places[site], low, high, 0.0)
            if size < 3:
                continue
            if walls == len(rows.sizes) or filled + size > len(rows.points):
                return walls, filled, FULL
            in_space(polygon, size, corners)
            rows.sites[walls, 0], rows.sites[walls, 1] = site, names[other]
            rows.sizes[walls] = size
            walls += 1
            for corner in range(size):
                for axis in range(3):
                    rows.points[filled, axis] = places[site, axis] + corners[corner, axis]
                filled += 1
    return walls, filled, -1


def walls_in_box(places: Floats, low: Floats, high: Floats) -> tuple[Ints, Floats, Ints]:
    """The walls between sites at places (n, 3) in the box low … high (3,).

    Returns their sites (w, 2), i < j, their corners (c, 3), one wall after the other and
    counter-clockwise seen from site j, and where each begins (w + 1,). Raises `GeometryError` for
    sites so uneven that over `ROOM` are near one.
    """
    if len(places) < 2:
        return np.empty((0, 2), np.int64), np.empty((0, 3)), np.zeros(1, np.int64)
    bins, reaches = cell_reaches(places, low, high)
    room, ended = EXPECTED * len(places), FULL
    while ended == FULL:
        rows = WallRows(
            np.empty((room // 3, 2), np.int64), np.empty(room // 3, np.int64), np.empty((room, 3))
        )
        walls, corners, ended = write_walls(bins, places, reaches, low, high, polygon_room(), rows)
        room *= 2
    if ended >= 0:
        raise too_uneven(ended)
    starts = np.concatenate([[0], np.cumsum(rows.sizes[:walls])])
    return rows.sites[:walls], rows.points[:corners], starts
