"""Closing the holes of a triangle mesh with patches of least area.

Barequet and Sharir, "Filling gaps in the boundary of a polyhedron" (1995): of all triangulations
of a hole's rim the one of least area, by dynamic programming. (pymeshfix does this too, but its
licence, AGPL, would bind the users of v3dcad; trimesh fills with fans, which fold where the rim is
not convex.)
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import ConstFloatRows, IntRows
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.geometry.mesh.bodies import arm, sides_of
from v3dcad.model import Floats, Ints

MAX_RIM_EDGES = 500
"""The time for a patch grows with the cube of its rim's edges: 0.1 s for this many. Longer
rims are cut in two, and in two again."""


def rims_of(triangles: Ints) -> list[Ints]:
    """Node ids of the rims of holes, each in the direction in which a patch has to pass it.

    An edge that triangles pass k times more one way than the other is on k rims. Since the surplus
    is the boundary of the triangles, it always parts into closed rims, here such that pass no node
    twice; with a patch for each of them every edge is passed as often one way as the other.
    """
    sides = sides_of(triangles)
    way = np.where(sides.ends[:, 0] < sides.ends[:, 1], 1, -1)
    surplus = np.add.reduceat(way, sides.starts[:-1])
    some = np.flatnonzero(surplus)
    low, high = np.sort(sides.ends[sides.starts[some]], axis=1).T
    forward = surplus[some] > 0
    times = np.abs(surplus[some])
    start, stop = np.repeat([np.where(forward, high, low), np.where(forward, low, high)], times, 1)
    onward: dict[int, list[int]] = {}
    for node, following in zip(start.tolist(), stop.tolist(), strict=True):
        onward.setdefault(node, []).append(following)
    rims = []
    for node in start.tolist():
        path: list[int] = []
        passed: dict[int, int] = {}
        while onward[node]:
            passed[node] = len(path)
            path.append(node)
            node = onward[node].pop()
            if node in passed:
                rims.append(np.array(path[passed[node] :], np.int64))
                for left in path[passed[node] :]:
                    del passed[left]
                del path[len(path) - len(rims[-1]) :]
    return rims


def patch(vertices: Floats, rim: Ints) -> Ints:
    """Triangles (k − 2, 3) that close a rim (k,) of node ids.

    Of least area, or, where the rim has more than `MAX_RIM_EDGES` edges, of parts that are.
    """
    if len(rim) <= MAX_RIM_EDGES:
        return rim[_least_area(vertices[rim])]
    first, last = _shortest_chord(vertices[rim])
    halves = rim[first : last + 1], np.concatenate([rim[last:], rim[: first + 1]])
    return np.vstack([patch(vertices, half) for half in halves])


def _shortest_chord(points: Floats) -> tuple[int, int]:
    """Where a rim (k, 3) is cut so that each part has at least a quarter of it: i < j.

    The shortest of the chords between `MAX_RIM_EDGES` of its points, evenly spread.
    """
    count = len(points)
    some = np.arange(MAX_RIM_EDGES) * count // MAX_RIM_EDGES
    i, j = np.triu_indices(MAX_RIM_EDGES, MAX_RIM_EDGES // 4 + 1)
    fits = some[j] - some[i] <= count - count // 4
    i, j = some[i[fits]], some[j[fits]]
    chord = int(np.argmin(((points[i] - points[j]) ** 2).sum(axis=1)))
    return int(i[chord]), int(j[chord])


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
