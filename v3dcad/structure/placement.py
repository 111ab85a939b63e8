"""Where a part stands on the bed, and at which heights it is cut."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from v3dcad.arguments import numbers
from v3dcad.errors import SettingError
from v3dcad.model import Floats, Placement

SNAP = 1e-9
"""mm; a part that already lies this close to its place is not moved at all, so that placing a
placed part changes no bit of it."""

MOST_LAYERS = 1_000_000
"""Ten metres of layers of 0.01 mm."""

TOP = 1e-6
"""mm; a plane this close to the part's top cuts nothing off it and is not a layer."""


def on_bed(bounds: Floats, base_clearance: float = 0.0) -> Placement:
    """The shift that centres bounds (2, 3), mm, in x and y and puts their base on z = 0.

    With a clearance (mm) the base lies that far below z = 0.
    """
    x, y, _ = bounds.mean(axis=0)
    shift = -np.array([x, y, bounds[0, 2] + base_clearance])
    return Placement(np.eye(3), np.where(np.abs(shift) < SNAP, 0.0, shift))


def turned(degrees: Sequence[float]) -> Placement:
    """The rotation about x, then y, then z, each by so many degrees; exact in right angles.

    `SettingError` unless there are three finite numbers.
    """
    rotation = np.eye(3)
    for axis, angle in enumerate(numbers("rotate", degrees, 3).tolist()):
        quarters, rest = divmod(angle, 90.0)
        cosine, sine = np.cos(np.radians(rest)), np.sin(np.radians(rest))
        for _ in range(int(quarters % 4)):
            cosine, sine = -sine, cosine
        step = np.eye(3)
        first, second = (axis + 1) % 3, (axis + 2) % 3
        step[first, first] = step[second, second] = cosine
        step[first, second], step[second, first] = -sine, sine
        rotation = step @ rotation
    return Placement(rotation, np.zeros(3))


def upward(direction: Floats) -> Placement:
    """The least rotation that makes a unit vector (3,) point up (Rodrigues' formula)."""
    x, y, z = direction.tolist()
    if z < -1 + 1e-15:
        return turned((180.0, 0.0, 0.0))
    tilt = np.array([[0.0, 0.0, -x], [0.0, 0.0, -y], [x, y, 0.0]])
    return Placement(np.eye(3) + tilt + tilt @ tilt / (1 + z), np.zeros(3))


def layer_heights(top: float, layer_height: float, above: float = 0.0) -> Floats:
    """The heights a, a + h, a + 2h, … below `top`, mm, for sections `above` their layer's base.

    `SettingError` where h is above the part, or so small that they are more than `MOST_LAYERS`.
    """
    if layer_height > top + TOP:
        raise SettingError(
            "layer_height",
            f"--layer-height {layer_height:g}: the part is only {top:g} mm high; "
            "give a smaller layer height",
        )
    layers = (top - above - TOP) / layer_height
    if layers > MOST_LAYERS:
        raise SettingError(
            "layer_height",
            f"--layer-height {layer_height:g}: {layers:.3g} layers, more than {MOST_LAYERS:,}; "
            f"give at least {top / MOST_LAYERS:.2g}",
        )
    count = int(np.ceil(layers))
    return np.arange(float(max(count, 1))) * layer_height + above
