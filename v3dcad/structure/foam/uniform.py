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
    smaller than the grid resolves, or more than `MOST`.
    """
    size = high - low
    margin = (MARGIN_CELLS + 0.01) * cell_size
    repeated = pattern(cell_size, random_seed, float(size[:2].max()) + 2 * margin)
    steps = repeated.pitch * np.array([1, 1, stretch])
    lowest, highest = (np.rint(corner / steps).astype(np.int64) for corner in (low, high))
    count = repeated.count_in(lowest, highest)
    refuse_many(count, cell_size)
    places, spans = repeated.sites_in(lowest, highest)
    corner = lowest[:2] - repeated.margin
    grid = Grid(np.asarray(corner * repeated.pitch, np.float64), repeated.pitch * STEPS)
    places[:, :2] -= corner
    return FoamSites(grid, stretch, places, spans)


def refuse_larger(cell_size: float, size: Floats) -> None:
    """Raise `SettingError` for cells larger than a part of a size (3,), mm, in the stretched space,
    in all directions.
    """
    if cell_size > size.max():
        raise SettingError(
            "cell_size",
            f"--cell-size {cell_size:g}: larger than the part, in which {size.max():.3g} mm fit; "
            "give a smaller one",
        )


def refuse_many(count: int, cell_size: float) -> None:
    """Raise `SettingError` for more cells than `MOST`."""
    if count > MOST:
        raise SettingError(
            "cell_size",
            f"--cell-size {cell_size:g}: {count:,} cells are more than memory holds "
            f"({MOST:,}); give a larger one",
        )
