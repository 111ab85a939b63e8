"""The colours of what is drawn, by what it is.

Two hues of Okabe and Ito's palette and a grey: colour-blind eyes tell apart all that is shown
together. Each has a contrast of at least 3 : 1 (WCAG 2, graphical objects) against white and
against a dark background, #222222, which leaves no room for lighter or darker ones.
"""

from __future__ import annotations

VERMILLION, BLUE, GREY = "#d55e00", "#0072b2", "#808080"

COLOURS = {
    "contour": VERMILLION,
    "wall": BLUE,
    "cell": VERMILLION,
    "neighbour": BLUE,
    "tree": VERMILLION,
    "context": GREY,
}
"""By role: the part's contours, walls between cells, the cell that was asked for, its neighbours,
the spanning tree, and what only says where in the part one is."""
