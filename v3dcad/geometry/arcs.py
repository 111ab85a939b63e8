"""Lengths of straight and circular steps."""

from __future__ import annotations

import numpy as np

from v3dcad.model import Floats


def lengths(start: Floats, stop: Floats, centre: Floats) -> Floats:
    """(n,) mm from start (n, d) to stop (n, d), d 2 or 3, along the arcs about centre (n, 2).

    Where the centre is NaN the step is straight. An arc is the shorter of the two between its
    ends, and lies at one height.
    """
    step = stop - start
    chord = np.sqrt((step * step).sum(axis=1))
    radius = np.hypot(*(start[:, :2] - centre).T)
    with np.errstate(invalid="ignore", divide="ignore"):
        arc = 2 * radius * np.arcsin(np.minimum(chord / (2 * radius), 1))
    return np.asarray(np.where(np.isnan(radius), chord, arc))
