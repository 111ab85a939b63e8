"""Points and tangents of the surfaces of a B-rep, for compiled code.

A surface is known by the index of its first coefficient (see `curves`), which is its kind. `frame`
is origin, x, y and z axis, 12 numbers:

| kind | numbers after it |
|---|---|
| PLANE | frame |
| CYLINDER | frame, radius |
| CONE | frame, radius at v = 0, sine and cosine of the half angle |
| SPHERE | frame, radius |
| TORUS | frame, major radius, minor radius |
| SPLINE_SURFACE | two times (degree, number of knots, 1 if periodic), u knots, v knots, poles |
| EXTRUSION | direction (3), then the index of the curve |
| REVOLUTION | frame with the axis as z, then the index of the curve |
| OFFSET | distance, then the index of the surface |
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstIntArray,
    FloatRows,
)
from v3dcad.geometry.compiled.intrinsics import stack_array
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled
from v3dcad.geometry.surface.curves import curve_at
from v3dcad.geometry.surface.splines import basis, span_of, wrapped

(
    PLANE,
    CYLINDER,
    CONE,
    SPHERE,
    TORUS,
    SPLINE_SURFACE,
    EXTRUSION,
    REVOLUTION,
    OFFSET,
) = range(9)

Vector = tuple[float, float, float]
Derivatives = tuple[Vector, Vector, Vector]
"""A point of a surface, and its derivatives by u and v."""


@compiled(INTERNAL)
def _profile_at(
    coefficients: ConstFloatArray, surface: int, v: float
) -> tuple[float, float, float, float]:
    """The line or circle that makes a cylinder, cone, sphere or torus when turned about z: its
    reach from z, its rise along z, and their slopes.
    """
    kind, radius = int(coefficients[surface]), coefficients[surface + 13]
    if kind == CYLINDER:
        return radius, v, 0.0, 1.0
    if kind == CONE:
        sine, cosine = coefficients[surface + 14], coefficients[surface + 15]
        return radius + v * sine, v * cosine, sine, cosine
    if kind == SPHERE:
        reach, rise = radius * np.cos(v), radius * np.sin(v)
        return reach, rise, -rise, reach
    small = coefficients[surface + 14]
    along, rise = small * np.cos(v), small * np.sin(v)
    return radius + along, rise, -rise, along


@compiled(INTERNAL)
def _spline_surface_at(
    coefficients: ConstFloatArray, surface: int, u: float, v: float
) -> Derivatives:
    u_degree, u_count = int(coefficients[surface + 1]), int(coefficients[surface + 2])
    v_degree, v_count = int(coefficients[surface + 4]), int(coefficients[surface + 5])
    u_knots = surface + 7
    v_knots = u_knots + u_count
    poles = v_knots + v_count
    columns = v_count - v_degree - 1
    u = wrapped(
        u,
        coefficients[u_knots + u_degree],
        coefficients[v_knots - 1 - u_degree],
        coefficients[surface + 3] > 0,
    )
    v = wrapped(
        v,
        coefficients[v_knots + v_degree],
        coefficients[poles - 1 - v_degree],
        coefficients[surface + 6] > 0,
    )
    u_span = span_of(coefficients, u_knots, u_count, u_degree, u)
    v_span = span_of(coefficients, v_knots, v_count, v_degree, v)
    u_values, u_slopes = stack_array(), stack_array()
    v_values, v_slopes = stack_array(), stack_array()
    basis(coefficients, u_knots, u_span, u_degree, u, u_values, u_slopes)
    basis(coefficients, v_knots, v_span, v_degree, v, v_values, v_slopes)
    x = y = z = w = u_x = u_y = u_z = u_w = v_x = v_y = v_z = v_w = 0.0
    for i in range(u_degree + 1):
        row = poles + 4 * ((u_span - u_degree + i) * columns + v_span - v_degree)
        for j in range(v_degree + 1):
            value = u_values[i] * v_values[j]
            u_slope = u_slopes[i] * v_values[j]
            v_slope = u_values[i] * v_slopes[j]
            pole = row + 4 * j
            a, b, c, weight = (
                coefficients[pole],
                coefficients[pole + 1],
                coefficients[pole + 2],
                coefficients[pole + 3],
            )
            x, y, z, w = x + value * a, y + value * b, z + value * c, w + value * weight
            u_x, u_y, u_z = u_x + u_slope * a, u_y + u_slope * b, u_z + u_slope * c
            v_x, v_y, v_z = v_x + v_slope * a, v_y + v_slope * b, v_z + v_slope * c
            u_w, v_w = u_w + u_slope * weight, v_w + v_slope * weight
    x, y, z = x / w, y / w, z / w
    return (
        (x, y, z),
        ((u_x - x * u_w) / w, (u_y - y * u_w) / w, (u_z - z * u_w) / w),
        ((v_x - x * v_w) / w, (v_y - y * v_w) / w, (v_z - z * v_w) / w),
    )


@compiled(INTERNAL)
def _vector(coefficients: ConstFloatArray, at: int) -> Vector:
    return coefficients[at], coefficients[at + 1], coefficients[at + 2]


@compiled(INTERNAL)
def _plus(p: Vector, a: float, q: Vector) -> Vector:
    return p[0] + a * q[0], p[1] + a * q[1], p[2] + a * q[2]


@compiled(INTERNAL)
def _times(a: float, p: Vector) -> Vector:
    return a * p[0], a * p[1], a * p[2]


@compiled(INTERNAL)
def _dot(p: Vector, q: Vector) -> float:
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


@linked(INTERNAL)
def _plain_at(coefficients: ConstFloatArray, surface: int, u: float, v: float) -> Derivatives:
    kind = int(coefficients[surface])
    if kind == SPLINE_SURFACE:
        return _spline_surface_at(coefficients, surface, u, v)
    if kind == EXTRUSION:
        x, y, z, dx, dy, dz = curve_at(coefficients, int(coefficients[surface + 4]), u)
        direction = _vector(coefficients, surface + 1)
        return _plus((x, y, z), v, direction), (dx, dy, dz), direction
    origin, x_axis = _vector(coefficients, surface + 1), _vector(coefficients, surface + 4)
    y_axis, z_axis = _vector(coefficients, surface + 7), _vector(coefficients, surface + 10)
    if kind == PLANE:
        return _plus(_plus(origin, u, x_axis), v, y_axis), x_axis, y_axis
    cosine, sine = np.cos(u), np.sin(u)
    if kind == REVOLUTION:
        x, y, z, dx, dy, dz = curve_at(coefficients, int(coefficients[surface + 13]), v)
        arm, slope = _plus((x, y, z), -1.0, origin), (dx, dy, dz)
        x, y, z = _dot(arm, x_axis), _dot(arm, y_axis), _dot(arm, z_axis)
        dx, dy, dz = _dot(slope, x_axis), _dot(slope, y_axis), _dot(slope, z_axis)
        a, b = cosine * x - sine * y, sine * x + cosine * y
        da, db = cosine * dx - sine * dy, sine * dx + cosine * dy
        return (
            _plus(_plus(_plus(origin, a, x_axis), b, y_axis), z, z_axis),
            _plus(_times(a, y_axis), -b, x_axis),
            _plus(_plus(_times(da, x_axis), db, y_axis), dz, z_axis),
        )
    reach, rise, d_reach, d_rise = _profile_at(coefficients, surface, v)
    outward = _plus(_times(cosine, x_axis), sine, y_axis)
    along = _plus(_times(cosine, y_axis), -sine, x_axis)
    return (
        _plus(_plus(origin, reach, outward), rise, z_axis),
        _times(reach, along),
        _plus(_times(d_reach, outward), d_rise, z_axis),
    )


@compiled(INTERNAL)
def _offset_point(coefficients: ConstFloatArray, surface: int, u: float, v: float) -> Vector:
    point, a, b = _plain_at(coefficients, int(coefficients[surface + 2]), u, v)
    x, y, z = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    return _plus(point, coefficients[surface + 1] / np.sqrt(x * x + y * y + z * z), (x, y, z))


@compiled(INTERNAL)
def _difference(p: Vector, q: Vector, step: float) -> Vector:
    return (p[0] - q[0]) / step, (p[1] - q[1]) / step, (p[2] - q[2]) / step


@compiled(INTERNAL)
def _offset_at(coefficients: ConstFloatArray, surface: int, u: float, v: float) -> Derivatives:
    """The point is exact; the tangents, which only steer Newton steps, are differences."""
    step = 1e-6
    right, left = (
        _offset_point(coefficients, surface, u + step, v),
        _offset_point(coefficients, surface, u - step, v),
    )
    above, below = (
        _offset_point(coefficients, surface, u, v + step),
        _offset_point(coefficients, surface, u, v - step),
    )
    return (
        _offset_point(coefficients, surface, u, v),
        _difference(right, left, 2 * step),
        _difference(above, below, 2 * step),
    )


@linked(ENTRY)
def surface_at(coefficients: ConstFloatArray, surface: int, u: float, v: float) -> Derivatives:
    """Point and tangents of a surface at (u, v), three vectors: S, ∂S/∂u, ∂S/∂v."""
    if int(coefficients[surface]) == OFFSET:
        return _offset_at(coefficients, surface, u, v)
    return _plain_at(coefficients, surface, u, v)


@linked(INTERNAL)
def height_at(coefficients: ConstFloatArray, surface: int, u: float, v: float) -> Vector:
    """z, ∂z/∂u and ∂z/∂v of `surface_at`, in half the time where that is short."""
    kind = int(coefficients[surface])
    if kind < CYLINDER or kind > TORUS:
        point, along_u, along_v = surface_at(coefficients, surface, u, v)
        return point[2], along_u[2], along_v[2]
    reach, rise, d_reach, d_rise = _profile_at(coefficients, surface, v)
    cosine, sine = np.cos(u), np.sin(u)
    x_z, y_z, z_z = coefficients[surface + 6], coefficients[surface + 9], coefficients[surface + 12]
    outward = cosine * x_z + sine * y_z
    return (
        coefficients[surface + 3] + reach * outward + rise * z_z,
        reach * (cosine * y_z - sine * x_z),
        d_reach * outward + d_rise * z_z,
    )


@compiled(INTERNAL)
def step_to_line(
    point: Derivatives, rise: float, off: float, x: float, y: float
) -> tuple[bool, float, float]:
    """Newton's step in u and v from a point of a surface to where its level curve meets a line.

    The point is `rise` above the level and `off` the line, a distance times the length of the
    line's normal (x, y). False where there is no such step.
    """
    u_off = point[1][0] * x + point[1][1] * y
    v_off = point[2][0] * x + point[2][1] * y
    determinant = point[1][2] * v_off - point[2][2] * u_off
    if determinant == 0.0:
        return False, 0.0, 0.0
    return (
        True,
        (rise * v_off - point[2][2] * off) / determinant,
        (point[1][2] * off - u_off * rise) / determinant,
    )


@compiled(ENTRY)
def surface_points(
    coefficients: ConstFloatArray, surfaces: ConstIntArray, parameters: FloatRows
) -> FloatRows:
    """Points (k, 3), mm, of surfaces (k,) at parameters (k, 2)."""
    points = np.empty((len(surfaces), 3))
    for k in range(len(surfaces)):
        point, _, _ = surface_at(coefficients, surfaces[k], parameters[k, 0], parameters[k, 1])
        points[k, 0], points[k, 1], points[k, 2] = point
    return points
