"""What can be measured on the cells of sites: volumes, centroids, extents, sections."""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.voronoi.cells import VoronoiCells
from v3dcad.model import Floats, Ints


def volumes_and_centroids(cells: VoronoiCells, places: Floats) -> tuple[Floats, Floats]:
    """The volumes (c,) and centroids (c, 3) of cells; places (n, 3) are all sites'.

    Each wall is a fan of triangles, each triangle the base of a tetrahedron with the site on top.
    """
    walls = cells.wall_joints.rows()
    pivot = cells.joints[cells.wall_joints.items[cells.wall_joints.starts[:-1]]][walls]
    corner, later = cells.joints[cells.wall_joints.items], cells.joints[cells.following()]
    volumes, moments = np.zeros(len(cells.sites)), np.zeros((len(cells.sites), 3))
    for side, sign in ((0, 1 / 6), (1, -1 / 6)):
        rows, cell = _cells_beside(cells, walls, side)
        apex = places[cells.sites[cell]]
        a, b, c = pivot[rows] - apex, corner[rows] - apex, later[rows] - apex
        parts = sign * (a * np.cross(b, c)).sum(axis=1)
        np.add.at(volumes, cell, parts)
        np.add.at(moments, cell, parts[:, None] * (a + b + c) / 4)
    return volumes, places[cells.sites] + moments / volumes[:, None]


def extents(cells: VoronoiCells) -> tuple[Floats, Floats]:
    """The lowest and highest coordinates (c, 3) of cells."""
    points, starts = cells.joints[cells.wall_joints.items], cells.wall_joints.starts[:-1]
    walls, owners = cells.cell_walls.items, cells.cell_walls.starts[:-1]
    low = np.minimum.reduceat(np.minimum.reduceat(points, starts)[walls], owners)
    high = np.maximum.reduceat(np.maximum.reduceat(points, starts)[walls], owners)
    return low, high


def section_areas(cells: VoronoiCells, height: float) -> Floats:
    """The area (c,) that a horizontal plane cuts out of each cell; 0 where it misses the cell.

    A wall's polygon, counter-clockwise seen from its second site, crosses the plane twice, once
    downward and once upward; in this order the crossings run along the section of the first site's
    cell, which lies on their left.
    """
    corners, nexts = cells.joints[cells.wall_joints.items], cells.joints[cells.following()]
    above, later = corners[:, 2] > height, nexts[:, 2] > height
    crossings = []
    for crossed in (above & ~later, ~above & later):
        a, b = corners[crossed], nexts[crossed]
        share = (height - a[:, 2]) / (b[:, 2] - a[:, 2])
        crossings.append((a + share[:, None] * (b - a))[:, :2])
    parts = (crossings[0][:, 0] * crossings[1][:, 1] - crossings[0][:, 1] * crossings[1][:, 0]) / 2
    walls = cells.wall_joints.rows()[above & ~later]
    areas = np.zeros(len(cells.sites))
    for side, sign in ((0, 1.0), (1, -1.0)):
        rows, cell = _cells_beside(cells, walls, side)
        np.add.at(areas, cell, sign * parts[rows])
    return areas


def _cells_beside(cells: VoronoiCells, walls: Ints, side: int) -> tuple[Ints, Ints]:
    """Of walls (m,) those whose first (0) or second (1) site has a whole cell; and these cells."""
    sites = cells.walls[walls, side]
    cell = np.minimum(np.searchsorted(cells.sites, sites), len(cells.sites) - 1)
    rows = np.flatnonzero(cells.sites[cell] == sites)
    return rows, cell[rows]
