"""The cells of sites as polyhedra, with walls, struts and joints in common.

Every wall is cut by itself (`cutting.py`), as a polygon whose corners are named by the sites
around: the two that share it and the two beyond its edges there. Corners of different walls with
the same four sites are one joint, edges with the same two joints one strut. Where more than four
sites lie on one sphere, walls name the same joint differently: joints nearer than `WELD` to each
other are welded, and walls that collapse left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from v3dcad.geometry.voronoi.cutting import cut_walls
from v3dcad.model import Floats, Ints

WELD = 1e-9
"""In mean spacings of sites: joints nearer to each other are one."""


class Ragged(NamedTuple):
    """Lists of different lengths in one array: list k is items[starts[k] : starts[k + 1]]."""

    starts: Ints
    """(k + 1,)"""
    items: Ints
    """(m,)"""

    def rows(self) -> Ints:
        """Which list each item (m,) belongs to."""
        return np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))


@dataclass(frozen=True, eq=False, slots=True)
class VoronoiCells:
    """The cells of some sites: polyhedra that share walls, struts and joints."""

    joints: Floats
    """(v, 3): where four cells meet"""
    joint_sites: Ragged
    """the sites around each joint, ascending: four, or more where they lie on one sphere"""
    struts: Ints
    """(s, 2) joints: the edges, where three cells meet"""
    strut_sites: Ragged
    """the sites around each strut, ascending: three, or more"""
    walls: Ints
    """(w, 2): the two sites of each wall, ascending"""
    wall_joints: Ragged
    """the joints around each wall, counter-clockwise seen from its second site"""
    wall_struts: Ints
    """(m,): the strut from each of these joints to the next of the same wall"""
    sites: Ints
    """(c,): the sites whose cells are whole, ascending"""
    cell_walls: Ragged
    """the walls of each of these"""

    def following(self) -> Ints:
        """(m,): the joint that follows each of `wall_joints.items` around its wall."""
        starts, items = self.wall_joints
        return items[_following(starts)]


def voronoi_cells(places: Floats, wanted: Ints) -> VoronoiCells:
    """The cells of the wanted (c,) among sites at places (n, 3).

    Their walls are all there, those with other sites among them. `GeometryError` for a wanted
    cell that has no end, and for two sites in one place; it names the site.
    """
    wanted = np.unique(wanted)
    pairs, sizes, quads, points = cut_walls(places, wanted)
    # Joints: corners named by the same four sites, and those in the same place.
    names, first = _numbered(np.sort(quads, axis=1))
    spacing = float((np.ptp(places, axis=0).prod() / len(places)) ** (1 / 3))
    close = KDTree(points[first]).query_pairs(WELD * spacing, output_type="ndarray")
    links = coo_array((np.ones(len(close)), close.T), shape=(len(first), len(first)))
    joints = np.asarray(connected_components(links, directed=False)[1][names], np.int64)
    # Corners that fell together leave their walls; and so do walls with fewer than three.
    walls = np.repeat(np.arange(len(sizes)), sizes)
    kept = joints != joints[_following(_starts(sizes))]
    kept &= np.bincount(walls[kept], minlength=len(sizes))[walls] > 2
    whole, walls = np.unique(walls[kept], return_inverse=True)
    _, joints = np.unique(joints[kept], return_inverse=True)
    pairs, quads, points = pairs[whole], quads[kept], points[kept]
    wall_joints = Ragged(_starts(np.bincount(walls)), joints)
    # Struts: edges between the same two joints.
    ends = np.sort(np.column_stack([joints, joints[_following(wall_joints.starts)]]), axis=1)
    struts, edge = _numbered(ends)
    cells = np.concatenate([pairs[:, 0], pairs[:, 1]])
    beside = np.isin(cells, wanted)
    numbers = np.tile(np.arange(len(pairs)), 2)[beside]
    return VoronoiCells(
        joints=points[np.unique(joints, return_index=True)[1]],
        joint_sites=_around(joints, quads),
        struts=ends[edge],
        strut_sites=_around(struts, quads[:, :3]),
        walls=pairs,
        wall_joints=wall_joints,
        wall_struts=struts,
        sites=wanted,
        cell_walls=_listed(np.searchsorted(wanted, cells[beside]), numbers, len(wanted)),
    )


def _starts(sizes: Ints) -> Ints:
    return np.concatenate([[0], np.cumsum(sizes)])


def _following(starts: Ints) -> Ints:
    """For each item of ragged lists, the item after it; the first one after the last."""
    following = np.arange(1, starts[-1] + 1)
    following[starts[1:] - 1] = starts[:-1]
    return following


def _numbered(rows: Ints) -> tuple[Ints, Ints]:
    """Numbers (m,) for rows (m, k), equal for equal ones; and the first row of each number."""
    order = np.lexsort(rows.T[::-1])
    fresh = np.ones(len(rows), np.bool_)
    fresh[1:] = (rows[order[1:]] != rows[order[:-1]]).any(axis=1)
    numbers = np.empty(len(rows), np.int64)
    numbers[order] = np.cumsum(fresh) - 1
    return numbers, order[fresh]


def _listed(owners: Ints, items: Ints, count: int) -> Ragged:
    """Items (m,) as lists of their owners (m,), ascending, each once."""
    _, first = _numbered(np.column_stack([owners, items]))
    return Ragged(_starts(np.bincount(owners[first], minlength=count)), items[first])


def _around(owners: Ints, sites: Ints) -> Ragged:
    """The sites (m, k) as lists of their owners (m,), ascending, each once."""
    count = sites.shape[1]
    return _listed(np.repeat(owners, count), sites.ravel(), int(owners.max(initial=-1)) + 1)
