"""A section's rings walked through a power diagram: which edges they cross, and where.

Rings are walked through the diagram instead of clipping cells: along a segment the power
functions of the sites are linear (but for a common square), so that the cells it passes are the
lower envelope of lines. A closed walk enters every cell as often as it leaves it; hence the
winding number of each diagram vertex, summed along the diagram's edges, is the same by every path,
whatever the rounding. Rings come a hair to their left, so that what they only touch lies outside:
vertices and edges exactly on a contour, and the cells behind them.

Names: a *cell* is a point of the triangulation; a *crossing* is where a ring goes from cell to
cell, over the diagram's edge that is dual to one of the triangulation.
"""

from __future__ import annotations

from typing import NamedTuple

from v3dcad.geometry.compiled.arrays import (
    FloatArray,
    FloatRows,
    Int32Array,
    Int32Rows,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INLINED, INTERNAL, compiled
from v3dcad.geometry.power_diagram.predicates import NUMBER, WEIGHT
from v3dcad.geometry.power_diagram.triangle_mesh import (
    ABSENT,
    ACROSS,
    SENTINELS,
    Triangulation,
    corner_at,
    edge_to,
)

EDGE, WINDING, SEGMENT, INTO = range(4)
"""Columns of a crossing: 3 · triangle + edge; what the winding number gains along the diagram's
edge from this triangle to the one across; the segment that crosses; the cell that it enters."""


class LayerRings(NamedTuple):
    """The rings of one section, to be walked."""

    corners: FloatRows
    """(r, 2) grid steps, ring after ring"""
    after: IntArray
    """(r,) the corner that follows each on its ring"""
    starts: IntArray
    """(rings + 1,) where each ring begins, counted from `starts[0]`"""


class Crossings(NamedTuple):
    """Where rings cross the diagram's edges, in the order of the walk, with room for more."""

    rows: Int32Rows
    """(c, 4) columns `EDGE`, `WINDING`, `SEGMENT`, `INTO`"""
    at: FloatArray
    """(c,) how far along the segment, 0 … 1"""
    next_on: Int32Array
    """(c,) the next crossing on the same edge, or −1"""
    begun_in: IntArray
    """(rings,) the cell that each ring begins in"""


FULL, OPEN = -1, -2
"""What a walk returns instead of a number of crossings: where there is no room for one more, and
where a ring does not close."""

LAPS = 4
"""How often a ring is walked at the most: a walk whose first point lies on an edge may end in the
cell beside the one it began in, and is then repeated from there."""


@compiled(INLINED)
def power(points: IntRows, cell: int, x: float, y: float) -> float:
    """The power distance of (x, y) to a cell's site, steps²."""
    dx, dy = points[cell, 0] - x, points[cell, 1] - y
    return dx * dx + dy * dy - points[cell, WEIGHT]


@compiled(INLINED)
def power_gap(points: IntRows, cell: int, other: int, x: float, y: float) -> float:
    """How much farther (x, y) is from `other` than from `cell`, without the common square."""
    dx, dy = points[other, 0] - points[cell, 0], points[other, 1] - points[cell, 1]
    along_x, along_y = points[other, 0] + points[cell, 0], points[other, 1] + points[cell, 1]
    lighter = points[cell, WEIGHT] - points[other, WEIGHT]
    return dx * (along_x - 2 * x) + dy * (along_y - 2 * y) + lighter


@linked(INTERNAL)
def cell_at(mesh: Triangulation, cell: int, x: float, y: float) -> int:
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
                number = points[other, NUMBER]
                if distance < least or (distance == least and number < points[nearest, NUMBER]):
                    nearest, least = other, distance
            triangle = triangles[triangle, ACROSS + (k + 1) % 3]
            if triangle == first:
                break
        if nearest == cell:
            return cell
        cell, own = nearest, least


@linked(INTERNAL)
def walk_segment(
    mesh: Triangulation,
    crossings: Int32Rows,
    at: FloatArray,
    count: int,
    cell: int,
    ax: float,
    ay: float,
    bx: float,
    by: float,
    segment: int,
) -> int:
    """Append the crossings of the segment a → b, which begins in `cell`, to the first `count`;
    returns how many there are then, or `FULL`.
    """
    points, triangles, triangle_of = mesh.points, mesh.triangles, mesh.triangle_of
    reached = 0.0
    while True:
        own, number = power(points, cell, bx, by), points[cell, NUMBER]
        ahead, crossed, winding, soonest, least = ABSENT, 0, 0, 2.0, 0.0
        first = triangle_of[cell]
        triangle = first
        while True:
            k = corner_at(triangles, triangle, cell)
            other = triangles[triangle, (k + 1) % 3]
            if other >= SENTINELS:
                distance = power(points, other, bx, by)
                if distance < own or (distance == own and points[other, NUMBER] < number):
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
        if ahead == ABSENT:
            return count
        reached = min(max(reached, soonest), 1.0)
        if count == len(at):
            return FULL
        crossings[count, EDGE], crossings[count, WINDING] = crossed, winding
        crossings[count, SEGMENT], crossings[count, INTO] = segment, ahead
        at[count] = reached
        count += 1
        cell = ahead


@linked(INTERNAL)
def walk_rings(mesh: Triangulation, rings: LayerRings, crossings: Crossings) -> int:
    """Walk a layer's rings and write what they cross, but for `next_on`.

    Returns the number of crossings, or else `FULL` or `OPEN`.
    """
    corners, after, starts, begun_in = rings.corners, rings.after, rings.starts, crossings.begun_in
    cell, count = SENTINELS, 0
    while mesh.triangle_of[cell] == ABSENT:
        cell += 1
    for ring in range(len(starts) - 1):
        start, stop = starts[ring] - starts[0], starts[ring + 1] - starts[0]
        if start == stop:
            continue
        cell = cell_at(mesh, cell, corners[start, 0], corners[start, 1])
        since, lap = count, 0
        while True:
            begun_in[ring] = cell
            for segment in range(start, stop):
                end = after[segment]
                count = walk_segment(
                    mesh,
                    crossings.rows,
                    crossings.at,
                    count,
                    cell,
                    corners[segment, 0],
                    corners[segment, 1],
                    corners[end, 0],
                    corners[end, 1],
                    segment,
                )
                if count == FULL:
                    return FULL
                if count > since:
                    cell = crossings.rows[count - 1, INTO]
            if cell == begun_in[ring]:
                break
            lap, count = lap + 1, since
            if lap == LAPS:
                return OPEN
    return count
