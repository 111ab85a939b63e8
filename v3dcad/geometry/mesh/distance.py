"""How far places are from triangles: by a tree of boxes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import ConstFloatRows, FloatArray, FloatRows, FloatStack
from v3dcad.geometry.compiled.options import ENTRY, INLINED, INTERNAL, compiled
from v3dcad.model import Floats, Ints

LEAF = 4
"""Triangles in a leaf of the tree."""

LEVELS = 40
"""More than a tree can have: each level has twice the boxes of the one above."""

BITS = 20
"""Of a coordinate, in the order along a Z-curve."""


class TriangleTree(NamedTuple):
    """Triangles in a complete binary tree of boxes: box 1 is around all, k around 2k and 2k + 1."""

    boxes: FloatStack
    """(2 · leaves, 2, 3) the lower and the upper corner of each box; box 0 is none"""
    triangles: FloatStack
    """(LEAF · leaves, 3, 3) corners, those of the first leaf first"""


def triangle_tree(corners: Floats) -> TriangleTree:
    """A tree of triangles (t, 3, 3), t > 0, in the order of a Z-curve.

    (Morton, "A computer oriented geodetic data base", IBM 1966.)
    """
    leaves = 1 << max(0, (-(-len(corners) // LEAF) - 1).bit_length())
    order = np.argsort(_along_z_curve(corners.mean(axis=1)), kind="stable")
    places = np.minimum(np.arange(LEAF * leaves), len(order) - 1)
    triangles = np.ascontiguousarray(corners[order[places]], dtype=np.float64)
    boxes = np.zeros((2 * leaves, 2, 3))
    in_leaves = triangles.reshape(leaves, LEAF * 3, 3)
    boxes[leaves:, 0], boxes[leaves:, 1] = in_leaves.min(axis=1), in_leaves.max(axis=1)
    level = leaves
    while level > 1:
        pairs = boxes[level : 2 * level].reshape(level // 2, 2, 2, 3)
        level //= 2
        boxes[level : 2 * level, 0] = pairs[:, :, 0].min(axis=1)
        boxes[level : 2 * level, 1] = pairs[:, :, 1].max(axis=1)
    return TriangleTree(boxes, triangles)


def _along_z_curve(points: Floats) -> Ints:
    """The numbers (n,) of points (n, 3) along a Z-curve through their box."""
    low, size = points.min(axis=0), np.ptp(points, axis=0).max()
    cells = ((points - low) / max(float(size), 1e-300) * (2**BITS - 1)).astype(np.int64)
    numbers = np.zeros(len(points), np.int64)
    for bit in range(BITS):
        for axis in range(3):
            numbers |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return numbers


@compiled(INLINED)
def _square_to_box(boxes: FloatStack, box: int, x: float, y: float, z: float) -> float:
    """The square of the distance from a place to a box, 0 within."""
    dx = max(boxes[box, 0, 0] - x, x - boxes[box, 1, 0], 0.0)
    dy = max(boxes[box, 0, 1] - y, y - boxes[box, 1, 1], 0.0)
    dz = max(boxes[box, 0, 2] - z, z - boxes[box, 1, 2], 0.0)
    return dx * dx + dy * dy + dz * dz


@compiled(INLINED)
def _dot(ax: float, ay: float, az: float, bx: float, by: float, bz: float) -> float:
    return ax * bx + ay * by + az * bz


@compiled(INTERNAL)
def _square_to_triangle(corners: FloatRows, x: float, y: float, z: float) -> float:
    """The square of the distance from a place to a triangle: from its plane, or from its sides.

    (Ericson, "Real-Time Collision Detection", 2005, section 5.1.)
    """
    ax, ay, az = corners[0, 0], corners[0, 1], corners[0, 2]
    bx, by, bz = corners[1, 0] - ax, corners[1, 1] - ay, corners[1, 2] - az
    cx, cy, cz = corners[2, 0] - ax, corners[2, 1] - ay, corners[2, 2] - az
    px, py, pz = x - ax, y - ay, z - az
    bp, cp = _dot(bx, by, bz, px, py, pz), _dot(cx, cy, cz, px, py, pz)
    bb, cc = _dot(bx, by, bz, bx, by, bz), _dot(cx, cy, cz, cx, cy, cz)
    bc = _dot(bx, by, bz, cx, cy, cz)
    # Shares of the corners b and c at the nearest place, each times `whole` where it lies within.
    whole = bb * cc - bc * bc
    b, c = cc * bp - bc * cp, bb * cp - bc * bp
    least = np.inf
    if b >= 0 and c >= 0 and b + c <= whole and whole > 0:
        b, c = b / whole, c / whole
        dx, dy, dz = px - b * bx - c * cx, py - b * by - c * cy, pz - b * bz - c * cz
        least = _dot(dx, dy, dz, dx, dy, dz)
    # The sides too: of a sliver, rounding may put the nearest place within anywhere along it.
    along_b = min(max(bp / bb, 0.0), 1.0) if bb > 0 else 0.0
    along_c = min(max(cp / cc, 0.0), 1.0) if cc > 0 else 0.0
    side = bb + cc - 2 * bc
    along = min(max((bb - bc + cp - bp) / side, 0.0), 1.0) if side > 0 else 0.0
    for edge in range(3):
        b = along_b if edge == 0 else (0.0 if edge == 1 else 1 - along)
        c = 0.0 if edge == 0 else (along_c if edge == 1 else along)
        dx, dy, dz = px - b * bx - c * cx, py - b * by - c * cy, pz - b * bz - c * cz
        least = min(least, _dot(dx, dy, dz, dx, dy, dz))
    return least


@compiled(ENTRY)
def distances(tree: TriangleTree, places: ConstFloatRows) -> FloatArray:
    """The distance from each place (n, 3) to the nearest triangle, mm."""
    boxes, leaves = tree.boxes, len(tree.boxes) // 2
    found = np.empty(len(places))
    waiting, squares = np.empty(LEVELS, np.int64), np.empty(LEVELS)
    for number in range(len(places)):
        x, y, z = places[number, 0], places[number, 1], places[number, 2]
        least = np.inf
        waiting[0], squares[0] = 1, _square_to_box(boxes, 1, x, y, z)
        count = 1
        while count:
            count -= 1
            box, square = waiting[count], squares[count]
            if square >= least:
                continue
            if box >= leaves:
                for triangle in range(LEAF * (box - leaves), LEAF * (box - leaves + 1)):
                    beside = _square_to_triangle(tree.triangles[triangle], x, y, z)
                    least = min(least, beside)
                continue
            near, far = 2 * box, 2 * box + 1
            to_near, to_far = (
                _square_to_box(boxes, near, x, y, z),
                _square_to_box(boxes, far, x, y, z),
            )
            if to_far < to_near:
                near, far, to_near, to_far = far, near, to_far, to_near
            waiting[count], squares[count] = far, to_far
            waiting[count + 1], squares[count + 1] = near, to_near
            count += 2
        found[number] = np.sqrt(least)
    return found
