"""Continuous births: new cells that start empty and grow, where cells have become too large.

A site q inside the triangle of three sites whose orthocentre v has the power P is empty exactly
while its weight is at most |q − v|² − P. So a newborn gets the least weight above that, and its
cell begins at v with no area and grows with the square of the weight gained since.

At the centroid that bound is where the newborn's power function is the mean of the three, and it
grows with the mean of their growths. A newborn grows a little more: `LEAD`. So it has never had a
cell before, it takes from slower parents and gives to faster ones, and all growths stay near each
other. One as fast as the fastest parent, or by the whole offset faster where all three are equal,
would run over its surroundings until it met its like: cells of up to 35 times their mean were seen.

Where contours are far outside the hull of the sites, cells are born there, too: see `rim.py`.
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.clipping.interior import Cut
from v3dcad.geometry.compiled.arrays import Int32Array, Int32Rows, IntArray, IntRows
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INLINED, INTERNAL, compiled
from v3dcad.geometry.power_diagram.event_queue import Motion
from v3dcad.geometry.power_diagram.grid import HEAVIEST
from v3dcad.geometry.power_diagram.kinetic_triangulation import add_point
from v3dcad.geometry.power_diagram.predicates import conflicts
from v3dcad.geometry.power_diagram.regular_triangulation import holds, locate
from v3dcad.geometry.power_diagram.triangle_mesh import (
    ABSENT,
    Triangulation,
)
from v3dcad.structure.holes import (
    BARREN,
    LISTED,
    SHARE,
    Shortlist,
    list_holes,
    look_again,
    size_of,
)
from v3dcad.structure.rim import (
    MARGIN,
    Rim,
    cells_at,
    largest_of,
    moved_out,
    size_rim,
    touching,
)
from v3dcad.structure.spacing import Squares, list_points, too_near

LEAD = 3
"""Units of growth by which a newborn is ahead of its parents' mean: an eighth of `growth.PACE`.
With more, cells are less even and the hull shrinks sooner; with less, they hardly change on the way
up."""


@compiled(INLINED)
def orthocentre(points: IntRows, a: int, b: int, c: int) -> tuple[float, float]:
    """Where the cells of three points meet, from the first of them, grid steps."""
    x, y, weight = points[a, 0], points[a, 1], points[a, 2]
    bx, by, cx, cy = points[b, 0] - x, points[b, 1] - y, points[c, 0] - x, points[c, 1] - y
    of_b = float(bx * bx + by * by - points[b, 2] + weight)
    of_c = float(cx * cx + cy * cy - points[c, 2] + weight)
    double = 2.0 * (bx * cy - by * cx)
    return (cy * of_b - by * of_c) / double, (bx * of_c - cx * of_b) / double


@linked(INTERNAL)
def empty_until(points: IntRows, q: int, a: int, b: int, c: int) -> float:
    """The largest weight (steps², but for rounding) at which q has no cell beside a, b, c."""
    vx, vy = orthocentre(points, a, b, c)
    qx, qy = float(points[q, 0] - points[a, 0]), float(points[q, 1] - points[a, 1])
    return qx * (qx - 2 * vx) + qy * (qy - 2 * vy) + points[a, 2]


@linked(INTERNAL)
def weigh_newborn(mesh: Triangulation, q: int, a: int, b: int, c: int, guess: int) -> bool:
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


@linked(INTERNAL)
def _sink(holes: IntArray, places: Int32Array, at: int, length: int) -> None:
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


@linked(INTERNAL)
def is_crowded(
    points: IntRows, parents: Int32Rows, first: int, q: int, a: int, b: int, c: int
) -> bool:
    """Whether q, newborn to a, b, c, has to wait because of newborns before it at this moment:
    those from point `first` on, with their parents (k, 3).

    Holes may lie in the same place (four sites orthogonal to one circle), where they would keep
    each other from having cells. A newborn has one where its parents' triangle would be regular
    beside all others. And two with two parents in common are equally far wherever the two other
    parents are, so that four cells would meet in a point at every height.
    """
    for sibling in range(len(parents)):
        d, e, f = parents[sibling, 0], parents[sibling, 1], parents[sibling, 2]
        if d == ABSENT:  # it came in from outside
            continue
        common = (a in (d, e, f)) + (b in (d, e, f)) + (c in (d, e, f))
        if (
            common > 1
            or conflicts(points, a, b, c, first + sibling)
            or conflicts(points, d, e, f, q)
        ):
            return True
    return False


@compiled(INLINED)
def newborn_at(points: IntRows, growth: IntArray, a: int, b: int, c: int) -> tuple[int, int, int]:
    """The place of a triangle's newborn, its centroid, and its growth."""
    x = (points[a, 0] + points[b, 0] + points[c, 0] + 1) // 3
    y = (points[a, 1] + points[b, 1] + points[c, 1] + 1) // 3
    return x, y, (growth[a] + growth[b] + growth[c]) // 3 + LEAD


@compiled(INLINED)
def _enter(mesh: Triangulation, motion: Motion, q: int, grows: int) -> None:
    """Let the point q, which has its place and its weight of now, be the last of all points."""
    weight, time = mesh.points[q, 2], motion.state.now
    motion.growth[q], motion.base[q] = grows, weight - grows * time
    motion.born[q] = time
    mesh.counts.points += 1
    # The epoch ends before it leaves the safe range.
    motion.state.last = min(motion.state.last, time + (HEAVIEST - weight) // max(grows, 1))


@linked(INTERNAL)
def _come_in(
    mesh: Triangulation,
    motion: Motion,
    squares: Squares,
    rim: Rim,
    crossings: Int32Rows,
    crossing: int,
    before: int,
    reach: float,
) -> int:
    """Enter a newborn for the hole at a crossing; returns the triangle that it stands in, or
    `ABSENT` where it cannot be. It is not joined to it yet.
    """
    points, growth, q = mesh.points, motion.growth, mesh.counts.points
    i, j = cells_at(mesh, crossings, crossing)
    x, y = moved_out(points, rim.corners, i, j)
    east, north = rim.corners[2, 0], rim.corners[2, 1]
    if not (0 <= x <= east and 0 <= y <= north):  # a rectangle narrower than the rows beside it
        return ABSENT
    triangle = locate(mesh, mesh.triangle_of[i], x, y)
    a, b, c = mesh.triangles[triangle, 0], mesh.triangles[triangle, 1], mesh.triangles[triangle, 2]
    vx, vy = orthocentre(points, a, b, c)
    inside = 0 <= points[a, 0] + vx <= east and 0 <= points[a, 1] + vy <= north
    if inside or not holds(mesh, triangle, x, y):
        return ABSENT
    weight, pace = touching(mesh, growth, rim, x, y)
    grows = int(np.floor(pace)) + LEAD
    if (
        weight + MARGIN >= HEAVIEST
        or weight - MARGIN <= -HEAVIEST
        or grows > motion.state.most_growth
    ):
        return ABSENT
    if too_near(mesh, growth, squares, before, x, y, grows, reach) != ABSENT:
        return ABSENT
    points[q, 0], points[q, 1], points[q, 2] = x, y, int(np.floor(weight)) - MARGIN
    if not conflicts(points, a, b, c, q):  # its cell would begin beside the rectangle
        return ABSENT
    mesh.triangle_of[q] = ABSENT
    _enter(mesh, motion, q, grows)
    rim.born[rim.counts[0]] = motion.state.now
    rim.counts[0] += 1
    return triangle


@linked(INTERNAL)
def give_births(
    mesh: Triangulation,
    motion: Motion,
    cut: Cut,
    squares: Squares,
    shortlist: Shortlist,
    rim: Rim,
    crossings: Int32Rows,
    count: int,
    wanted: int,
    reach: float,
) -> int:
    """Add up to `wanted` newborns at the present time, largest hole first; returns how many.

    Each is at the centroid of a triangle whose vertex lies inside the section, or, one at a time,
    from outside where a wall leaves the section: at one of its first `count` crossings. It
    keeps its distance: `reach` grid steps per unit of growth. There must be room for them in points
    and log.
    """
    points, triangles, growth = mesh.points, mesh.triangles, motion.growth
    before, born, outer, within = mesh.counts.points, 0, ABSENT, ABSENT
    heap, places, parents = shortlist.heap, shortlist.places, shortlist.parents
    list_points(mesh, growth, squares)
    size_rim(mesh, rim, crossings, count)
    widest = largest_of(mesh, rim, crossings, count)
    for attempt in range(3):  # with the old shortlist, a new one, and all holes
        if attempt == 0 and not look_again(mesh, cut, shortlist):
            continue
        if attempt > 0:
            list_holes(mesh, cut, shortlist, SHARE if attempt == 1 else 0.0)
        length = 0
        for place in range(shortlist.length[0]):
            triangle = shortlist.holes[place]
            size = size_of(mesh, triangle)  # it may have become another since it was listed
            if size > shortlist.bar[0] and shortlist.listed[triangle] == LISTED:
                heap[length], places[length] = size, triangle
                length += 1
        for at in range(length // 2 - 1, -1, -1):
            _sink(heap, places, at, length)
        while born < wanted:
            largest = float(heap[0]) if length > 0 else shortlist.bar[0]
            if outer == ABSENT and widest != ABSENT and rim.sizes[widest] > largest:
                q = mesh.counts.points
                within = _come_in(mesh, motion, squares, rim, crossings, widest, before, reach)
                rim.sizes[widest] = 0
                widest = largest_of(mesh, rim, crossings, count)
                if within != ABSENT:
                    outer, parents[born, 0] = q, ABSENT
                    born += 1
                continue
            if length == 0:
                break
            triangle = places[0]
            length -= 1
            heap[0], places[0] = heap[length], places[length]
            _sink(heap, places, 0, length)
            a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
            if max(a, b, c) >= before:  # a newborn has just been put here
                continue
            shortlist.listed[triangle] = BARREN  # unless it changes, as it does with a newborn
            q = mesh.counts.points
            x, y, grows = newborn_at(points, growth, a, b, c)
            if grows > motion.state.most_growth:
                continue
            if not holds(mesh, triangle, x, y):  # a sliver that no grid point lies in
                continue
            near = too_near(mesh, growth, squares, before, x, y, grows, reach)
            if near != ABSENT:
                shortlist.listed[triangle] = near
                continue
            points[q, 0], points[q, 1] = x, y
            guess = empty_until(points, q, a, b, c)
            if abs(guess) > HEAVIEST or not weigh_newborn(mesh, q, a, b, c, int(guess)):
                continue
            if is_crowded(points, parents[:born], before, q, a, b, c):
                shortlist.listed[triangle] = LISTED  # for the next layer
                continue
            _enter(mesh, motion, q, grows)
            add_point(mesh, motion, triangle, q)
            parents[born, 0], parents[born, 1], parents[born, 2] = a, b, c
            born += 1
        if born == wanted:
            break
    if outer != ABSENT:  # at last, since it leaves the triangulation far from regular
        add_point(mesh, motion, within, outer)
    return born
