"""Plane polygons in space that share their corners."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from v3dcad.model import Floats, Ints, Value

WELD = 1e-5
"""mm; corners this close are one, and an edge this short is none. The corners at an event of the
structure (a flip, a birth) come from different triangles, equal but for rounding."""


@dataclass(frozen=True, eq=False, slots=True)
class Facets(Value):
    """The walls between cells: plane convex polygons with shared corners.

    Seen from its second site a wall's corners run counter-clockwise, so that its normal points
    from the first site to the second.
    """

    points: Floats
    """(v, 3) mm"""
    slack: Floats
    """(v,) mm: how far from a point the corners lay that were welded into it"""
    corners: Ints
    """(c,) point ids, one wall after the other"""
    starts: Ints
    """(f + 1,) where each wall's corners begin"""
    sites: Ints
    """(f, 2) site ids, i < j"""

    def __len__(self) -> int:
        return len(self.sites)

    def moved(self, points: Floats) -> Facets:
        """The same walls on other points (v, 3), mm."""
        return Facets(points, self.slack, self.corners, self.starts, self.sites)

    def edges(self) -> Ints:
        """(c, 2) point ids: from each corner to the next one of the same wall."""
        return np.column_stack([self.corners, self.corners[_following(self.starts)]])

    def vectors(self) -> Floats:
        """(f, 3) the area of each wall, mm², along its normal (Newell's sum)."""
        if not len(self):
            return np.empty((0, 3))
        ends = self.points[self.edges()] - self.points.mean(axis=0)
        crossed = np.cross(ends[:, 0], ends[:, 1]) / 2
        return np.asarray(np.add.reduceat(crossed, self.starts[:-1], axis=0))

    def struts(self) -> Ints:
        """(s, 2) point ids, i < j, of the edges where three walls meet or more."""
        found, uses = np.unique(np.sort(self.edges(), axis=1), axis=0, return_counts=True)
        return np.asarray(found[uses > 2])


def welded_facets(sites: Ints, points: Floats, starts: Ints, sites_at: Floats) -> Facets:
    """Polygons (f), given one by one, with their corners shared.

    `sites` (f, 2), i < j, lie on the two sides of each, at the points `sites_at` (n, 3), mm;
    `points` (c, 3), mm, are the corners, `starts` (f + 1,) where each polygon begins. Corners may
    run either way. Polygons that shrink to less than a triangle are left out.
    """
    if not len(points):
        none = np.empty((0, 2), np.int64)
        return Facets(points, np.empty(0), none[:, 0], np.zeros(1, np.int64), none)
    pairs = KDTree(points).query_pairs(WELD, output_type="ndarray")
    near = coo_array((np.ones(len(pairs)), pairs.T), (len(points), len(points)))
    group = connected_components(near, directed=False)[1]
    first = np.unique(group, return_index=True)[1]
    slack = np.zeros(len(first))
    np.maximum.at(slack, group, np.linalg.norm(points - points[first[group]], axis=1))
    polygon = np.repeat(np.arange(len(sites)), np.diff(starts))
    kept = group != group[_following(starts)]
    kept &= np.bincount(polygon[kept], minlength=len(sites))[polygon] > 2
    counts = np.bincount(polygon[kept], minlength=len(sites))
    left = counts > 0
    found = Facets(
        points[first],
        slack,
        group[kept].astype(np.int64),
        np.concatenate([[0], np.cumsum(counts[left])]),
        sites[left],
    )
    across = sites_at[found.sites[:, 1]] - sites_at[found.sites[:, 0]]
    return _turned(found, (found.vectors() * across).sum(axis=1) < 0)


def _turned(walls: Facets, backwards: NDArray[np.bool_]) -> Facets:
    """The walls, some of them (f,) the other way round."""
    polygon = np.repeat(np.arange(len(walls)), np.diff(walls.starts))
    index = np.arange(len(polygon))
    mirrored = walls.starts[:-1][polygon] + walls.starts[1:][polygon] - 1 - index
    corners = walls.corners[np.where(backwards[polygon], mirrored, index)]
    return Facets(walls.points, walls.slack, corners, walls.starts, walls.sites)


def _following(starts: Ints) -> Ints:
    """(c,) for each corner in a list of polygons the index of the same polygon's next corner."""
    after = np.arange(1, starts[-1] + 1)
    after[starts[1:] - 1] = starts[:-1]
    return after
