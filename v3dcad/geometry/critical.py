"""Where the height of a surface is critical: crests, pits and saddles inside its faces.

Planes, cylinders and cones have no isolated ones; those of spheres and tori are known in closed
form; on other surfaces ∇z = 0 is solved by Newton's method from every triangle whose corners'
gradients surround zero. Critical lines (the crest of a lying cylinder or of an upright torus)
need nothing here: mesh edges that pass over them turn there.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from v3dcad.geometry.surface_mesh import SurfaceMesh, depth
from v3dcad.geometry.surfaces import CONE, SPHERE, TORUS, surface_at
from v3dcad.model import Floats, Ints


def critical_points(mesh: SurfaceMesh) -> tuple[Ints, Floats]:
    """Triangles (k,) and parameters (k, 2) of the critical points of the mesh's faces.

    Candidates only: a point next to a face's boundary may lie outside it.
    """
    order = np.argsort(mesh.faces, kind="stable")
    first = np.searchsorted(mesh.faces[order], np.arange(len(mesh.surfaces) + 1))
    found, parameters = _search(mesh.heap, mesh.surfaces, mesh.corners[order], first)
    return order[found], parameters


@njit(cache=True, nogil=True, error_model="numpy")
def _search(heap, surfaces, corners, first):  # type: ignore[no-untyped-def]
    triangles = [0]
    found = [(0.0, 0.0)]
    for face in range(len(surfaces)):
        place = surfaces[face]
        kind = int(heap[place])
        begin, end = first[face], first[face + 1]
        if kind <= CONE or begin == end:
            continue
        if kind in (SPHERE, TORUS):
            for point in _of_quadric(heap, place):
                best, owner, best_u, best_v = -0.2, -1, 0.0, 0.0
                for triangle in range(begin, end):
                    for turn in range(-2, 3):
                        for turn_v in range(-2, 3) if kind == TORUS else range(1):
                            u = point[0] + turn * 2 * np.pi
                            v = point[1] + turn_v * 2 * np.pi
                            inside = depth(corners[triangle], u, v)
                            if inside > best:
                                best, owner, best_u, best_v = inside, triangle, u, v
                if owner >= 0:
                    triangles.append(owner)
                    found.append((best_u, best_v))
            continue
        known = len(found)
        for triangle in range(begin, end):
            for u, v in _of_triangle(heap, place, corners[triangle]):
                new = True
                for other in found[known:]:
                    if abs(other[0] - u) + abs(other[1] - v) < 1e-7:
                        new = False
                if new:
                    triangles.append(triangle)
                    found.append((u, v))
    return np.array(triangles[1:], np.int64), np.array(found)[1:]


@njit(cache=True, nogil=True, error_model="numpy")
def _of_quadric(heap, place):  # type: ignore[no-untyped-def]
    """Where the normal of a sphere or torus is vertical."""
    up_x, up_y, up_z = heap[place + 6], heap[place + 9], heap[place + 12]
    level = np.hypot(up_x, up_y)
    points = [(0.0, 0.0)]
    if level > 1e-9:
        u = np.arctan2(up_y, up_x)
        points.append((u, np.arctan2(up_z, level)))
        points.append((u + np.pi, np.arctan2(-up_z, level)))
        if int(heap[place]) == TORUS:
            points.append((u, np.arctan2(-up_z, -level)))
            points.append((u + np.pi, np.arctan2(up_z, -level)))
    return points[1:]


@njit(cache=True, nogil=True, error_model="numpy")
def _of_triangle(heap, place, corners):  # type: ignore[no-untyped-def]
    """Zeros of the gradient in a triangle, sought in its four quarters."""
    points = np.empty((6, 2))
    gradients = np.empty((6, 2))
    for k in range(3):
        points[k] = corners[k]
        points[3 + k] = (corners[k] + corners[(k + 1) % 3]) / 2
    for k in range(6):
        s = surface_at(heap, place, points[k, 0], points[k, 1])
        gradients[k, 0], gradients[k, 1] = s[1, 2], s[2, 2]
    zeros = [(0.0, 0.0)]
    for quarter in ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)):
        around = np.empty((3, 2))
        start = np.empty((3, 2))
        for k in range(3):
            around[k] = gradients[quarter[k]]
            start[k] = points[quarter[k]]
        if depth(around, 0.0, 0.0) < -0.5:
            continue
        u, v = start[:, 0].mean(), start[:, 1].mean()
        solved, u, v = _zero_gradient(heap, place, u, v, np.abs(start - points[0]).max() * 1e-5)
        if solved and depth(corners, u, v) > -0.05:
            zeros.append((u, v))
    return zeros[1:]


@njit(cache=True, nogil=True, error_model="numpy")
def _zero_gradient(heap, place, u, v, step):  # type: ignore[no-untyped-def]
    """Newton's method on ∂z/∂u = ∂z/∂v = 0, second derivatives by differences."""
    for _ in range(15):
        s = surface_at(heap, place, u, v)
        right, left = surface_at(heap, place, u + step, v), surface_at(heap, place, u - step, v)
        above, below = surface_at(heap, place, u, v + step), surface_at(heap, place, u, v - step)
        uu = (right[1, 2] - left[1, 2]) / (2 * step)
        vv = (above[2, 2] - below[2, 2]) / (2 * step)
        uv = (right[2, 2] - left[2, 2] + above[1, 2] - below[1, 2]) / (4 * step)
        determinant = uu * vv - uv * uv
        if abs(determinant) <= 1e-9 * (abs(uu * vv) + uv * uv) or determinant == 0:
            return False, u, v
        u_step = (uv * s[2, 2] - vv * s[1, 2]) / determinant
        v_step = (uv * s[1, 2] - uu * s[2, 2]) / determinant
        u, v = u + u_step, v + v_step
        if max(abs(u_step), abs(v_step)) < 1e-4 * step:
            return True, u, v
    return False, u, v
