"""The colours of what is drawn, by what it is.

Two hues of Okabe and Ito's palette and a grey: colour-blind eyes tell apart all that is shown
together. Each has a contrast of at least 3 : 1 (WCAG 2, graphical objects) against white and
against a dark background, #222222, which leaves no room for lighter or darker ones.
"""

from __future__ import annotations

import numpy as np

from v3dcad.model import Floats

VERMILLION, BLUE, GREY = "#d55e00", "#0072b2", "#808080"

COLOURS = {
    "contour": VERMILLION,
    "wall": BLUE,
    "cell": VERMILLION,
    "neighbour": BLUE,
    "tree": VERMILLION,
    "context": GREY,
    "perimeter": VERMILLION,
    "bead": BLUE,
    "travel": GREY,
    "seam": VERMILLION,
}
"""By role: the part's contours, walls between cells, the cell that was asked for, its neighbours,
the spanning tree, and what only says where in the part one is; of a toolpath the perimeters, all
other beads, the moves without extrusion, and the points where perimeters begin."""

RAMP = (BLUE, GREY, VERMILLION)
"""The colours of the least, the middle and the greatest of values; between them evenly mixed."""


def rgb(colour: str) -> Floats:
    """Red, green and blue (3,), 0 … 1, of a colour written as #rrggbb."""
    return np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255


def ramp(shares: Floats) -> Floats:
    """The colours (n, 3), 0 … 1, of values as shares (n,) of the way from least to greatest."""
    stops = np.array([rgb(colour) for colour in RAMP])
    places = np.linspace(0, 1, len(stops))
    return np.column_stack([np.interp(shares, places, stop) for stop in stops.T])
