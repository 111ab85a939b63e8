"""The loops that a layer's cells are printed from: two beads for each wall, one in either cell."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import shapely

from v3dcad.geometry.loops.loops import Loops
from v3dcad.geometry.loops.power_cells import PowerCells
from v3dcad.geometry.loops.region import Region
from v3dcad.model import Ints, Layer
from v3dcad.toolpath.perimeters import inset, rings

LEAST_RADIUS = 0.55
"""Cells into which no circle of so many bead spacings fits are left out."""
LEAST_LENGTH = 2.0
"""Loops shorter than so many bead spacings are left out,"""
LEAST_WIDTH = 0.01
"""and those that are, on average, not so many bead spacings wide."""


def cell_loops(
    layer: Layer, within: shapely.Geometry, spacing: float, without: Ints | None = None
) -> Loops:
    """The loops of all cells but those `without` a loop, each owned by its site.

    A loop lies half a bead spacing (mm) inside its cell's walls and inside the area `within`. Loops
    run counter-clockwise, those around holes clockwise. A cell too small for a loop is left
    out, too: all others are as if its site were absent. Where none would stay, the largest does.
    """
    core = inset(within, spacing / 2)
    if core.is_empty:
        return Loops.of([], [])
    region = _region(core)
    sites = layer.diagram.sites()
    if without is not None:
        some = sites[~np.isin(sites, without)]
        sites = some if len(some) else sites
    places, weights = layer.state.sites[sites, :2], layer.state.weights[sites]
    left, bottom, right, top = core.bounds
    low, high = np.array([left, bottom]) - spacing, np.array([right, top]) + spacing

    cells = PowerCells(places, weights, low, high)
    roomy = region.cut(*cells.drawn_in(LEAST_RADIUS * spacing), 0.0, 0.0)
    kept = np.zeros(len(sites), np.bool_)
    kept[roomy.owner] = True
    if not kept.any():
        kept[np.argmax(layer.diagram.areas(len(layer.state.sites))[sites])] = True
    least = LEAST_LENGTH * spacing
    loops = region.cut(*cells.drawn_in(spacing / 2, kept), least, LEAST_WIDTH * spacing * least)
    return replace(loops, owner=sites[loops.owner])


@lru_cache(maxsize=64)
def _region(core: shapely.Geometry) -> Region:
    """An area that cells are cut by; upright walls have the same on many layers."""
    return Region(core, rings(core))
