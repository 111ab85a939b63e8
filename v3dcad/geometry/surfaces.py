"""Points and tangents of the surfaces of a B-rep, for compiled code.

A surface is a stretch of numbers in a `heap`, found by the place of its first, which says its
kind. `frame` is origin, x, y and z axis, 12 numbers:

| kind | numbers after it |
|---|---|
| PLANE | frame |
| CYLINDER | frame, radius |
| CONE | frame, radius at v = 0, sine and cosine of the half angle |
| SPHERE | frame, radius |
| TORUS | frame, major radius, minor radius |
| SPLINE_SURFACE | two times (degree, number of knots, 1 if periodic), u knots, v knots, poles |
| EXTRUSION | direction (3), then the place of the curve |
| REVOLUTION | frame with the axis as z, then the place of the curve |
| OFFSET | distance, then the place of the surface |
"""

from __future__ import annotations

import numpy as np
from numba import njit, types

from v3dcad.geometry.curves import curve_at
from v3dcad.geometry.exact import ALLOCATING, COMPILED, INTERNAL, WORD
from v3dcad.geometry.linking import linked
from v3dcad.geometry.splines import FLOAT, HEAP, basis, span_of, wrapped

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

SURFACE_AT = types.float64[:, ::1](HEAP, WORD, FLOAT, FLOAT)


@njit(**INTERNAL)
def _profile_at(heap, place, v):  # type: ignore[no-untyped-def]
    """The line or circle that makes a cylinder, cone, sphere or torus when turned about z: its
    reach from z, its rise along z, and their slopes.
    """
    kind, radius = int(heap[place]), heap[place + 13]
    if kind == CYLINDER:
        return radius, v, 0.0, 1.0
    if kind == CONE:
        sine, cosine = heap[place + 14], heap[place + 15]
        return radius + v * sine, v * cosine, sine, cosine
    if kind == SPHERE:
        reach, rise = radius * np.cos(v), radius * np.sin(v)
        return reach, rise, -rise, reach
    small = heap[place + 14]
    along, rise = small * np.cos(v), small * np.sin(v)
    return radius + along, rise, -rise, along


@njit(**ALLOCATING)
def _spline_surface_at(heap, place, u, v):  # type: ignore[no-untyped-def]
    u_degree, u_count = int(heap[place + 1]), int(heap[place + 2])
    v_degree, v_count = int(heap[place + 4]), int(heap[place + 5])
    u_knots = place + 7
    v_knots = u_knots + u_count
    poles = v_knots + v_count
    columns = v_count - v_degree - 1
    u = wrapped(u, heap[u_knots + u_degree], heap[v_knots - 1 - u_degree], heap[place + 3] > 0)
    v = wrapped(v, heap[v_knots + v_degree], heap[poles - 1 - v_degree], heap[place + 6] > 0)
    u_span = span_of(heap, u_knots, u_count, u_degree, u)
    v_span = span_of(heap, v_knots, v_count, v_degree, v)
    u_values, u_slopes = basis(heap, u_knots, u_span, u_degree, u)
    v_values, v_slopes = basis(heap, v_knots, v_span, v_degree, v)
    total = np.zeros((3, 4))
    for i in range(u_degree + 1):
        row = poles + 4 * ((u_span - u_degree + i) * columns + v_span - v_degree)
        for j in range(v_degree + 1):
            value = u_values[i] * v_values[j]
            u_slope = u_slopes[i] * v_values[j]
            v_slope = u_values[i] * v_slopes[j]
            for axis in range(4):
                number = heap[row + 4 * j + axis]
                total[0, axis] += value * number
                total[1, axis] += u_slope * number
                total[2, axis] += v_slope * number
    result = np.empty((3, 3))
    weight = total[0, 3]
    for axis in range(3):
        point = total[0, axis] / weight
        result[0, axis] = point
        result[1, axis] = (total[1, axis] - point * total[1, 3]) / weight
        result[2, axis] = (total[2, axis] - point * total[2, 3]) / weight
    return result


@linked(SURFACE_AT, **ALLOCATING)
def _plain_at(heap, place, u, v):  # type: ignore[no-untyped-def]
    kind = int(heap[place])
    if kind == SPLINE_SURFACE:
        return _spline_surface_at(heap, place, u, v)
    result = np.empty((3, 3))
    if kind == EXTRUSION:
        curve = curve_at(heap, int(heap[place + 4]), u)
        for axis in range(3):
            result[0, axis] = curve[axis] + v * heap[place + 1 + axis]
            result[1, axis] = curve[3 + axis]
            result[2, axis] = heap[place + 1 + axis]
        return result
    # The frame by its places: views of it would cost more than what is computed from them.
    origin, x_axis, y_axis, z_axis = place + 1, place + 4, place + 7, place + 10
    if kind == PLANE:
        for axis in range(3):
            result[0, axis] = (
                heap[origin + axis] + u * heap[x_axis + axis] + v * heap[y_axis + axis]
            )
            result[1, axis] = heap[x_axis + axis]
            result[2, axis] = heap[y_axis + axis]
        return result
    cosine, sine = np.cos(u), np.sin(u)
    if kind == REVOLUTION:
        curve = curve_at(heap, int(heap[place + 13]), v)
        x = y = z = dx = dy = dz = 0.0
        for axis in range(3):
            arm, slope = curve[axis] - heap[origin + axis], curve[3 + axis]
            x += arm * heap[x_axis + axis]
            y += arm * heap[y_axis + axis]
            z += arm * heap[z_axis + axis]
            dx += slope * heap[x_axis + axis]
            dy += slope * heap[y_axis + axis]
            dz += slope * heap[z_axis + axis]
        a, b = cosine * x - sine * y, sine * x + cosine * y
        da, db = cosine * dx - sine * dy, sine * dx + cosine * dy
        for axis in range(3):
            result[0, axis] = (
                heap[origin + axis]
                + a * heap[x_axis + axis]
                + b * heap[y_axis + axis]
                + z * heap[z_axis + axis]
            )
            result[1, axis] = a * heap[y_axis + axis] - b * heap[x_axis + axis]
            result[2, axis] = (
                da * heap[x_axis + axis] + db * heap[y_axis + axis] + dz * heap[z_axis + axis]
            )
        return result
    reach, rise, d_reach, d_rise = _profile_at(heap, place, v)
    for axis in range(3):
        outward = cosine * heap[x_axis + axis] + sine * heap[y_axis + axis]
        along = cosine * heap[y_axis + axis] - sine * heap[x_axis + axis]
        result[0, axis] = heap[origin + axis] + reach * outward + rise * heap[z_axis + axis]
        result[1, axis] = reach * along
        result[2, axis] = d_reach * outward + d_rise * heap[z_axis + axis]
    return result


@njit(**ALLOCATING)
def _offset_point(heap, place, u, v):  # type: ignore[no-untyped-def]
    s = _plain_at(heap, int(heap[place + 2]), u, v)
    x = s[1, 1] * s[2, 2] - s[1, 2] * s[2, 1]
    y = s[1, 2] * s[2, 0] - s[1, 0] * s[2, 2]
    z = s[1, 0] * s[2, 1] - s[1, 1] * s[2, 0]
    share = heap[place + 1] / np.sqrt(x * x + y * y + z * z)
    return s[0, 0] + share * x, s[0, 1] + share * y, s[0, 2] + share * z


@njit(**ALLOCATING)
def _offset_at(heap, place, u, v):  # type: ignore[no-untyped-def]
    """The point is exact; the tangents, which only steer Newton steps, are differences."""
    step = 1e-6
    point = _offset_point(heap, place, u, v)
    right, left = _offset_point(heap, place, u + step, v), _offset_point(heap, place, u - step, v)
    above, below = _offset_point(heap, place, u, v + step), _offset_point(heap, place, u, v - step)
    result = np.empty((3, 3))
    for axis in range(3):
        result[0, axis] = point[axis]
        result[1, axis] = (right[axis] - left[axis]) / (2 * step)
        result[2, axis] = (above[axis] - below[axis]) / (2 * step)
    return result


@linked(SURFACE_AT, **COMPILED)
def surface_at(heap, place, u, v):  # type: ignore[no-untyped-def]
    """Point and tangents of a surface at (u, v), as an array (3, 3): S, ∂S/∂u, ∂S/∂v."""
    if int(heap[place]) == OFFSET:
        return _offset_at(heap, place, u, v)
    return _plain_at(heap, place, u, v)


@linked(types.UniTuple(FLOAT, 3)(HEAP, WORD, FLOAT, FLOAT), **ALLOCATING)
def height_at(heap, place, u, v):  # type: ignore[no-untyped-def]
    """z, ∂z/∂u and ∂z/∂v of `surface_at`, in half the time where that is short."""
    kind = int(heap[place])
    if kind < CYLINDER or kind > TORUS:
        s = surface_at(heap, place, u, v)
        return s[0, 2], s[1, 2], s[2, 2]
    reach, rise, d_reach, d_rise = _profile_at(heap, place, v)
    cosine, sine = np.cos(u), np.sin(u)
    x_z, y_z, z_z = heap[place + 6], heap[place + 9], heap[place + 12]
    outward = cosine * x_z + sine * y_z
    return (
        heap[place + 3] + reach * outward + rise * z_z,
        reach * (cosine * y_z - sine * x_z),
        d_reach * outward + d_rise * z_z,
    )


@njit(**COMPILED)
def surface_points(heap, places, parameters):  # type: ignore[no-untyped-def]
    """Points (k, 3) of surfaces (k,) at parameters (k, 2)."""
    points = np.empty((len(places), 3))
    for k in range(len(places)):
        s = surface_at(heap, places[k], parameters[k, 0], parameters[k, 1])
        points[k, 0], points[k, 1], points[k, 2] = s[0, 0], s[0, 1], s[0, 2]
    return points
