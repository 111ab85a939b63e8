"""Closing the holes of a triangle mesh with patches of least area.

Barequet and Sharir, "Filling gaps in the boundary of a polyhedron" (1995): of all triangulations
of a hole's rim the one of least area, by dynamic programming. (pymeshfix does this too, but its
licence, AGPL, would bind the users of v3dcad; trimesh fills with fans, which fold where the rim is
not convex.)
"""

from __future__ import annotations

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.compiled.arrays import ConstFloatRows, IntRows
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.geometry.mesh.bodies import arm, sides_of
from v3dcad.model import Floats, Ints

MAX_RIM_EDGES = 1000
"""The time for a patch grows with the cube of its rim's edges: about a second for this many."""


def rims_of(triangles: Ints) -> list[Ints]:
    """Node ids of each hole's rim, in the direction in which a patch has to pass it.

    A hole is bounded by edges of only one triangle; triangles must wind alike.
    """
    sides = sides_of(triangles)
    lone = sides.starts[:-1][sides.uses() == 1]
    head, tail = sides.ends[lone].T
    onward: dict[int, list[int]] = {}
    for start, stop in zip(tail.tolist(), head.tolist(), strict=True):
        onward.setdefault(start, []).append(stop)
    rims = []
    for start in tail.tolist():
        rim, node = [], start
        while onward.get(node):
            rim.append(node)
            node = onward[node].pop()
        if rim:
            rims.append(np.array(rim, np.int64))
    return rims


def patch(vertices: Floats, rim: Ints) -> Ints:
    """Triangles (k − 2, 3) of least area that close a rim (k,) of node ids.

    `GeometryError` where the rim has more than `MAX_RIM_EDGES` edges.
    """
    if len(rim) > MAX_RIM_EDGES:
        x, y, z = vertices[rim].mean(axis=0)
        raise GeometryError(
            f"a hole of {len(rim)} edges about ({x:.4g}, {y:.4g}, {z:.4g}) is too long to patch "
            f"(at most {MAX_RIM_EDGES}): close it where the mesh was made"
        )
    return rim[_least_area(vertices[rim])]


@compiled(ENTRY)
def _least_area(points: ConstFloatRows) -> IntRows:
    count = len(points)
    area = np.zeros((count, count))
    apex = np.zeros((count, count), np.int64)
    for span in range(2, count):
        for first in range(count - span):
            last = first + span
            best = np.inf
            chord = arm(points, last, points[first])
            for middle in range(first + 1, last):
                there = arm(points, middle, points[first])
                x = chord[1] * there[2] - chord[2] * there[1]
                y = chord[2] * there[0] - chord[0] * there[2]
                z = chord[0] * there[1] - chord[1] * there[0]
                cost = np.sqrt(x * x + y * y + z * z) / 2
                cost += area[first, middle] + area[middle, last]
                if cost < best:
                    best = cost
                    apex[first, last] = middle
            area[first, last] = best
    triangles = np.empty((max(count - 2, 0), 3), np.int64)
    waiting = np.empty((count + 1, 2), np.int64)
    waiting[0, 0], waiting[0, 1] = 0, count - 1
    top, written = 1, 0
    while top > 0:
        top -= 1
        first, last = waiting[top, 0], waiting[top, 1]
        if last - first < 2:
            continue
        middle = apex[first, last]
        triangles[written, 0], triangles[written, 1], triangles[written, 2] = first, middle, last
        written += 1
        waiting[top, 1] = middle
        waiting[top + 1, 0], waiting[top + 1, 1] = middle, last
        top += 2
    return triangles
