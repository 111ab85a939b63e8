"""Power diagrams whose weights grow linearly: only the flips that happen, in the order they happen.

A point weighs base + growth · time, in whole grid units. The power test of an edge is linear in
time, so that the moment at which it fails is known; a heap of these moments drives the flips (a
kinetic data structure: Basch, Guibas and Hershberger, "Data structures for mobile data",
J. Algorithms 1999). The moments are floats, a little early; the exact test decides. At whole
times the triangulation is the canonical one, whatever its history.

With power functions plus z², the whole motion is one power diagram in space: the orthocentre of a
triangle runs along a straight strut while the triangle lasts. `Motion.struts` logs each as it ends.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.core.types import NamedTuple as TupleType

from v3dcad.geometry.exact import COMPILED, INLINED, INTERNAL, POINT_ROWS, WORD, conflicts
from v3dcad.geometry.triangulation import (
    ACROSS,
    FLIP,
    FLIP_HIDE_SECOND,
    FREE,
    HIDE_THIRD,
    MESH,
    NOTHING,
    POINTS,
    ROW,
    STUCK,
    TRIANGLE_ROWS,
    TRIANGLES,
    Triangulation,
    build,
    carry_out,
    edge_to,
    plan,
    split,
)
from v3dcad.model import Ints

NEVER = np.inf
ALWAYS = -(1 << 62)
ROUNDING = 4e-15
"""Bound of the relative error of the floating power test (some 20 operations)."""

DUE, STRUTS, TOUCHED, NOW, LAST = range(5)
"""What `Motion.state` holds: heap and log length, how many triangles have been touched, the whole
time that the weights belong to, and the last time that will be asked for."""

EVERYTHING = -1
"""How many triangles have been touched when there is no telling which."""


class Motion(NamedTuple):
    """How the points of a triangulation grow, and what is due when."""

    base: Any
    """(p,) int64: weight at time 0, steps²"""
    growth: Any
    """(p,) int64: weight gained in one unit of time, steps²"""
    born: Any
    """(p,) int64: time of birth; `ALWAYS` for points that were there from the start"""
    begun: Any
    """(t,) float64: when each triangle came to be"""
    stamp: Any
    """(3 t,) int32: which entry of the heap about this edge is valid"""
    due: Any
    """(h,) float64: heap of moments"""
    due_edge: Any
    """(h, 2) int32: 3 · triangle + edge, and its stamp"""
    struts: Any
    """(s, 3) int32: log of ended triangles, smallest point first"""
    spans: Any
    """(s, 2) float64: when each began and ended"""
    touched: Any
    """(t,) int32: triangles that came, changed or went since somebody last emptied this list"""
    moment: Any
    """(1,) float64: the latest event"""
    state: Any
    """(5,) int64"""


MOTION = TupleType(
    [
        types.int64[::1],
        types.int64[::1],
        types.int64[::1],
        types.float64[::1],
        ROW,
        types.float64[::1],
        TRIANGLE_ROWS,
        TRIANGLE_ROWS,
        types.float64[:, ::1],
        ROW,
        types.float64[::1],
        types.int64[::1],
    ],
    Motion,
)
TIME = types.float64


@njit(types.UniTuple(TIME, 4)(POINT_ROWS, *[types.int64[::1]] * 2, *[WORD] * 3), **INLINED)
def strut(points, base, growth, a, b, c):  # type: ignore[no-untyped-def]
    """Where the orthocentre of a triangle is at time 0, and how it moves per unit of time.

    (x, y, x velocity, y velocity) in grid steps. The smallest point comes first, so that the same
    triangle gives the same bits whatever its history.
    """
    if b < a and b < c:
        a, b, c = b, c, a
    elif c < a and c < b:
        a, b, c = c, a, b
    x, y = points[a, 0], points[a, 1]
    bx, by, cx, cy = points[b, 0] - x, points[b, 1] - y, points[c, 0] - x, points[c, 1] - y
    half = 0.5 / (bx * cy - by * cx)
    still_b = float(bx * bx + by * by - base[b] + base[a])
    still_c = float(cx * cx + cy * cy - base[c] + base[a])
    grown_b, grown_c = growth[a] - growth[b], growth[a] - growth[c]
    return (
        x + (cy * still_b - by * still_c) * half,
        y + (bx * still_c - cx * still_b) * half,
        (cy * grown_b - by * grown_c) * half,
        (bx * grown_c - cx * grown_b) * half,
    )


@njit(types.UniTuple(TIME, 2)(POINT_ROWS, types.int64[::1], *[WORD] * 5), **INLINED)
def failure(points, growth, a, b, c, d, now):  # type: ignore[no-untyped-def]
    """When d gets into the orthocircle of a, b, c: the moment, and a bound that is surely earlier.

    The moment is `NEVER` where the weights do not bring them closer. Then the bound is too, unless
    the four may be orthogonal to one circle for good: that is for the exact test to say, now.
    """
    dx, dy, weight, speed = points[d, 0], points[d, 1], points[d, 2], growth[d]
    ax, ay = points[a, 0] - dx, points[a, 1] - dy
    bx, by = points[b, 0] - dx, points[b, 1] - dy
    cx, cy = points[c, 0] - dx, points[c, 1] - dy
    of_a, of_b, of_c = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
    slope = of_a * (speed - growth[a]) + of_b * (speed - growth[b]) + of_c * (speed - growth[c])
    from_a = float(ax * ax + ay * ay - points[a, 2] + weight) * of_a
    from_b = float(bx * bx + by * by - points[b, 2] + weight) * of_b
    from_c = float(cx * cx + cy * cy - points[c, 2] + weight) * of_c
    power = from_a + from_b + from_c
    doubt = ROUNDING * (abs(from_a) + abs(from_b) + abs(from_c))
    if slope <= 0:
        return NEVER, now if power + doubt >= 0.0 else NEVER
    return now - power / slope, now - (power + doubt) / slope


@njit(types.void(MOTION, WORD, WORD), **INLINED)
def _sift(motion, at, length):  # type: ignore[no-untyped-def]
    """Let the entry at a place of the heap sink to where it belongs."""
    due, edges = motion.due, motion.due_edge
    moment, edge, stamp = due[at], edges[at, 0], edges[at, 1]
    while True:
        below = 2 * at + 1
        if below >= length:
            break
        if below + 1 < length and due[below + 1] < due[below]:
            below += 1
        if due[below] >= moment:
            break
        due[at], edges[at, 0], edges[at, 1] = due[below], edges[below, 0], edges[below, 1]
        at = below
    due[at], edges[at, 0], edges[at, 1] = moment, edge, stamp


@njit(types.void(MOTION), **INTERNAL)
def _drop_stale(motion):  # type: ignore[no-untyped-def]
    """Take entries out of the heap that no longer hold: what stays is at most one an edge."""
    due, edges, stamp = motion.due, motion.due_edge, motion.stamp
    length = 0
    for at in range(motion.state[DUE]):
        if stamp[edges[at, 0]] == edges[at, 1]:
            due[length], edges[length, 0], edges[length, 1] = due[at], edges[at, 0], edges[at, 1]
            length += 1
    motion.state[DUE] = length
    for at in range(length // 2 - 1, -1, -1):
        _sift(motion, at, length)


@njit(types.void(MOTION, TIME, WORD, WORD), **INTERNAL)
def _push(motion, moment, edge, stamp):  # type: ignore[no-untyped-def]
    due, edges, state = motion.due, motion.due_edge, motion.state
    if state[DUE] == len(due):
        _drop_stale(motion)
    at = state[DUE]
    state[DUE] += 1
    while at > 0 and due[(at - 1) >> 1] > moment:
        above = (at - 1) >> 1
        due[at], edges[at, 0], edges[at, 1] = due[above], edges[above, 0], edges[above, 1]
        at = above
    due[at], edges[at, 0], edges[at, 1] = moment, edge, stamp


@njit(WORD(MOTION), **INTERNAL)
def _pop(motion):  # type: ignore[no-untyped-def]
    """Take the first entry out; returns its edge, or −1 where it no longer holds."""
    due, edges, state = motion.due, motion.due_edge, motion.state
    edge, stamp = edges[0, 0], edges[0, 1]
    last = state[DUE] - 1
    state[DUE] = last
    due[0], edges[0, 0], edges[0, 1] = due[last], edges[last, 0], edges[last, 1]
    if last > 0:
        _sift(motion, 0, last)
    return edge if motion.stamp[edge] == stamp else -1


@njit(types.void(MESH, MOTION, WORD, WORD, TIME), **INTERNAL)
def _certify(mesh, motion, triangle, i, earliest):  # type: ignore[no-untyped-def]
    """Enter when the exact test of an edge is due, no sooner than `earliest`."""
    triangles = mesh.triangles
    other = triangles[triangle, ACROSS + i]
    if other == NOTHING:
        return
    j = edge_to(triangles, other, triangle)
    if other < triangle:  # the edge goes by its smaller triangle
        triangle, i, other, j = other, j, triangle, i
    edge = 3 * triangle + i
    motion.stamp[edge] += 1
    b, c = triangles[triangle, (i + 1) % 3], triangles[triangle, (i + 2) % 3]
    moment, due = failure(
        mesh.points,
        motion.growth,
        triangles[triangle, i],
        b,
        c,
        triangles[other, j],
        motion.state[NOW],
    )
    if moment == NEVER and earliest > -NEVER:  # the exact test has just been passed
        return
    due = max(due, earliest)
    if due <= motion.state[LAST]:
        _push(motion, due, edge, motion.stamp[edge])


@njit(types.void(MESH, MOTION, WORD), **INTERNAL)
def _end_strut(mesh, motion, triangle):  # type: ignore[no-untyped-def]
    """Log a triangle that ends at this moment; not one that lasted no time at all."""
    triangles, begun, moment = mesh.triangles, motion.begun[triangle], motion.moment[0]
    if begun < moment:
        row = motion.state[STRUTS]
        motion.state[STRUTS] = row + 1
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        first = 0 if a < b and a < c else (1 if b < c else 2)
        for i in range(3):
            motion.struts[row, i] = triangles[triangle, (first + i) % 3]
        motion.spans[row, 0], motion.spans[row, 1] = begun, moment


@njit(types.void(MOTION, WORD), **INTERNAL)
def _touch(motion, triangle):  # type: ignore[no-untyped-def]
    touched, state = motion.touched, motion.state
    if state[TOUCHED] == len(touched):
        state[TOUCHED] = EVERYTHING
    if state[TOUCHED] != EVERYTHING:
        touched[state[TOUCHED]] = triangle
        state[TOUCHED] += 1


@njit(types.void(MESH, MOTION, WORD), **INTERNAL)
def _begin_strut(mesh, motion, triangle):  # type: ignore[no-untyped-def]
    """Date a new triangle and certify its edges; what was due about it no longer is."""
    motion.begun[triangle] = motion.moment[0]
    _touch(motion, triangle)
    for i in range(3):
        motion.stamp[3 * triangle + i] += 1
    for i in range(3):
        _certify(mesh, motion, triangle, i, -NEVER)


@njit(types.void(MESH, MOTION), **COMPILED)
def certify_all(mesh, motion):  # type: ignore[no-untyped-def]
    """Begin with the triangulation as it stands: every triangle begins now."""
    motion.state[DUE] = 0
    motion.state[TOUCHED] = EVERYTHING
    triangles = mesh.triangles
    for triangle in range(mesh.count[TRIANGLES]):
        motion.begun[triangle] = motion.moment[0]
        if triangles[triangle, 0] != NOTHING:
            for i in range(3):
                if triangles[triangle, ACROSS + i] > triangle:
                    _certify(mesh, motion, triangle, i, -NEVER)


@njit(types.void(MESH, MOTION), **COMPILED)
def end_all(mesh, motion):  # type: ignore[no-untyped-def]
    """Log every triangle as ended at this moment; `struts` must have room for all."""
    for triangle in range(mesh.count[TRIANGLES]):
        if mesh.triangles[triangle, 0] != NOTHING:
            _end_strut(mesh, motion, triangle)


@njit(types.boolean(MESH, MOTION, WORD), **COMPILED)
def advance(mesh, motion, time):  # type: ignore[no-untyped-def]
    """Bring the triangulation to a later whole time.

    Returns False where the log of struts is full; after `with_room` it goes on from there.
    """
    points, triangles, state, stuck = mesh.points, mesh.triangles, motion.state, mesh.stack
    if time != state[NOW]:
        for point in range(mesh.count[POINTS]):
            points[point, 2] = motion.base[point] + motion.growth[point] * time
        state[NOW] = time
    waiting, flipped = 0, False
    while True:
        if state[DUE] == 0 or motion.due[0] > time:
            if waiting == 0:
                break
            # Edges that could not be flipped: another flip may have freed them.
            if not flipped:
                # None did (moments that differ by less than floats tell): start afresh.
                if len(motion.spans) - state[STRUTS] < mesh.count[TRIANGLES]:
                    for at in range(waiting):
                        _certify(mesh, motion, stuck[at] // 3, stuck[at] % 3, -NEVER)
                    return False
                motion.moment[0] = time
                end_all(mesh, motion)
                build(mesh, mesh.count[POINTS])
                certify_all(mesh, motion)
                break
            for at in range(waiting):
                if triangles[stuck[at] // 3, 0] != NOTHING:
                    _certify(mesh, motion, stuck[at] // 3, stuck[at] % 3, -NEVER)
            waiting, flipped = 0, False
            continue
        if len(motion.spans) - state[STRUTS] < 4:
            for at in range(waiting):
                _certify(mesh, motion, stuck[at] // 3, stuck[at] % 3, -NEVER)
            return False
        edge = _pop(motion)
        if edge < 0:
            continue
        triangle, i = edge // 3, edge % 3
        other = triangles[triangle, ACROSS + i]
        a, b, c = (
            triangles[triangle, i],
            triangles[triangle, (i + 1) % 3],
            triangles[triangle, (i + 2) % 3],
        )
        d = triangles[other, edge_to(triangles, other, triangle)]
        if not conflicts(points, a, b, c, d):
            _certify(mesh, motion, triangle, i, time + 1.0)
            continue
        kind, other, near, far = plan(mesh, triangle, i)
        if kind == STUCK:
            stuck[waiting] = edge
            waiting += 1
            continue
        moment, _ = failure(points, motion.growth, a, b, c, d, time)
        if moment != NEVER:
            motion.moment[0] = max(motion.moment[0], min(moment, float(time)))
        _end_strut(mesh, motion, triangle)
        _end_strut(mesh, motion, other)
        if kind != FLIP:
            _end_strut(mesh, motion, near)
            if kind >= FLIP_HIDE_SECOND:
                _end_strut(mesh, motion, far)
        carry_out(mesh, triangle, i, kind, other, near, far)
        if kind != FLIP:
            for freed in range(mesh.count[FREE] - 2, mesh.count[FREE]):
                _touch(motion, mesh.free[freed])
                for k in range(3):
                    motion.stamp[3 * mesh.free[freed] + k] += 1
        flipped = True
        _begin_strut(mesh, motion, triangle)
        if kind == FLIP or kind > HIDE_THIRD:
            _begin_strut(mesh, motion, other)
    motion.moment[0] = max(motion.moment[0], float(time))
    return True


@njit(types.void(MESH, MOTION, WORD, WORD), **INTERNAL)
def add_point(mesh, motion, triangle, point):  # type: ignore[no-untyped-def]
    """Join a new point to the triangle that holds it, now; what is due then is up to `advance`.

    There must be room for one more strut.
    """
    _end_strut(mesh, motion, triangle)
    second, third = split(mesh, triangle, point)
    _begin_strut(mesh, motion, triangle)
    _begin_strut(mesh, motion, second)
    _begin_strut(mesh, motion, third)


def motion_of(mesh: Triangulation, growth: Ints, now: int, last: int) -> Motion:
    """The motion of a triangulation whose points gain `growth` (p,) a unit of time.

    `now` is the time that it stands at, `last` the latest that will be asked for.
    """
    points, triangles = len(mesh.points), len(mesh.triangles)
    motion = Motion(
        base=mesh.points[:, 2] - growth * now,
        growth=growth,
        born=np.full(points, ALWAYS),
        begun=np.zeros(triangles),
        stamp=np.zeros(3 * triangles, np.int32),
        due=np.empty(3 * triangles),
        due_edge=np.empty((3 * triangles, 2), np.int32),
        struts=np.empty((4 * points, 3), np.int32),
        spans=np.empty((4 * points, 2)),
        touched=np.empty(triangles, np.int32),
        moment=np.array([float(now)]),
        state=np.array([0, 0, 0, now, last]),
    )
    certify_all(mesh, motion)
    return motion


def with_room(mesh: Triangulation, motion: Motion, points: int) -> tuple[Triangulation, Motion]:
    """The same with room for `points` more points, and the log that goes with them."""
    triangles = 2 * points
    mesh = mesh._replace(
        points=_longer(mesh.points, points),
        triangle_of=_longer(mesh.triangle_of, points),
        triangles=_longer(mesh.triangles, triangles),
        free=_longer(mesh.free, triangles),
        stack=_longer(mesh.stack, triangles),
    )
    motion = with_log(motion, 8 * points)._replace(
        base=_longer(motion.base, points),
        growth=_longer(motion.growth, points),
        born=_longer(motion.born, points),
        begun=_longer(motion.begun, triangles),
        stamp=_longer(motion.stamp, 3 * triangles),
        due=_longer(motion.due, 3 * triangles),
        due_edge=_longer(motion.due_edge, 3 * triangles),
        touched=_longer(motion.touched, triangles),
    )
    return mesh, motion


def with_log(motion: Motion, rows: int) -> Motion:
    """The same with room for so many more struts."""
    return motion._replace(struts=_longer(motion.struts, rows), spans=_longer(motion.spans, rows))


def _longer(array: Any, by: int) -> Any:
    return np.concatenate([array, np.zeros((by, *array.shape[1:]), array.dtype)])
