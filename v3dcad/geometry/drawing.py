"""Curves in space as plain numbers, as they are drawn: chains of lines, arcs, splines."""

from __future__ import annotations

from typing import NamedTuple

from v3dcad.model import Floats

Vector = tuple[float, float, float]


class Conic(NamedTuple):
    """An arc of a circle or ellipse, counter-clockwise about its axis."""

    centre: Vector
    axis: Vector
    towards: Vector
    """unit vector from the centre along the major radius, where the angle is 0"""
    major: float
    minor: float
    first: float
    last: float
    """angles, radians, that it runs from and to"""


class Spline(NamedTuple):
    """A B-spline without weights, from its first knot to its last."""

    degree: int
    poles: Floats
    """(k, 3) mm"""
    knots: list[float]
    multiplicities: list[int]


class Drawing(NamedTuple):
    """Named curves."""

    name: str
    points: Floats
    """(v, 3) mm"""
    polylines: list[list[int]]
    """numbers of points, along each"""
    conics: list[Conic]
    splines: list[Spline]
