"""One power diagram at a time, of any weights, by the engine: what layers with a history need."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.model import Diagram, Floats, Section
from v3dcad.structure.sweep.kinetic_sweep import Sweep
from v3dcad.structure.sweep.sites import ALWAYS, SweptSites

Engine = Callable[[Floats, Floats, Section], Diagram]
"""(sites (n, 2) mm, weights (n,) mm², section) → their power diagram inside the section."""


def diagrams_on(grid: Grid) -> Engine:
    """The function that makes power diagrams of sites and weights snapped to a grid.

    It raises `GeometryError` for sites or sections that the engine cannot compute with.
    """

    def diagram_of(sites: Floats, weights: Floats, section: Section) -> Diagram:
        places, heavy = grid.snap(sites), grid.snap_weights(weights)
        numbers = np.arange(len(places))
        still, always = np.zeros(len(places), np.int64), np.full(len(places), ALWAYS)
        swept = SweptSites(places, still, heavy, -always, always, numbers)
        sweep = Sweep(grid, swept, np.zeros(1, np.int64), 2)
        return next(sweep.run([section], 0))[0]

    return diagram_of
