"""Births at contours, where the sites whose cells are inside have drawn back from them.

A newborn between three sites never stands outside the hull of the living, which so shrinks from
generation to generation. Therefore cells are also born where the wall of two of them leaves the
section: q is the middle of the two sites, moved along the wall out to the base rectangle.

As its weight grows the cell of q begins at the orthocentre of the triangle that q stands in. Where
that is outside the base rectangle the cell has to come nearer before anything is seen of it. q's
power function less that of any other site is linear in x, y and z, so that less the least of all
others it is convex; its minimum in the layer's plane lies at that orthocentre; so over the
rectangle it is least at a corner, or where a wall meets a side. With the weight that makes that 0,
q's cell touches the rectangle from outside.

Below the layer the difference must not be negative in the rectangle either, so that q's cell has
never been there and all that is stays one power diagram in space. Since it is convex, its slope at
the touching point decides: q has to grow no slower than the site there, or, on a side, than the two
on average, each weighted by how near it is to q along the side. Like all newborns it grows a little
more.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.clipping.ring_walk import (
    EDGE,
    INTO,
    SEGMENT,
    Crossings,
    LayerRings,
    power,
    walk_rings,
)
from v3dcad.geometry.compiled.arrays import (
    FloatArray,
    FloatRows,
    Int32Rows,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INLINED, INTERNAL, compiled
from v3dcad.geometry.power_diagram.triangle_mesh import ABSENT, Triangulation
from v3dcad.model import Floats

MARGIN = 64
"""Steps² that a newborn is too light by, so that rounding leaves its cell outside."""

ROWS_BESIDE = 61
"""In so many rows of grid points beside a side newborns stand: in one they would be collinear, and
none could come between two others."""


class Rim(NamedTuple):
    """The base rectangle as a ring, with room for what is found along it."""

    corners: FloatRows
    """(4, 2) float64 grid steps, counter-clockwise from (0, 0)"""
    starts: IntArray
    """(2,) int64: where the ring begins and ends"""
    after: IntArray
    """(4,) int64: which corner follows each"""
    begun_in: IntArray
    """(1,) int32: the cell that the walk around it begins in"""
    crossings: Int32Rows
    """(c, 4) int32 and"""
    at: FloatArray
    """(c,) float64: what it meets"""
    sizes: IntArray
    """(k,) int64: how large the holes at a section's crossings are"""
    born: IntArray
    """(p,) int64: at which times newborns came from outside, and"""
    counts: IntArray
    """(1,) int64: how many they are"""


def rim_of(extent: Floats, crossings: int, points: int) -> Rim:
    """The rim of a rectangle of an extent (2,) in grid steps, for a section's crossings and so many
    points.
    """
    most = 12 * points  # no side crosses any of a diagram's edges twice
    return Rim(
        corners=np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]) * np.ceil(extent),
        starts=np.array([0, 4]),
        after=np.array([1, 2, 3, 0]),
        begun_in=np.empty(1, np.int64),
        crossings=np.empty((most, 4), np.int32),
        at=np.empty(most),
        sizes=np.empty(crossings, np.int64),
        born=np.empty(points, np.int64),
        counts=np.zeros(1, np.int64),
    )


@compiled(INLINED)
def cells_at(mesh: Triangulation, crossings: Int32Rows, crossing: int) -> tuple[int, int]:
    """The cells that a ring leaves and enters at a crossing."""
    triangles, into = mesh.triangles, crossings[crossing, INTO]
    triangle, i = crossings[crossing, EDGE] // 3, crossings[crossing, EDGE] % 3
    one, other = triangles[triangle, (i + 1) % 3], triangles[triangle, (i + 2) % 3]
    return (other, into) if one == into else (one, into)


@compiled(INLINED)
def moved_out(points: IntRows, corners: FloatRows, i: int, j: int) -> tuple[int, int]:
    """Where the middle of two points gets to a side of the rectangle, at right angles to the way
    from the first to the second and to its right: that is where a ring around what is inside has
    its outside when it passes from cell to cell.
    """
    dx, dy = points[j, 1] - points[i, 1], points[i, 0] - points[j, 0]
    x, y = (points[i, 0] + points[j, 0]) / 2, (points[i, 1] + points[j, 1]) / 2
    inset = 1 + (i + j) % ROWS_BESIDE
    east, north = corners[2, 0] - inset, corners[2, 1] - inset
    share = np.inf
    if dx != 0:
        share = max(((east if dx > 0 else inset) - x) / dx, 0.0)
    if dy != 0:
        share = min(share, max(((north if dy > 0 else inset) - y) / dy, 0.0))
    return int(np.rint(x + share * dx)), int(np.rint(y + share * dy))


@linked(INTERNAL)
def size_rim(mesh: Triangulation, rim: Rim, crossings: Int32Rows, count: int) -> None:
    """Fill in how large the holes at a section's crossings are: four times the area of the triangle
    of two sites and where their newborn would be, steps². That compares with other holes as if the
    sites had mirror images outside.
    """
    points = mesh.points
    for crossing in range(count):
        i, j = cells_at(mesh, crossings, crossing)
        x, y = moved_out(points, rim.corners, i, j)
        dx, dy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
        rim.sizes[crossing] = 2 * abs(dx * (y - points[i, 1]) - dy * (x - points[i, 0]))


@compiled(INLINED)
def largest_of(mesh: Triangulation, rim: Rim, crossings: Int32Rows, count: int) -> int:
    """The crossing with the largest hole, or `ABSENT` where all are 0; of equal ones that between
    the cells that come first.
    """
    largest, size, first, second = ABSENT, 0, 0, 0
    for crossing in range(count):
        if rim.sizes[crossing] > 0 and rim.sizes[crossing] >= size:
            i, j = cells_at(mesh, crossings, crossing)
            if rim.sizes[crossing] > size or i < first or (i == first and j < second):
                largest, size, first, second = crossing, rim.sizes[crossing], i, j
    return largest


@linked(INTERNAL)
def touching(
    mesh: Triangulation, growth: IntArray, rim: Rim, x: int, y: int
) -> tuple[float, float]:
    """The weight with which the cell of a point begins to touch the rectangle from outside, and the
    growth at which it goes on to do so; an infinite weight where it cannot be found.
    """
    points, crossings, corners = mesh.points, rim.crossings, rim.corners
    rings = LayerRings(corners, rim.after, rim.starts)
    count = walk_rings(mesh, rings, Crossings(crossings, rim.at, mesh.stack, rim.begun_in))
    if count < 0:
        return np.inf, 0.0
    cell, crossing, weight, pace = rim.begun_in[0], 0, np.inf, 0.0
    for side in range(4):
        ax, ay = corners[side, 0], corners[side, 1]
        bx, by = corners[rim.after[side], 0], corners[rim.after[side], 1]
        least = (ax - x) ** 2 + (ay - y) ** 2 - power(points, cell, ax, ay)
        if least < weight:
            weight, pace = least, float(growth[cell])
        while crossing < count and crossings[crossing, SEGMENT] == side:
            into, share = crossings[crossing, INTO], rim.at[crossing]
            cx, cy = ax + share * (bx - ax), ay + share * (by - ay)
            least = (cx - x) ** 2 + (cy - y) ** 2 - power(points, into, cx, cy)
            if least < weight:
                axis = 0 if ay == by else 1
                start, way = points[cell, axis], points[into, axis] - points[cell, axis]
                near = ((x if axis == 0 else y) - start) / way if way != 0 else 1.0
                near = min(max(near, 0.0), 1.0)
                weight, pace = least, growth[cell] + near * (growth[into] - growth[cell])
            cell, crossing = into, crossing + 1
    return weight, pace
