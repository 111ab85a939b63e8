"""The cut diagram as a planar graph in arrays: vertices, edges, and who lies beside them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.clipping.interior import Cut
from v3dcad.geometry.clipping.ring_walk import INTO, SEGMENT, WINDING, Crossings, LayerRings
from v3dcad.geometry.compiled.arrays import (
    FloatRows,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INTERNAL
from v3dcad.geometry.power_diagram.predicates import NUMBER
from v3dcad.geometry.power_diagram.triangle_mesh import ACROSS, Triangulation


class Edges(NamedTuple):
    """Room for edges, one behind the other."""

    ends: IntRows
    """(e, 2) vertices"""
    sites: IntRows
    """(e, 2) the sites to the right and to the left, i < j; −1 outside the section"""


@linked(INTERNAL)
def write_edges(
    mesh: Triangulation,
    cut: Cut,
    rings: LayerRings,
    crossings: Crossings,
    count: int,
    edges: Edges,
    row: int,
) -> tuple[int, int]:
    """Write all edges into `edges` from `row` on: whole ones, the first pieces of
    crossed ones, their further pieces, the rings. Returns where the first pieces and where the
    edges end: up to there each pair of neighbours comes once.

    Vertices are numbered: inner ones, then the rings' corners, then the crossings. Takes the
    crossings' winding away.

    Along an edge pieces begin at its first end as often as that is wound around and wherever a
    crossing gains, and end where one loses and at the other end: the first where the first ends,
    and so on, whatever rounding has made of the crossings' order.
    """
    points, triangles, inside = mesh.points, mesh.triangles, cut.inside
    corners, starts, after = rings.corners, rings.starts, rings.after
    crossed, at, next_on = crossings.rows, crossings.at, crossings.next_on
    ends, sites = edges.ends, edges.sites
    vertex_of, first_on, inner = cut.vertex_of, cut.first_on, cut.state.vertices
    whole, whole_sites, crossing_base = cut.edges, cut.sites, inner + len(corners)
    for edge in range(cut.state.whole):
        for k in range(2):
            ends[row + edge, k], sites[row + edge, k] = whole[edge, k], whole_sites[edge, k]
    row += cut.state.whole
    length = row + cut.state.crossed
    for place in range(cut.state.crossed):
        key = cut.crossed[place]
        triangle, i = key // 3, key % 3
        other = triangles[triangle, ACROSS + i]
        right, left = triangles[triangle, (i + 1) % 3], triangles[triangle, (i + 2) % 3]
        low, high, backwards = points[right, NUMBER], points[left, NUMBER], 0
        if low > high:
            low, high, backwards = high, low, 1
        way_x = float(points[left, 1] - points[right, 1])
        way_y = float(points[right, 0] - points[left, 0])
        near, far, to = np.int64(inside[triangle]), np.int64(inside[other]), row
        row += 1
        while True:
            end = -1
            for k in range(2):  # where a piece begins and where it ends
                gain, end = 1 - 2 * k, -1
                if near * gain > 0:
                    near, end = near - gain, vertex_of[triangle]
                else:
                    best, soonest, crossing = -1, np.inf, first_on[key]
                    while crossing >= 0:
                        if crossed[crossing, WINDING] == gain:
                            p = crossed[crossing, SEGMENT]
                            q = after[p]
                            x = corners[p, 0] + at[crossing] * (corners[q, 0] - corners[p, 0])
                            y = corners[p, 1] + at[crossing] * (corners[q, 1] - corners[p, 1])
                            if x * way_x + y * way_y < soonest:
                                best, soonest = crossing, x * way_x + y * way_y
                        crossing = next_on[crossing]
                    if best >= 0:
                        crossed[best, WINDING], end = 0, crossing_base + best  # taken
                    elif far * gain < 0:
                        far, end = far + gain, vertex_of[other]
                if end < 0:
                    break
                ends[to, k ^ backwards] = end
            if end < 0:
                break
            sites[to, 0], sites[to, 1] = low, high
            length += to == length
            to = length
    crossing = 0
    for ring in range(len(starts) - 1):
        cell = crossings.begun_in[ring]
        for segment in range(starts[ring] - starts[0], starts[ring + 1] - starts[0]):
            begin = inner + segment
            while crossing < count and crossed[crossing, SEGMENT] == segment:
                ends[length, 0], ends[length, 1] = begin, crossing_base + crossing
                sites[length, 0], sites[length, 1] = -1, points[cell, NUMBER]
                length += 1
                begin, cell = crossing_base + crossing, crossed[crossing, INTO]
                crossing += 1
            ends[length, 0], ends[length, 1] = begin, inner + after[segment]
            sites[length, 0], sites[length, 1] = -1, points[cell, NUMBER]
            length += 1
    return row, length


class Frame(NamedTuple):
    """Where the grid lies, mm: its lower left corner, and its pitch."""

    left: float
    low: float
    pitch: float


@linked(INTERNAL)
def place_vertices(
    cut: Cut,
    time: float,
    corners: FloatRows,
    after: IntArray,
    crossings: Crossings,
    count: int,
    frame: Frame,
    vertices: FloatRows,
    row: int,
) -> int:
    """Write the vertices' coordinates, mm, into `vertices` from `row` on; returns the row after.

    The rings' corners (r, 2) are in mm.
    """
    struts, crossed, at = cut.struts, crossings.rows, crossings.at
    left, low, pitch = frame.left, frame.low, frame.pitch
    for vertex in range(cut.state.vertices):
        vertices[row, 0] = left + pitch * (struts[vertex, 0] + time * struts[vertex, 2])
        vertices[row, 1] = low + pitch * (struts[vertex, 1] + time * struts[vertex, 3])
        row += 1
    for corner in range(len(corners)):
        vertices[row, 0], vertices[row, 1] = corners[corner, 0], corners[corner, 1]
        row += 1
    for crossing in range(count):
        p = crossed[crossing, SEGMENT]
        q = after[p]
        for k in range(2):
            vertices[row, k] = corners[p, k] + at[crossing] * (corners[q, k] - corners[p, k])
        row += 1
    return row
