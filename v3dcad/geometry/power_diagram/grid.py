"""The integer grid that the engine computes on.

2²⁴ steps over the side of a stated square: 60 nm over a metre. Weights are integers in steps².
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstIntRows,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.options import ENTRY, UNCOUNTED, compiled
from v3dcad.model import Floats, Ints

STEPS = 1 << 24
"""Grid steps over the frame's side."""

AREAS = 16
"""How many times the frame's area the largest |weight| is: up to there cells of the four
sentinels (`triangulation.py`) stay out of the frame, and"""
HEAVIEST = AREAS * STEPS**2
"""in steps², 2⁵², weights are exact as floats."""


@dataclass(frozen=True, eq=False, slots=True)
class Grid:
    """A square frame and its grid: the sites' and sections' range."""

    origin: Floats
    """(2,) mm, the frame's lower left corner"""
    size: float
    """mm, the frame's side"""

    @classmethod
    def around(cls, low: Floats, high: Floats, heaviest: float = 0.0) -> Grid:
        """The grid of the square that has the box low … high (2,), mm, in its lower left corner.

        The square is as large as weights up to `heaviest`, mm², need it. A box without extent
        gets a side that still tells its coordinates apart.
        """
        size = max(float((high - low).max()), math.sqrt(heaviest / AREAS) * (1 + 1e-12))
        return cls(np.asarray(low, np.float64), size or max(float(np.abs(low).max()), 1.0))

    @property
    def pitch(self) -> float:
        """One grid step, mm."""
        return self.size / STEPS

    @property
    def heaviest(self) -> float:
        """The largest |weight| of the safe range, mm²."""
        return AREAS * self.size**2

    def snap(self, points: Floats) -> Ints:
        """The grid points (n, 2) nearest to points (n, 2), mm.

        `GeometryError` for one that is not finite or outside the frame.
        """
        points = np.ascontiguousarray(points, np.float64).reshape(-1, 2)
        snapped = np.empty(points.shape, np.int64)
        x, y = self.origin
        faulty = _snap(points, x, y, self.pitch, snapped)
        if faulty >= 0 and np.isfinite(points[faulty]).all():
            raise GeometryError(
                f"it lies outside the plane's range, {self.size:g} mm each way from "
                f"({x:g}, {y:g}); move it into the part's base rectangle",
                site=faulty,
            )
        if faulty >= 0:
            raise GeometryError("its coordinates are not finite numbers", site=faulty)
        return snapped

    def millimetres(self, points: Ints | Floats) -> Floats:
        """Grid points (n, 2) in mm."""
        return np.asarray(self.origin + points * self.pitch, np.float64)

    def snap_weights(self, weights: Floats) -> Ints:
        """Weights (n,), mm², as whole steps²; `GeometryError` beyond the safe range."""
        weights = np.ascontiguousarray(weights, np.float64)
        snapped = np.empty(len(weights), np.int64)
        faulty = _snap_weights(weights, self.pitch**2, snapped)
        if faulty >= 0 and np.isfinite(weights[faulty]):
            raise GeometryError(
                f"its weight is beyond the safe range of ±{self.heaviest:g} mm²", site=faulty
            )
        if faulty >= 0:
            raise GeometryError("its weight is not a finite number", site=faulty)
        return snapped


@compiled(UNCOUNTED)
def _snap(points: ConstFloatRows, x: float, y: float, pitch: float, snapped: IntRows) -> int:
    """Write the grid points nearest to points; returns the first one outside the grid, or -1."""
    for row in range(len(points)):
        for axis in range(2):
            place = (points[row, axis] - (y if axis else x)) / pitch
            if not -0.5 <= place <= STEPS + 0.5:
                return row
            snapped[row, axis] = int(np.rint(place))
    return -1


@compiled(UNCOUNTED)
def _snap_weights(weights: ConstFloatArray, step: float, snapped: IntArray) -> int:
    """Write weights as whole steps (mm²); returns the first one beyond the safe range, or -1."""
    for row in range(len(weights)):
        weight = weights[row] / step
        if not abs(weight) <= HEAVIEST:
            return row
        snapped[row] = int(np.rint(weight))
    return -1


@compiled(ENTRY)
def hilbert_keys(points: ConstIntRows) -> IntArray:
    """Positions (n,) along a Hilbert curve of grid points (n, 2); distinct for distinct points."""
    keys = np.empty(len(points), np.int64)
    for row in range(len(points)):
        x, y, key, bit = points[row, 0], points[row, 1], 0, STEPS
        while bit > 0:
            right, upper = (x & bit) != 0, (y & bit) != 0
            key = 4 * key + (3 * right ^ upper)
            if not upper:
                if right:
                    x, y = ~x, ~y
                x, y = y, x
            bit >>= 1
        keys[row] = key
    return keys


def curve_order(points: Ints) -> Ints:
    """The order (n,) of grid points (n, 2) along a Hilbert curve: near points follow each other."""
    return np.argsort(hilbert_keys(points), kind="stable")
