"""The walls of whole cells, cut from all sites that can matter.

A site can only cut a cell if it is at most twice as far away as the cell reaches. So a cell is cut
from the sites within a radius, and again from those within a greater one, until that radius is
twice its reach.
"""

from __future__ import annotations

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.compiled.arrays import BoolArray, FloatRows, IntArray, IntRows
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled
from v3dcad.geometry.voronoi.bins import (
    CROWDED,
    ROOM,
    Bins,
    bins_of,
    gather,
    sort_by_distance,
    too_uneven,
)
from v3dcad.geometry.voronoi.neighbours import spacing_at
from v3dcad.geometry.voronoi.wall import OPEN, Polygon, in_space, polygon_room, wall
from v3dcad.model import Floats, Ints

CORNERS = 4096
"""Corners of all walls of one cell."""

EXPECTED = 64
"""Corners to make room for, for each cell."""

FULL, UNBOUNDED, TWINS, TOO_MANY = range(1, 5)
"""Why `cut_cells` stops early: no room for another cell's walls, a cell that has no end, two sites
in one place, too many sites near one."""


@compiled(INTERNAL)
def cut_cell(
    offsets: FloatRows,
    count: int,
    reach: float,
    polygon: Polygon,
    points: FloatRows,
    sizes: IntArray,
    edges: IntRows,
    corners: FloatRows,
) -> float:
    """Cut the walls of the site at the origin with all others at offsets (count, 3).

    Writes each wall's number of corners, 0 where there is none; and, one after the other, the two
    edges beside each corner, and the corner. Returns how far the cell reaches, infinity where it
    is not closed.
    """
    farthest, filled = 0.0, 0
    for other in range(count):
        sizes[other] = 0
        if offsets[other, 0] == 0 and offsets[other, 1] == 0 and offsets[other, 2] == 0:
            continue
        size = wall(offsets, count, other, reach, 0.0, polygon)
        if filled + size > len(edges):
            return np.inf
        in_space(polygon, size, points)
        sizes[other] = size
        for corner in range(size):
            edges[filled, 0] = polygon.edges[corner - 1 if corner > 0 else size - 1]
            edges[filled, 1] = polygon.edges[corner]
            if edges[filled, 1] == OPEN:
                return np.inf
            square = 0.0
            for axis in range(3):
                corners[filled, axis] = points[corner, axis]
                square += points[corner, axis] ** 2
            farthest = max(farthest, square)
            filled += 1
    return np.sqrt(farthest)


@compiled(ENTRY)
def cut_cells(
    bins: Bins,
    places: FloatRows,
    wanted: IntArray,
    is_wanted: BoolArray,
    whole: float,
    polygon: Polygon,
    pairs: IntRows,
    sizes: IntArray,
    quads: IntRows,
    corners: FloatRows,
) -> tuple[int, int, int, int]:
    """Cut the cells of the wanted (c,) and write each wall once, for as many as there is room.

    pairs (w, 2), sizes (w,), and for each corner of each: quads (m, 4), the wall's two sites, the
    one beyond the edge to the next corner and the one beyond the edge before; corners (m, 3).
    `whole` is a radius that all sites are in. Returns how many walls, how many corners, why it
    ended (0 at the end), and at which site.
    """
    names, offsets, squares = np.empty(ROOM, np.int64), np.empty((ROOM, 3)), np.empty(ROOM)
    found, edges = np.empty(ROOM, np.int64), np.empty((CORNERS, 2), np.int64)
    points, own = np.empty((len(polygon.edges), 3)), np.empty((CORNERS, 3))
    walls, filled = 0, 0
    for site in wanted:
        radius = 2.5 * spacing_at(bins, places[site])
        while True:
            count = gather(bins, places, places[site], radius, names, offsets, squares)
            if count == CROWDED:
                return walls, filled, TOO_MANY, site
            sort_by_distance(count, names, offsets, squares)
            reach = cut_cell(offsets, count, 2 * radius, polygon, points, found, edges, own)
            if 2 * reach <= radius:
                break
            if radius > 4 * whole:
                return walls, filled, UNBOUNDED, site
            radius = min(2 * reach * (1 + 1e-9), 2 * radius)
        row = 0
        for other in range(count):
            size, name = found[other], names[other]
            if name != site and squares[other] == 0:
                return walls, filled, TWINS, site
            if size > 0 and (site < name or not is_wanted[name]):
                if walls == len(sizes) or filled + size > len(quads):
                    return walls, filled, FULL, site
                # Counter-clockwise seen from the site of the higher number.
                turned = name < site
                pairs[walls, 0], pairs[walls, 1] = min(site, name), max(site, name)
                sizes[walls] = size
                walls += 1
                for step in range(size):
                    corner = row + (size - 1 - step if turned else step)
                    after, before = (0, 1) if turned else (1, 0)
                    quads[filled, 0], quads[filled, 1] = min(site, name), max(site, name)
                    quads[filled, 2] = names[edges[corner, after]]
                    quads[filled, 3] = names[edges[corner, before]]
                    for axis in range(3):
                        corners[filled, axis] = places[site, axis] + own[corner, axis]
                    filled += 1
            row += size
    return walls, filled, 0, 0


def cut_walls(places: Floats, wanted: Ints) -> tuple[Ints, Ints, Ints, Floats]:
    """The walls of the cells of the wanted (c,), ascending, among sites at places (n, 3).

    For each wall: its two sites (w, 2), ascending, and its number of corners (w,). For each corner,
    counter-clockwise seen from the second site: the four sites around it (m, 4), the wall's own
    first, then the one beyond the edge to the next corner; and its place (m, 3). `GeometryError`
    for a cell without end and two sites in one place.
    """
    low, high = places.min(axis=0), places.max(axis=0)
    bins = bins_of(places, low, high, periodic=False)
    is_wanted = np.zeros(len(places), np.bool_)
    is_wanted[wanted] = True
    room, reason, site = EXPECTED * len(wanted) + CORNERS, FULL, 0
    while reason == FULL:
        pairs, sizes = np.empty((room // 3, 2), np.int64), np.empty(room // 3, np.int64)
        quads, corners = np.empty((room, 4), np.int64), np.empty((room, 3))
        whole = float(np.linalg.norm(high - low))
        polygon = polygon_room()
        walls, filled, reason, site = cut_cells(
            bins, places, wanted, is_wanted, whole, polygon, pairs, sizes, quads, corners
        )
        room *= 2
    if reason == TOO_MANY:
        raise too_uneven(site)
    if reason == UNBOUNDED:
        raise GeometryError("its cell has no end; sites around it are missing", site=site)
    if reason == TWINS:
        raise GeometryError("it lies where another site lies", site=site)
    return pairs[:walls], sizes[:walls], quads[:filled], corners[:filled]
