"""What of a power diagram lies inside a section's rings: its inner vertices and whole edges.

An edge is *whole* where both its ends lie inside and no ring crosses it. Inner vertices and whole
edges are numbered without gaps: the last one moves to where one has gone.

Where a part is thinner than rounding, as at points where rings touch, winding numbers may be others
than 0 and 1. Vertices and edges there count as often as they are wound around, backwards if less
than 0 times, so that each cell's sides close up. Edges there are listed among the crossed ones.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    FloatRows,
    Int32Array,
    Int32Rows,
)
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INTERNAL
from v3dcad.geometry.compiled.records import Record
from v3dcad.geometry.power_diagram.event_queue import Motion, strut
from v3dcad.geometry.power_diagram.predicates import NUMBER
from v3dcad.geometry.power_diagram.triangle_mesh import (
    ABSENT,
    ACROSS,
    Triangulation,
    edge_to,
)

UNLISTED, UNCROSSED = -1, -2
"""What `Cut.first_on` has for an edge without crossings: listed nowhere, or among the crossed."""


class CutCounts(Record):
    """How many rows of a cut's arrays are in use."""

    vertices: int
    """inner vertices"""
    whole: int
    """whole edges"""
    filled: int
    """cells with an inner vertex"""
    crossed: int
    """edges that rings cross"""
    highest_winding: int
    """the largest winding number, of either sign, that an inner vertex has had"""


class Cut(NamedTuple):
    """The diagram inside the rings. t, p: slots of triangles and points; edges by their keys."""

    inside: Int32Array
    """(t,) int32: each triangle's winding number"""
    vertex_of: Int32Array
    """(t,) int32: its inner vertex, or −1"""
    corners: Int32Rows
    """(t, 4) int32: triangle and cells of each inner vertex"""
    struts: FloatRows
    """(t, 4) float64: how each inner vertex moves"""
    edges: Int32Rows
    """(3 t, 2) int32: vertices of each whole edge"""
    sites: Int32Rows
    """(3 t, 2) int32: to its right and to its left"""
    halves: Int32Rows
    """(3 t, 2) int32: 3 · triangle + edge on both sides; the first is its key"""
    edge_at: Int32Array
    """(3 t,) int32: the whole edge of a half, or −1"""
    first_on: Int32Array
    """(3 t,) int32: the first crossing on the edge with a key, `UNLISTED` or `UNCROSSED`"""
    gain: Int32Rows
    """(3 t, 2) int32: what the winding number gains along it; and room for the next"""
    crossed: Int32Array
    """(3 t,) int32: keys of crossed edges"""
    filled: Int32Array
    """(p,) int32: how many inner vertices each cell has"""
    listed: Int32Array
    """(t,) int32: room for the triangles that are cut anew,"""
    picked: Int32Array
    """(t,) int32: some of them,"""
    keys: Int32Array
    """(6 t,) int32: the keys or halves of their edges, and"""
    former: Int32Array
    """(3 t,) int32: the keys of edges that were crossed before"""
    state: CutCounts


def empty_cut(points: int, triangles: int) -> Cut:
    """A cut of nothing, with room for so many points and triangles."""
    return Cut(
        inside=np.zeros(triangles, np.int32),
        vertex_of=np.full(triangles, -1, np.int32),
        corners=np.empty((triangles, 4), np.int32),
        struts=np.empty((triangles, 4)),
        edges=np.empty((3 * triangles, 2), np.int32),
        sites=np.empty((3 * triangles, 2), np.int32),
        halves=np.empty((3 * triangles, 2), np.int32),
        edge_at=np.full(3 * triangles, -1, np.int32),
        first_on=np.full(3 * triangles, UNLISTED, np.int32),
        gain=np.zeros((3 * triangles, 2), np.int32),
        crossed=np.empty(3 * triangles, np.int32),
        filled=np.zeros(points, np.int32),
        listed=np.empty(triangles, np.int32),
        picked=np.empty(triangles, np.int32),
        keys=np.empty(6 * triangles, np.int32),
        former=np.empty(3 * triangles, np.int32),
        state=CutCounts.of(),
    )


@linked(INTERNAL)
def drop_edges(cut: Cut, halves: Int32Array, count: int) -> None:
    """Take out the whole edges of some halves; their places get the edges' keys, or −1."""
    edges, sites, sides, edge_at = cut.edges, cut.sites, cut.halves, cut.edge_at
    last = cut.state.whole
    for place in range(count):
        edge = edge_at[halves[place]]
        halves[place] = -1
        if edge < 0:
            continue
        halves[place] = sides[edge, 0]
        edge_at[sides[edge, 0]] = edge_at[sides[edge, 1]] = -1
        last -= 1
        if edge < last:
            for k in range(2):
                edges[edge, k], sites[edge, k] = edges[last, k], sites[last, k]
                sides[edge, k] = sides[last, k]
                edge_at[sides[edge, k]] = edge
    cut.state.whole = last


@linked(INTERNAL)
def drop_vertices(cut: Cut, doomed: Int32Array, count: int) -> None:
    """Take out the inner vertices of triangles whose edges have been taken out."""
    vertex_of, corners, struts = cut.vertex_of, cut.corners, cut.struts
    edges, edge_at, filled = cut.edges, cut.edge_at, cut.filled
    last, cells = cut.state.vertices, cut.state.filled
    for place in range(count):
        vertex = vertex_of[doomed[place]]
        vertex_of[doomed[place]] = -1
        for k in range(1, 4):
            cell = corners[vertex, k]
            filled[cell] -= 1
            cells -= filled[cell] == 0
        last -= 1
        if vertex == last:
            continue
        moved = corners[last, 0]
        vertex_of[moved] = vertex
        for k in range(4):
            corners[vertex, k], struts[vertex, k] = corners[last, k], struts[last, k]
        for k in range(3):
            edge = edge_at[3 * moved + k]
            if edge >= 0:
                edges[edge, 0 if edges[edge, 0] == last else 1] = vertex
    cut.state.vertices, cut.state.filled = last, cells


@linked(INTERNAL)
def add_vertices(
    mesh: Triangulation, motion: Motion, cut: Cut, listed: Int32Array, count: int
) -> None:
    """Number those of the listed triangles that lie inside and have no vertex yet."""
    points, triangles, base, growth = mesh.points, mesh.triangles, motion.base, motion.growth
    vertex_of, corners, struts = cut.vertex_of, cut.corners, cut.struts
    inside, filled = cut.inside, cut.filled
    vertex, cells = cut.state.vertices, cut.state.filled
    most = cut.state.highest_winding
    for place in range(count):
        triangle = listed[place]
        if inside[triangle] == 0 or vertex_of[triangle] >= 0:
            continue
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        x, y, vx, vy = strut(points, base, growth, a, b, c)
        struts[vertex, 0], struts[vertex, 1], struts[vertex, 2], struts[vertex, 3] = x, y, vx, vy
        corners[vertex, 0] = triangle
        for k in range(3):
            cell = triangles[triangle, k]
            corners[vertex, k + 1] = cell
            cells += filled[cell] == 0
            filled[cell] += 1
        vertex_of[triangle] = vertex
        vertex += 1
        most = max(most, abs(inside[triangle]))
    cut.state.vertices, cut.state.filled = vertex, cells
    cut.state.highest_winding = most


@linked(INTERNAL)
def settle_edges(mesh: Triangulation, cut: Cut, keys: Int32Array, count: int) -> None:
    """Make the edges with some keys (−1: none) what they should be: whole, crossed or neither."""
    points, triangles = mesh.points, mesh.triangles
    inside, vertex_of = cut.inside, cut.vertex_of
    edges, sites, halves, edge_at = cut.edges, cut.sites, cut.halves, cut.edge_at
    first_on, edge = cut.first_on, cut.state.whole
    for place in range(count):
        key = keys[place]
        if key < 0:
            continue
        triangle, i = key // 3, key % 3
        other = triangles[triangle, ACROSS + i]
        if triangles[triangle, 0] != ABSENT and other > triangle:
            right, left = triangles[triangle, (i + 1) % 3], triangles[triangle, (i + 2) % 3]
            whole = first_on[key] < 0 and inside[triangle] == 1  # as is the one across
            if not whole and first_on[key] == UNLISTED and inside[triangle] != 0:
                cut.crossed[cut.state.crossed], first_on[key] = key, UNCROSSED
                cut.state.crossed += 1
            if whole and edge_at[key] < 0:
                half = 3 * other + edge_to(triangles, other, triangle)
                low, high, backwards = points[right, NUMBER], points[left, NUMBER], 0
                if low > high:
                    low, high, backwards = high, low, 1
                edges[edge, backwards] = vertex_of[triangle]
                edges[edge, 1 - backwards] = vertex_of[other]
                sites[edge, 0], sites[edge, 1] = low, high
                halves[edge, 0], halves[edge, 1] = key, half
                edge_at[key] = edge_at[half] = edge
                edge += 1
    cut.state.whole = edge
