"""Horizontal sections of a closed triangle mesh, all planes in one pass.

A triangle is crossed by a plane from the edge where it descends to the edge where it rises, so
that the material lies on the left. Crossings are linked by the id of the mesh edge they lie on:
in a closed mesh every edge carries as many beginnings as ends, and every ring closes without
any tolerance.

One rule decides about nodes that lie in a plane: they are above it. A section is thus the limit
from below. At the mesh's lowest height, where nothing is below, they are beneath it: the limit
from above. Nodes closer than `SNAP` to a plane lie in it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numba import njit

from v3dcad.errors import GeometryError
from v3dcad.model import Floats, Ints, Mesh, Section

SNAP = 1e-9
"""mm: a node this close to a plane lies in it; a ring this thin has no area."""

BATCH = 4_000_000
"""Crossings held at a time: bounds the memory of a tall part with many planes."""


class MeshEdges(NamedTuple):
    """The edges of a closed mesh. Where 2m triangles share an edge it counts as m edges."""

    nodes: Ints
    """(e, 2) node ids, the lesser first"""
    of_triangles: Ints
    """(t, 3) the edge from a triangle's corner j to its corner j + 1"""


class Crossings(NamedTuple):
    """Where planes cross a mesh: rings of points, each on one mesh edge, end to end."""

    points: Floats
    """(p, 2) mm"""
    edges: Ints
    """(p,) the mesh edge on which the point lies"""
    triangles: Ints
    """(p,) the triangle that is crossed from this point to the next"""
    starts: Ints
    """(r + 1,) where each ring begins"""
    planes: Ints
    """(r,) the plane of each ring, ascending"""


def section_mesh(mesh: Mesh, heights: Floats) -> list[Section]:
    """Sections of a closed mesh at ascending heights (k,), mm.

    Each is the limit from below, at the mesh's lowest height from above. Duplicate points,
    retraced spikes and rings without area are dropped. `GeometryError` where the mesh is open
    or heights do not ascend.
    """
    sections = []
    edges = mesh_edges(mesh.triangles)
    first = 0
    for count, crossings in cross_planes(mesh, edges, heights):
        kept, starts = tidy(crossings.points, crossings.starts)
        points = crossings.points[kept]
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
    key = (low * nodes + high) * 2 + (tail > head)
    order = np.argsort(key, kind="stable")
    forward, backward = order[key[order] % 2 == 0], order[key[order] % 2 == 1]
    if len(forward) != len(backward) or np.any(key[forward] // 2 != key[backward] // 2):
        raise GeometryError(
            "the mesh is open, or its triangles do not wind alike: repair it before slicing"
        )
    of_sides = np.empty(len(key), np.int64)
    of_sides[forward] = of_sides[backward] = np.arange(len(forward))
    return MeshEdges(np.column_stack([low[forward], high[forward]]), of_sides.reshape(-1, 3))


def cross_planes(mesh: Mesh, edges: MeshEdges, heights: Floats) -> Iterator[tuple[int, Crossings]]:
    """The crossings of a closed mesh with ascending heights (k,), mm, some planes at a time.

    Yields how many planes the batch has, and its crossings, whose `planes` count from the
    batch's first. Edges are those of `mesh_edges`. `GeometryError` where heights do not ascend.
    """
    if np.any(~np.isfinite(heights)) or np.any(np.diff(heights) < 0):
        raise GeometryError("section heights: give finite heights in ascending order")
    z = mesh.vertices[:, 2]
    levels = plane_levels(heights, float(z.min(initial=np.inf)))
    of_corners = z[mesh.triangles]
    begin = np.searchsorted(levels, of_corners.min(axis=1, initial=np.inf), side="right")
    end = np.searchsorted(levels, of_corners.max(axis=1, initial=-np.inf), side="right")
    planes = len(heights)
    total = np.cumsum(
        np.bincount(begin, minlength=planes + 1) - np.bincount(end, minlength=planes + 1)
    )
    before = np.concatenate([[0], np.cumsum(total[:-1])])
    first = 0
    while first < planes:
        stop = max(first + 1, int(np.searchsorted(before, before[first] + BATCH, side="right")) - 1)
        yield (
            stop - first,
            Crossings(
                *_cross(
                    mesh.vertices,
                    mesh.triangles,
                    edges.nodes,
                    edges.of_triangles,
                    heights[first:stop],
                    levels[first:stop],
                    np.clip(begin, first, stop) - first,
                    np.clip(end, first, stop) - first,
                    before[first : stop + 1] - before[first],
                )
            ),
        )
        first = stop


def plane_levels(heights: Floats, lowest: float) -> Floats:
    """(k,) least z of the nodes that are above each plane: the module's one rule."""
    base = np.abs(heights - lowest) < SNAP
    return np.maximum.accumulate(np.where(base, heights + SNAP, heights - SNAP))


@njit(cache=True, nogil=True)
def _cross(vertices, triangles, edge_nodes, edge_of, heights, levels, begin, end, before):  # type: ignore[no-untyped-def]
    """Cross every triangle with its planes, then link the crossings of each plane into rings."""
    total = before[-1]
    descent = np.empty(total, np.int64)
    rise = np.empty(total, np.int64)
    crossed = np.empty(total, np.int64)
    place = before[:-1].copy()
    for triangle in range(len(triangles)):
        for plane in range(begin[triangle], end[triangle]):
            slot = place[plane]
            place[plane] += 1
            crossed[slot] = triangle
            for side in range(3):
                tail_above = vertices[triangles[triangle, side], 2] >= levels[plane]
                head_above = vertices[triangles[triangle, (side + 1) % 3], 2] >= levels[plane]
                if tail_above and not head_above:
                    descent[slot] = edge_of[triangle, side]
                elif head_above and not tail_above:
                    rise[slot] = edge_of[triangle, side]

    follower = np.empty(len(edge_nodes), np.int64)
    points = np.empty((total, 2))
    edges = np.empty(total, np.int64)
    walked = np.empty(total, np.int64)
    done = np.zeros(total, np.bool_)
    starts = [0]
    planes = [0]
    written = 0
    for plane in range(len(heights)):
        for slot in range(before[plane], before[plane + 1]):
            follower[descent[slot]] = slot
        for first in range(before[plane], before[plane + 1]):
            slot = first
            while not done[slot]:
                done[slot] = True
                edges[written] = descent[slot]
                walked[written] = crossed[slot]
                low, high = edge_nodes[descent[slot]]
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
            if written > starts[-1]:
                starts.append(written)
                planes.append(plane)
    return points, edges, walked, np.array(starts), np.array(planes[1:], np.int64)


@njit(cache=True, nogil=True)
def tidy(points, starts):  # type: ignore[no-untyped-def]
    """Drop duplicate points, spikes passed to and fro, and rings thinner than `SNAP`.

    Of points (p, 2) in rings that begin at starts (r + 1,) returns the indices of those to keep
    and where each ring begins among them; a dropped ring has no points. Of equal points the last
    stays, whose way to the next has a length.
    """
    kept = np.empty(len(points), np.int64)
    new_starts = np.zeros(len(starts), np.int64)
    bottom = 0
    for ring in range(len(starts) - 1):
        top = bottom
        for index in range(starts[ring], starts[ring + 1]):
            if top - bottom >= 2 and _equal(points, kept[top - 2], index):
                top -= 1
            if top > bottom and _equal(points, kept[top - 1], index):
                top -= 1
            kept[top] = index
            top += 1
        first = bottom
        while top - first >= 2:
            long = top - first >= 3
            if _equal(points, kept[top - 1], kept[first]) or (
                long and _equal(points, kept[top - 2], kept[first])
            ):
                top -= 1
            elif long and _equal(points, kept[top - 1], kept[first + 1]):
                first += 1
            else:
                break
        area, length = 0.0, 0.0
        for place in range(first + 1, top):
            here, back = points[kept[place]], points[kept[place - 1]]
            origin = points[kept[first]]
            area += (back[0] - origin[0]) * (here[1] - origin[1])
            area -= (back[1] - origin[1]) * (here[0] - origin[0])
            length += np.hypot(here[0] - back[0], here[1] - back[1])
        if abs(area) > SNAP * length:
            for place in range(first, top):
                kept[bottom + place - first] = kept[place]
            bottom += top - first
        new_starts[ring + 1] = bottom
    return kept[:bottom], new_starts


@njit(cache=True, nogil=True)
def _equal(points, one, other):  # type: ignore[no-untyped-def]
    return points[one, 0] == points[other, 0] and points[one, 1] == points[other, 1]
