"""Loops of random cells in a square that face each other, and the perimeter around them."""

from __future__ import annotations

import numpy as np
import shapely

from v3dcad.geometry.loops.loops import Loops
from v3dcad.geometry.loops.power_cells import PowerCells
from v3dcad.geometry.loops.region import Region
from v3dcad.toolpath.perimeters import rings

S = 0.45


def loops_of(seed: int, count: int) -> Loops:
    """Loops of random cells in a square, and the square's perimeter around them."""
    sites = np.random.default_rng(seed).uniform(0, 12, (count, 2))
    cells = PowerCells(sites, np.zeros(count), np.full(2, -1.0), np.full(2, 13.0))
    area = shapely.box(0, 0, 12, 12)
    found = Region(area, rings(area)).cut(*cells.drawn_in(S / 2), S, 0.01)
    # Neighbours run in opposite directions.
    outer = shapely.get_coordinates(shapely.box(-S, -S, 12 + S, 12 + S, ccw=False).exterior)[:-1]
    return found.and_these(Loops.of([outer], [-1]))


def place(loops: Loops, loop: int, along: float) -> shapely.Geometry:
    ring = loops.ring(loop)
    line = shapely.LineString(np.vstack([ring, ring[:1]]))
    return shapely.line_interpolate_point(line, along % line.length)
