"""The cut diagram as a planar graph in arrays: vertices, edges, and who lies beside them."""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.clipping.interior import Cut
from v3dcad.geometry.clipping.ring_walk import INTO, SEGMENT, WINDING
from v3dcad.geometry.compiled.arrays import (
    ConstIntArray,
    FloatArray,
    FloatRows,
    Int32Array,
    Int32Rows,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INTERNAL
from v3dcad.geometry.power_diagram.triangle_mesh import ACROSS, Triangulation


@linked(INTERNAL)
def write_edges(
    mesh: Triangulation,
    cut: Cut,
    site_of: ConstIntArray,
    corners: FloatRows,
    starts: IntArray,
    after: IntArray,
    begun_in: IntArray,
    crossings: Int32Rows,
    at: FloatArray,
    count: int,
    next_on: Int32Array,
    edges: IntRows,
    sites: IntRows,
    row: int,
) -> tuple[int, int]:
    """Write all edges into `edges` and `sites` from `row` on: whole ones, the first pieces of
    crossed ones, their further pieces, the rings. Returns where the first pieces and where the
    edges end: up to there each pair of neighbours comes once.

    Vertices are numbered: inner ones, then the rings' corners, then the crossings. Takes the
    crossings' winding away.

    Along an edge pieces begin at its first end as often as that is wound around and wherever a
    crossing gains, and end where one loses and at the other end: the first where the first ends,
    and so on, whatever rounding has made of the crossings' order.
    """
    points, triangles, inside = mesh.points, mesh.triangles, cut.inside
    vertex_of, first_on, inner = cut.vertex_of, cut.first_on, cut.state.vertices
    whole, whole_sites, crossing_base = cut.edges, cut.sites, inner + len(corners)
    for edge in range(cut.state.whole):
        for k in range(2):
            edges[row + edge, k], sites[row + edge, k] = whole[edge, k], whole_sites[edge, k]
    row += cut.state.whole
    length = row + cut.state.crossed
    for place in range(cut.state.crossed):
        key = cut.crossed[place]
        triangle, i = key // 3, key % 3
        other = triangles[triangle, ACROSS + i]
        right, left = triangles[triangle, (i + 1) % 3], triangles[triangle, (i + 2) % 3]
        low, high, backwards = site_of[right], site_of[left], 0
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
                        if crossings[crossing, WINDING] == gain:
                            p = crossings[crossing, SEGMENT]
                            q = after[p]
                            x = corners[p, 0] + at[crossing] * (corners[q, 0] - corners[p, 0])
                            y = corners[p, 1] + at[crossing] * (corners[q, 1] - corners[p, 1])
                            if x * way_x + y * way_y < soonest:
                                best, soonest = crossing, x * way_x + y * way_y
                        crossing = next_on[crossing]
                    if best >= 0:
                        crossings[best, WINDING], end = 0, crossing_base + best  # taken
                    elif far * gain < 0:
                        far, end = far + gain, vertex_of[other]
                if end < 0:
                    break
                edges[to, k ^ backwards] = end
            if end < 0:
                break
            sites[to, 0], sites[to, 1] = low, high
            length += to == length
            to = length
    crossing = 0
    for ring in range(len(starts) - 1):
        cell = begun_in[ring]
        for segment in range(starts[ring] - starts[0], starts[ring + 1] - starts[0]):
            begin = inner + segment
            while crossing < count and crossings[crossing, SEGMENT] == segment:
                edges[length, 0], edges[length, 1] = begin, crossing_base + crossing
                sites[length, 0], sites[length, 1] = -1, site_of[cell]
                length += 1
                begin, cell = crossing_base + crossing, crossings[crossing, INTO]
                crossing += 1
            edges[length, 0], edges[length, 1] = begin, inner + after[segment]
            sites[length, 0], sites[length, 1] = -1, site_of[cell]
            length += 1
    return row, length


@linked(INTERNAL)
def place_vertices(
    struts: FloatRows,
    inner: int,
    time: float,
    corners: FloatRows,
    after: IntArray,
    crossings: Int32Rows,
    at: FloatArray,
    count: int,
    left: float,
    low: float,
    pitch: float,
    vertices: FloatRows,
    row: int,
) -> int:
    """Write the vertices' coordinates, mm, into `vertices` from `row` on; returns the row after.

    The rings' corners (r, 2) are in mm; (`left`, `low`), mm, and `pitch` say where the grid lies.
    """
    for vertex in range(inner):
        vertices[row, 0] = left + pitch * (struts[vertex, 0] + time * struts[vertex, 2])
        vertices[row, 1] = low + pitch * (struts[vertex, 1] + time * struts[vertex, 3])
        row += 1
    for corner in range(len(corners)):
        vertices[row, 0], vertices[row, 1] = corners[corner, 0], corners[corner, 1]
        row += 1
    for crossing in range(count):
        p = crossings[crossing, SEGMENT]
        q = after[p]
        for k in range(2):
            vertices[row, k] = corners[p, k] + at[crossing] * (corners[q, k] - corners[p, k])
        row += 1
    return row
