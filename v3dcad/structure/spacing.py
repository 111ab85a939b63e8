"""The distance that newborns keep, so that no wall leans too much."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import Int32Array, IntArray, IntRows
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INLINED, INTERNAL, compiled
from v3dcad.geometry.power_diagram.grid import STEPS
from v3dcad.geometry.power_diagram.triangle_mesh import (
    ABSENT,
    SENTINELS,
    Triangulation,
)


@compiled(INLINED)
def is_apart(
    points: IntRows, growth: IntArray, point: int, x: int, y: int, grows: int, reach: float
) -> bool:
    """Whether a site at (x, y) is at least `reach` from a point per unit of growth between them.

    Faster points count as slower ones do: the wall between the two leans as much.
    """
    apart = abs(grows - growth[point]) * reach
    dx, dy = points[point, 0] - x, points[point, 1] - y
    return dx * dx + dy * dy >= apart * apart


class Squares(NamedTuple):
    """Points by squares of a grid over the frame, to look for near ones."""

    first: Int32Array
    """(side²,) int32: the point listed last in each square, or −1"""
    following: Int32Array
    """(p,) int32: the point listed before each in its square, or −1"""
    state: IntArray
    """(2,) int64: how many points are listed, and the fastest one's growth"""


COUNT, FASTEST = range(2)


def no_squares(points: int) -> Squares:
    """An empty grid for up to so many points."""
    side = int(np.sqrt(points / 4)) + 1
    return Squares(
        np.full(side * side, -1, np.int32), np.empty(points, np.int32), np.array([SENTINELS, 0])
    )


@linked(INTERNAL)
def list_points(mesh: Triangulation, growth: IntArray, squares: Squares) -> None:
    """List the points that are not listed yet."""
    points, first, following = mesh.points, squares.first, squares.following
    side = int(np.sqrt(len(first)))
    for point in range(squares.state[COUNT], mesh.counts.points):
        row, column = points[point, 1] * side // STEPS, points[point, 0] * side // STEPS
        square = min(row, side - 1) * side + min(column, side - 1)
        following[point] = first[square]
        first[square] = point
        squares.state[FASTEST] = max(squares.state[FASTEST], growth[point])
    squares.state[COUNT] = mesh.counts.points


@linked(INTERNAL)
def too_near(
    mesh: Triangulation,
    growth: IntArray,
    squares: Squares,
    before: int,
    x: int,
    y: int,
    grows: int,
    reach: float,
) -> int:
    """A point that a site at (x, y) would be too near to, or `ABSENT`: it must be apart from every
    listed point that is not hidden, in another place than those that are, and apart from all
    points from `before` on.
    """
    points, live, first = mesh.points, mesh.triangle_of, squares.first
    side, farthest = int(np.sqrt(len(first))), (squares.state[FASTEST] + 1) * reach
    west, east = int((x - farthest) * side / STEPS), int((x + farthest) * side / STEPS)
    south, north = int((y - farthest) * side / STEPS), int((y + farthest) * side / STEPS)
    # The last squares hold what lies on the frame's sides, too.
    south, west = max(min(south, side - 1), 0), max(min(west, side - 1), 0)
    for row in range(south, min(north, side - 1) + 1):
        for column in range(west, min(east, side - 1) + 1):
            point = first[row * side + column]
            while point >= 0:
                if points[point, 0] == x and points[point, 1] == y:
                    return point
                if live[point] != ABSENT and not is_apart(
                    points, growth, point, x, y, grows, reach
                ):
                    return point
                point = squares.following[point]
    for point in range(before, mesh.counts.points):
        if not is_apart(points, growth, point, x, y, grows, reach):
            return point
    return ABSENT
