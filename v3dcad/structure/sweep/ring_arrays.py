"""The rings of some layers' sections as long arrays, ready to be walked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, FloatRows, IntArray
from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.model import Section

HAIR = 2.0**-20
"""Grid steps: far above the rounding of a walk, 1e-8 steps, and too little to be seen elsewhere."""


class Rings(NamedTuple):
    """The rings of some layers' sections."""

    corners: FloatRows
    """(r, 2) float64 mm"""
    stepped: FloatRows
    """(r, 2) float64 grid steps: where they are walked"""
    after: IntArray
    """(r,) int64: which of its layer's corners follows each on its ring"""
    starts: IntArray
    """(rings + 1,) int64: where each ring begins"""
    layers: IntArray
    """(layers + 1,) int64: where each layer's rings begin"""
    areas: FloatArray
    """(layers,) float64 mm²: positive where outer rings run counter-clockwise"""


def rings_of(sections: Sequence[Section], grid: Grid) -> Rings:
    """The rings of sections, to be walked a `HAIR` to the left of their sides."""
    rings = [ring for section in sections for ring in section.rings]
    lengths = np.array([len(ring) for ring in rings], np.int64)
    starts = np.concatenate([[0], np.cumsum(lengths)])
    layers = np.cumsum([0, *(len(section.rings) for section in sections)])
    corners = np.empty((starts[-1], 2))
    if rings:
        np.concatenate(rings, out=corners)  # row by row, however the rings lie in memory
    following = np.arange(1, len(corners) + 1)
    following[starts[1:][lengths > 0] - 1] = starts[:-1][lengths > 0]

    x, y = (corners[following] - corners).T
    length = np.sqrt(x * x + y * y)
    length[length == 0] = np.inf
    left = HAIR * np.column_stack([-y, x]) / length[:, None]
    stepped = (corners - grid.origin) / grid.pitch + left
    stepped[following] += left

    x, y = (corners - corners[np.repeat(starts[:-1], lengths)]).T
    double = x * y[following] - y * x[following]
    first, areas = starts[layers], np.zeros(len(sections))
    some = first[1:] > first[:-1]
    areas[some] = np.add.reduceat(double, first[:-1][some]) / 2
    after = following - np.repeat(first[:-1], np.diff(first))
    return Rings(corners, stepped, after, starts, layers, areas)
