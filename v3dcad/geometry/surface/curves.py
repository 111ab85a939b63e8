"""Points and tangents of the curves of a B-rep, for compiled code.

All curves and surfaces of a part lie in one array of numbers, its `coefficients`. A curve is known
by the index of its first coefficient, which is its kind:

| kind | numbers after it |
|---|---|
| LINE | origin (3), direction (3) |
| ELLIPSE, HYPERBOLA | centre (3), x axis (3), y axis (3), major and minor radius; circles too |
| PARABOLA | apex (3), x axis (3), y axis (3), focal length, 0 |
| SPLINE | degree, number of knots, 1 if periodic, knots, poles as (wx, wy, wz, w) |
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstIntArray,
    FloatArray,
    FloatRows,
)
from v3dcad.geometry.compiled.intrinsics import stack_array
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled
from v3dcad.geometry.surface.splines import basis, span_of, wrapped

LINE, ELLIPSE, HYPERBOLA, PARABOLA, SPLINE = range(5)


@compiled(INTERNAL)
def _spline_at(
    coefficients: ConstFloatArray, curve: int, t: float
) -> tuple[float, float, float, float, float, float]:
    degree, count = int(coefficients[curve + 1]), int(coefficients[curve + 2])
    knots = curve + 4
    poles = knots + count
    t = wrapped(
        t,
        coefficients[knots + degree],
        coefficients[poles - 1 - degree],
        coefficients[curve + 3] > 0,
    )
    span = span_of(coefficients, knots, count, degree, t)
    values, slopes = stack_array(), stack_array()
    basis(coefficients, knots, span, degree, t, values, slopes)
    x = y = z = w = dx = dy = dz = dw = 0.0
    for r in range(degree + 1):
        pole = poles + 4 * (span - degree + r)
        x += values[r] * coefficients[pole]
        y += values[r] * coefficients[pole + 1]
        z += values[r] * coefficients[pole + 2]
        w += values[r] * coefficients[pole + 3]
        dx += slopes[r] * coefficients[pole]
        dy += slopes[r] * coefficients[pole + 1]
        dz += slopes[r] * coefficients[pole + 2]
        dw += slopes[r] * coefficients[pole + 3]
    x, y, z = x / w, y / w, z / w
    return x, y, z, (dx - x * dw) / w, (dy - y * dw) / w, (dz - z * dw) / w


@linked(ENTRY)
def curve_at(
    coefficients: ConstFloatArray, curve: int, t: float
) -> tuple[float, float, float, float, float, float]:
    """Point and tangent of a curve at parameter t: x, y, z, dx, dy, dz."""
    kind = int(coefficients[curve])
    if kind == SPLINE:
        return _spline_at(coefficients, curve, t)
    p = coefficients[curve + 1 : curve + 12]
    if kind == LINE:
        return p[0] + t * p[3], p[1] + t * p[4], p[2] + t * p[5], p[3], p[4], p[5]
    if kind == ELLIPSE:
        a, b, da, db = p[9] * np.cos(t), p[10] * np.sin(t), -p[9] * np.sin(t), p[10] * np.cos(t)
    elif kind == HYPERBOLA:
        a, b, da, db = p[9] * np.cosh(t), p[10] * np.sinh(t), p[9] * np.sinh(t), p[10] * np.cosh(t)
    else:
        a, b, da, db = t * t / (4 * p[9]), t, t / (2 * p[9]), 1.0
    return (
        p[0] + a * p[3] + b * p[6],
        p[1] + a * p[4] + b * p[7],
        p[2] + a * p[5] + b * p[8],
        da * p[3] + db * p[6],
        da * p[4] + db * p[7],
        da * p[5] + db * p[8],
    )


@compiled(ENTRY)
def curve_points(
    coefficients: ConstFloatArray, curves: ConstIntArray, parameters: FloatArray
) -> FloatRows:
    """Points (k, 3), mm, of curves (k,) at parameters (k,)."""
    points = np.empty((len(curves), 3))
    for k in range(len(curves)):
        points[k, 0], points[k, 1], points[k, 2], _, _, _ = curve_at(
            coefficients, curves[k], parameters[k]
        )
    return points
