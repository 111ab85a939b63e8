"""Sites in a periodic box as sites in space: with their copies around the box."""

from __future__ import annotations

import numpy as np

from v3dcad.model import Floats


def with_copies(places: Floats, box: Floats, margin: float) -> Floats:
    """Sites (n, 3) of a periodic box from 0 to `box` (3,), and their copies within a margin of it.

    The sites themselves come first.
    """
    steps = np.arange(-1, 2)
    shifts = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    shifts = shifts[(shifts != 0).any(axis=1)]
    copies = (places[None] + shifts[:, None] * box).reshape(-1, 3)
    near = ((copies > -margin) & (copies < box + margin)).all(axis=1)
    return np.concatenate([places, copies[near]])
