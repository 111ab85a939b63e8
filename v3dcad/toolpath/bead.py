"""The cross-section of a bead."""

from __future__ import annotations

import math


def bead_area(width: float, height: float, shape: str) -> float:
    """Cross-section of a bead, mm²: a rectangle, or one with half-round sides ("rounded").

    The rounded one is as wide and as high as the rectangle around it; where it would be higher
    than wide, top and bottom are the round ones.
    """
    if shape == "rectangle":
        return width * height
    low = min(width, height)
    return low * (max(width, height) - low) + math.pi / 4 * low**2
