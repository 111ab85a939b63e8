"""How much of the plane each bead covers alone, so that no more plastic is laid than has room.

What is nearer to one bead's line than to all others is that bead's own, up to half a bead from the
line. On either side of a point of the line this ends where a circle that touches the line there
meets another line: at their medial axis (Blum 1967).
"""

from __future__ import annotations

import math

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    BoolArray,
    ConstFloatArray,
    ConstIntArray,
    FloatArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.reach import within
from v3dcad.geometry.loops.segments import Segments, beside
from v3dcad.model import Floats, Ints

NEAR = 0.95
"""Lines nearer to each other than so many bead widths share room."""
TOUCHING = 1 - 1e-6
"""Bead widths: lines as far apart as they should be take no room from each other."""
ROUND = 1.6
"""Bead widths: so near along a stroke, a bead that only bends meets nothing."""
MITRE = math.tan(math.pi / 3)
"""A notch is filled as far as that of a turn by 120°."""
FLAT = 3.1
"""Turns, in radians, count as no larger."""
BACK = -0.2
"""The cosine between two beads of a stroke that run back rather than on."""
PIECE = 4.0
"""Bead widths: longer beads are looked at piece by piece."""
FEW = 2
"""Pieces: a bead of no more is looked at without asking first which of them others come near to."""
STEP = 0.5
"""Bead widths between two places at which room is measured."""
COUNTS = np.arange(math.ceil(PIECE / STEP) + 1)
ENDS = (1 - np.cos(np.pi * COUNTS / np.maximum(COUNTS, 1)[:, None])) / 2
"""Where places on a piece end, in shares of it: in row n those of n places. They are closer to each
other at the ends, where other beads come in."""


def covered(segments: Segments, stroke: Ints, width: float) -> Floats:
    """(n,) what share of its room each straight bead has to itself; 1 where none is near.

    Beads lie along `segments` and are `width` wide, mm; those of one `stroke` (n,) follow each
    other where ends meet. A bend to the left covers its inside twice and leaves a
    notch outside, which what is too much fills: it counts as even. To the right, where loops have
    their hollow, nothing closes the notch, and it is taken off.
    """
    if not len(stroke):
        return np.zeros(0)
    ax, ay, bx, by = segments.ends.T
    x, y = bx - ax, by - ay
    length = np.sqrt(x * x + y * y)
    passed = np.cumsum(length) - length
    bends = np.zeros(len(stroke) + 1)
    follows = (stroke[1:] == stroke[:-1]) & (ax[1:] == bx[:-1]) & (ay[1:] == by[:-1])
    run = np.concatenate([[0], np.cumsum(~follows)])
    u, v, x, y = x[1:], y[1:], x[:-1], y[:-1]
    bends[1:-1] = np.where(follows, np.arctan2(x * v - y * u, x * u + y * v), 0.0)

    kite = np.tan(np.minimum(np.abs(bends), FLAT) / 2)
    lost = kite - np.where(bends < 0, np.abs(bends) / 2, np.minimum(kite, MITRE))
    areas = length * width
    areas -= (lost[:-1] + lost[1:]) * width**2 / 8
    # Where a kite is longer than its bead, it is no kite.
    crowded = length < np.maximum(kite[:-1], kite[1:]) * width / 2
    _measure(
        segments,
        run,
        passed,
        length,
        bends,
        lost * width**2 / 8,
        crowded,
        width,
        np.full(len(length), -1),
        np.empty(len(length) + 1, np.int64),
        np.empty((len(length), 2)),
        np.empty((len(length), 2)),
        areas,
    )
    return np.asarray(np.clip(areas / np.maximum(length * width, 1e-12), 0.0, 1.0))


@compiled(INTERNAL)
def _room(
    x: float, y: float, nx: float, ny: float, ax: float, ay: float, bx: float, by: float
) -> float:
    """Radius of the circle that touches (x, y), its middle towards the unit (nx, ny), and a → b.

    The least of |q − p|² ÷ 2 (q − p) · n over the points q of the segment: along it a convex
    function, least where its derivative, a quadratic, is zero.
    """
    ux, uy, vx, vy = ax - x, ay - y, bx - ax, by - ay
    if max(ux * nx + uy * ny, (ux + vx) * nx + (uy + vy) * ny) < 1e-12:
        return math.inf  # it lies behind
    square, mixed, rest = vx * vx + vy * vy, ux * vx + uy * vy, ux * ux + uy * uy
    ahead, rise = ux * nx + uy * ny, vx * nx + vy * ny
    if abs(rise) < 1e-12:
        share = -mixed / max(square, 1e-300)
    else:
        root = square * square * ahead * ahead - square * rise * (2 * mixed * ahead - rise * rest)
        share = (math.sqrt(max(root, 0.0)) - square * ahead) / (square * rise)
    share = min(max(share, 0.0), 1.0)
    ahead += share * rise
    if ahead < 1e-12:
        return math.inf
    return (rest + share * (2 * mixed + share * square)) / (2 * ahead)


@compiled(INTERNAL)
def _meets(
    segments: Segments,
    run: ConstIntArray,
    passed: ConstFloatArray,
    length: ConstFloatArray,
    width: float,
    one: int,
    other: int,
) -> bool:
    """Whether two beads near each other share room: not those where a stroke only bends."""
    before, after = (one, other) if one < other else (other, one)
    ahead = passed[after] - passed[before] - length[before]
    if run[other] != run[one] or ahead >= ROUND * width:
        return True
    ends = segments.ends
    along = (ends[one, 2] - ends[one, 0]) * (ends[other, 2] - ends[other, 0])
    along += (ends[one, 3] - ends[one, 1]) * (ends[other, 3] - ends[other, 1])
    return ahead >= 1e-9 and along <= BACK * length[one] * length[other]


@compiled(UNCOUNTED)
def _measure(
    segments: Segments,
    run: ConstIntArray,
    passed: ConstFloatArray,
    length: ConstFloatArray,
    bends: ConstFloatArray,
    lost: ConstFloatArray,
    crowded: BoolArray,
    width: float,
    stamp: IntArray,
    near: IntArray,
    spans: FloatRows,
    contacts: FloatRows,
    areas: FloatArray,
) -> None:
    """The area that each bead has to itself where others come near, from places along it.

    `areas` come with what each has alone. At its bends, numbers `one` and `one` + 1, a bead has
    `lost` mm² of that; all beads that are `crowded` are measured, by places.
    """
    ends, half, visit = segments.ends, width / 2, 0
    for one in range(len(length)):
        if length[one] < 1e-9:
            continue
        along_x, along_y = ends[one, 2] - ends[one, 0], ends[one, 3] - ends[one, 1]
        ux, uy = along_x / length[one], along_y / length[one]
        # By pieces, so that few others are near; of long beads, those pieces that others come near
        # to. Most lines of a skin have none.
        pieces = math.ceil(length[one] / (PIECE * width))
        touching = 0
        asked = pieces > FEW and not crowded[one]
        if asked:
            ax, ay, bx, by = ends[one, 0], ends[one, 1], ends[one, 2], ends[one, 3]
            visit += 1
            for k in range(beside(segments, ax, ay, bx, by, width, stamp, visit, near)):
                other = near[k]
                if other == one or not _meets(segments, run, passed, length, width, one, other):
                    continue
                cx, cy, dx, dy = ends[other, 0], ends[other, 1], ends[other, 2], ends[other, 3]
                low, high = within(ax, ay, bx, by, cx, cy, dx, dy, NEAR * width)
                if low <= high:
                    contacts[touching, 0], contacts[touching, 1] = low, high
                    touching += 1
        places = min(math.ceil(length[one] / (pieces * STEP * width)), len(ENDS) - 1)
        for piece in range(pieces):
            low, high = piece / pieces, (piece + 1) / pieces
            alone = asked
            for k in range(touching):
                alone &= contacts[k, 0] > high or contacts[k, 1] < low
            if alone:
                continue
            ax, ay = ends[one, 0] + low * along_x, ends[one, 1] + low * along_y
            bx, by = ends[one, 0] + high * along_x, ends[one, 1] + high * along_y
            visit += 1
            found = beside(segments, ax, ay, bx, by, width, stamp, visit, near)
            shares = crowded[one]
            for k in range(found):
                if shares:
                    break
                other = near[k]
                if other == one or not _meets(segments, run, passed, length, width, one, other):
                    continue
                cx, cy, dx, dy = ends[other, 0], ends[other, 1], ends[other, 2], ends[other, 3]
                low, high = within(ax, ay, bx, by, cx, cy, dx, dy, NEAR * width)
                shares = low <= high
            if not shares:
                continue
            count = 0
            for k in range(found):
                other = near[k]
                if other == one:
                    continue
                cx, cy, dx, dy = ends[other, 0], ends[other, 1], ends[other, 2], ends[other, 3]
                low, high = within(ax, ay, bx, by, cx, cy, dx, dy, TOUCHING * width)
                if low <= high:
                    near[count] = other
                    spans[count, 0], spans[count, 1] = low, high
                    count += 1
            long = length[one] / pieces
            area = 0.0
            for place in range(places):
                from_, to = ENDS[places, place], ENDS[places, place + 1]
                share = (from_ + to) / 2
                x, y = ax + share * (bx - ax), ay + share * (by - ay)
                left, right = half, half
                for k in range(count):
                    if spans[k, 0] <= share <= spans[k, 1]:
                        other = near[k]
                        cx, cy = ends[other, 0], ends[other, 1]
                        dx, dy = ends[other, 2], ends[other, 3]
                        left = min(left, _room(x, y, -uy, ux, cx, cy, dx, dy))
                        right = min(right, _room(x, y, uy, -ux, cx, cy, dx, dy))
                area += (left + right) * (to - from_) * long
            room = long * width
            # The notch outside a bend, a fan of which either bead has one half.
            for end in range(2):
                if piece != (pieces - 1 if end else 0):
                    continue
                bend = bends[one + end]
                room -= lost[one + end]
                if bend == 0:
                    continue
                x, y = (bx, by) if end else (ax, ay)
                outward = -1.0 if bend > 0 else 1.0
                for ray in range(1, 4, 2):
                    angle = (bend if end else -bend) * ray / 8
                    sine, cosine = outward * math.sin(angle), outward * math.cos(angle)
                    nx, ny = -uy * cosine - ux * sine, ux * cosine - uy * sine
                    radius = half
                    for k in range(count):
                        if spans[k, 0] <= end <= spans[k, 1]:
                            other = near[k]
                            cx, cy = ends[other, 0], ends[other, 1]
                            dx, dy = ends[other, 2], ends[other, 3]
                            radius = min(radius, _room(x, y, nx, ny, cx, cy, dx, dy))
                    area += abs(bend) / 8 * radius * radius
            areas[one] += area - room
