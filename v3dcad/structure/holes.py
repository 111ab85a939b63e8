"""The largest holes between cells, shortlisted: not all need to be looked at in every layer.

A hole is an inner vertex of the diagram; its size is the vertex's power, steps². That is convex in
time, so that one which is small at two moments is small in between.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.core.types import NamedTuple as TupleType

from v3dcad.geometry.agenda import ALWAYS, LEAST, MOTION, NOW
from v3dcad.geometry.exact import INLINED, INTERNAL, WORD
from v3dcad.geometry.flips import MESH, NOTHING, ROW
from v3dcad.geometry.inside import CUT, FRESH, TOO_MANY, VERTICES
from v3dcad.geometry.linking import linked

FLOATS, FLOAT_ROWS = types.float64[::1], types.float64[:, ::1]

SHARE = 0.8
"""How far between the mean hole and the largest one the bar of a shortlist is."""

HORIZON = 16
"""For so many layers a shortlist is made."""

LENGTH, SEEN, UNTIL = range(3)
"""What `Shortlist.state` holds: how many holes are listed, when they were last looked at, and for
how long the list is complete."""


LISTED, BARREN = 1, 2
"""What `Shortlist.listed` says of a triangle: that it is on the list; that it has no newborn unless
it changes. A larger number is the point that its newborn would be too near to, while that lives."""


class Shortlist(NamedTuple):
    """All holes with room that are above a bar, or may be before the list is made anew."""

    holes: Any
    """(t,) int32: their triangles"""
    listed: Any
    """(t,) int32: what there is to say of each triangle, or 0"""
    heap: Any
    """(t,) float64: room for the sizes of those that may get newborns next, largest first,"""
    places: Any
    """(t,) int32: their triangles,"""
    parents: Any
    """(t, 3) int32: and the parents of the newborns"""
    bar: Any
    """(1,) float64, steps²"""
    state: Any
    """(3,) int64"""


SHORTLIST = TupleType(
    [ROW, ROW, FLOATS, ROW, types.int32[:, ::1], FLOATS, types.int64[::1]], Shortlist
)


def no_shortlist(triangles: int) -> Shortlist:
    """A shortlist that has yet to be made, of up to so many triangles."""
    return Shortlist(
        np.empty(triangles, np.int32),
        np.zeros(triangles, np.int32),
        np.empty(triangles),
        np.empty(triangles, np.int32),
        np.empty((triangles, 3), np.int32),
        np.zeros(1),
        np.array([0, ALWAYS, ALWAYS]),
    )


@njit(types.float64(FLOAT_ROWS, WORD, types.float64), **INLINED)
def size_at(sizes, vertex, time):  # type: ignore[no-untyped-def]
    """How large the hole at a vertex is at a time, steps²."""
    return sizes[vertex, 0] + time * (sizes[vertex, 1] + time * sizes[vertex, 2])


@njit(types.boolean(MOTION, types.int32[:, ::1], WORD, types.float64), **INLINED)
def has_parents(motion, corners, vertex, gain):  # type: ignore[no-untyped-def]
    """Whether none of a vertex's cells is a newborn that has not yet gained so much, steps²."""
    for k in range(1, 4):
        point = corners[vertex, k]
        born = motion.born[point]
        growth = motion.growth[point] + motion.state[LEAST]
        if born != ALWAYS and growth * (motion.state[NOW] - born) < gain:
            return False
    return True


@njit(types.void(CUT, SHORTLIST, WORD, WORD, WORD), **INLINED)
def _consider(cut, shortlist, triangle, now, until):  # type: ignore[no-untyped-def]
    """List the hole of a triangle that is not listed if it may get above the bar."""
    vertex, state, said = cut.vertex_of[triangle], shortlist.state, shortlist.listed[triangle]
    if vertex >= 0 and (said == 0 or said > BARREN):
        size = max(size_at(cut.holes, vertex, now), size_at(cut.holes, vertex, until))
        if size > shortlist.bar[0]:
            shortlist.holes[state[LENGTH]] = triangle
            shortlist.listed[triangle] = max(said, LISTED)
            state[LENGTH] += 1


@linked(types.void(MESH, MOTION, CUT, SHORTLIST, types.float64, types.float64), **INTERNAL)
def list_holes(mesh, motion, cut, shortlist, share, gain):  # type: ignore[no-untyped-def]
    """List all holes anew that are or may get above a bar, so far between their mean and the
    largest one that has parents; with a share of 0, list all, and only for now.

    Newborns are parents after the gain in weight, steps².
    """
    listed, state, now = shortlist.listed, shortlist.state, motion.state[NOW]
    for place in range(state[LENGTH]):
        if listed[shortlist.holes[place]] == LISTED:
            listed[shortlist.holes[place]] = 0
    if cut.state[FRESH] == TOO_MANY:
        listed[:] = 0
    for place in range(cut.state[FRESH]):
        listed[cut.fresh[place]] = 0
    largest, total = -np.inf, 0.0
    for vertex in range(cut.state[VERTICES]):
        size, triangle = size_at(cut.holes, vertex, now), cut.corners[vertex, 0]
        total += size
        if listed[triangle] > BARREN and mesh.triangle_of[listed[triangle]] == NOTHING:
            listed[triangle] = 0
        if (
            size > largest
            and listed[triangle] == 0
            and has_parents(motion, cut.corners, vertex, gain)
        ):
            largest = size
    until = now
    if share > 0 and state[SEEN] != ALWAYS:
        until += HORIZON * (now - state[SEEN])
    mean = total / max(cut.state[VERTICES], 1)
    shortlist.bar[0] = mean + share * (largest - mean) if share > 0 else -np.inf
    cut.state[FRESH] = state[LENGTH] = 0
    for vertex in range(cut.state[VERTICES]):
        _consider(cut, shortlist, cut.corners[vertex, 0], now, until)
    state[SEEN], state[UNTIL] = now, until


@linked(types.boolean(MESH, MOTION, CUT, SHORTLIST), **INTERNAL)
def look_again(mesh, motion, cut, shortlist):  # type: ignore[no-untyped-def]
    """Whether the shortlist still holds: then what is new is on it, too."""
    holes, listed, state = shortlist.holes, shortlist.listed, shortlist.state
    now, kept = motion.state[NOW], 0
    if now > state[UNTIL] or cut.state[FRESH] == TOO_MANY:
        return False
    for place in range(cut.state[FRESH]):
        if listed[cut.fresh[place]] != LISTED:
            listed[cut.fresh[place]] = 0
    for place in range(state[LENGTH]):
        triangle = holes[place]
        if cut.vertex_of[triangle] < 0:
            listed[triangle] = 0
        elif listed[triangle] == LISTED or listed[triangle] > BARREN:
            if listed[triangle] > BARREN and mesh.triangle_of[listed[triangle]] == NOTHING:
                listed[triangle] = LISTED
            holes[kept] = triangle
            kept += 1
    state[LENGTH], state[SEEN] = kept, now
    for place in range(cut.state[FRESH]):
        _consider(cut, shortlist, cut.fresh[place], now, state[UNTIL])
    cut.state[FRESH] = 0
    return True
