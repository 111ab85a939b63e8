"""Sites scattered evenly in a rectangle, the same ones for a seed on every platform."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from v3dcad.errors import SettingError
from v3dcad.model import Floats

GRID = 1 << 24
"""Cells of the grid over the rectangle's longer side; the scatter works in whole cells, so that
its squared distances are exact and no platform can order them differently."""

CANDIDATES = 10


def scatter_sites(rectangle: Floats, count: int, random_seed: int) -> Floats:
    """`count` sites (count, 2), mm, spread evenly in a rectangle [[x0, y0], [x1, y1]], mm.

    Best-candidate sampling (Mitchell, "Spectrally optimal sampling for distribution ray
    tracing", SIGGRAPH 1991), as Grasshopper's Populate does: of ten random places, each new
    site takes the one farthest from all sites so far. Raises `SettingError` where the
    rectangle has no room for that many different sites.
    """
    low = rectangle[0]
    size = rectangle[1] - low
    step = float(size.max()) / GRID
    cells = np.maximum(size / step, 1.0).astype(np.int64)
    if count > cells.prod() // CANDIDATES:
        raise SettingError("sites", f"--sites {count}: the base rectangle has no room for so many")
    random = np.random.default_rng(random_seed)
    chosen = np.empty((count, 2))
    done = 0
    while done < count:
        # Distances to all earlier blocks come from one tree, those within the block one by one;
        # a block of about √done keeps both parts of the work small.
        block = min(count - done, max(16, int(np.sqrt(done)) * 4))
        places = random.integers(0, cells, (block, CANDIDATES, 2)).astype(np.float64)
        if done:
            nearest = np.asarray(KDTree(chosen[:done]).query(places)[0])
        else:
            nearest = np.full((block, CANDIDATES), np.inf)
        for k in range(block):
            fresh = chosen[done : done + k]
            distances = np.hypot(*(places[k, :, None] - fresh).T).min(axis=0, initial=np.inf)
            best = int(np.argmax(np.minimum(nearest[k], distances)))
            chosen[done + k] = places[k, best]
        done += block
    return np.asarray(low + (chosen + 0.5) * step)
