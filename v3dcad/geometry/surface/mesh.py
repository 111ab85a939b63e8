"""A mesh that knows the true surface: its sections have exactly the true section's topology.

Every mesh edge is a stretch of a B-rep edge or a straight stretch in a face's parameters, so
that between its nodes it is a curve on the true surface. Refined until

* every point of a face where its height is critical (crest, pit, saddle) is a node, and
* the height along every mesh edge is monotone,

the boundary of each (curved) triangle rises on one side and falls on the other, and no level
line closes inside it: every plane meets it in one stretch, from the edge where it descends to
the edge where it rises, or not at all (Morse theory, piece by piece). The mesh may be coarse,
and nothing is missed however thin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstFloatStack,
    ConstIntArray,
    ConstIntRows,
    FloatRows,
)
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled
from v3dcad.geometry.surface.curves import LINE, curve_at
from v3dcad.geometry.surface.surfaces import PLANE, height_at, surface_at
from v3dcad.model import Floats, Ints, Value

NEGLIGIBLE = 1e-7
"""mm, OCCT's confusion: a turn of an edge that rises less than this above its ends is not one. In
slivers along a curve's inflection each split would make another such turn."""


@dataclass(frozen=True, eq=False, slots=True)
class SurfaceMesh(Value):
    """Triangles on true surfaces. Only numbers: it travels between processes as it is."""

    coefficients: Floats
    """(c,) of all curves and surfaces, see `curves` and `surfaces`"""
    surfaces: Ints
    """(f,) index of each face's surface in the coefficients"""
    nodes: Floats
    """(n, 3) mm"""
    triangles: Ints
    """(t, 3) node ids; two are equal at a pole"""
    corners: Floats
    """(t, 3, 2) parameters of each triangle's corners on its face's surface"""
    faces: Ints
    """(t,)"""
    sides: Ints
    """(t, 3) the mesh edge from corner j to corner j + 1; −1 for a side shrunk to a pole"""
    edge_nodes: Ints
    """(e, 2)"""
    edge_faces: Ints
    """(e,) a face on which the edge lies"""
    edge_curves: Ints
    """(e,) index of its curve in the coefficients, if it lies on an edge of the B-rep, else −1"""
    edge_spans: Floats
    """(e, 4) the curve's parameters at both nodes, or u, v at the first and u, v at the second"""
    gaps: Floats
    """(f,) mm: how far the edges of each face may lie off it, where that is worth repairing
    (see `gaps`), else 0"""

    def arrays(self) -> MeshArrays:
        """The arrays as compiled functions take them."""
        return MeshArrays(*(_constant(getattr(self, name)) for name in MeshArrays._fields))


class MeshArrays(NamedTuple):
    """The arrays of a `SurfaceMesh`, which compiled functions only read."""

    coefficients: ConstFloatArray
    surfaces: ConstIntArray
    nodes: ConstFloatRows
    triangles: ConstIntRows
    corners: ConstFloatStack
    faces: ConstIntArray
    sides: ConstIntRows
    edge_nodes: ConstIntRows
    edge_faces: ConstIntArray
    edge_curves: ConstIntArray
    edge_spans: ConstFloatRows
    gaps: ConstFloatArray


def _constant(array: NDArray[Any]) -> NDArray[Any]:
    """A contiguous, read-only view of an array; numba converts no array inside of a tuple."""
    view = np.ascontiguousarray(array).view()
    view.flags.writeable = False
    return view


@compiled(INTERNAL)
def depth(corners: ConstFloatRows, u: float, v: float) -> float:
    """The least barycentric coordinate of (u, v) in a triangle (3, 2); −inf if it is flat."""
    a, b, c = corners[0], corners[1], corners[2]
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    if area == 0:
        return -np.inf
    beside_b = ((u - a[0]) * (c[1] - a[1]) - (v - a[1]) * (c[0] - a[0])) / area
    beside_c = ((b[0] - a[0]) * (v - a[1]) - (b[1] - a[1]) * (u - a[0])) / area
    return min(beside_b, beside_c, 1 - beside_b - beside_c)


@compiled(ENTRY)
def along_edge(
    coefficients: ConstFloatArray, surface: int, curve: int, span: ConstFloatArray, share: float
) -> tuple[float, float, float, float]:
    """Point at a share of the way along a mesh edge, and its z slope: x, y, z, dz/dshare."""
    if curve >= 0:
        step = span[1] - span[0]
        point = curve_at(coefficients, curve, span[0] + share * step)
        return point[0], point[1], point[2], point[5] * step
    u_step, v_step = span[2] - span[0], span[3] - span[1]
    s = surface_at(coefficients, surface, span[0] + share * u_step, span[1] + share * v_step)
    return s[0][0], s[0][1], s[0][2], s[1][2] * u_step + s[2][2] * v_step


@compiled(INTERNAL)
def _height_along(
    coefficients: ConstFloatArray, surface: int, curve: int, span: ConstFloatArray, share: float
) -> tuple[float, float]:
    """The z and dz/dshare of `along_edge`."""
    if curve >= 0:
        step = span[1] - span[0]
        point = curve_at(coefficients, curve, span[0] + share * step)
        return point[2], point[5] * step
    u_step, v_step = span[2] - span[0], span[3] - span[1]
    z, u_slope, v_slope = height_at(
        coefficients, surface, span[0] + share * u_step, span[1] + share * v_step
    )
    return z, u_slope * u_step + v_slope * v_step


@linked(INTERNAL)
def turning_point(
    coefficients: ConstFloatArray, surface: int, curve: int, span: ConstFloatArray
) -> tuple[float, float]:
    """Share of the way at which an edge's height turns the most, and by how much above or below
    its nearer end (mm); 0 and 0 if it is monotone.
    """
    straight = coefficients[curve] == LINE if curve >= 0 else coefficients[surface] == PLANE
    if straight:
        return 0.0, 0.0
    pieces = 8
    first_z, before = _height_along(coefficients, surface, curve, span, 0.0)
    best, found = 0.0, 0.0
    for piece in range(pieces):
        slope = _height_along(coefficients, surface, curve, span, (piece + 1) / pieces)[1]
        if before * slope < 0:
            low, high = piece / pieces, (piece + 1) / pieces
            for _ in range(48):
                middle = (low + high) / 2
                if _height_along(coefficients, surface, curve, span, middle)[1] * slope < 0:
                    low = middle
                else:
                    high = middle
            z = _height_along(coefficients, surface, curve, span, low)[0]
            last_z = _height_along(coefficients, surface, curve, span, 1.0)[0]
            rise = min(abs(z - first_z), abs(z - last_z))
            if rise > max(best, NEGLIGIBLE):
                best, found = rise, low
        before = slope
    return found, best


@compiled(ENTRY)
def turning_points(
    coefficients: ConstFloatArray,
    surfaces: ConstIntArray,
    faces: ConstIntArray,
    curves: ConstIntArray,
    spans: ConstFloatRows,
) -> FloatRows:
    """(e, 2) `turning_point` of every edge."""
    turns = np.empty((len(faces), 2))
    for edge in range(len(faces)):
        turns[edge, 0], turns[edge, 1] = turning_point(
            coefficients, surfaces[faces[edge]], curves[edge], spans[edge]
        )
    return turns


@linked(INTERNAL)
def project(
    coefficients: ConstFloatArray, surface: int, point: ConstFloatArray, u: float, v: float
) -> tuple[float, float]:
    """Parameters of the point of a surface next to a point, by Gauss–Newton from (u, v)."""
    for _ in range(20):
        s = surface_at(coefficients, surface, u, v)
        uu = uv = vv = a = b = 0.0
        for axis in range(3):
            gap, along_u, along_v = point[axis] - s[0][axis], s[1][axis], s[2][axis]
            uu, uv, vv = uu + along_u * along_u, uv + along_u * along_v, vv + along_v * along_v
            a, b = a + along_u * gap, b + along_v * gap
        determinant = uu * vv - uv * uv
        if determinant <= 1e-14 * uu * vv:
            break
        u_step = (vv * a - uv * b) / determinant
        v_step = (uu * b - uv * a) / determinant
        u, v = u + u_step, v + v_step
        if uu * u_step * u_step + vv * v_step * v_step < 1e-26:
            break
    return u, v
