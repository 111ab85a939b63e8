"""The sites of a foam of cells of one size, for a part in a box."""

from __future__ import annotations

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.geometry.power_diagram.grid import STEPS, Grid
from v3dcad.model import Floats
from v3dcad.structure.foam.sites import FoamSites
from v3dcad.structure.foam.tile import MARGIN_CELLS, pattern

MOST = 20_000_000
"""Sites: what a structure may have, some 4 GB of memory."""


def uniform_sites(
    low: Floats, high: Floats, cell_size: float, stretch: float, random_seed: int
) -> FoamSites:
    """The shipped sites, repeated in reach of the box low … high (3,), mm, bed coordinates.

    There are 1 / cell_size² cells a mm² in a horizontal section. Raises `SettingError` for cells
    larger than the box, smaller than the grid resolves, or more than `MOST`.
    """
    size = high - low
    if cell_size > max(size[0], size[1], size[2] / stretch):
        raise SettingError(
            "cell_size",
            f"--cell-size {cell_size:g}: larger than the part, {size[0]:g} × {size[1]:g} × "
            f"{size[2]:g} mm; give a smaller one",
        )
    margin = (MARGIN_CELLS + 0.01) * cell_size
    repeated = pattern(cell_size, random_seed, float(size[:2].max()) + 2 * margin)
    steps = repeated.pitch * np.array([1, 1, stretch])
    lowest, highest = (np.rint(corner / steps).astype(np.int64) for corner in (low, high))
    count = repeated.count_in(lowest, highest)
    if count > MOST:
        raise SettingError(
            "cell_size",
            f"--cell-size {cell_size:g}: {count:,} cells are more than memory holds "
            f"({MOST:,}); give a larger one",
        )
    places, spans = repeated.sites_in(lowest, highest)
    corner = lowest[:2] - repeated.margin
    grid = Grid(np.asarray(corner * repeated.pitch, np.float64), repeated.pitch * STEPS)
    places[:, :2] -= corner
    return FoamSites(grid, stretch, places, spans)
