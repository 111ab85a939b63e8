"""Continuous births: new cells that start empty and grow, where cells have become too large.

A site q inside the triangle of three sites whose orthocentre v has the power P is empty exactly
while its weight is at most |q − v|² − P. So a newborn gets the least weight above that, and its
cell begins at v with no area and grows with the square of the weight gained since.

At the centroid that bound is where the newborn's power function is the mean of the three, and it
grows with the mean of their growths. A newborn grows a little more: `LEAD`. So it has never had a
cell before, it takes from slower parents and gives to faster ones, and all growths stay near each
other. One as fast as the fastest parent, or by the whole offset faster where all three are equal,
would run over its surroundings until it met its like: cells of up to 35 times their mean were seen.

A newborn stands inside the triangle of its parents. Hence the hull of the living sites shrinks from
generation to generation, and on a tall pole births come to an end where the distance that newborns
keep leaves no room in it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.core.types import NamedTuple as TupleType

from v3dcad.geometry.agenda import LAST, MOST, MOTION, NOW
from v3dcad.geometry.exact import INLINED, INTERNAL, POINT_ROWS, WORD, conflicts
from v3dcad.geometry.flips import MESH, NOTHING, POINTS, ROW, SENTINELS, TRIANGLE_ROWS
from v3dcad.geometry.grid import HEAVIEST, STEPS
from v3dcad.geometry.inside import CUT
from v3dcad.geometry.kinetics import add_point
from v3dcad.geometry.linking import linked
from v3dcad.geometry.triangulation import locate
from v3dcad.structure.holes import (
    BARREN,
    LISTED,
    SHARE,
    SHORTLIST,
    list_holes,
    look_again,
    size_of,
)

LEAD = 3
"""Units of growth by which a newborn is ahead of its parents' mean: an eighth of `growth.PACE`.
With more, cells are less even and the hull shrinks sooner; with less, they hardly change on the way
up."""

FLOAT = types.float64


@linked(FLOAT(POINT_ROWS, *[WORD] * 4), **INTERNAL)
def empty_until(points, q, a, b, c):  # type: ignore[no-untyped-def]
    """The largest weight (steps², but for rounding) at which q has no cell beside a, b, c."""
    x, y, weight = points[a, 0], points[a, 1], points[a, 2]
    bx, by, cx, cy = points[b, 0] - x, points[b, 1] - y, points[c, 0] - x, points[c, 1] - y
    of_b = float(bx * bx + by * by - points[b, 2] + weight)
    of_c = float(cx * cx + cy * cy - points[c, 2] + weight)
    double = 2.0 * (bx * cy - by * cx)
    vx, vy = (cy * of_b - by * of_c) / double, (bx * of_c - cx * of_b) / double
    qx, qy = float(points[q, 0] - x), float(points[q, 1] - y)
    return qx * (qx - 2 * vx) + qy * (qy - 2 * vy) + weight


@njit(types.boolean(POINT_ROWS, types.int64[::1], *[WORD] * 4, FLOAT), **INLINED)
def is_apart(points, growth, point, x, y, grows, reach):  # type: ignore[no-untyped-def]
    """Whether a site at (x, y) is at least `reach` from a point per step of growth between them.

    Faster points count as slower ones do: the wall between the two leans as much.
    """
    apart = abs(grows - growth[point]) * reach
    dx, dy = points[point, 0] - x, points[point, 1] - y
    return dx * dx + dy * dy >= apart * apart


class Squares(NamedTuple):
    """Points by squares of a grid over the frame, to look for near ones."""

    first: Any
    """(side²,) int32: the point listed last in each square, or −1"""
    following: Any
    """(p,) int32: the point listed before each in its square, or −1"""
    state: Any
    """(2,) int64: how many points are listed, and the fastest one's growth"""


SQUARES = TupleType([ROW, ROW, types.int64[::1]], Squares)
COUNT, FASTEST = range(2)


def no_squares(points: int) -> Squares:
    """An empty grid for up to so many points."""
    side = int(np.sqrt(points / 4)) + 1
    return Squares(
        np.full(side * side, -1, np.int32), np.empty(points, np.int32), np.array([SENTINELS, 0])
    )


@linked(types.void(MESH, types.int64[::1], SQUARES), **INTERNAL)
def _list_points(mesh, growth, squares):  # type: ignore[no-untyped-def]
    """List the points that are not listed yet."""
    points, first, following = mesh.points, squares.first, squares.following
    side = int(np.sqrt(len(first)))
    for point in range(squares.state[COUNT], mesh.count[POINTS]):
        row, column = points[point, 1] * side // STEPS, points[point, 0] * side // STEPS
        square = min(row, side - 1) * side + min(column, side - 1)
        following[point] = first[square]
        first[square] = point
        squares.state[FASTEST] = max(squares.state[FASTEST], growth[point])
    squares.state[COUNT] = mesh.count[POINTS]


@linked(
    WORD(MESH, types.int64[::1], SQUARES, WORD, *[WORD] * 3, FLOAT),
    **INTERNAL,
)
def too_near(mesh, growth, squares, before, x, y, grows, reach):  # type: ignore[no-untyped-def]
    """A point that a site at (x, y) would be too near to, or `NOTHING`: it must be apart from every
    listed point that is not hidden, in another place than those that are, and apart from all
    points from `before` on.
    """
    points, live, first = mesh.points, mesh.triangle_of, squares.first
    side, farthest = int(np.sqrt(len(first))), (squares.state[FASTEST] + 1) * reach
    west, east = int((x - farthest) * side / STEPS), int((x + farthest) * side / STEPS)
    south, north = int((y - farthest) * side / STEPS), int((y + farthest) * side / STEPS)
    for row in range(max(south, 0), min(north, side - 1) + 1):
        for column in range(max(west, 0), min(east, side - 1) + 1):
            point = first[row * side + column]
            while point >= 0:
                if points[point, 0] == x and points[point, 1] == y:
                    return point
                if live[point] != NOTHING and not is_apart(
                    points, growth, point, x, y, grows, reach
                ):
                    return point
                point = squares.following[point]
    for point in range(before, mesh.count[POINTS]):
        if not is_apart(points, growth, point, x, y, grows, reach):
            return point
    return NOTHING


@linked(types.boolean(MESH, WORD, WORD, WORD, WORD, WORD), **INTERNAL)
def weigh_newborn(mesh, q, a, b, c, guess):  # type: ignore[no-untyped-def]
    """Give point q the least weight at which its cell is not empty; False beyond the safe range.

    `guess` is that weight but for rounding.
    """
    points, step = mesh.points, 1
    low = high = guess
    points[q, 2] = guess
    if conflicts(points, a, b, c, q):
        while conflicts(points, a, b, c, q):
            low -= step
            step *= 2
            points[q, 2] = low
    else:
        while not conflicts(points, a, b, c, q):
            high += step
            step *= 2
            points[q, 2] = high
    while high - low > 1:
        points[q, 2] = (low + high) // 2
        if conflicts(points, a, b, c, q):
            high = points[q, 2]
        else:
            low = points[q, 2]
    points[q, 2] = high
    return abs(high) < HEAVIEST


@linked(types.void(types.int64[::1], types.int32[::1], WORD, WORD), **INTERNAL)
def _sink(holes, places, at, length):  # type: ignore[no-untyped-def]
    """Let an entry sink in a heap with the largest hole first."""
    while True:
        below = 2 * at + 1
        if below >= length:
            return
        if below + 1 < length and holes[below + 1] > holes[below]:
            below += 1
        if holes[below] <= holes[at]:
            return
        holes[at], holes[below] = holes[below], holes[at]
        places[at], places[below] = places[below], places[at]
        at = below


@linked(types.boolean(POINT_ROWS, TRIANGLE_ROWS, *[WORD] * 5), **INTERNAL)
def is_crowded(points, parents, first, q, a, b, c):  # type: ignore[no-untyped-def]
    """Whether q, newborn to a, b, c, has to wait because of newborns before it at this moment:
    those from point `first` on, with their parents (k, 3).

    Holes may lie in the same place (four sites orthogonal to one circle), where they would keep
    each other from having cells. A newborn has one where its parents' triangle would be regular
    beside all others. And two with two parents in common are equally far wherever the two other
    parents are, so that four cells would meet in a point at every height.
    """
    for sibling in range(len(parents)):
        d, e, f = parents[sibling, 0], parents[sibling, 1], parents[sibling, 2]
        common = (a in (d, e, f)) + (b in (d, e, f)) + (c in (d, e, f))
        if (
            common > 1
            or conflicts(points, a, b, c, first + sibling)
            or conflicts(points, d, e, f, q)
        ):
            return True
    return False


@njit(types.UniTuple(WORD, 3)(POINT_ROWS, types.int64[::1], *[WORD] * 3), **INLINED)
def newborn_at(points, growth, a, b, c):  # type: ignore[no-untyped-def]
    """The place of a triangle's newborn, its centroid, and its growth."""
    x = (points[a, 0] + points[b, 0] + points[c, 0] + 1) // 3
    y = (points[a, 1] + points[b, 1] + points[c, 1] + 1) // 3
    return x, y, (growth[a] + growth[b] + growth[c]) // 3 + LEAD


@linked(WORD(MESH, MOTION, CUT, SQUARES, SHORTLIST, WORD, FLOAT), **INTERNAL)
def give_births(mesh, motion, cut, squares, shortlist, wanted, reach):  # type: ignore[no-untyped-def]
    """Add up to `wanted` newborns at the present time, largest hole first; returns how many.

    Each is at the centroid of a triangle whose vertex lies inside the section, and keeps its
    distance: `reach` grid steps per unit of growth. There must be room for them in points and log.
    """
    points, triangles, growth, time = mesh.points, mesh.triangles, motion.growth, motion.state[NOW]
    before, born = mesh.count[POINTS], 0
    heap, places, parents = shortlist.heap, shortlist.places, shortlist.parents
    _list_points(mesh, growth, squares)
    for attempt in range(3):  # with the old shortlist, a new one, and all holes
        if attempt == 0 and not look_again(mesh, cut, shortlist):
            continue
        if attempt > 0:
            list_holes(mesh, cut, shortlist, SHARE if attempt == 1 else 0.0)
        length = 0
        for place in range(shortlist.length[0]):
            triangle = shortlist.holes[place]
            if shortlist.listed[triangle] == LISTED:
                heap[length], places[length] = size_of(mesh, triangle), triangle
                length += 1
        for at in range(length // 2 - 1, -1, -1):
            _sink(heap, places, at, length)
        while born < wanted and length > 0:
            triangle = places[0]
            length -= 1
            heap[0], places[0] = heap[length], places[length]
            _sink(heap, places, 0, length)
            a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
            if max(a, b, c) >= before:  # a newborn has just been put here
                continue
            shortlist.listed[triangle] = BARREN  # unless it changes, as it does with a newborn
            q = mesh.count[POINTS]
            x, y, grows = newborn_at(points, growth, a, b, c)
            if grows > motion.state[MOST]:
                continue
            if locate(mesh, triangle, x, y) != triangle:  # a sliver that no grid point lies in
                continue
            near = too_near(mesh, growth, squares, before, x, y, grows, reach)
            if near != NOTHING:
                shortlist.listed[triangle] = near
                continue
            points[q, 0], points[q, 1] = x, y
            guess = empty_until(points, q, a, b, c)
            if abs(guess) > HEAVIEST or not weigh_newborn(mesh, q, a, b, c, int(guess)):
                continue
            if is_crowded(points, parents[:born], before, q, a, b, c):
                shortlist.listed[triangle] = LISTED  # for the next layer
                continue
            growth[q], motion.base[q] = grows, points[q, 2] - grows * time
            # The epoch ends before it leaves the safe range.
            until = time + (HEAVIEST - points[q, 2]) // grows
            motion.state[LAST] = min(motion.state[LAST], until)
            motion.born[q] = time
            mesh.count[POINTS] += 1
            add_point(mesh, motion, triangle, q)
            parents[born, 0], parents[born, 1], parents[born, 2] = a, b, c
            born += 1
        if born == wanted:
            break
    return born
