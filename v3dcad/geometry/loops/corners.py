"""Corners cut off, so that the nozzle need not slow down so much at them."""

from __future__ import annotations

import math

import numpy as np

from v3dcad.geometry.compiled.arrays import ConstFloatRows, ConstIntArray, FloatRows, IntArray
from v3dcad.geometry.compiled.options import UNCOUNTED, compiled
from v3dcad.geometry.loops.curves import GRID, LINK, Curves

CORNER = math.radians(20)
"""A smaller turn is no corner: it is taken at full speed."""
STRAIGHT = math.cos(CORNER)
LINK_SHARE = 0.3
"""The share of a step that a cut takes at a link: so half a turn round it is half an octagon."""
WALL_SHARE = 1 / 50
"""The same between two walls of a cell, where what is cut off leaves the walls bare,"""
WALL_MOST = 0.25
"""and at most so many bead spacings."""


def corners_cut(curves: Curves, spacing: float, shortest: float) -> Curves:
    """The curves with two corners of half the turn in place of corners at links and of cells.

    A printer takes a corner of 45° twice as fast as one of 90°. Where walls are short, their
    corners stay: too much of the walls would be bare. So do perimeters, and corners where the piece
    put in would be shorter than `shortest` (mm). Beads lie `spacing` apart, mm.
    """
    room = 2 * len(curves.points)
    points, owner = np.empty((room, 2)), np.empty(room, np.int64)
    first = np.zeros_like(curves.first)
    most = WALL_MOST * spacing
    _cut(curves.points, curves.first, curves.owner, most, shortest, points, first, owner)
    size = first[-1]
    return Curves(points[:size].copy(), first, owner[:size].copy())


@compiled(UNCOUNTED)
def _cut(
    points: ConstFloatRows,
    first: ConstIntArray,
    owner: ConstIntArray,
    most: float,
    shortest: float,
    found: FloatRows,
    begins: IntArray,
    whose: IntArray,
) -> None:
    size = 0
    for curve in range(len(first) - 1):
        low, high = first[curve], first[curve + 1]
        before = high - 1
        for k in range(low, high):
            after = k + 1 if k + 1 < high else low
            x, y = points[k, 0], points[k, 1]
            pieces = 1
            ux, uy = x - points[before, 0], y - points[before, 1]
            vx, vy = points[after, 0] - x, points[after, 1] - y
            gone = max(math.sqrt(ux * ux + uy * uy), 1e-12)
            left = max(math.sqrt(vx * vx + vy * vy), 1e-12)
            ux, uy, vx, vy = ux / gone, uy / gone, vx / left, vy / left
            cosine = min(max(ux * vx + uy * vy, -1.0), 1.0)
            away = 0.0
            if owner[k] == LINK or owner[before] == LINK:
                away = LINK_SHARE * min(gone, left)
            elif owner[k] >= 0 and ux * vy > uy * vx:
                away = min(WALL_SHARE * min(gone, left), most)
            # The piece put in is 2 · away · cos(turn ÷ 2) long.
            if cosine < STRAIGHT and away * math.sqrt(2 + 2 * cosine) >= max(shortest, GRID):
                found[size, 0], found[size, 1] = x - away * ux, y - away * uy
                x, y = x + away * vx, y + away * vy
                pieces = 2
            size += pieces
            found[size - 1, 0], found[size - 1, 1] = x, y
            whose[size - pieces] = whose[size - 1] = owner[k]
            before = k
        begins[curve + 1] = size
