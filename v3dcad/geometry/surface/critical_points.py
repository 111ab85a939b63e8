"""Where the height of a surface is critical: crests, pits and saddles inside its faces.

Planes, cylinders and cones have no isolated ones; those of spheres and tori are known in closed
form; on other surfaces ∇z = 0 is solved by Newton's method from every triangle whose corners'
gradients surround zero. Critical lines (the crest of a lying cylinder or of an upright torus)
need nothing here: mesh edges that pass over them turn there.
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstFloatStack,
    ConstIntArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import ALLOCATING, ENTRY, INTERNAL, compiled
from v3dcad.geometry.surface.mesh import SurfaceMesh, depth
from v3dcad.geometry.surface.surfaces import CONE, SPHERE, TORUS, height_at
from v3dcad.model import Floats, Ints

MAX_POINTS_EACH = 4
"""Critical points that a sphere, a torus or a triangle may have."""


def critical_points(mesh: SurfaceMesh) -> tuple[Ints, Floats]:
    """Triangles (k,) and parameters (k, 2) of the critical points of the mesh's faces.

    Candidates only: a point next to a face's boundary may lie outside it.
    """
    if not (mesh.coefficients[mesh.surfaces] > CONE).any():
        return np.empty(0, np.int64), np.empty((0, 2))
    order = np.argsort(mesh.faces, kind="stable")
    first = np.searchsorted(mesh.faces[order], np.arange(len(mesh.surfaces) + 1))
    found, parameters = _search(mesh.coefficients, mesh.surfaces, mesh.corners[order], first)
    return order[found], parameters


@compiled(INTERNAL)
def _of_quadric(coefficients: ConstFloatArray, surface: int, points: FloatRows) -> int:
    """Where the normal of a sphere or torus is vertical: to `points` (4, 2); how many."""
    up_x, up_y, up_z = (
        coefficients[surface + 6],
        coefficients[surface + 9],
        coefficients[surface + 12],
    )
    level = np.hypot(up_x, up_y)
    if level <= 1e-9:
        return 0
    u = np.arctan2(up_y, up_x)
    points[0, 0], points[0, 1] = u, np.arctan2(up_z, level)
    points[1, 0], points[1, 1] = u + np.pi, np.arctan2(-up_z, level)
    points[2, 0], points[2, 1] = u, np.arctan2(-up_z, -level)
    points[3, 0], points[3, 1] = u + np.pi, np.arctan2(up_z, -level)
    return 4 if int(coefficients[surface]) == TORUS else 2


@compiled(INTERNAL)
def _zero_gradient(
    coefficients: ConstFloatArray, surface: int, u: float, v: float, step: float
) -> tuple[bool, float, float]:
    """Newton's method on ∂z/∂u = ∂z/∂v = 0, second derivatives by differences."""
    for _ in range(15):
        _, u_slope, v_slope = height_at(coefficients, surface, u, v)
        _, right_u, right_v = height_at(coefficients, surface, u + step, v)
        _, left_u, left_v = height_at(coefficients, surface, u - step, v)
        _, above_u, above_v = height_at(coefficients, surface, u, v + step)
        _, below_u, below_v = height_at(coefficients, surface, u, v - step)
        uu = (right_u - left_u) / (2 * step)
        vv = (above_v - below_v) / (2 * step)
        uv = (right_v - left_v + above_u - below_u) / (4 * step)
        determinant = uu * vv - uv * uv
        if abs(determinant) <= 1e-9 * (abs(uu * vv) + uv * uv) or determinant == 0:
            return False, u, v
        u_step = (uv * v_slope - vv * u_slope) / determinant
        v_step = (uv * u_slope - uu * v_slope) / determinant
        u, v = u + u_step, v + v_step
        if max(abs(u_step), abs(v_step)) < 1e-4 * step:
            return True, u, v
    return False, u, v


@compiled(ALLOCATING)
def _of_triangle(
    coefficients: ConstFloatArray, surface: int, corners: ConstFloatRows, zeros: FloatRows
) -> int:
    """Zeros of the gradient in a triangle, sought in its four quarters: to `zeros` (4, 2); how
    many.
    """
    points, gradients = np.empty((6, 2)), np.empty((6, 2))
    for k in range(6):  # its corners, then the middles of its sides
        one, other = k % 3, k if k < 3 else (k + 1) % 3
        u, v = (corners[one, 0] + corners[other, 0]) / 2, (corners[one, 1] + corners[other, 1]) / 2
        points[k, 0], points[k, 1] = u, v
        _, gradients[k, 0], gradients[k, 1] = height_at(coefficients, surface, u, v)
    around = np.empty((3, 2))
    count = 0
    for quarter in ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)):
        u = v = size = 0.0
        for k in range(3):
            at = quarter[k]
            around[k, 0], around[k, 1] = gradients[at, 0], gradients[at, 1]
            u, v = u + points[at, 0], v + points[at, 1]
            size = max(size, abs(points[at, 0] - points[0, 0]), abs(points[at, 1] - points[0, 1]))
        if depth(around, 0.0, 0.0) < -0.5:
            continue
        solved, u, v = _zero_gradient(coefficients, surface, u / 3, v / 3, size * 1e-5)
        if solved and depth(corners, u, v) > -0.05:
            zeros[count, 0], zeros[count, 1] = u, v
            count += 1
    return count


@compiled(ENTRY)
def _search(
    coefficients: ConstFloatArray,
    surfaces: ConstIntArray,
    corners: ConstFloatStack,
    first: ConstIntArray,
) -> tuple[IntArray, FloatRows]:
    triangles = np.empty(MAX_POINTS_EACH * (len(surfaces) + len(corners)), np.int64)
    found = np.empty((len(triangles), 2))
    points = np.empty((MAX_POINTS_EACH, 2))
    count = 0
    for face in range(len(surfaces)):
        surface = surfaces[face]
        kind = int(coefficients[surface])
        begin, end = first[face], first[face + 1]
        if kind <= CONE or begin == end:
            continue
        if kind in (SPHERE, TORUS):
            turns = 2 if kind == TORUS else 0
            for k in range(_of_quadric(coefficients, surface, points)):
                best, owner = -0.2, -1
                for triangle in range(begin, end):
                    for turn in range(-2, 3):
                        for turn_v in range(-turns, turns + 1):
                            u = points[k, 0] + turn * 2 * np.pi
                            v = points[k, 1] + turn_v * 2 * np.pi
                            inside = depth(corners[triangle], u, v)
                            if inside > best:
                                best, owner = inside, triangle
                                found[count, 0], found[count, 1] = u, v
                if owner >= 0:
                    triangles[count] = owner
                    count += 1
            continue
        known = count
        for triangle in range(begin, end):
            for k in range(_of_triangle(coefficients, surface, corners[triangle], points)):
                u, v = points[k, 0], points[k, 1]
                new = True
                for other in range(known, count):
                    if abs(found[other, 0] - u) + abs(found[other, 1] - v) < 1e-7:
                        new = False
                if new:
                    triangles[count] = triangle
                    found[count, 0], found[count, 1] = u, v
                    count += 1
    return triangles[:count], found[:count]
