"""Which vertices of a power diagram lie inside rings, told by winding numbers.

They are a potential on the triangles, whose differences across edges the crossings give: where
those of some triangles fit those of all their neighbours, and the outermost is 0, they are the
only right ones. Inside they are 1, but where a part is thinner than rounding.
"""

from __future__ import annotations

from v3dcad.geometry.clipping.interior import UNLISTED, Cut
from v3dcad.geometry.clipping.ring_walk import EDGE, WINDING, Crossings
from v3dcad.geometry.compiled.arrays import Int32Array, Int32Rows
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INTERNAL
from v3dcad.geometry.power_diagram.triangle_mesh import (
    ABSENT,
    ACROSS,
    Triangulation,
    edge_to,
)

UNKNOWN = -(1 << 30)


@linked(INTERNAL)
def wind(
    mesh: Triangulation, inside: Int32Array, gain: Int32Rows, listed: Int32Array, count: int
) -> bool:
    """Find the winding numbers of the listed triangles, which are `UNKNOWN`, from those around.

    Returns whether they fit everywhere.
    """
    triangles, stack = mesh.triangles, mesh.stack
    fits, outermost = True, mesh.triangle_of[0]
    for place in range(count):
        stack[0], waiting = listed[place], 1
        begun = inside[listed[place]] != UNKNOWN
        while waiting > 0:
            waiting -= 1
            triangle = stack[waiting]
            # Settled: once more around, to settle those across and to see whether it fits.
            winding = inside[triangle] if begun else UNKNOWN
            for i in range(3):
                other = triangles[triangle, ACROSS + i]
                if other == ABSENT:
                    continue
                if triangle < other:
                    step = gain[3 * triangle + i, 0]
                else:
                    step = -gain[3 * other + edge_to(triangles, other, triangle), 0]
                if inside[other] == UNKNOWN:
                    if begun:
                        inside[other] = winding + step
                        stack[waiting] = other
                        waiting += 1
                elif not begun:
                    inside[triangle] = inside[other] - step
                    stack[0], waiting, begun = triangle, 1, True
                    break
                else:
                    fits = fits and inside[other] == winding + step
    for place in range(count):
        fits = fits and inside[listed[place]] != UNKNOWN
    return fits and inside[outermost] == 0


@linked(INTERNAL)
def chain(
    mesh: Triangulation,
    cut: Cut,
    crossings: Crossings,
    count: int,
    length: int,
) -> int:
    """Chain the crossings on each edge in place of those before, which come to `cut.former`; adds
    the triangles beside edges whose gain has changed to the first `length` of `cut.listed`, and
    returns how many are listed then.
    """
    rows, next_on = crossings.rows, crossings.next_on
    triangles, inside, listed, former = mesh.triangles, cut.inside, cut.listed, cut.former
    first_on, gain, crossed, past = cut.first_on, cut.gain, cut.crossed, cut.state.crossed
    for place in range(past):
        former[place] = crossed[place]
        first_on[former[place]] = UNLISTED
    some = 0
    for crossing in range(count):
        key = rows[crossing, EDGE]
        gain[key, 1] += rows[crossing, WINDING]
        next_on[crossing] = first_on[key]
        if first_on[key] < 0:
            crossed[some] = key
            some += 1
        first_on[key] = crossing
    cut.state.crossed = some
    for place in range(past + count):
        key = former[place] if place < past else rows[place - past, EDGE]
        if gain[key, 0] != gain[key, 1]:
            gain[key, 0] = gain[key, 1]
            for side in range(2):
                triangle = triangles[key // 3, ACROSS + key % 3] if side else key // 3
                if (
                    triangle != ABSENT
                    and triangles[triangle, 0] != ABSENT
                    and inside[triangle] != UNKNOWN
                ):
                    inside[triangle] = UNKNOWN
                    listed[length] = triangle
                    length += 1
    for place in range(past):
        gain[former[place], 1] = 0
    for crossing in range(count):
        gain[rows[crossing, EDGE], 1] = 0
    return length
