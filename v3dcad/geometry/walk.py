"""A section's rings walked through a power diagram: which edges they cross, and where.

Rings are walked through the diagram instead of clipping cells: along a segment the power
functions of the sites are linear (but for a common square), so that the cells it passes are the
lower envelope of lines. A closed walk enters every cell as often as it leaves it; hence the
winding number of each diagram vertex, summed along the diagram's edges, is the same by every path,
whatever the rounding. Rings are walked a `HAIR` to their left, so that what they only touch lies
outside: vertices and edges exactly on a contour, and the cells behind them.

Names: a *cell* is a point of the triangulation; a *crossing* is where a ring goes from cell to
cell, over the diagram's edge that is dual to one of the triangulation.
"""

from __future__ import annotations

import numpy as np
from numba import njit, types

from v3dcad.geometry.exact import INLINED, INTERNAL, POINT_ROWS, WORD
from v3dcad.geometry.flips import ACROSS, MESH, NOTHING, SENTINELS, corner_at, edge_to
from v3dcad.geometry.linking import linked

EDGE, WINDING, SEGMENT, INTO = range(4)
"""Columns of a crossing: 3 · triangle + edge; what the winding number gains along the diagram's
edge from this triangle to the one across; the segment that crosses; the cell that it enters."""

HAIR = 2.0**-20
"""Grid steps: far above the rounding of a walk, 1e-8 steps, and too little to be seen elsewhere."""

LAPS = 4
"""A walk whose first point lies on an edge may end in the cell beside the one it began in; it then
goes round once more from there."""

FLOAT = types.float64
FLOATS, FLOAT_ROWS = types.float64[::1], types.float64[:, ::1]
INTS, INT_ROWS = types.int64[::1], types.int64[:, ::1]
ROW, ROWS = types.int32[::1], types.int32[:, ::1]
WALKED = types.Tuple((WORD, ROWS, FLOATS))


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


@linked(WORD(MESH, WORD, FLOAT, FLOAT), **INTERNAL)
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


@linked(
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


@linked(
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


@linked(types.void(FLOAT_ROWS, INTS, *[FLOAT] * 3, INTS, FLOAT_ROWS), **INTERNAL)
def link_corners(corners, starts, left, low, pitch, after, stepped):  # type: ignore[no-untyped-def]
    """Fill `after` (r,), which corner follows each on its ring, and `stepped` (r, 2), where the
    rings' corners (r, 2), mm, lie in grid steps, moved a `HAIR` to the left of either side there.

    (`left`, `low`), mm, and `pitch` say where the grid lies.
    """
    for ring in range(len(starts) - 1):
        for corner in range(starts[ring], starts[ring + 1]):
            after[corner] = corner + 1 if corner + 1 < starts[ring + 1] else starts[ring]
            stepped[corner, 0] = (corners[corner, 0] - left) / pitch
            stepped[corner, 1] = (corners[corner, 1] - low) / pitch
    for corner in range(len(corners)):
        end = after[corner]
        x, y = corners[end, 0] - corners[corner, 0], corners[end, 1] - corners[corner, 1]
        length = np.sqrt(x * x + y * y)
        if length > 0.0:
            x, y = HAIR * x / length, HAIR * y / length
            stepped[corner, 0], stepped[corner, 1] = stepped[corner, 0] - y, stepped[corner, 1] + x
            stepped[end, 0], stepped[end, 1] = stepped[end, 0] - y, stepped[end, 1] + x
