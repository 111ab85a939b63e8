"""Power diagrams whose weights change linearly: only the flips that happen, and points that enter.

The heap of moments at which edges' power tests fail (`event_queue.py`) drives the flips (a kinetic
data structure: Basch, Guibas and Hershberger, "Data structures for mobile data", J. Algorithms
1999). The moments are floats, a little early; the exact test decides. At whole times the
triangulation is the canonical one, whatever its history.
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.power_diagram.ending import Ending
from v3dcad.geometry.power_diagram.event_queue import (
    EVERYTHING,
    NEVER,
    Motion,
    MotionState,
    failure,
    pop,
    push,
)
from v3dcad.geometry.power_diagram.predicates import WEIGHT, conflicts
from v3dcad.geometry.power_diagram.regular_triangulation import insert
from v3dcad.geometry.power_diagram.triangle_mesh import (
    ABSENT,
    ACROSS,
    FLIP,
    HIDE_THIRD,
    STUCK,
    Triangulation,
    carry_out,
    corner_at,
    edge_to,
    plan,
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
    due, closer = failure(
        mesh.points,
        motion.growth,
        triangles[triangle, i],
        b,
        c,
        triangles[other, j],
        motion.state.now,
    )
    if not closer and earliest > -NEVER:  # the exact test has just been passed
        return
    due = max(due, earliest)
    if due <= motion.state.last:
        push(motion, due, edge, motion.stamp[edge])


@linked(INTERNAL)
def _touch(motion: Motion, triangle: int) -> None:
    """Note that a triangle has come, changed or gone; what was due about it no longer is."""
    touched, state = motion.touched, motion.state
    for i in range(3):
        motion.stamp[3 * triangle + i] += 1
    if state.touched == len(touched):
        state.touched = EVERYTHING
    if state.touched != EVERYTHING:
        touched[state.touched] = triangle
        state.touched += 1


@linked(INTERNAL)
def _renew(mesh: Triangulation, motion: Motion, triangle: int) -> None:
    """Certify the edges of a triangle that is new or has changed."""
    _touch(motion, triangle)
    for i in range(3):
        _certify(mesh, motion, triangle, i, -NEVER)


@compiled(UNCOUNTED)
def certify_all(mesh: Triangulation, motion: Motion) -> None:
    """Begin with the triangulation as it is now."""
    motion.state.due = 0
    motion.state.touched = EVERYTHING
    triangles = mesh.triangles
    for triangle in range(mesh.counts.triangles):
        if triangles[triangle, 0] != ABSENT:
            for i in range(3):
                if triangles[triangle, ACROSS + i] > triangle:
                    _certify(mesh, motion, triangle, i, -NEVER)


@linked(UNCOUNTED)
def advance(mesh: Triangulation, motion: Motion, time: int) -> int:
    """Bring the triangulation to a later whole time.

    Returns an `Ending`: `DONE`, or `NO_FLIP` where edges are due of which none can be flipped.
    Then the triangulation has to be built anew at that time.
    """
    points, triangles, state, stuck = mesh.points, mesh.triangles, motion.state, mesh.stack
    if time != state.now:
        for point in range(mesh.counts.points):
            points[point, WEIGHT] = motion.base[point] + motion.growth[point] * time
        state.now = time
    waiting, flipped = 0, False
    while True:
        if state.due == 0 or motion.due[0] > time:
            if waiting == 0:
                return Ending.DONE
            if not flipped:
                return Ending.NO_FLIP
            # Edges that could not be flipped: another flip may have freed them.
            for at in range(waiting):
                if triangles[stuck[at] // 3, 0] != ABSENT:
                    _certify(mesh, motion, stuck[at] // 3, stuck[at] % 3, -NEVER)
            waiting, flipped = 0, False
            continue
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
        carry_out(mesh, triangle, i, kind, other, near, far)
        if kind != FLIP:
            for freed in range(mesh.counts.free - 2, mesh.counts.free):
                _touch(motion, mesh.free[freed])
        flipped = True
        _renew(mesh, motion, triangle)
        if kind == FLIP or kind > HIDE_THIRD:
            _renew(mesh, motion, other)


@linked(INTERNAL)
def enter(mesh: Triangulation, motion: Motion, point: int, triangle: int) -> int:
    """Insert a point with its weight of now, if it is not hidden.

    The search for its place starts at `triangle`; returns a triangle nearby. The point is hidden
    if `mesh.triangle_of[point]` is `ABSENT` then.
    """
    points, state = mesh.points, motion.state
    points[point, WEIGHT] = motion.base[point] + motion.growth[point] * state.now
    free = mesh.counts.free
    triangle = insert(mesh, point, triangle)
    if mesh.triangle_of[point] == ABSENT:
        return triangle
    for freed in range(max(free - 2, 0), mesh.counts.free):
        _touch(motion, mesh.free[freed])
    # All that has changed lies around the point.
    triangle = first = mesh.triangle_of[point]
    while True:
        _touch(motion, triangle)
        k = corner_at(mesh.triangles, triangle, point)
        triangle = mesh.triangles[triangle, ACROSS + (k + 1) % 3]
        if triangle == first:
            break
    while True:
        k = corner_at(mesh.triangles, triangle, point)
        _certify(mesh, motion, triangle, k, -NEVER)
        _certify(mesh, motion, triangle, (k + 1) % 3, -NEVER)
        triangle = mesh.triangles[triangle, ACROSS + (k + 1) % 3]
        if triangle == first:
            return first


def motion_of(mesh: Triangulation, growth: Ints, now: int, last: int) -> Motion:
    """The motion of a triangulation whose points gain `growth` (p,) a unit of time.

    `now` is the time that its weights belong to, `last` the latest that can be asked for.
    """
    triangles = len(mesh.triangles)
    motion = Motion(
        base=mesh.points[:, WEIGHT] - growth * now,
        growth=growth,
        stamp=np.zeros(3 * triangles, np.int32),
        due=np.empty(3 * triangles),
        due_edge=np.empty((3 * triangles, 2), np.int32),
        touched=np.empty(triangles, np.int32),
        state=MotionState.of(now=now, last=last),
    )
    certify_all(mesh, motion)
    return motion
