"""Compile the engine once, so that no later start has to wait for it."""

from __future__ import annotations

import numpy as np

from v3dcad.model import Section
from v3dcad.settings import FillSettings


def warm_up() -> None:
    """Load the engine, compiling it (some seconds, once) where numba's cache has it not yet."""
    from v3dcad.structure.fill import fill_sections

    ring = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    sites = np.array([[0.2, 0.2], [0.7, 0.3], [0.5, 0.8]])
    for _ in fill_sections(
        [Section(0.0, (ring,)), Section(0.2, (ring,))], sites, FillSettings()
    ).layers:
        pass
