"""Horizontal sections of a closed triangle mesh, all planes in one pass.

A triangle is crossed by a plane from the edge where it descends to the edge where it rises, so
that the material lies on the left. Crossings are linked by the id of the mesh edge they lie on:
in a closed mesh every edge carries as many beginnings as ends, and every ring closes without
any tolerance.

One rule decides about nodes that lie in a plane: they are above it. A section is thus the limit
from below. At the mesh's lowest height, where nothing is below, they are beneath it: the limit
from above. Nodes closer than `SNAP` to a plane lie in it. An edge in the plane that is a crest
would be passed twice, there and back: both passes are left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from v3dcad.errors import GeometryError
from v3dcad.geometry.compiled.arrays import (
    ConstFloatRows,
    ConstIntArray,
    ConstIntRows,
    FloatArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled
from v3dcad.model import Floats, Ints, Mesh, Section, Value

SNAP = 1e-9
"""mm: a node this close to a plane lies in it; a ring this thin has no area."""

BASE_TOLERANCE = 1e-6
"""mm: a plane this close to a part's lowest height is at its base; the placement of the part is no
more exact."""

PLANES_PER_TASK = 64
"""Planes in one task of an executor."""

CROSSINGS_PER_BATCH = 4_000_000
"""Crossings computed at a time: limits the memory for a tall part with many planes."""


@dataclass(frozen=True, eq=False, slots=True)
class MeshEdges(Value):
    """The edges of a closed mesh. Where 2m triangles share an edge it counts as m edges."""

    nodes: Ints
    """(e, 2) node ids, the lesser first"""
    of_triangles: Ints
    """(t, 3) the edge from a triangle's corner j to its corner j + 1"""


class Crossings(NamedTuple):
    """Where planes cross a mesh: rings of points, each on one mesh edge, end to end."""

    points: FloatRows
    """(p, 2) mm"""
    edges: IntArray
    """(p,) the mesh edge on which the point lies"""
    triangles: IntArray
    """(p,) the triangle that is crossed from this point to the next"""
    starts: IntArray
    """(r + 1,) where each ring begins"""
    planes: IntArray
    """(r,) the plane of each ring, ascending"""


class _Planes(NamedTuple):
    """Planes, and which of them cross what."""

    heights: FloatArray
    """(k,) mm"""
    ranks: IntArray
    """(v,) the first plane that each vertex is not above"""
    begin: IntArray
    """(t,) the first plane that crosses each triangle"""
    end: IntArray
    """(t,) the first plane after those"""
    before: IntArray
    """(k + 1,) crossings of triangles with the planes before each"""


def section_mesh(mesh: Mesh, heights: Floats, executor: Executor | None = None) -> list[Section]:
    """Sections of a closed mesh at ascending heights (k,), mm.

    Each is the limit from below, at the mesh's lowest height from above. Duplicate points,
    crests passed there and back, and rings without area are dropped. With an executor several
    planes are computed at a time; the results are the same. `GeometryError` where the mesh is open
    or heights do not ascend.
    """
    if executor is not None:
        check_heights(heights)
        waiting = [executor.submit(section_mesh, mesh, task) for task in tasks(heights)]
        return [section for future in waiting for section in future.result()]
    sections = []
    edges = mesh_edges(mesh.triangles)
    first = 0
    for count, crossings in cross_planes(mesh, edges, at_base(heights, mesh.vertices)):
        kept, starts = tidy(crossings.points, crossings.starts)
        points = crossings.points
        if len(kept) < len(points):
            points = points[kept]
        rings: list[list[Floats]] = [[] for _ in range(count)]
        for start, stop, plane in zip(starts[:-1], starts[1:], crossings.planes, strict=True):
            if stop > start:
                rings[plane].append(points[start:stop])
        sections += [
            Section(z=float(z), rings=tuple(loops))
            for z, loops in zip(heights[first : first + count], rings, strict=True)
        ]
        first += count
    return sections


def mesh_edges(triangles: Ints) -> MeshEdges:
    """The edges of triangles (t, 3), each shared by one triangle either way.

    `GeometryError` where a triangle's side is not passed as often one way as the other.
    """
    tail, head = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    nodes = int(triangles.max(initial=-1)) + 1
    forward, backward, unpaired = pair_sides(low * nodes + high, tail > head)
    if unpaired:
        raise GeometryError(
            "the mesh is open, or its triangles do not wind alike: read it with repair=True"
        )
    of_sides = np.empty(len(tail), np.int64)
    of_sides[forward] = of_sides[backward] = np.arange(len(forward))
    return MeshEdges(np.column_stack([low[forward], high[forward]]), of_sides.reshape(-1, 3))


def pair_sides(key: Ints, backward: NDArray[np.bool_]) -> tuple[Ints, Ints, int]:
    """Pair sides (s,) of equal key that are passed one way with those passed the other way.

    Returns the indices (e,) of the sides passed forward, those of their partners, and the number
    of sides without a partner.
    """
    way = key * 2 + backward
    order = np.argsort(way)
    ways = way[order]
    there, back = ways[::2], ways[1::2]
    one_by_one = np.array_equal(back, there + 1) and not np.any(there & 1)
    if one_by_one and np.all(there[1:] > there[:-1]):  # as in a sound mesh: one side either way
        return order[::2], order[1::2], 0
    if np.any(np.diff(ways) == 0):  # only a stable order is the same everywhere
        order = np.argsort(way, kind="stable")
    sorted_key, against = key[order], backward[order]
    there, back = order[~against], order[against]
    if len(there) == len(back) and np.array_equal(sorted_key[~against], sorted_key[against]):
        return there, back, 0
    names = np.unique(key)
    balance = np.bincount(np.searchsorted(names, key), np.where(backward, -1.0, 1.0))
    return there[:0], back[:0], int(np.abs(balance).sum())


def cross_planes(mesh: Mesh, edges: MeshEdges, heights: Floats) -> Iterator[tuple[int, Crossings]]:
    """The crossings of a closed mesh with ascending heights (k,), mm, some planes at a time.

    Yields how many planes the batch has, and its crossings, whose `planes` count from the
    batch's first. Edges are those of `mesh_edges`. `GeometryError` where heights do not ascend.
    """
    check_heights(heights)
    z = mesh.vertices[:, 2]
    levels = plane_levels(heights, float(z.min(initial=np.inf)))
    # A node is above the planes before its rank, and beneath the others.
    ranks = np.searchsorted(levels, z, side="right")
    a, b, c = (ranks[corner] for corner in mesh.triangles.T)
    begin, end = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    planes = len(heights)
    total = np.cumsum(
        np.bincount(begin, minlength=planes + 1) - np.bincount(end, minlength=planes + 1)
    )
    before = np.concatenate([[0], np.cumsum(total[:-1])])
    first = 0
    while first < planes:
        stop = max(
            first + 1,
            int(np.searchsorted(before, before[first] + CROSSINGS_PER_BATCH, side="right")) - 1,
        )
        yield (
            stop - first,
            _cross(
                mesh.vertices,
                mesh.triangles,
                edges.nodes,
                edges.of_triangles,
                _Planes(
                    np.array(heights[first:stop], np.float64),
                    ranks - first,
                    np.clip(begin, first, stop) - first,
                    np.clip(end, first, stop) - first,
                    before[first : stop + 1] - before[first],
                ),
            ),
        )
        first = stop


def at_base(heights: Floats, nodes: Floats) -> Floats:
    """The heights (k,), those within `BASE_TOLERANCE` of the lowest node (n, 3) moved to it."""
    lowest = nodes[:, 2].min(initial=np.inf)
    return np.where(np.abs(heights - lowest) < BASE_TOLERANCE, lowest, heights)


def check_heights(heights: Floats) -> None:
    """Raise `GeometryError` unless heights (k,) are finite and ascend."""
    if np.any(~np.isfinite(heights)) or np.any(np.diff(heights) < 0):
        raise GeometryError("section heights: give finite heights in ascending order")


def tasks(heights: Floats) -> list[Floats]:
    """The heights (k,) divided into the tasks that an executor is given."""
    return np.split(heights, np.arange(PLANES_PER_TASK, len(heights), PLANES_PER_TASK))


def plane_levels(heights: Floats, lowest: float) -> Floats:
    """(k,) least z of the nodes that are above each plane: the module's one rule."""
    base = np.abs(heights - lowest) < SNAP
    return np.maximum.accumulate(np.where(base, heights + SNAP, heights - SNAP))


@compiled(ENTRY)
def _cross(
    vertices: ConstFloatRows,
    triangles: ConstIntRows,
    edge_nodes: ConstIntRows,
    edge_of: ConstIntRows,
    planes: _Planes,
) -> Crossings:
    """Cross every triangle with its planes, then link the crossings of each plane into rings."""
    heights, ranks, begin, end, before = planes
    total = before[-1]
    descent = np.empty(total, np.int64)
    rise = np.empty(total, np.int64)
    crossed = np.empty(total, np.int64)
    level = np.full(total, -1)
    free = before[:-1].copy()
    corner_z, corner_rank = np.empty(4), np.empty(4, np.int64)
    for triangle in range(len(triangles)):
        for corner in range(4 if begin[triangle] < end[triangle] else 0):
            node = triangles[triangle, corner % 3]
            corner_z[corner], corner_rank[corner] = vertices[node, 2], ranks[node]
        for plane in range(begin[triangle], end[triangle]):
            slot = free[plane]
            free[plane] += 1
            crossed[slot] = triangle
            for side in range(3):
                tail_z, head_z = corner_z[side], corner_z[side + 1]
                tail_above, head_above = corner_rank[side] > plane, corner_rank[side + 1] > plane
                if tail_above and not head_above:
                    descent[slot] = edge_of[triangle, side]
                elif head_above and not tail_above:
                    rise[slot] = edge_of[triangle, side]
                elif max(abs(tail_z - heights[plane]), abs(head_z - heights[plane])) < SNAP:
                    level[slot] = edge_of[triangle, side]

    follower = np.empty(len(edge_nodes), np.int64)
    lies_on = np.full(len(edge_nodes), -1)
    opposite = np.full(total, -1)
    points = np.empty((total, 2))
    edges = np.empty(total, np.int64)
    walked = np.empty(total, np.int64)
    done = np.zeros(total, np.bool_)
    starts = np.zeros(total + 1, np.int64)
    plane_of = np.empty(total, np.int64)
    written = rings = 0
    for plane in range(len(heights)):
        for slot in range(before[plane], before[plane + 1]):
            follower[descent[slot]] = slot
            if level[slot] >= 0:
                other = lies_on[level[slot]]
                if other >= before[plane]:
                    opposite[slot], opposite[other] = other, slot
                lies_on[level[slot]] = slot
        for first in range(before[plane], before[plane + 1]):
            slot = first
            while opposite[slot] < 0 and not done[slot]:
                done[slot] = True
                edges[written] = descent[slot]
                walked[written] = crossed[slot]
                low, high = edge_nodes[descent[slot], 0], edge_nodes[descent[slot], 1]
                rise_z = vertices[high, 2] - vertices[low, 2]
                if abs(vertices[low, 2] - heights[plane]) < SNAP:
                    share = 0.0
                elif abs(vertices[high, 2] - heights[plane]) < SNAP:
                    share = 1.0
                else:
                    share = (heights[plane] - vertices[low, 2]) / rise_z
                for axis in range(2):
                    points[written, axis] = (1.0 - share) * vertices[low, axis] + share * vertices[
                        high, axis
                    ]
                written += 1
                slot = follower[rise[slot]]
                while opposite[slot] >= 0:
                    slot = follower[rise[opposite[slot]]]
            if written > starts[rings]:
                plane_of[rings] = plane
                rings += 1
                starts[rings] = written
    return Crossings(
        points[:written],
        edges[:written],
        walked[:written],
        starts[: rings + 1].copy(),
        plane_of[:rings].copy(),
    )


@compiled(INTERNAL)
def is_thin(ring: ConstFloatRows, width: float) -> bool:
    """Whether the area of a ring (k, 2) is that of a line of a width, or less."""
    area, length = 0.0, 0.0
    for k in range(1, len(ring)):
        x, y = ring[k, 0] - ring[0, 0], ring[k, 1] - ring[0, 1]
        back_x, back_y = ring[k - 1, 0] - ring[0, 0], ring[k - 1, 1] - ring[0, 1]
        area += back_x * y - back_y * x
        length += np.hypot(x - back_x, y - back_y)
    return abs(area) <= width * length


@compiled(INTERNAL)
def _differ(points: ConstFloatRows, one: int, other: int) -> bool:
    return points[one, 0] != points[other, 0] or points[one, 1] != points[other, 1]


@compiled(ENTRY)
def tidy(points: ConstFloatRows, starts: ConstIntArray) -> tuple[IntArray, IntArray]:
    """Drop duplicate points, and rings thinner than `SNAP`.

    Of points (p, 2) in rings that begin at starts (r + 1,) returns the indices of those to keep
    and where each ring begins among them; a dropped ring has no points.
    """
    kept = np.empty(len(points), np.int64)
    new_starts = np.zeros(len(starts), np.int64)
    top = 0
    for ring in range(len(starts) - 1):
        bottom = top
        for index in range(starts[ring], starts[ring + 1]):
            if top == bottom or _differ(points, kept[top - 1], index):
                kept[top] = index
                top += 1
        while top > bottom + 1 and not _differ(points, kept[top - 1], kept[bottom]):
            top -= 1
        if is_thin(points[kept[bottom:top]], SNAP):
            top = bottom
        new_starts[ring + 1] = top
    return kept[:top], new_starts
