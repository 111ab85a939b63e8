"""Where two loops may be joined: stretches on which they face each other a bead's spacing apart."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstIntArray,
    FloatArray,
    FloatRows,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.options import UNCOUNTED, compiled
from v3dcad.geometry.loops.loops import Loops, Measured
from v3dcad.geometry.loops.segments import Segments, beside
from v3dcad.model import Floats, Ints, Value

SLACK = 0.12
"""Facing loops are one bead spacing apart, but for this share of it."""
STRAIGHT = 0.98
"""The cosine of the angle between two segments that face each other, at least."""


@dataclass(frozen=True, eq=False, slots=True)
class Facing(Value):
    """Pairs of segments that face each other, running in opposite directions."""

    loops: Ints
    """(n, 2) the two loops, the lower one first"""
    along: Floats
    """(n, 2) mm along the first loop: where the stretch begins and ends"""
    beyond: Floats
    """(n,) mm along the second loop of what faces the first's 0, so that x faces beyond − x"""
    middle: Floats
    """(n, 2) mm: the middle of the stretch on the first loop"""
    ahead: Floats
    """(n, 2) the unit vector along it"""


def facing(loops: Loops, measured: Measured, spacing: float) -> Facing:
    """All stretches on which two loops face each other about one bead `spacing` (mm) apart."""
    room = 4 * len(loops.points)
    ends, loop = np.empty((len(loops.points), 4)), np.empty(len(loops.points), np.int64)
    _sides(measured, ends, loop)
    segments = Segments.along(ends, (1 + SLACK) * spacing)
    near = np.empty(len(loop) + 1, np.int64)
    while True:
        pairs, beyond = np.empty((room, 2), np.int64), np.empty(room)
        along, middle, ahead = np.empty((3, room, 2))
        count = _faced(
            segments,
            loop,
            measured.at,
            spacing,
            np.full(len(loop), -1),
            near,
            pairs,
            along,
            beyond,
            middle,
            ahead,
        )
        if count <= room:
            return Facing(
                pairs[:count], along[:count], beyond[:count], middle[:count], ahead[:count]
            )
        room = count


@compiled(UNCOUNTED)
def _sides(loops: Measured, ends: FloatRows, loop: IntArray) -> None:
    """Fill in the ends of the segments that loops are made of, and whose each is."""
    points = loops.points
    for one in range(len(loops.length)):
        low, high = loops.first[one], loops.first[one + 1]
        for k in range(low, high):
            after = k + 1 if k + 1 < high else low
            ends[k, 0], ends[k, 1] = points[k, 0], points[k, 1]
            ends[k, 2], ends[k, 3] = points[after, 0], points[after, 1]
            loop[k] = one


@compiled(UNCOUNTED)
def _faced(
    segments: Segments,
    loop: ConstIntArray,
    at: ConstFloatArray,
    spacing: float,
    stamp: IntArray,
    near: IntArray,
    pairs: IntRows,
    along: FloatRows,
    beyond: FloatArray,
    middles: FloatRows,
    ahead: FloatRows,
) -> int:
    """How many stretches there are; those that there is no room for are only counted."""
    count = 0
    ends, reach = segments.ends, (1 + SLACK) * spacing
    for one in range(len(loop)):
        ax, ay, bx, by = ends[one, 0], ends[one, 1], ends[one, 2], ends[one, 3]
        length = math.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
        if length < 1e-12:
            continue
        ux, uy = (bx - ax) / length, (by - ay) / length
        for k in range(beside(segments, ax, ay, bx, by, reach, stamp, one, near)):
            other = near[k]
            if loop[other] <= loop[one]:
                continue
            # The other, turned round, from where it ends on.
            cx, cy = ends[other, 0], ends[other, 1]
            dx, dy = cx - ends[other, 2], cy - ends[other, 3]
            long = math.sqrt(dx * dx + dy * dy)
            if ux * dx + uy * dy <= STRAIGHT * long:
                continue
            from_ = (ends[other, 2] - ax) * ux + (ends[other, 3] - ay) * uy
            to = from_ + ux * dx + uy * dy
            low, high = max(from_, 0.0), min(to, length)
            if high <= low + 1e-6:
                continue
            # At the middle of what faces: how far the other's line is, and where on it.
            middle = (low + high) / 2
            share = (to - middle) / (to - from_)
            across_x = cx - dx * share - ax - ux * middle
            across_y = cy - dy * share - ay - uy * middle
            apart = math.sqrt(across_x * across_x + across_y * across_y)
            if abs(apart - spacing) >= SLACK * spacing:
                continue
            if count < len(pairs):
                pairs[count, 0], pairs[count, 1] = loop[one], loop[other]
                along[count, 0], along[count, 1] = at[one] + low, at[one] + high
                beyond[count] = at[other] + share * long + at[one] + middle
                middles[count, 0], middles[count, 1] = ax + ux * middle, ay + uy * middle
                ahead[count, 0], ahead[count, 1] = ux, uy
            count += 1
    return count
