"""The cross-section of a bead."""

from __future__ import annotations

import math

import numpy as np

from v3dcad.model import BRIDGE, FEATURES, Floats
from v3dcad.settings import PrintSettings


def bead_area(width: float, height: float, shape: str) -> float:
    """Cross-section of a bead, mm²: a rectangle, or one with half-round sides ("rounded").

    The rounded one is as wide and as high as the rectangle around it; where it would be higher
    than wide, top and bottom are the round ones.
    """
    if shape == "rectangle":
        return width * height
    low = min(width, height)
    return low * (max(width, height) - low) + math.pi / 4 * low**2


def bead_areas(settings: PrintSettings, height: float, *, first: bool) -> Floats:
    """(`FEATURES`,) mm²: what is laid for a mm of each feature, on a layer of a `height`, mm."""
    area = bead_area(settings.bead_width, height, settings.bead_shape)
    flow = settings.first_layer_flow if first else settings.flow
    areas = np.full(FEATURES, area * flow / 100)
    areas[BRIDGE] = area * settings.bridge_flow / 100
    return areas


def bead_spacing(settings: PrintSettings, height: float) -> float:
    """How far apart beads fill a layer of a `height` between them, mm."""
    return bead_area(settings.bead_width, height, settings.bead_shape) / height
