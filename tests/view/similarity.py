"""How alike two pictures are: the mean structural similarity of their colours.

Wang, Bovik, Sheikh and Simoncelli, 2004.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter

from v3dcad.model import Floats

SPREAD = 1.5
"""Of the window, pixels: as in the paper."""


def similarity(one: Floats, other: Floats) -> float:
    """1 for two pictures (h, w, 3), 0 … 1, that are the same; about 0 where nothing is alike."""
    lightness, contrast = 0.01**2, 0.03**2

    def blurred(values: Floats) -> Floats:
        return gaussian_filter(values, (SPREAD, SPREAD, 0))

    a, b = blurred(one), blurred(other)
    spread_a, spread_b = blurred(one * one) - a * a, blurred(other * other) - b * b
    common = blurred(one * other) - a * b
    alike = (2 * a * b + lightness) * (2 * common + contrast)
    return float(np.mean(alike / ((a * a + b * b + lightness) * (spread_a + spread_b + contrast))))
