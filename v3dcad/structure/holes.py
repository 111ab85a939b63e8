"""Where newborns have most room, shortlisted: not all places need to be looked at in every layer.

A hole is an inner vertex of the diagram; its size is the area of the triangle of the sites around
it, in which a newborn would stand.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.clipping.interior import TOO_MANY, Cut
from v3dcad.geometry.compiled.arrays import FloatArray, Int32Array, Int32Rows, IntArray
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INLINED, INTERNAL, compiled
from v3dcad.geometry.power_diagram.predicates import orientation
from v3dcad.geometry.power_diagram.triangle_mesh import ABSENT, Triangulation

SHARE = 0.8
"""How far between the mean hole and the largest one the bar of a shortlist is."""

LISTED, BARREN = 1, 2
"""What `Shortlist.listed` says of a triangle: that it is on the list; that it has no newborn unless
it changes. A larger number is the point that its newborn would be too near to, while that lives."""


class Shortlist(NamedTuple):
    """All holes with room that are above a bar."""

    holes: Int32Array
    """(t,) int32: their triangles"""
    listed: Int32Array
    """(t,) int32: what there is to say of each triangle, or 0"""
    heap: IntArray
    """(t,) int64: room for the sizes of those that may get newborns next, largest first,"""
    places: Int32Array
    """(t,) int32: their triangles,"""
    parents: Int32Rows
    """(t, 3) int32: and the parents of the newborns"""
    bar: FloatArray
    """(1,) float64, steps²"""
    length: IntArray
    """(1,) int64: how many holes are listed"""


def no_shortlist(triangles: int) -> Shortlist:
    """A shortlist that has yet to be made, of up to so many triangles."""
    return Shortlist(
        np.empty(triangles, np.int32),
        np.zeros(triangles, np.int32),
        np.empty(triangles, np.int64),
        np.empty(triangles, np.int32),
        np.empty((triangles, 3), np.int32),
        np.full(1, np.inf),
        np.zeros(1, np.int64),
    )


@compiled(INLINED)
def size_of(mesh: Triangulation, triangle: int) -> int:
    """How large the hole of a triangle is: twice its area, steps²."""
    triangles = mesh.triangles
    a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
    return orientation(mesh.points, a, b, c)


@compiled(INLINED)
def _consider(mesh: Triangulation, cut: Cut, shortlist: Shortlist, triangle: int) -> None:
    """List the hole of a triangle that is not listed if it is above the bar."""
    said = shortlist.listed[triangle]
    lists = cut.vertex_of[triangle] >= 0 and (said == 0 or said > BARREN)
    if lists and size_of(mesh, triangle) > shortlist.bar[0]:
        shortlist.holes[shortlist.length[0]] = triangle
        shortlist.listed[triangle] = max(said, LISTED)
        shortlist.length[0] += 1


@linked(INTERNAL)
def list_holes(mesh: Triangulation, cut: Cut, shortlist: Shortlist, share: float) -> None:
    """List all holes anew that are above a bar, so far between their mean and the largest one that
    may have a newborn; with a share of 0, list all.
    """
    listed, length = shortlist.listed, shortlist.length
    for place in range(length[0]):
        if listed[shortlist.holes[place]] == LISTED:
            listed[shortlist.holes[place]] = 0
    if cut.state.fresh == TOO_MANY:
        listed[:] = 0
    for place in range(cut.state.fresh):
        listed[cut.fresh[place]] = 0
    largest, total = 0, 0.0
    for vertex in range(cut.state.vertices):
        triangle = cut.corners[vertex, 0]
        size = size_of(mesh, triangle)
        total += size
        if listed[triangle] > BARREN and mesh.triangle_of[listed[triangle]] == ABSENT:
            listed[triangle] = 0
        if listed[triangle] == 0:
            largest = max(largest, size)
    mean = total / max(cut.state.vertices, 1)
    shortlist.bar[0] = mean + share * (largest - mean) if share > 0 else -1.0
    cut.state.fresh = length[0] = 0
    for vertex in range(cut.state.vertices):
        _consider(mesh, cut, shortlist, cut.corners[vertex, 0])


@linked(INTERNAL)
def look_again(mesh: Triangulation, cut: Cut, shortlist: Shortlist) -> bool:
    """Whether the shortlist still holds: then what is new is on it, too."""
    holes, listed, length = shortlist.holes, shortlist.listed, shortlist.length
    kept = 0
    if cut.state.fresh == TOO_MANY:
        return False
    for place in range(cut.state.fresh):
        if listed[cut.fresh[place]] != LISTED:
            listed[cut.fresh[place]] = 0
    for place in range(length[0]):
        triangle = holes[place]
        if cut.vertex_of[triangle] < 0:
            listed[triangle] = 0
        elif listed[triangle] == LISTED or listed[triangle] > BARREN:
            if listed[triangle] > BARREN and mesh.triangle_of[listed[triangle]] == ABSENT:
                listed[triangle] = LISTED
            holes[kept] = triangle
            kept += 1
    length[0] = kept
    for place in range(cut.state.fresh):
        _consider(mesh, cut, shortlist, cut.fresh[place])
    cut.state.fresh = 0
    return True
