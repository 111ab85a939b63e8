"""Continuous births: new cells that start empty and grow, where cells have become too large.

A site q inside the triangle of three sites whose orthocentre v has the power P is empty exactly
while its weight is at most |q − v|² − P. So a newborn gets the least weight above that, and its
cell begins at v with no area and grows with the square of the weight gained since.
"""

from __future__ import annotations

import numpy as np
from numba import njit, types

from v3dcad.geometry.exact import INLINED, INTERNAL, POINT_ROWS, WORD, conflicts
from v3dcad.geometry.grid import HEAVIEST, STEPS
from v3dcad.geometry.kinetics import ALWAYS, LAST, MOTION, NOW, add_point
from v3dcad.geometry.triangulation import MESH, NOTHING, POINTS, ROW, SENTINELS, TRIANGLES, locate

FLOAT, SIDES = types.float64, types.int8[::1]


@njit(FLOAT(POINT_ROWS, WORD, WORD, WORD), **INTERNAL)
def orthocentre_power(points, a, b, c):  # type: ignore[no-untyped-def]
    """The power of the orthocentre of a triangle, steps²: how large the hole between its sites is.

    The smallest point comes first, so that the bits do not depend on history.
    """
    if b < a and b < c:
        a, b, c = b, c, a
    elif c < a and c < b:
        a, b, c = c, a, b
    x, y, weight = points[a, 0], points[a, 1], points[a, 2]
    bx, by, cx, cy = points[b, 0] - x, points[b, 1] - y, points[c, 0] - x, points[c, 1] - y
    of_b = float(bx * bx + by * by - points[b, 2] + weight)
    of_c = float(cx * cx + cy * cy - points[c, 2] + weight)
    double = 2.0 * (bx * cy - by * cx)
    vx, vy = (cy * of_b - by * of_c) / double, (bx * of_c - cx * of_b) / double
    return vx * vx + vy * vy - weight


@njit(FLOAT(POINT_ROWS, *[WORD] * 4), **INTERNAL)
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


@njit(types.void(MESH, WORD, ROW, ROW), **INTERNAL)
def _list_by_place(mesh, side, first, listed):  # type: ignore[no-untyped-def]
    """List live points by squares of a `side` × `side` grid: first (side² + 1,), listed (p,)."""
    points, live = mesh.points, mesh.triangle_of
    for square in range(len(first)):
        first[square] = 0
    for writing in range(2):
        for point in range(SENTINELS, mesh.count[POINTS]):
            if live[point] != NOTHING:
                row, column = points[point, 1] * side, points[point, 0] * side
                square = min(row // STEPS, side - 1) * side + min(column // STEPS, side - 1)
                if writing:
                    first[square] -= 1
                    listed[first[square]] = point
                else:
                    first[square] += 1
        if not writing:
            for square in range(1, len(first)):
                first[square] += first[square - 1]


@njit(
    types.boolean(POINT_ROWS, types.int64[::1], *[WORD] * 3, FLOAT, FLOAT, WORD, ROW, ROW),
    **INTERNAL,
)
def keeps_distance(  # type: ignore[no-untyped-def]
    points, growth, x, y, grows, reach, farthest, side, first, listed
):
    """Whether a site at (x, y) is apart from every listed point; none is asked for more than
    `farthest` grid steps.
    """
    west, east = int((x - farthest) * side / STEPS), int((x + farthest) * side / STEPS)
    south, north = int((y - farthest) * side / STEPS), int((y + farthest) * side / STEPS)
    for row in range(max(south, 0), min(north, side - 1) + 1):
        for column in range(max(west, 0), min(east, side - 1) + 1):
            square = row * side + column
            for place in range(first[square], first[square + 1]):
                if not is_apart(points, growth, listed[place], x, y, grows, reach):
                    return False
    return True


@njit(types.boolean(MESH, WORD, WORD, WORD, WORD, WORD), **INTERNAL)
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


@njit(types.void(types.float64[::1], types.int32[::1], WORD, WORD), **INTERNAL)
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


@njit(types.boolean(WORD, WORD, WORD, FLOAT), **INLINED)
def ripe(born, growth, now, gain):  # type: ignore[no-untyped-def]
    """Whether a point is no newborn, or has gained so much weight since its birth, steps²."""
    return born == ALWAYS or growth * (now - born) >= gain


@njit(types.UniTuple(WORD, 3)(POINT_ROWS, types.int64[::1], *[WORD] * 3), **INLINED)
def newborn_at(points, growth, a, b, c):  # type: ignore[no-untyped-def]
    """The place of a triangle's newborn, its centroid, and its growth."""
    fastest = max(growth[a], growth[b], growth[c])
    equal = growth[a] == growth[b] and growth[b] == growth[c]
    x = (points[a, 0] + points[b, 0] + points[c, 0] + 1) // 3
    y = (points[a, 1] + points[b, 1] + points[c, 1] + 1) // 3
    return x, y, fastest + equal


@njit(WORD(MESH, MOTION, SIDES, WORD, FLOAT, FLOAT), **INTERNAL)
def give_births(mesh, motion, inside, wanted, reach, gain):  # type: ignore[no-untyped-def]
    """Add up to `wanted` newborns at the present time, largest hole first; returns how many.

    Each is at the centroid of a triangle whose vertex lies `inside` (t,) the section. It grows
    as fast as the fastest of the three, one step faster where they are equal, and keeps its
    distance: `reach` grid steps per step of growth. A newborn is no parent before it has gained the
    weight `gain`, steps²: around its tiny cell the hole still looks as large as before.
    There must be room for them in points and log.
    """
    points, triangles = mesh.points, mesh.triangles
    growth, births = motion.growth, motion.born
    time, total = motion.state[NOW], mesh.count[TRIANGLES]
    holes, places = np.empty(total), np.empty(total, np.int32)
    side = int(np.sqrt(mesh.count[POINTS] / 4)) + 1
    first, listed = np.empty(side * side + 1, np.int32), np.empty(mesh.count[POINTS], np.int32)
    _list_by_place(mesh, side, first, listed)
    length, born, before, fastest = 0, 0, mesh.count[POINTS], 0
    for point in range(SENTINELS, before):
        fastest = max(fastest, growth[point])
    farthest = (fastest + 1) * reach
    for triangle in range(total):
        if inside[triangle] != 1 or triangles[triangle, 0] == NOTHING:
            continue
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        if (
            ripe(births[a], growth[a], time, gain)
            and ripe(births[b], growth[b], time, gain)
            and ripe(births[c], growth[c], time, gain)
        ):
            x, y, grows = newborn_at(points, growth, a, b, c)
            if (
                is_apart(points, growth, a, x, y, grows, reach)
                and is_apart(points, growth, b, x, y, grows, reach)
                and is_apart(points, growth, c, x, y, grows, reach)
                and keeps_distance(
                    points, growth, x, y, grows, reach, farthest, side, first, listed
                )
            ):
                holes[length], places[length] = orthocentre_power(points, a, b, c), triangle
                length += 1
    for at in range(length // 2 - 1, -1, -1):
        _sink(holes, places, at, length)
    while born < wanted and length > 0:
        triangle = places[0]
        length -= 1
        holes[0], places[0] = holes[length], places[length]
        _sink(holes, places, 0, length)
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        if max(a, b, c) >= before:  # a newborn has just been put here
            continue
        q = mesh.count[POINTS]
        x, y, grows = newborn_at(points, growth, a, b, c)
        if locate(mesh, triangle, x, y) != triangle:  # a sliver that no grid point lies in
            continue
        alone = True
        for other in range(before, q):
            alone = alone and is_apart(points, growth, other, x, y, grows, reach)
        points[q, 0], points[q, 1] = x, y
        guess = empty_until(points, q, a, b, c)
        if not alone or abs(guess) > HEAVIEST:
            continue
        if not weigh_newborn(mesh, q, a, b, c, int(guess)):
            continue
        growth[q], motion.base[q] = grows, points[q, 2] - grows * time
        if points[q, 2] + grows * (motion.state[LAST] - time) > HEAVIEST:
            continue
        motion.born[q] = time
        mesh.count[POINTS] += 1
        add_point(mesh, motion, triangle, q)
        born += 1
    return born
