"""The loops that a layer's cells are printed from: two beads for each wall, one in either cell."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import shapely

from v3dcad.geometry.loops.loops import Loops
from v3dcad.geometry.loops.power_cells import PowerCells
from v3dcad.geometry.loops.region import Region
from v3dcad.model import Layer
from v3dcad.toolpath.perimeters import inset, rings

LEAST_LENGTH = 2.0
"""Loops shorter than so many bead spacings are left out,"""
LEAST_WIDTH = 0.01
"""and those that are, on average, not so many bead spacings wide."""


def cell_loops(layer: Layer, within: shapely.Geometry, spacing: float) -> Loops:
    """The loops of all cells that have room for one, each owned by its site.

    A loop lies half a bead spacing (mm) inside its cell's walls and inside the area `within`. Loops
    run counter-clockwise, those around holes clockwise. Where a cell is too small for a loop, those
    around it lie a little apart: so walls move no faster than the foam's where a cell opens. Where
    none has room, all is one cell: that with the largest area.
    """
    core = inset(within, spacing / 2)
    if core.is_empty:
        return Loops.of([], [])
    region = _region(core)
    sites = layer.diagram.sites()
    places, weights = layer.state.sites[sites, :2], layer.state.weights[sites]
    left, bottom, right, top = core.bounds
    low, high = np.array([left, bottom]) - spacing, np.array([right, top]) + spacing

    cells = PowerCells(places, weights, low, high)
    length = LEAST_LENGTH * spacing
    least = length, LEAST_WIDTH * spacing * length
    loops = region.cut(*cells.drawn_in(spacing / 2), *least)
    if not len(loops.owner):
        largest = np.argmax(layer.diagram.areas(len(layer.state.sites))[sites])
        alone = np.arange(len(sites)) == largest
        loops = region.cut(*cells.drawn_in(spacing / 2, alone), *least)
    return replace(loops, owner=sites[loops.owner])


@lru_cache(maxsize=64)
def _region(core: shapely.Geometry) -> Region:
    """An area that cells are cut by; upright walls have the same on many layers."""
    return Region(core, rings(core))
