"""A foam in space: its walls as plane polygons, its struts, and its steepest wall."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from v3dcad.geometry.solid.facets import Facets, welded_facets
from v3dcad.geometry.voronoi.steepest import SteepestWall, steepest_wall
from v3dcad.geometry.voronoi.walls import walls_in_box
from v3dcad.model import Floats, Ints, Value
from v3dcad.structure.foam.sites import FoamSites
from v3dcad.structure.walls import StrutAxes, Walls


@dataclass(frozen=True, eq=False, slots=True)
class Space(Value):
    """The walls of a foam in a box."""

    places: Floats
    """(n, 3) mm: the sites"""
    stretch: float
    sites: Ints
    """(w, 2) i < j: the sites of each wall"""
    points: Floats
    """(c, 3) mm: corners, one wall after the other"""
    starts: Ints
    """(w + 1,) where each wall begins"""

    def walls(self) -> Walls:
        """The walls as polygons, with their tilts."""
        i, j = self.sites.T
        apart = np.abs(self.places[j] - self.places[i])
        # The normal is (Δx, Δy, Δz / s²): the wall leans as it rises.
        rise = apart[:, 2] / self.stretch**2
        tilts = np.degrees(np.arctan2(rise, np.hypot(apart[:, 0], apart[:, 1])))
        return Walls(self.sites, self.points, self.starts, tilts)

    def facets(self) -> Facets:
        """The walls with shared corners."""
        return welded_facets(self.sites, self.points, self.starts)

    def strut_axes(self) -> StrutAxes:
        """The lines where three walls meet."""
        return strut_axes(self.facets())


def space_of(foam: FoamSites, box: Floats) -> Space:
    """The walls of a foam's sites in a box (2, 3), mm, bed coordinates."""
    squeezed = np.array([1, 1, 1 / foam.stretch])
    places = foam.millimetres()
    if not (box[0] < box[1]).all():
        return Space(
            places, foam.stretch, np.empty((0, 2), np.int64), np.empty((0, 3)), np.zeros(1, int)
        )
    sites, points, starts = walls_in_box(places * squeezed, *(box * squeezed))
    return Space(places, foam.stretch, sites, points / squeezed, starts)


def strut_axes(facets: Facets) -> StrutAxes:
    """The edges where three walls meet or more, each once; the three lowest sites name it."""
    ends = np.sort(facets.edges(), axis=1)
    wall = np.repeat(np.arange(len(facets)), np.diff(facets.starts))
    edges, edge = np.unique(ends, axis=0, return_inverse=True)
    around = np.column_stack([np.repeat(edge, 2), facets.sites[wall].ravel()])
    around = np.unique(around, axis=0)
    first = np.searchsorted(around[:, 0], np.arange(len(edges)))
    meets = np.flatnonzero(np.bincount(around[:, 0], minlength=len(edges)) > 2)
    sites = around[first[meets, None] + np.arange(3), 1]
    points = facets.points[edges[meets]]
    downwards = points[:, 0, 2] > points[:, 1, 2]
    points[downwards] = points[downwards, ::-1]
    return StrutAxes(sites, points)


def steepest_in(foam: FoamSites, low: Floats, high: Floats) -> SteepestWall:
    """The steepest wall of a foam's sites in the box low … high (3,), mm, exactly."""
    corner = np.append(foam.grid.origin, 0.0)
    steps = np.array([foam.grid.pitch, foam.grid.pitch, foam.step])
    lowest = np.floor((low - corner) / steps).astype(np.int64)
    highest = np.ceil((high - corner) / steps).astype(np.int64)
    return steepest_wall(foam.places, lowest, highest)


def tilt(wall: SteepestWall, stretch: float) -> float:
    """The angle of a wall from the vertical, degrees: tan = |Δz| / (s · |Δxy|), stretched space."""
    return math.degrees(math.atan2(math.sqrt(wall.rise), stretch * math.sqrt(wall.run)))
