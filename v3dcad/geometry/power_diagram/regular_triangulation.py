"""The regular triangulation of weighted grid points: the dual of their power diagram.

Incremental insertion along a Hilbert curve with Lawson flips (Edelsbrunner and Shah, "Incremental
topological flipping works for regular triangulations", Algorithmica 1996). With the predicates of
`predicates.py` it is canonical: neither the order of insertion nor the history of flips shows, and
grids, collinear and cocircular points are no special cases.
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INLINED, INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.power_diagram.grid import STEPS
from v3dcad.geometry.power_diagram.predicates import NUMBER, WEIGHT, conflicts
from v3dcad.geometry.power_diagram.triangle_mesh import (
    ABSENT,
    ACROSS,
    FAR,
    SENTINELS,
    STUCK,
    MeshCounts,
    Triangulation,
    carry_out,
    corner_at,
    edge_to,
    note_hidden,
    plan,
    split,
)
from v3dcad.model import Ints


@compiled(INLINED)
def locate(mesh: Triangulation, triangle: int, px: int, py: int) -> int:
    """The triangle whose closed area holds (px, py): a walk from `triangle`.

    Triangles seen from a point have no cyclic order in a regular triangulation, so it ends
    (Edelsbrunner, "An acyclicity theorem for cell complexes", Combinatorica 1990).
    """
    points, triangles = mesh.points, mesh.triangles
    before = ABSENT
    while True:
        ahead = ABSENT
        for i in range(3):
            other = triangles[triangle, ACROSS + i]
            if other not in (before, ABSENT):
                a, b = triangles[triangle, (i + 1) % 3], triangles[triangle, (i + 2) % 3]
                ax, ay = points[a, 0], points[a, 1]
                if (points[b, 0] - ax) * (py - ay) < (points[b, 1] - ay) * (px - ax):
                    ahead = other
                    break
        if ahead == ABSENT:
            return triangle
        before, triangle = triangle, ahead


@compiled(INLINED)
def holds(mesh: Triangulation, triangle: int, px: int, py: int) -> bool:
    """Whether (px, py) lies inside a triangle, not on its sides."""
    points, triangles = mesh.points, mesh.triangles
    for i in range(3):
        a, b = triangles[triangle, i], triangles[triangle, (i + 1) % 3]
        ax, ay = points[a, 0], points[a, 1]
        if (points[b, 0] - ax) * (py - ay) <= (points[b, 1] - ay) * (px - ax):
            return False
    return True


@compiled(INLINED)
def _take_over(mesh: Triangulation, point: int, other: int) -> int:
    """Put a point in the place of another with the same x and y, if it outweighs that.

    Equal weights are decided by the numbers, as in `conflicts`. The triangles around come to the
    stack, with the point as their first corner; returns how many they are, 0 where the point is
    hidden.
    """
    points, triangles, stack = mesh.points, mesh.triangles, mesh.stack
    gain = points[point, WEIGHT] - points[other, WEIGHT]
    if gain < 0 or (gain == 0 and points[point, NUMBER] > points[other, NUMBER]):
        return 0
    triangle = first = mesh.triangle_of[other]
    count = 0
    while True:
        k = corner_at(triangles, triangle, other)
        beside = triangles[triangle, ACROSS + (k + 1) % 3]
        b, c = triangles[triangle, (k + 1) % 3], triangles[triangle, (k + 2) % 3]
        over = triangles[triangle, ACROSS + k]
        over_b, over_c = beside, triangles[triangle, ACROSS + (k + 2) % 3]
        triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2] = point, b, c
        triangles[triangle, ACROSS] = over
        triangles[triangle, ACROSS + 1], triangles[triangle, ACROSS + 2] = over_b, over_c
        stack[count] = triangle
        count += 1
        triangle = beside
        if triangle == first:
            break
    mesh.triangle_of[point] = first
    note_hidden(mesh, other)
    return count


@linked(INTERNAL)
def insert(mesh: Triangulation, point: int, triangle: int) -> int:
    """Insert a point, or hide it; returns a triangle nearby. The search starts at `triangle`."""
    points, triangles, stack = mesh.points, mesh.triangles, mesh.stack
    triangle = locate(mesh, triangle, points[point, 0], points[point, 1])
    waiting = 0
    for k in range(3):
        other = triangles[triangle, k]
        if points[other, 0] == points[point, 0] and points[other, 1] == points[point, 1]:
            waiting = _take_over(mesh, point, other)
            if waiting == 0:
                note_hidden(mesh, point)
                return triangle
            break
    if waiting == 0:
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        if not conflicts(points, a, b, c, point):
            note_hidden(mesh, point)
            return triangle
        second, third = split(mesh, triangle, point)
        stack[0], stack[1], stack[2] = triangle, second, third
        waiting = 3
    deferred, flipped = len(stack), False
    while waiting > 0:
        waiting -= 1
        triangle = stack[waiting]
        other = triangles[triangle, ACROSS]
        # All that changes has the new point, as its first corner.
        if triangles[triangle, 0] == point and other != ABSENT:
            d = triangles[other, edge_to(triangles, other, triangle)]
            if conflicts(points, point, triangles[triangle, 1], triangles[triangle, 2], d):
                kind, other, near, far = plan(mesh, triangle, 0)
                if kind == STUCK:  # until a flip nearby frees it
                    deferred -= 1
                    stack[deferred] = triangle
                else:
                    carry_out(mesh, triangle, 0, kind, other, near, far)
                    flipped = True
                    stack[waiting], stack[waiting + 1] = triangle, other
                    waiting += 2
        if waiting == 0 and flipped:
            flipped = False
            while deferred < len(stack):
                stack[waiting] = stack[deferred]
                waiting += 1
                deferred += 1
    return mesh.triangle_of[point]


@compiled(UNCOUNTED)
def build(mesh: Triangulation, count: int) -> None:
    """Triangulate the first `count` points, sentinels among them, anew."""
    triangles, far = mesh.triangles, FAR
    for point in range(SENTINELS):
        mesh.points[point, 0] = STEPS + far if point in (1, 2) else -far
        mesh.points[point, 1] = STEPS + far if point >= 2 else -far
        mesh.points[point, WEIGHT], mesh.points[point, NUMBER] = 0, point - SENTINELS
        mesh.triangle_of[point] = point // 3
    for i, first, second in ((0, 0, 0), (1, 1, 2), (2, 2, 3)):
        triangles[0, i], triangles[1, i] = first, second
        triangles[0, ACROSS + i] = triangles[1, ACROSS + i] = ABSENT
    triangles[0, ACROSS + 1], triangles[1, ACROSS + 2] = 1, 0
    mesh.counts.points, mesh.counts.triangles = count, 2
    mesh.counts.free = mesh.counts.hidden = 0
    triangle = 0
    for point in range(SENTINELS, count):
        triangle = insert(mesh, point, triangle)


def triangulation(
    sites: Ints, weights: Ints, numbers: Ints | None = None, inserted: int | None = None
) -> Triangulation:
    """The regular triangulation of sites (n, 2) with weights (n,), in grid units.

    `numbers` (n,), by default the rows, break ties. The first `inserted` are inserted, by default
    all; the others may enter later. Quick where they come in `curve_order`, and canonical in any
    order.
    """
    count = SENTINELS + len(sites)
    mesh = Triangulation(
        points=np.empty((count, 4), np.int64),
        triangle_of=np.full(count, ABSENT, np.int32),
        triangles=np.empty((2 * count, 6), np.int32),
        free=np.empty(2 * count, np.int32),
        stack=np.empty(2 * count, np.int32),
        hidden=np.empty(count, np.int32),
        counts=MeshCounts.of(),
    )
    mesh.points[SENTINELS:, :2] = sites
    mesh.points[SENTINELS:, WEIGHT] = weights
    mesh.points[SENTINELS:, NUMBER] = np.arange(len(sites)) if numbers is None else numbers
    build(mesh, count if inserted is None else SENTINELS + inserted)
    return mesh


def neighbour_pairs(mesh: Triangulation, order: Ints) -> Ints:
    """(m, 2) pairs i < j of points that share an edge; `order` (n,) numbers the mesh's points."""
    corners = mesh.triangles[: mesh.counts.triangles, :3]
    corners = corners[corners[:, 0] != ABSENT].astype(np.int64) - SENTINELS
    ends = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    ends = ends[(ends >= 0).all(axis=1) & (ends[:, 0] < ends[:, 1])]
    return np.sort(order[ends], axis=1)
