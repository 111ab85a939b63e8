"""One power diagram at a time, of any weights, by the engine: what layers with a history need."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from v3dcad.geometry.power_diagram.event_queue import ALWAYS
from v3dcad.geometry.power_diagram.grid import Grid, curve_order
from v3dcad.model import Diagram, Floats, Section
from v3dcad.structure.sweep.growing_sites import Timed
from v3dcad.structure.sweep.kinetic_sweep import Course

Engine = Callable[[Floats, Floats, Section], Diagram]
"""(sites (n, 2) mm, weights (n,) mm², section) → their power diagram inside the section."""


def diagrams_on(grid: Grid) -> Engine:
    """The function that makes power diagrams of sites and weights snapped to a grid.

    It raises `GeometryError` for sites or sections that the engine cannot compute with.
    """
    frame = grid.origin + np.array([[0.0], [grid.size]])

    def diagram_of(sites: Floats, weights: Floats, section: Section) -> Diagram:
        places, heavy = grid.snap(sites), grid.snap_weights(weights)
        order = curve_order(places)
        still, always = np.zeros(len(order), np.int64), np.full(len(order), ALWAYS)
        bed = np.zeros(len(order))
        standing = Timed(places[order], heavy[order], still, always, bed, order)
        course = Course(grid, standing, 0.0, np.array([section.z]), 1.0, frame)
        return next(course.run([section], 0, np.inf)).diagram

    return diagram_of
