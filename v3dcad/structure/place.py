"""Where a part stands on the bed, and at which heights it is cut."""

from __future__ import annotations

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.model import Floats, Placement

SNAP = 1e-9
"""mm; a part that already lies this close to its place is not moved at all, so that placing a
placed part changes no bit of it."""

TOP = 1e-6
"""mm; a plane this close to the part's top cuts nothing off it and is not a layer."""


def on_bed(bounds: Floats) -> Placement:
    """The shift that centres bounds (2, 3), mm, in x and y and puts their base on z = 0."""
    x, y, _ = bounds.mean(axis=0)
    shift = -np.array([x, y, bounds[0, 2]])
    return Placement(np.eye(3), np.where(np.abs(shift) < SNAP, 0.0, shift))


def layer_heights(top: float, layer_height: float) -> Floats:
    """The heights 0, h, 2h, … below `top`, mm; `SettingError` where h is above the part."""
    if layer_height > top + TOP:
        raise SettingError(
            "layer_height",
            f"--layer-height {layer_height:g}: the part is only {top:g} mm high; "
            "give a smaller layer height",
        )
    count = int(np.ceil((top - TOP) / layer_height))
    return np.arange(float(max(count, 1))) * layer_height
