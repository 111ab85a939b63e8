"""Where two loops may be joined: stretches on which they face each other a bead's spacing apart."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstIntArray,
    FloatArray,
    FloatRows,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.geometry.loops.loops import Loops
from v3dcad.geometry.loops.segment_bins import bin_range, row_span, segment_bins
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


def facing(loops: Loops, spacing: float) -> Facing:
    """All stretches on which two loops face each other about one bead `spacing` (mm) apart."""
    room = 4 * len(loops.points)
    if not room:
        return Facing(np.empty((0, 2), np.int64), np.empty((0, 2)), np.empty(0))
    at, _ = loops.positions()
    end = loops.points[loops.after()]
    loop = np.repeat(np.arange(len(loops.owner)), np.diff(loops.first))
    bins = segment_bins(loops.points, end, (1 + SLACK) * spacing)
    while True:
        pairs, along, beyond = np.empty((room, 2), np.int64), np.empty((room, 2)), np.empty(room)
        count = _faced(loops.points, end, loop, at, *bins, spacing, pairs, along, beyond)
        if count <= room:
            return Facing(pairs[:count], along[:count], beyond[:count])
        room = count


@compiled(ENTRY)
def _faced(
    start: ConstFloatRows,
    stop: ConstFloatRows,
    loop: ConstIntArray,
    at: ConstFloatArray,
    frame: FloatArray,
    shape: IntArray,
    bin_first: IntArray,
    items: IntArray,
    spacing: float,
    pairs: IntRows,
    along: FloatRows,
    beyond: FloatArray,
) -> int:
    """How many stretches there are; those that there is no room for are only counted."""
    count = 0
    stamp = np.full(len(start), -1)
    side = frame[2]
    for one in range(len(start)):
        ax, ay, bx, by = start[one, 0], start[one, 1], stop[one, 0], stop[one, 1]
        length = math.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
        if length < 1e-12:
            continue
        ux, uy = (bx - ax) / length, (by - ay) / length
        below, above = bin_range(min(ay, by), max(ay, by), frame[1], side, shape[1])
        for row in range(below, above + 1):
            y = frame[1] + row * side
            left, right = row_span(ax, ay, bx, by, y, y + side)
            first, last = bin_range(left, right, frame[0], side, shape[0])
            for bin_ in range(row * shape[0] + first, row * shape[0] + last + 1):
                for k in range(bin_first[bin_], bin_first[bin_ + 1]):
                    other = items[k]
                    if loop[other] <= loop[one] or stamp[other] == one:
                        continue
                    stamp[other] = one
                    # The other, turned round, from where it ends on.
                    dx, dy = start[other, 0] - stop[other, 0], start[other, 1] - stop[other, 1]
                    long = math.sqrt(dx * dx + dy * dy)
                    if ux * dx + uy * dy <= STRAIGHT * long:
                        continue
                    from_ = (stop[other, 0] - ax) * ux + (stop[other, 1] - ay) * uy
                    to = from_ + ux * dx + uy * dy
                    low, high = max(from_, 0.0), min(to, length)
                    if high <= low + 1e-6:
                        continue
                    # At the middle of what faces: how far the other's line is, and where on it.
                    middle = (low + high) / 2
                    share = (to - middle) / (to - from_)
                    across_x = start[other, 0] - dx * share - ax - ux * middle
                    across_y = start[other, 1] - dy * share - ay - uy * middle
                    apart = math.sqrt(across_x * across_x + across_y * across_y)
                    if abs(apart - spacing) >= SLACK * spacing:
                        continue
                    if count < len(pairs):
                        pairs[count, 0], pairs[count, 1] = loop[one], loop[other]
                        along[count, 0], along[count, 1] = at[one] + low, at[one] + high
                        beyond[count] = at[other] + share * long + at[one] + middle
                    count += 1
    return count
