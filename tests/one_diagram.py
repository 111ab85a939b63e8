"""Single power diagrams by the engine, on a grid whose pitch is a power of two."""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.structure.sweep.one_layer import diagrams_on

GRID = Grid(np.array([-32.0, -32.0]), 64.0)
power_diagram = diagrams_on(GRID)
