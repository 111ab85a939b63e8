"""Triangles in arrays, and what is done to them: points join, edges flip, points become hidden.

Four sentinels, points 0 to 3, stand far around the frame and hold the hull; a site's point is its
number among the sites + 4. A triangle's corners are in counter-clockwise order, and
"edge i" is the one opposite corner i.
"""

from __future__ import annotations

from typing import NamedTuple

from v3dcad.geometry.compiled.arrays import Int32Array, Int32Rows, IntRows
from v3dcad.geometry.compiled.options import INLINED, compiled
from v3dcad.geometry.compiled.records import Record
from v3dcad.geometry.power_diagram.grid import STEPS
from v3dcad.geometry.power_diagram.predicates import orientation

SENTINELS = 4


FAR = 4 * STEPS
"""How far outside the frame the sentinels stand, in grid steps."""


ABSENT = -1
"""No triangle: beyond the hull, or of a hidden point. Also the first corner of a freed slot."""


ACROSS = 3
"""Where a triangle's neighbours begin in its row."""


STUCK, FLIP, HIDE_SECOND, HIDE_THIRD, FLIP_HIDE_SECOND, FLIP_HIDE_THIRD = range(6)
"""What can be done about an edge: see `plan`."""


class MeshCounts(Record):
    """How many slots of a triangulation's arrays are in use."""

    points: int
    triangles: int
    free: int
    """triangle slots that were in use and can be used again"""
    hidden: int
    """how many points have become hidden since somebody last emptied that list"""


class Triangulation(NamedTuple):
    """Weighted points and triangles in arrays with room to grow."""

    points: IntRows
    """(p, 4) int64: x and y in grid steps, weight in steps², and number"""
    triangle_of: Int32Array
    """(p,) int32: one triangle at the point, or `ABSENT` where the point is hidden"""
    triangles: Int32Rows
    """(t, 6) int32: three corners, and the triangles across edges 0, 1 and 2"""
    free: Int32Array
    """(t,) int32: slots of triangles to be used again"""
    stack: Int32Array
    """(t,) int32: room for insertions"""
    hidden: Int32Array
    """(p,) int32: the points that have become hidden, each once"""
    counts: MeshCounts


@compiled(INLINED)
def edge_to(triangles: Int32Rows, triangle: int, other: int) -> int:
    """Which edge of a triangle it shares with another."""
    if triangles[triangle, 3] == other:
        return 0
    return 1 if triangles[triangle, 4] == other else 2


@compiled(INLINED)
def corner_at(triangles: Int32Rows, triangle: int, point: int) -> int:
    """Which corner of a triangle a point is."""
    if triangles[triangle, 0] == point:
        return 0
    return 1 if triangles[triangle, 1] == point else 2


@compiled(INLINED)
def _relink(triangles: Int32Rows, triangle: int, before: int, now: int) -> None:
    if triangle != ABSENT:
        triangles[triangle, ACROSS + edge_to(triangles, triangle, before)] = now


@compiled(INLINED)
def _place(
    mesh: Triangulation,
    triangle: int,
    a: int,
    b: int,
    c: int,
    over_a: int,
    over_b: int,
    over_c: int,
) -> None:
    triangles, triangle_of = mesh.triangles, mesh.triangle_of
    triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2] = a, b, c
    triangles[triangle, 3], triangles[triangle, 4], triangles[triangle, 5] = over_a, over_b, over_c
    triangle_of[a] = triangle_of[b] = triangle_of[c] = triangle


@compiled(INLINED)
def _slot_to_use(mesh: Triangulation) -> int:
    counts = mesh.counts
    if counts.free > 0:
        counts.free -= 1
        return mesh.free[counts.free]
    counts.triangles += 1
    return counts.triangles - 1


@compiled(INLINED)
def split(mesh: Triangulation, triangle: int, point: int) -> tuple[int, int]:
    """Join a point to a triangle's corners; returns the two new slots.

    The point is the first corner of all three triangles.
    """
    triangles = mesh.triangles
    second, third = _slot_to_use(mesh), _slot_to_use(mesh)
    a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
    over_a, over_b, over_c = triangles[triangle, 3], triangles[triangle, 4], triangles[triangle, 5]
    _place(mesh, triangle, point, b, c, over_a, second, third)
    _place(mesh, second, point, c, a, over_b, third, triangle)
    _place(mesh, third, point, a, b, over_c, triangle, second)
    _relink(triangles, over_b, triangle, second)
    _relink(triangles, over_c, triangle, third)
    return second, third


@compiled(INLINED)
def plan(mesh: Triangulation, triangle: int, i: int) -> tuple[int, int, int, int]:
    """What to do about edge i of a triangle, which is not regular.

    Let the corners be a, b, c from i on, and d the one across. Returns what, and three triangles:
    the one across, and those of a, d and a hidden point (`ABSENT` where there is none).

    - `FLIP`: d sees a between b and c: triangles a, b, d and a, d, c.
    - `HIDE_SECOND`, `HIDE_THIRD`: b (or c) has three triangles and becomes hidden.
    - `FLIP_HIDE_SECOND`, `FLIP_HIDE_THIRD`: b (or c) lies between a and d and has four.
    - `STUCK`: none of these, as yet.
    """
    points, triangles = mesh.points, mesh.triangles
    next_i, last_i = (i + 1) % 3, (i + 2) % 3
    other = triangles[triangle, ACROSS + i]
    j = edge_to(triangles, other, triangle)
    a, d = triangles[triangle, i], triangles[other, j]
    side_b = orientation(points, a, triangles[triangle, next_i], d)
    side_c = orientation(points, a, d, triangles[triangle, last_i])
    if side_b > 0 and side_c > 0:
        return FLIP, other, ABSENT, ABSENT
    if side_b <= 0:
        near = triangles[triangle, ACROSS + last_i]
        far = triangles[other, ACROSS + (j + 1) % 3]
        side, hide, flip_hide = side_b, HIDE_SECOND, FLIP_HIDE_SECOND
    else:
        near = triangles[triangle, ACROSS + next_i]
        far = triangles[other, ACROSS + (j + 2) % 3]
        side, hide, flip_hide = side_c, HIDE_THIRD, FLIP_HIDE_THIRD
    if near != ABSENT and far != ABSENT:
        if near == far:
            return hide, other, near, far
        if side == 0 and triangles[far, ACROSS + edge_to(triangles, far, near)] == near:
            return flip_hide, other, near, far
    return STUCK, other, near, far


@compiled(INLINED)
def _flip(mesh: Triangulation, triangle: int, i: int, other: int) -> None:
    """Replace a, b, c and d, c, b by a, b, d and a, d, c."""
    triangles = mesh.triangles
    j = edge_to(triangles, other, triangle)
    next_i, last_i, next_j, last_j = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
    a, d = triangles[triangle, i], triangles[other, j]
    b, c = triangles[triangle, next_i], triangles[triangle, last_i]
    beside_b, beside_c = triangles[triangle, ACROSS + next_i], triangles[triangle, ACROSS + last_i]
    over_c, over_b = triangles[other, ACROSS + next_j], triangles[other, ACROSS + last_j]
    _place(mesh, triangle, a, b, d, over_c, other, beside_c)
    _place(mesh, other, a, d, c, over_b, beside_b, triangle)
    _relink(triangles, over_c, other, triangle)
    _relink(triangles, beside_b, triangle, other)


@compiled(INLINED)
def note_hidden(mesh: Triangulation, point: int) -> None:
    """Note that a point has no triangles any more, or got none."""
    mesh.triangle_of[point] = ABSENT
    mesh.hidden[mesh.counts.hidden] = point
    mesh.counts.hidden += 1


@compiled(INLINED)
def _hide(mesh: Triangulation, triangle: int, i: int, other: int, third: int, second: bool) -> None:
    """Merge the three triangles of b (`second`) or c into `triangle`, with a first."""
    triangles = mesh.triangles
    j = edge_to(triangles, other, triangle)
    hidden_at, kept_at = ((i + 1) % 3, (i + 2) % 3) if second else ((i + 2) % 3, (i + 1) % 3)
    a, d = triangles[triangle, i], triangles[other, j]
    hidden, kept = triangles[triangle, hidden_at], triangles[triangle, kept_at]
    beside = triangles[triangle, ACROSS + hidden_at]
    over = triangles[other, ACROSS + corner_at(triangles, other, hidden)]
    beyond = triangles[third, ACROSS + corner_at(triangles, third, hidden)]
    if second:
        _place(mesh, triangle, a, d, kept, over, beside, beyond)
    else:
        _place(mesh, triangle, a, kept, d, over, beyond, beside)
    _relink(triangles, over, other, triangle)
    _relink(triangles, beyond, third, triangle)
    note_hidden(mesh, hidden)
    triangles[other, 0] = triangles[third, 0] = ABSENT
    freed = mesh.counts.free
    mesh.free[freed], mesh.free[freed + 1] = other, third
    mesh.counts.free = freed + 2


@compiled(INLINED)
def carry_out(
    mesh: Triangulation, triangle: int, i: int, kind: int, other: int, near: int, far: int
) -> None:
    """Do what `plan` says. Corner a comes first in what is left: `triangle`, and, where there is
    a flip, `other`.
    """
    if kind not in (HIDE_SECOND, HIDE_THIRD):
        _flip(mesh, triangle, i, other)
        if kind == FLIP:
            return
        if kind == FLIP_HIDE_THIRD:
            triangle = other
        i, other = 0, far
    _hide(mesh, triangle, i, other, near, kind in (HIDE_SECOND, FLIP_HIDE_SECOND))
