"""A power diagram cut by a section's rings, as a planar graph.

Rings are walked through the diagram instead of clipping cells: along a segment the power
functions of the sites are linear (but for a common square), so that the cells it passes are the
lower envelope of lines. A closed walk enters every cell as often as it leaves it; hence the
winding number of each diagram vertex, summed along the diagram's edges, is the same by every path,
whatever the rounding. Where a ring runs exactly through a vertex or along an edge, the walk passes
on one side of it, and the graph is that of a section moved by less than the rounding.

Names: a *cell* is a point of the triangulation; a *crossing* is where a ring goes from cell to
cell, over the diagram's edge that is dual to one of the triangulation.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.core.types import NamedTuple as TupleType

from v3dcad.geometry.exact import INLINED, INTERNAL, POINT_ROWS, WORD
from v3dcad.geometry.kinetics import MOTION, strut
from v3dcad.geometry.triangulation import (
    ACROSS,
    MESH,
    NOTHING,
    SENTINELS,
    TRIANGLES,
    corner_at,
    edge_to,
)

EDGE, WINDING, SEGMENT, INTO = range(4)
"""Columns of a crossing: 3 · triangle + edge; what the winding number gains along the diagram's
edge from this triangle to the one across; the segment that crosses; the cell that it enters."""

LAPS = 4
"""A walk whose first point lies on an edge may end in the cell beside the one it began in; it then
goes round once more from there."""

FLOAT = types.float64
FLOATS, FLOAT_ROWS, SIDES = types.float64[::1], types.float64[:, ::1], types.int8[::1]
INTS, INT_ROWS = types.int64[::1], types.int64[:, ::1]
ROW, ROWS = types.int32[::1], types.int32[:, ::1]
WALKED = types.Tuple((WORD, ROWS, FLOATS))


class Graph(NamedTuple):
    """Where cut graphs are written: behind each other, with room for the next."""

    edges: Any
    """(e, 2) int64 vertices"""
    sites: Any
    """(e, 2) int64: to the right and to the left of each edge"""
    neighbours: Any
    """(m, 2) int64 sites"""
    end: Any
    """(2,) int64: how many rows of edges and of neighbours are in use"""
    keys: Any
    """(k,) int32: 3 · triangle + edge of each of the last graph's neighbours"""
    struts: Any
    """(t, 4) float64: how the last graph's inner vertices move"""


OUT = TupleType([INT_ROWS, INT_ROWS, INT_ROWS, INTS, ROW, FLOAT_ROWS], Graph)


@njit(FLOAT(POINT_ROWS, WORD, FLOAT, FLOAT), **INLINED)
def power(points, cell, x, y):  # type: ignore[no-untyped-def]
    """The power distance of (x, y) to a cell's site, steps²."""
    dx, dy = points[cell, 0] - x, points[cell, 1] - y
    return dx * dx + dy * dy - points[cell, 2]


@njit(FLOAT(POINT_ROWS, WORD, WORD, FLOAT, FLOAT), **INLINED)
def power_gap(points, cell, other, x, y):  # type: ignore[no-untyped-def]
    """How much farther (x, y) is from `other` than from `cell`, without the common square."""
    dx, dy = points[other, 0] - points[cell, 0], points[other, 1] - points[cell, 1]
    along_x, along_y = points[other, 0] + points[cell, 0], points[other, 1] + points[cell, 1]
    lighter = points[cell, 2] - points[other, 2]
    return dx * (along_x - 2 * x) + dy * (along_y - 2 * y) + lighter


@njit(WORD(MESH, WORD, FLOAT, FLOAT), **INTERNAL)
def cell_at(mesh, cell, x, y):  # type: ignore[no-untyped-def]
    """The cell that holds (x, y), searched from neighbour to nearer neighbour.

    Of a cell that does not hold it, some neighbour is nearer, so that the search cannot stop short.
    """
    points, triangles = mesh.points, mesh.triangles
    own = power(points, cell, x, y)
    while True:
        nearest, least = cell, own
        first = mesh.triangle_of[cell]
        triangle = first
        while True:
            k = corner_at(triangles, triangle, cell)
            other = triangles[triangle, (k + 1) % 3]
            if other >= SENTINELS:
                distance = power(points, other, x, y)
                if distance < least or (distance == least and other < nearest):
                    nearest, least = other, distance
            triangle = triangles[triangle, ACROSS + (k + 1) % 3]
            if triangle == first:
                break
        if nearest == cell:
            return cell
        cell, own = nearest, least


@njit(
    WALKED(MESH, ROWS, FLOATS, WORD, WORD, *[FLOAT] * 4, WORD),
    **INTERNAL,
)
def walk_segment(  # type: ignore[no-untyped-def]
    mesh, crossings, at, count, cell, ax, ay, bx, by, segment
):
    """Append the crossings of the segment a → b, which begins in `cell`."""
    points, triangles, triangle_of = mesh.points, mesh.triangles, mesh.triangle_of
    reached = 0.0
    while True:
        own = power(points, cell, bx, by)
        ahead, crossed, winding, soonest, least = NOTHING, 0, 0, 2.0, 0.0
        first = triangle_of[cell]
        triangle = first
        while True:
            k = corner_at(triangles, triangle, cell)
            other = triangles[triangle, (k + 1) % 3]
            if other >= SENTINELS:
                distance = power(points, other, bx, by)
                if distance < own or (distance == own and other < cell):
                    before = power_gap(points, cell, other, ax, ay)
                    after = power_gap(points, cell, other, bx, by)
                    moment = 1.0
                    if after < 0.0:
                        moment = max(before, 0.0) / (max(before, 0.0) - after)
                    if moment < soonest or (moment == soonest and after < least):
                        ahead, soonest, least = other, moment, after
                        edge = (k + 2) % 3
                        over = triangles[triangle, ACROSS + edge]
                        if triangle < over:
                            crossed, winding = 3 * triangle + edge, -1
                        else:
                            crossed, winding = 3 * over + edge_to(triangles, over, triangle), 1
            triangle = triangles[triangle, ACROSS + (k + 1) % 3]
            if triangle == first:
                break
        if ahead == NOTHING:
            return count, crossings, at
        reached = min(max(reached, soonest), 1.0)
        if count == len(at):
            shorter, at_shorter = crossings, at
            crossings, at = np.empty((2 * count, 4), np.int32), np.empty(2 * count)
            for row in range(count):
                at[row] = at_shorter[row]
                for column in range(4):
                    crossings[row, column] = shorter[row, column]
        crossings[count, EDGE], crossings[count, WINDING] = crossed, winding
        crossings[count, SEGMENT], crossings[count, INTO] = segment, ahead
        at[count] = reached
        count += 1
        cell = ahead


@njit(
    WALKED(MESH, FLOAT_ROWS, INTS, INTS, ROW, ROWS, FLOATS),
    **INTERNAL,
)
def walk_rings(mesh, corners, starts, after, begun_in, crossings, at):  # type: ignore[no-untyped-def]
    """Walk the rings (corners (r, 2) in grid steps, ring k from starts[k] to starts[k + 1]),
    `after` each corner the next.

    Fills `begun_in` (rings,) with the cell that each begins in; returns the number of crossings,
    or −1 where a ring does not close, and the arrays of them, which may have been replaced.
    """
    cell, count = SENTINELS, 0
    while mesh.triangle_of[cell] == NOTHING:
        cell += 1
    for ring in range(len(starts) - 1):
        start, stop = starts[ring], starts[ring + 1]
        if start == stop:
            continue
        cell = cell_at(mesh, cell, corners[start, 0], corners[start, 1])
        since, lap = count, 0
        while True:
            begun_in[ring] = cell
            for segment in range(start, stop):
                end = after[segment]
                count, crossings, at = walk_segment(
                    mesh,
                    crossings,
                    at,
                    count,
                    cell,
                    corners[segment, 0],
                    corners[segment, 1],
                    corners[end, 0],
                    corners[end, 1],
                    segment,
                )
                if count > since:
                    cell = crossings[count - 1, INTO]
            if cell == begun_in[ring]:
                break
            lap, count = lap + 1, since
            if lap == LAPS:
                return -1, crossings, at
    return count, crossings, at


@njit(types.boolean(MESH, ROWS, WORD, ROW, ROW, SIDES), **INTERNAL)
def wind(mesh, crossings, count, first_on, next_on, inside):  # type: ignore[no-untyped-def]
    """Find which triangles' vertices lie inside the section: `inside` (t,) 0 or 1.

    Chains the crossings on each edge: `first_on` (3 t,), which must be −1, and `next_on`. Returns
    False where a winding number is neither 0 nor 1: rings overlap or run the wrong way round.
    """
    triangles, stack = mesh.triangles, mesh.stack
    for crossing in range(count):
        edge = crossings[crossing, EDGE]
        next_on[crossing] = first_on[edge]
        first_on[edge] = crossing
    unknown = -2
    for triangle in range(mesh.count[TRIANGLES]):
        inside[triangle] = unknown
    stack[0] = mesh.triangle_of[0]  # at a sentinel, far outside
    inside[stack[0]] = 0
    waiting, sound = 1, True
    while waiting > 0:
        waiting -= 1
        triangle = stack[waiting]
        winding = inside[triangle]
        sound = sound and 0 <= winding <= 1
        for i in range(3):
            other = triangles[triangle, ACROSS + i]
            if other == NOTHING or inside[other] != unknown:
                continue
            if triangle < other:
                crossing, sense = first_on[3 * triangle + i], 1
            else:
                crossing, sense = first_on[3 * other + edge_to(triangles, other, triangle)], -1
            reached = winding
            while crossing >= 0:
                reached += sense * crossings[crossing, WINDING]
                crossing = next_on[crossing]
            inside[other] = reached if -2 < reached < 3 else -1
            stack[waiting] = other
            waiting += 1
    return sound


@njit(types.void(ROWS, WORD, ROW), **INTERNAL)
def unchain(crossings, count, first_on):  # type: ignore[no-untyped-def]
    """Make `first_on` −1 again."""
    for crossing in range(count):
        first_on[crossings[crossing, EDGE]] = -1


@njit(WORD(MESH, ROW, ROWS, WORD, SIDES, ROW, WORD), **INTERNAL)
def count_cells(mesh, begun_in, crossings, count, inside, seen, token):  # type: ignore[no-untyped-def]
    """How many cells have a part inside. Marks them in `seen` (p,) with a token not used before."""
    cells, triangles = 0, mesh.triangles
    for ring in range(len(begun_in)):
        if seen[begun_in[ring]] != token:
            seen[begun_in[ring]] = token
            cells += 1
    for crossing in range(count):
        cell = crossings[crossing, INTO]
        if seen[cell] != token:
            seen[cell] = token
            cells += 1
    for triangle in range(mesh.count[TRIANGLES]):
        if inside[triangle] == 1 and triangles[triangle, 0] != NOTHING:
            for i in range(3):
                cell = triangles[triangle, i]
                if seen[cell] != token:
                    seen[cell] = token
                    cells += 1
    return cells


@njit(types.void(INTS, INTS), **INTERNAL)
def link_corners(starts, after):  # type: ignore[no-untyped-def]
    """Fill `after` (r,): which corner follows each on its ring."""
    for ring in range(len(starts) - 1):
        for corner in range(starts[ring], starts[ring + 1]):
            after[corner] = corner + 1 if corner + 1 < starts[ring + 1] else starts[ring]


@njit(
    types.UniTuple(WORD, 3)(
        MESH, MOTION, INTS, FLOAT_ROWS, INTS, INTS, ROW, ROWS, FLOATS, WORD, ROW, ROW, SIDES, OUT
    ),
    **INTERNAL,
)
def cut_graph(  # type: ignore[no-untyped-def]
    mesh,
    motion,
    site_of,
    corners,
    starts,
    after,
    begun_in,
    crossings,
    at,
    count,
    first_on,
    next_on,
    inside,
    out,
):
    """The diagram's part inside the rings, after `walk_rings` and `wind`.

    Vertices are numbered: inner ones, then the rings' corners, then the crossings. Writes into
    `out`, by the site numbers `site_of` (p,), and returns how many inner vertices there are and
    where edges and neighbours end.
    """
    points, triangles, edges, sites = mesh.points, mesh.triangles, out.edges, out.sites
    neighbours, keys, struts = out.neighbours, out.keys, out.struts
    total = mesh.count[TRIANGLES]
    vertex_of = np.empty(total, np.int32)
    inner = 0
    for triangle in range(total):
        if inside[triangle] == 1 and triangles[triangle, 0] != NOTHING:
            vertex_of[triangle] = inner
            a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
            x, y, vx, vy = strut(points, motion.base, motion.growth, a, b, c)
            struts[inner, 0], struts[inner, 1], struts[inner, 2], struts[inner, 3] = x, y, vx, vy
            inner += 1
    length, first_pair, crossing_base = out.end[0], out.end[1], inner + len(corners)
    pairs = first_pair
    for triangle in range(total):
        if triangles[triangle, 0] == NOTHING:
            continue
        for i in range(3):
            other = triangles[triangle, ACROSS + i]
            if other < triangle:  # hull edges too
                continue
            crossing = first_on[3 * triangle + i]
            winding = inside[triangle]
            if crossing < 0 and winding == 0:
                continue
            right, left = triangles[triangle, (i + 1) % 3], triangles[triangle, (i + 2) % 3]
            low, high, backwards = site_of[right], site_of[left], 0
            if low > high:
                low, high, backwards = high, low, 1
            since, begin = length, vertex_of[triangle]
            if crossing >= 0:
                # The crossings in their order from this triangle to the other: they alternate.
                way_x = float(points[left, 1] - points[right, 1])
                way_y = float(points[right, 0] - points[left, 0])
                while True:
                    best, soonest = -1, np.inf
                    while crossing >= 0:
                        if crossings[crossing, WINDING] == (-1 if winding == 1 else 1):
                            p = crossings[crossing, SEGMENT]
                            q = after[p]
                            x = corners[p, 0] + at[crossing] * (corners[q, 0] - corners[p, 0])
                            y = corners[p, 1] + at[crossing] * (corners[q, 1] - corners[p, 1])
                            if x * way_x + y * way_y < soonest:
                                best, soonest = crossing, x * way_x + y * way_y
                        crossing = next_on[crossing]
                    if best < 0:
                        break
                    crossings[best, WINDING] = 0  # taken
                    if winding == 1:
                        edges[length, backwards] = begin
                        edges[length, 1 - backwards] = crossing_base + best
                        sites[length, 0], sites[length, 1] = low, high
                        length += 1
                    begin, winding = crossing_base + best, 1 - winding
                    crossing = first_on[3 * triangle + i]
            if winding == 1:
                edges[length, backwards], edges[length, 1 - backwards] = begin, vertex_of[other]
                sites[length, 0], sites[length, 1] = low, high
                length += 1
            if length > since:
                neighbours[pairs, 0], neighbours[pairs, 1] = low, high
                keys[pairs - first_pair] = 3 * triangle + i
                pairs += 1
    crossing = 0
    for ring in range(len(starts) - 1):
        cell = begun_in[ring]
        for segment in range(starts[ring], starts[ring + 1]):
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
    return inner, length, pairs


@njit(
    WORD(
        FLOAT_ROWS,
        WORD,
        FLOAT,
        FLOAT_ROWS,
        INTS,
        ROWS,
        FLOATS,
        WORD,
        *[FLOAT] * 3,
        FLOAT_ROWS,
        WORD,
    ),
    **INTERNAL,
)
def place_vertices(  # type: ignore[no-untyped-def]
    struts, inner, time, corners, after, crossings, at, count, left, low, pitch, vertices, row
):
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
