"""Lengths of straight and circular steps."""

from __future__ import annotations

import numpy as np

from v3dcad.model import Floats


def lengths(start: Floats, stop: Floats, centre: Floats) -> Floats:
    """(n,) mm from start (n, d) to stop (n, d), d 2 or 3, along the arcs about centre (n, 2).

    Where the centre is NaN the step is straight. An arc is the shorter of the two between its
    ends, and lies at one height.
    """
    square = np.zeros(len(start))
    for here, there in zip(start.T, stop.T, strict=True):
        step = there - here
        square += step * step
    length = np.sqrt(square)
    (turns,) = np.nonzero(~np.isnan(centre[:, 0]))
    if len(turns):
        radius = np.hypot(*(start[turns, :2] - centre[turns]).T)
        half = np.minimum(length[turns] / np.maximum(2 * radius, 1e-300), 1)
        length[turns] = 2 * radius * np.arcsin(half)
    return length
