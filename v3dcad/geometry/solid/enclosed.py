"""Which walls and cells lie wholly inside a part, told by its triangles: these need no cutting.

Nothing is claimed of what comes near the surface. A wall is clear of a triangle where a plane lies
between them: that of the wall, that of the triangle, or one across an axis (three of the separating
axes of convex bodies; where only others part them, the wall counts as near). Clear walls that share
a corner lie on the same side of the surface, and the winding number of one of their corners tells
on which. (Jacobson et al., "Robust inside-outside segmentation using generalized winding numbers",
ACM Trans. Graph. 2013.)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from v3dcad.geometry.mesh.bodies import bodies_of
from v3dcad.geometry.solid.facets import Facets
from v3dcad.model import Floats, Ints, Mesh

INSIDE, NEAR, OUTSIDE = 1, 0, -1
"""Sides of a surface; what may cross it is near."""

AT_ONCE = 512
"""Triangles compared with walls in one go, which bounds the memory."""


class CellWalls(NamedTuple):
    """The walls of some cells, one cell after the other."""

    sites: Ints
    """(c,) ascending"""
    starts: Ints
    """(c + 1,) where the walls of each begin"""
    walls: Ints
    """(m,) numbers of walls"""
    turned: NDArray[np.bool_]
    """(m,) whether the wall's normal points into the cell"""


def cell_walls(walls: Facets) -> CellWalls:
    """The walls of all cells."""
    first, second = walls.sites.T
    owners = np.concatenate([first, second])
    order = np.argsort(owners, kind="stable")
    sites, begins = np.unique(owners[order], return_index=True)
    return CellWalls(sites, np.append(begins, len(order)), order % len(walls), order >= len(walls))


def sides_of(walls: Facets, surface: Mesh, margin: float) -> Ints:
    """(f,) on which side of a closed surface walls lie, or `NEAR` within a margin of it, mm."""
    clear = ~_near(walls, surface, margin)
    wall = np.repeat(np.arange(len(walls)), np.diff(walls.starts))[clear[_wall_of(walls)]]
    corners = walls.corners[clear[_wall_of(walls)]]
    touching = coo_array((np.ones(len(wall)), (wall, corners)), (len(walls), len(walls.points)))
    group = connected_components(touching @ touching.T, directed=False)[1]
    groups, first = np.unique(group[clear], return_index=True)
    some = walls.points[walls.corners[walls.starts[:-1][clear][first]]]
    sides = np.where(winding_numbers(some, surface) > 0.5, INSIDE, OUTSIDE)
    found = np.full(len(walls), NEAR)
    found[clear] = sides[np.searchsorted(groups, group[clear])]
    return found


def whole_cells(walls: Facets, inside: NDArray[np.bool_], surface: Mesh) -> CellWalls:
    """The cells that lie wholly inside a surface, given which walls (f,) do.

    All their walls are inside and close around them, and no body of the surface lies in them.
    """
    cells = cell_walls(walls)
    cell = np.repeat(np.arange(len(cells.sites)), np.diff(cells.starts))
    whole = np.logical_and.reduceat(inside[cells.walls], cells.starts[:-1])
    whole &= _closed(walls, cells)
    vectors = walls.vectors()
    on = (vectors * walls.points[walls.corners[walls.starts[:-1]]]).sum(axis=1)
    body = bodies_of(surface.triangles)
    firsts = surface.triangles[np.unique(body, return_index=True)[1], 0]
    for point in surface.vertices[firsts]:
        behind = (vectors @ point < on)[cells.walls] != cells.turned
        whole &= ~np.logical_and.reduceat(behind, cells.starts[:-1])
    kept = whole[cell]
    counts = np.diff(cells.starts)[whole]
    return CellWalls(
        cells.sites[whole],
        np.concatenate([[0], np.cumsum(counts)]),
        cells.walls[kept],
        cells.turned[kept],
    )


def volumes_and_middles(walls: Facets, cells: CellWalls) -> tuple[Floats, Floats]:
    """The volumes (c,), mm³, of closed cells, and a point (c, 3) inside each: its corners' mean.

    By the divergence theorem: each wall is the base of a pyramid with that point on top.
    """
    sums = np.add.reduceat(walls.points[walls.corners], walls.starts[:-1])[cells.walls]
    counts = np.diff(walls.starts)[cells.walls]
    middles = np.add.reduceat(sums, cells.starts[:-1])
    middles /= np.add.reduceat(counts, cells.starts[:-1])[:, None]
    middle = np.repeat(middles, np.diff(cells.starts), axis=0)
    height = walls.points[walls.corners[walls.starts[:-1]]][cells.walls] - middle
    parts = (walls.vectors()[cells.walls] * height).sum(axis=1) / 3
    return np.add.reduceat(np.where(cells.turned, -parts, parts), cells.starts[:-1]), middles


def winding_numbers(points: Floats, surface: Mesh) -> Floats:
    """(k,) how often a closed surface runs around points (k, 3): 1 inside, 0 outside.

    The sum of the solid angles of its triangles (Van Oosterom and Strackee, "The solid angle of a
    plane triangle", IEEE Trans. Biomed. Eng. 1983).
    """
    found = np.empty(len(points))
    for k, point in enumerate(points):
        corners = surface.vertices[surface.triangles] - point
        a, b, c = corners.transpose(1, 0, 2)
        x, y, z = np.linalg.norm(corners, axis=2).T
        below = x * y * z + (a * b).sum(1) * z + (b * c).sum(1) * x + (c * a).sum(1) * y
        found[k] = np.arctan2((a * np.cross(b, c)).sum(1), below).sum() / (2 * np.pi)
    return found


def _wall_of(walls: Facets) -> Ints:
    """(c,) which wall each corner belongs to."""
    return np.repeat(np.arange(len(walls)), np.diff(walls.starts))


def _closed(walls: Facets, cells: CellWalls) -> NDArray[np.bool_]:
    """(c,) whether every edge of a cell is between two of its walls."""
    _, edge = np.unique(np.sort(walls.edges(), axis=1), axis=0, return_inverse=True)
    site = walls.sites[_wall_of(walls)]
    rows = np.searchsorted(cells.sites, site) * (int(edge.max(initial=-1)) + 1) + edge[:, None]
    found, uses = np.unique(rows, return_counts=True)
    open_cells = found[uses != 2] // (int(edge.max(initial=-1)) + 1)
    return np.bincount(open_cells, minlength=len(cells.sites)) == 0


def _near(walls: Facets, surface: Mesh, margin: float) -> NDArray[np.bool_]:
    """(f,) whether a wall may come within a margin of a surface."""
    points = walls.points[walls.corners]
    low = np.minimum.reduceat(points, walls.starts[:-1]) - margin
    high = np.maximum.reduceat(points, walls.starts[:-1]) + margin
    tree = shapely.STRtree(shapely.box(*low[:, :2].T, *high[:, :2].T))
    normals = _unit(walls.vectors())
    offsets = (points[walls.starts[:-1]] * normals).sum(axis=1)
    near = np.zeros(len(walls), np.bool_)
    for start in range(0, len(surface.triangles), AT_ONCE):
        corners = surface.vertices[surface.triangles[start : start + AT_ONCE]]
        lowest, highest = corners.min(axis=1), corners.max(axis=1)
        boxes = shapely.box(*lowest[:, :2].T, *highest[:, :2].T)
        triangle, wall = tree.query(boxes)
        level = (low[wall, 2] <= highest[triangle, 2]) & (lowest[triangle, 2] <= high[wall, 2])
        level &= ~near[wall]
        triangle, wall = triangle[level], wall[level]
        heights = (corners[triangle] * normals[wall, None]).sum(axis=2) - offsets[wall, None]
        level = (heights.min(axis=1) <= margin) & (heights.max(axis=1) >= -margin)
        triangle, wall = triangle[level], wall[level]
        near[wall[_crossed(walls, wall, corners[triangle], margin)]] = True
    return near


def _crossed(walls: Facets, wall: Ints, corners: Floats, margin: float) -> NDArray[np.bool_]:
    """(p,) whether walls (p,) come within a margin of the planes of triangles (p, 3, 3)."""
    a, b, c = corners.transpose(1, 0, 2)
    normals = _unit(np.cross(b - a, c - a))
    sizes = np.diff(walls.starts)[wall]
    begins = np.cumsum(sizes) - sizes
    pair = np.repeat(np.arange(len(wall)), sizes)
    corner = np.arange(len(pair)) + (walls.starts[wall] - begins)[pair]
    heights = ((walls.points[walls.corners[corner]] - a[pair]) * normals[pair]).sum(axis=1)
    if not len(wall):
        return np.zeros(0, np.bool_)
    least, most = np.minimum.reduceat(heights, begins), np.maximum.reduceat(heights, begins)
    return np.asarray((least <= margin) & (most >= -margin))


def _unit(vectors: Floats) -> Floats:
    """Vectors (k, 3) with a length of 1; 0 stays 0, the normal of what separates nothing."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.where(lengths > 0, lengths, 1.0))
