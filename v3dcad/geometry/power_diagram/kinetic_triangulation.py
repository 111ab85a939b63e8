"""Power diagrams whose weights grow linearly: only the flips that happen, in the order they happen.

The heap of moments at which edges' power tests fail (`agenda.py`) drives the flips (a kinetic data
structure: Basch, Guibas and Hershberger, "Data structures for mobile data", J. Algorithms 1999).
The moments are floats, a little early; the exact test decides. At whole times the triangulation is
the canonical one, whatever its history.

With power functions plus z², the whole motion is one power diagram in space: the orthocentre of a
triangle runs along a straight strut while the triangle lasts. `Motion.struts` logs each as it ends.
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.power_diagram.ending import Ending
from v3dcad.geometry.power_diagram.event_queue import (
    ALWAYS,
    EVERYTHING,
    NEVER,
    Motion,
    MotionState,
    _longer,
    failure,
    pop,
    push,
    with_log,
)
from v3dcad.geometry.power_diagram.grid import HEAVIEST
from v3dcad.geometry.power_diagram.predicates import conflicts
from v3dcad.geometry.power_diagram.regular_triangulation import build
from v3dcad.geometry.power_diagram.triangle_mesh import (
    ABSENT,
    ACROSS,
    FLIP,
    FLIP_HIDE_SECOND,
    HIDE_THIRD,
    STUCK,
    Triangulation,
    carry_out,
    edge_to,
    plan,
    split,
)
from v3dcad.model import Ints


@linked(INTERNAL)
def _certify(mesh: Triangulation, motion: Motion, triangle: int, i: int, earliest: float) -> None:
    """Enter when the exact test of an edge is due, no sooner than `earliest`."""
    triangles = mesh.triangles
    other = triangles[triangle, ACROSS + i]
    if other == ABSENT:
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
        motion.state.now,
    )
    if moment == NEVER and earliest > -NEVER:  # the exact test has just been passed
        return
    due = max(due, earliest)
    if due <= motion.state.last:
        push(motion, due, edge, motion.stamp[edge])


@linked(INTERNAL)
def _end_strut(mesh: Triangulation, motion: Motion, triangle: int) -> None:
    """Log a triangle that ends at this moment; not one that lasted no time at all."""
    triangles, begun, moment = mesh.triangles, motion.begun[triangle], motion.moment[0]
    if begun < moment:
        row = motion.state.struts
        motion.state.struts = row + 1
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        first = 0 if a < b and a < c else (1 if b < c else 2)
        for i in range(3):
            motion.struts[row, i] = triangles[triangle, (first + i) % 3]
        motion.spans[row, 0], motion.spans[row, 1] = begun, moment


@linked(INTERNAL)
def _touch(motion: Motion, triangle: int) -> None:
    touched, state = motion.touched, motion.state
    if state.touched == len(touched):
        state.touched = EVERYTHING
    if state.touched != EVERYTHING:
        touched[state.touched] = triangle
        state.touched += 1


@linked(INTERNAL)
def _begin_strut(mesh: Triangulation, motion: Motion, triangle: int) -> None:
    """Date a new triangle and certify its edges; what was due about it no longer is."""
    motion.begun[triangle] = motion.moment[0]
    _touch(motion, triangle)
    for i in range(3):
        motion.stamp[3 * triangle + i] += 1
    for i in range(3):
        _certify(mesh, motion, triangle, i, -NEVER)


@compiled(UNCOUNTED)
def certify_all(mesh: Triangulation, motion: Motion) -> None:
    """Begin with the triangulation as it stands: every triangle begins now."""
    motion.state.due = 0
    motion.state.touched = EVERYTHING
    triangles = mesh.triangles
    for triangle in range(mesh.counts.triangles):
        motion.begun[triangle] = motion.moment[0]
        if triangles[triangle, 0] != ABSENT:
            for i in range(3):
                if triangles[triangle, ACROSS + i] > triangle:
                    _certify(mesh, motion, triangle, i, -NEVER)


@linked(UNCOUNTED)
def advance(mesh: Triangulation, motion: Motion, time: int) -> int:
    """Bring the triangulation to a later whole time. Returns an `Ending`: if it is not `DONE`,
    call `resumed` and then this again.
    """
    points, triangles, state, stuck = mesh.points, mesh.triangles, motion.state, mesh.stack
    if time != state.now:
        for point in range(mesh.counts.points):
            points[point, 2] = motion.base[point] + motion.growth[point] * time
        state.now = time
    waiting, flipped = 0, False
    while True:
        if state.due == 0 or motion.due[0] > time:
            if waiting == 0:
                break
            if not flipped:
                return Ending.NO_FLIP
            # Edges that could not be flipped: another flip may have freed them.
            for at in range(waiting):
                if triangles[stuck[at] // 3, 0] != ABSENT:
                    _certify(mesh, motion, stuck[at] // 3, stuck[at] % 3, -NEVER)
            waiting, flipped = 0, False
            continue
        if len(motion.spans) - state.struts < 4:
            for at in range(waiting):
                _certify(mesh, motion, stuck[at] // 3, stuck[at] % 3, -NEVER)
            return Ending.LOG_FULL
        edge = pop(motion)
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
            for freed in range(mesh.counts.free - 2, mesh.counts.free):
                _touch(motion, mesh.free[freed])
                for k in range(3):
                    motion.stamp[3 * mesh.free[freed] + k] += 1
        flipped = True
        _begin_strut(mesh, motion, triangle)
        if kind == FLIP or kind > HIDE_THIRD:
            _begin_strut(mesh, motion, other)
    motion.moment[0] = max(motion.moment[0], float(time))
    return Ending.DONE


@linked(INTERNAL)
def add_point(mesh: Triangulation, motion: Motion, triangle: int, point: int) -> None:
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

    `now` is the time that it stands at, `last` the latest that can be asked for.
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
        state=MotionState.of(now=now, last=last, most_growth=HEAVIEST),
    )
    certify_all(mesh, motion)
    return motion


def all_ended(mesh: Triangulation, motion: Motion) -> Motion:
    """The motion with every triangle that has lasted any time logged as ended at this moment."""
    some = slice(0, int(mesh.counts.triangles))
    corners, begun, moment = mesh.triangles[some, :3], motion.begun[some], motion.moment[0]
    ended = (corners[:, 0] != ABSENT) & (begun < moment)
    corners, begun = corners[ended], begun[ended]
    motion = with_log(motion, len(corners))
    rows = slice(int(motion.state.struts), int(motion.state.struts) + len(corners))
    turn = (corners.argmin(axis=1)[:, None] + np.arange(3)) % 3
    motion.struts[rows] = np.take_along_axis(corners, turn, axis=1)
    motion.spans[rows, 0], motion.spans[rows, 1] = begun, moment
    motion.state.struts = rows.stop
    return motion


def resumed(mesh: Triangulation, motion: Motion, ended: int) -> Motion:
    """The motion with what `advance` needs to go on where it has ended before the time asked for.

    `LOG_FULL`: room for more struts. `NO_FLIP`: edges are due of which none can be flipped, since
    moments differ by less than floats tell; so the triangulation is built afresh at that time.
    """
    if ended == Ending.LOG_FULL:
        return with_log(motion, len(motion.spans))
    motion.moment[0] = motion.state.now
    motion = all_ended(mesh, motion)
    build(mesh, mesh.counts.points)
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
