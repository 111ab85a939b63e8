"""The wall between two sites: their bisector plane, cut by the bisectors with all others near.

One of the two sites is the origin. On the plane a wall is a convex polygon in two coordinates, and
every other site's bisector a half-plane that cuts it (Sutherland and Hodgman, "Reentrant polygon
clipping", Comm. ACM 1974).

**An empty polygon proves that there is no wall**, although floats are rounded. Half-planes are
loosened by `slack`. In exact numbers, the polygon would then hold the wall with all points within
slack / |offset| around it. A corner computed by interpolation is off the edge that it lies on, and
off its half-plane's side, by a few units in the last place of the polygon's size, and so is each
side of a half-plane that a corner is said to be on. A convex polygon whose corners are off by e
holds the true one less a rim of e; some hundred cuts, each off by 10⁻¹⁵ of the size, leave more
than nothing of a rim of `ROUNDING` of it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, FloatRows, IntArray
from v3dcad.geometry.compiled.options import ENTRY, INLINED, INTERNAL, compiled

ROUNDING = 1e-11
"""By which share of the square of the polygon's reach half-planes are loosened for a proof."""

OPEN = -1
"""The name of an edge that no site made: the polygon's size ends there."""


class Polygon(NamedTuple):
    """Room for one wall at a time; `wall` writes it."""

    frame: FloatRows
    """(3, 3) float64: the middle between the two sites, and two unit vectors in the plane"""
    corners: FloatRows
    """(c, 2) float64: the corners in the plane's coordinates, in order"""
    edges: IntArray
    """(c,) int64: which offset's bisector the edge from each corner to the next lies on"""
    kept_corners: FloatRows
    """(c, 2) float64: what a cut keeps of the corners"""
    kept_edges: IntArray
    """(c,) int64: what a cut keeps of the edges"""
    farthest: FloatArray
    """(1,) float64: the square of the greatest distance of a corner from the middle"""


def polygon_room(corners: int = 128) -> Polygon:
    """Room for polygons of up to so many corners."""
    return Polygon(
        np.empty((3, 3)),
        np.empty((corners, 2)),
        np.empty(corners, np.int64),
        np.empty((corners, 2)),
        np.empty(corners, np.int64),
        np.empty(1),
    )


@compiled(INTERNAL)
def lay_frame(offset: FloatArray, frame: FloatRows) -> None:
    """Write the middle between the origin and an offset, and unit vectors across it.

    Together with the offset they are right-handed: seen from the offset's end, the second lies
    counter-clockwise of the first.
    """
    x, y, z = offset[0], offset[1], offset[2]
    for axis in range(3):
        frame[0, axis] = offset[axis] / 2
    if abs(z) < abs(x):
        length = np.sqrt(x * x + y * y)
        frame[1, 0], frame[1, 1], frame[1, 2] = -y / length, x / length, 0.0
    else:
        length = np.sqrt(y * y + z * z)
        frame[1, 0], frame[1, 1], frame[1, 2] = 0.0, -z / length, y / length
    length = np.sqrt(x * x + y * y + z * z)
    a, b, c = frame[1, 0], frame[1, 1], frame[1, 2]
    frame[2, 0] = (y * c - z * b) / length
    frame[2, 1] = (z * a - x * c) / length
    frame[2, 2] = (x * b - y * a) / length


@compiled(INLINED)
def cut(polygon: Polygon, size: int, along: float, across: float, limit: float, name: int) -> int:
    """Cut a polygon of `size` corners by the half-plane along · u + across · v ≤ limit.

    The new edge gets a name. Returns the new number of corners, 0 where nothing is left.
    """
    corners, edges = polygon.corners, polygon.edges
    inside, outside = False, False
    for corner in range(size):
        if along * corners[corner, 0] + across * corners[corner, 1] > limit:
            outside = True
        else:
            inside = True
    # Where there is no room for more corners, the polygon stays larger than the wall.
    if not outside or 2 * size > len(edges):
        return size
    if not inside:
        return 0
    kept, kept_edges = polygon.kept_corners, polygon.kept_edges
    last, new_size = size - 1, 0
    before = along * corners[last, 0] + across * corners[last, 1] - limit
    for corner in range(size):
        after = along * corners[corner, 0] + across * corners[corner, 1] - limit
        if (before <= 0) != (after <= 0):
            share = before / (before - after)
            for axis in range(2):
                step = corners[corner, axis] - corners[last, axis]
                kept[new_size, axis] = corners[last, axis] + share * step
            kept_edges[new_size] = name if before <= 0 else edges[last]
            new_size += 1
        if after <= 0:
            kept[new_size, 0], kept[new_size, 1] = corners[corner, 0], corners[corner, 1]
            kept_edges[new_size] = edges[corner]
            new_size += 1
        last, before = corner, after
    farthest = 0.0
    for corner in range(new_size):
        u, v = kept[corner, 0], kept[corner, 1]
        corners[corner, 0], corners[corner, 1], edges[corner] = u, v, kept_edges[corner]
        farthest = max(farthest, u * u + v * v)
    polygon.farthest[0] = farthest
    return new_size


@compiled(INTERNAL)
def wall(
    offsets: FloatRows, count: int, other: int, reach: float, slack: float, polygon: Polygon
) -> int:
    """Cut the wall between the origin and site `other`, as far as `reach` from both.

    offsets (count, 3) are the sites' places; slack, in squared lengths, loosens every half-plane.
    Writes the polygon, counter-clockwise seen from `other`; returns its number of corners, 0 where
    there is no wall. What lies farther than `reach` away may have been left out.
    """
    to_x, to_y, to_z = offsets[other, 0], offsets[other, 1], offsets[other, 2]
    quarter = (to_x * to_x + to_y * to_y + to_z * to_z) / 4
    half = reach * reach - quarter
    if half <= 0:
        return 0
    half = np.sqrt(half)
    frame = polygon.frame
    lay_frame(offsets[other], frame)
    for corner in range(4):
        polygon.corners[corner, 0] = half if corner == 0 or corner == 3 else -half
        polygon.corners[corner, 1] = half if corner < 2 else -half
        polygon.edges[corner] = OPEN
    size = 4
    polygon.farthest[0] = 2 * half * half
    for site in range(count):
        x, y, z = offsets[site, 0], offsets[site, 1], offsets[site, 2]
        if site == other or x * x + y * y + z * z >= 4 * (quarter + polygon.farthest[0]):
            continue
        along = x * frame[1, 0] + y * frame[1, 1] + z * frame[1, 2]
        across = x * frame[2, 0] + y * frame[2, 1] + z * frame[2, 2]
        limit = (x * (x - to_x) + y * (y - to_y) + z * (z - to_z)) / 2 + slack
        size = cut(polygon, size, along, across, limit, site)
        if size == 0:
            break
    return size


@compiled(INTERNAL)
def cut_by_box(
    polygon: Polygon, size: int, at: FloatArray, low: FloatArray, high: FloatArray, slack: float
) -> int:
    """Cut a wall of the site at a place (3,) by the box low … high, loosened by slack, a length."""
    frame = polygon.frame
    for axis in range(3):
        middle = at[axis] + frame[0, axis]
        along, across = frame[1, axis], frame[2, axis]
        if size > 0:
            size = cut(polygon, size, along, across, high[axis] - middle + slack, OPEN)
        if size > 0:
            size = cut(polygon, size, -along, -across, middle - low[axis] + slack, OPEN)
    return size


@compiled(INTERNAL)
def in_space(polygon: Polygon, size: int, points: FloatRows) -> None:
    """Write the corners of a polygon as points (size, 3), seen from the origin site."""
    frame, corners = polygon.frame, polygon.corners
    for corner in range(size):
        for axis in range(3):
            points[corner, axis] = (
                frame[0, axis]
                + corners[corner, 0] * frame[1, axis]
                + corners[corner, 1] * frame[2, axis]
            )


@compiled(ENTRY)
def wall_in_space(
    offsets: FloatRows,
    other: int,
    reach: float,
    polygon: Polygon,
    points: FloatRows,
    beyond: IntArray,
) -> int:
    """The wall between the origin and site `other` among sites at offsets (n, 3).

    Writes its corners into points (c, 3), counter-clockwise seen from `other`, and which site is
    beyond the edge from each to the next into beyond (c,), `OPEN` where none is. Returns their
    number, 0 where there is no wall within `reach` of both sites.
    """
    size = wall(offsets, len(offsets), other, reach, 0.0, polygon)
    in_space(polygon, size, points)
    beyond[:size] = polygon.edges[:size]
    return size
