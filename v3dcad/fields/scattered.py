"""Values at scattered points, interpolated."""

from __future__ import annotations

from typing import Any

import numpy as np

from v3dcad.model import Floats
from v3dcad.settings import Field

FLAT = 1e-9
"""Points whose extent along an axis is a smaller share of the largest lie in a plane across it."""


def interpolated(points: Floats, values: Floats) -> Field:
    """The field that has values (n,) at points (n, 3): linear between them, beyond them that of the
    nearest.

    Points in a plane, or on a line, along the axes say nothing of the other directions, in which
    the field then does not change.
    """
    from scipy.interpolate import LinearNDInterpolator
    from scipy.spatial import KDTree, QhullError

    extent = np.ptp(points, axis=0)
    axes = np.flatnonzero(extent > FLAT * max(float(extent.max()), FLAT))
    if len(axes) == 0:
        return lambda x, y, z: np.full(np.shape(x), values[0])
    flat = points[:, axes]
    tree = KDTree(flat)
    linear: Any = None
    if len(axes) > 1 and len(flat) > len(axes) + 1:
        try:
            linear = LinearNDInterpolator(flat, values)
        except QhullError:  # on a slanted plane or line: the nearest values must do
            linear = None
    order = np.argsort(flat[:, 0], kind="stable")

    def field(x: Floats, y: Floats, z: Floats) -> Floats:
        at = np.stack([x, y, z], axis=-1)[..., axes]
        if len(axes) == 1:
            return np.asarray(np.interp(at[..., 0], flat[order, 0], values[order]))
        found = np.full(np.shape(x), np.nan) if linear is None else linear(at)
        missing = np.isnan(found)
        found[missing] = values[tree.query(at[missing])[1]]
        return np.asarray(found)

    return field
