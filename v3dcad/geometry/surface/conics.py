"""Horizontal sections of planes, cylinders, cones, spheres and upright turned surfaces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import ConstFloatArray
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INTERNAL
from v3dcad.geometry.surface.surfaces import CONE, CYLINDER, PLANE, REVOLUTION, SPHERE, TORUS

NO_CONIC, STRAIGHT_LINE, CIRCLE_ARC, ELLIPSE_ARC = range(4)
"""What a horizontal section of a surface is; no conic where only points of it are known."""

SLENDER = 1e-4
"""Ellipses more slender than this (minor ÷ major squared) are left as points."""


class Conic(NamedTuple):
    """What a plane cuts from a surface; of a circle or ellipse also where it lies."""

    kind: int
    """`NO_CONIC`, `STRAIGHT_LINE`, `CIRCLE_ARC` or `ELLIPSE_ARC`"""
    x: float
    y: float
    """mm, centre"""
    major_x: float
    major_y: float
    """mm, vector of the major half axis"""
    ratio: float
    """minor ÷ major half axis"""


@linked(INTERNAL)
def conic_at(
    coefficients: ConstFloatArray, surface: int, height: float, x: float, y: float
) -> Conic:
    """What the plane z = height cuts from a surface, next to the point (x, y) of the section."""
    kind = int(coefficients[surface])
    if kind == PLANE:
        return Conic(STRAIGHT_LINE, 0.0, 0.0, 0.0, 0.0, 0.0)
    if kind > TORUS and kind != REVOLUTION:
        return Conic(NO_CONIC, 0.0, 0.0, 0.0, 0.0, 0.0)
    a, b, c = coefficients[surface + 1], coefficients[surface + 2], coefficients[surface + 3]
    e, f, g = coefficients[surface + 10], coefficients[surface + 11], coefficients[surface + 12]
    lean = e * e + f * f
    upright = lean < 1e-24
    if kind == SPHERE:
        rise = height - c
        radius = np.sqrt(max(coefficients[surface + 13] ** 2 - rise * rise, 0.0))
        return Conic(CIRCLE_ARC, a, b, radius, 0.0, 1.0)
    if upright and kind != CYLINDER:
        return Conic(CIRCLE_ARC, a, b, np.hypot(x - a, y - b), 0.0, 1.0)
    if kind == CYLINDER:
        radius = coefficients[surface + 13]
        if upright:
            return Conic(CIRCLE_ARC, a, b, radius, 0.0, 1.0)
        if abs(g) < 1e-12:
            return Conic(STRAIGHT_LINE, 0.0, 0.0, 0.0, 0.0, 0.0)
        if g * g > SLENDER:
            way = (height - c) / g
            slant = radius / (abs(g) * np.sqrt(lean))
            return Conic(ELLIPSE_ARC, a + way * e, b + way * f, slant * e, slant * f, abs(g))
    elif kind == CONE:
        sine, cosine = coefficients[surface + 14], coefficients[surface + 15]
        reach = coefficients[surface + 13] * cosine / sine  # from the apex to the frame's origin
        a, b, rise = a - reach * e, b - reach * f, height - (c - reach * g)
        if abs(rise) < 1e-9:
            return Conic(NO_CONIC, 0.0, 0.0, 0.0, 0.0, 0.0)
        open_share = cosine * cosine - lean
        if open_share > SLENDER:
            shift = g * rise / open_share
            major = abs(rise * cosine * sine) / open_share / np.sqrt(lean)
            ratio = np.sqrt(open_share) / cosine
            return Conic(ELLIPSE_ARC, a + shift * e, b + shift * f, major * e, major * f, ratio)
    return Conic(NO_CONIC, 0.0, 0.0, 0.0, 0.0, 0.0)
