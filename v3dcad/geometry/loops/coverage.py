"""How much of the plane each bead covers alone, so that no more plastic is laid than has room.

What is nearer to one bead's line than to all others is that bead's own, up to half a bead from the
line (`own_room.py`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import ConstIntArray, FloatArray, FloatRows, IntArray
from v3dcad.geometry.compiled.options import INLINED, INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.corners import CORNER
from v3dcad.geometry.loops.own_room import Near, around, fan, own
from v3dcad.geometry.loops.reach import within
from v3dcad.geometry.loops.segments import Segments, beside
from v3dcad.model import Floats, Ints

NEAR = 0.95
"""Lines nearer to each other than so many bead widths share room."""
BRIEF, CLOSE = 1.5, 0.85
"""Bead widths: on so short a stretch at a corner, as at links, only those as near as that do."""
ROUND = 1.6
"""Bead widths: so near along a stroke, a bead that only bends meets nothing."""
MITRE = math.tan(math.pi / 3)
"""A notch is filled as far as that of a turn by 120°."""
FLAT = 3.1
"""Turns, in radians, count as no larger."""
BACK = -0.75
"""The cosine between two beads of a stroke that run back rather than on. In a half turn by eighths,
as at links, each only bends from the last."""
PIECE = 4.0
"""Bead widths: longer beads are looked at piece by piece."""
FEW = 2
"""Pieces: a bead of no more is looked at as a whole when it is asked which others are near."""
STEP = 0.5
"""Bead widths between two places at which room is measured."""
COUNTS = np.arange(math.ceil(PIECE / STEP) + 1)
ENDS = (1 - np.cos(np.pi * COUNTS / np.maximum(COUNTS, 1)[:, None])) / 2
"""Where places on a piece end, in shares of it: in row n those of n places. They are closer to each
other at the ends, where other beads come in."""


class Beads(NamedTuple):
    """Beads along segments, as their strokes go; at bend k one ends and bead k begins."""

    run: IntArray
    """(n,) the number of each one's stroke, where ends meet; another where they do not"""
    passed: FloatArray
    """(n,) mm of beads before each"""
    length: FloatArray
    """(n,) mm"""
    bends: FloatArray
    """(n + 1,) radians, to the left"""
    kites: FloatArray
    """(n + 1,) mm along either bead at a bend, on whose inside both lie in the same room"""
    lost: FloatArray
    """(n + 1,) mm² of each of the two beads that have no room there"""


def covered(segments: Segments, stroke: Ints, width: float) -> Floats:
    """(n,) what share of its room each straight bead has to itself; 1 where none is near.

    Beads lie along `segments` and are `width` wide, mm; those of one `stroke` (n,) follow each
    other where ends meet. A bend to the left covers its inside twice and leaves a
    notch outside, which what is too much fills: it counts as even. To the right, where loops have
    their hollow, nothing closes the notch, and it is taken off.
    """
    count = len(stroke)
    run, numbers = np.zeros(count, np.int64), np.empty((2, count + 1), np.int64)
    amounts, bends, rows = np.empty((3, count)), np.zeros((3, count + 1)), np.empty((2, count, 2))
    beads = Beads(run, *amounts[:2], *bends)
    near = Near(np.full(count, -1), numbers[0], rows[0], numbers[1], rows[1])
    _share(segments, stroke, width, beads, near, amounts[2])
    return amounts[2]


@compiled(INTERNAL)
def _follow(ends: FloatRows, stroke: ConstIntArray, width: float, beads: Beads) -> None:
    """Fill in how beads follow each other."""
    run, passed, length, bends, kites, lost = beads
    before = 0.0
    for one in range(len(stroke)):
        x, y = ends[one, 2] - ends[one, 0], ends[one, 3] - ends[one, 1]
        length[one] = math.sqrt(x * x + y * y)
        passed[one] = before
        before += length[one]
        if one == 0:
            continue
        last = one - 1
        meet = ends[last, 2] == ends[one, 0] and ends[last, 3] == ends[one, 1]
        if not meet or stroke[last] != stroke[one]:
            run[one] = run[last] + 1
            continue
        run[one] = run[last]
        u, v = ends[last, 2] - ends[last, 0], ends[last, 3] - ends[last, 1]
        bends[one] = math.atan2(u * y - v * x, u * x + v * y)
        kite = math.tan(min(abs(bends[one]), FLAT) / 2)
        notch = abs(bends[one]) / 2 if bends[one] < 0 else min(kite, MITRE)
        kites[one] = kite * width / 2
        lost[one] = (kite - notch) * width * width / 8


@compiled(INLINED)
def _meets(segments: Segments, beads: Beads, width: float, one: int, other: int) -> bool:
    """Whether two beads near each other share room: not those where a stroke only bends."""
    run, passed, length = beads.run, beads.passed, beads.length
    before, after = (one, other) if one < other else (other, one)
    ahead = passed[after] - passed[before] - length[before]
    if run[other] != run[one] or ahead >= ROUND * width:
        return True
    ends = segments.ends
    along = (ends[one, 2] - ends[one, 0]) * (ends[other, 2] - ends[other, 0])
    along += (ends[one, 3] - ends[one, 1]) * (ends[other, 3] - ends[other, 1])
    return ahead >= 1e-9 and along <= BACK * length[one] * length[other]


@compiled(INLINED)
def _contacts(
    segments: Segments, beads: Beads, width: float, near: Near, found: int, one: int, enough: int
) -> int:
    """On how many stretches others share the room of a bead, of those `found` that may be near.

    No more than `enough` are looked for.
    """
    ends, count = segments.ends, 0
    ax, ay, bx, by = ends[one, 0], ends[one, 1], ends[one, 2], ends[one, 3]
    begins, stops = abs(beads.bends[one]) > CORNER, abs(beads.bends[one + 1]) > CORNER
    for k in range(found):
        other = near.found[k]
        if count == enough:
            break
        if other == one or not _meets(segments, beads, width, one, other):
            continue
        low, high = within(ax, ay, bx, by, ends, other, NEAR * width)
        if low > high:
            continue
        at_corner = (low <= 0 and begins) or (high >= 1 and stops)
        if at_corner and (high - low) * beads.length[one] < BRIEF * width:
            closest, last = within(ax, ay, bx, by, ends, other, CLOSE * width)
            if closest > last:
                continue
        near.contacts[count, 0], near.contacts[count, 1] = low, high
        count += 1
    return count


@compiled(UNCOUNTED)
def _share(
    segments: Segments,
    stroke: ConstIntArray,
    width: float,
    beads: Beads,
    near: Near,
    shares: FloatArray,
) -> None:
    """The share of its room that each bead has to itself, from places along it where others are.

    Beads are looked at piece by piece, so that few others are near; most lines of a skin have
    none. Where a kite is longer than its bead, it is no kite, and all of the bead is looked at.
    """
    ends, half, visit = segments.ends, width / 2, 0
    _follow(ends, stroke, width, beads)
    for one in range(len(shares)):
        length = beads.length[one]
        whole = length * width
        area = whole - beads.lost[one] - beads.lost[one + 1]
        crowded = length < max(beads.kites[one], beads.kites[one + 1])
        ax, ay, bx, by = ends[one, 0], ends[one, 1], ends[one, 2], ends[one, 3]
        found = contacts = pieces = 0
        if length >= 1e-9:
            visit += 1
            found = beside(segments, ax, ay, bx, by, width, near.stamp, visit, near.found)
            pieces = math.ceil(length / (PIECE * width))
            enough = 0 if crowded else 1 if pieces == 1 else found
            contacts = _contacts(segments, beads, width, near, found, one, enough)
        if contacts == 0 and not crowded:
            pieces = 0
        for piece in range(pieces):
            low, high = piece / pieces, (piece + 1) / pieces
            alone = not crowded
            for k in range(contacts):
                alone &= near.contacts[k, 0] > high or near.contacts[k, 1] < low
            if alone:
                continue
            px, py = ax + low * (bx - ax), ay + low * (by - ay)
            qx, qy = ax + high * (bx - ax), ay + high * (by - ay)
            if pieces > FEW:
                visit += 1
                found = beside(segments, px, py, qx, qy, width, near.stamp, visit, near.found)
            count = around(segments, width, near, found, one, px, py, qx, qy)
            long = length / pieces
            ux, uy = (bx - ax) / length, (by - ay) / length
            places = min(math.ceil(long / (STEP * width)), len(ENDS) - 1)
            area -= long * width
            for place in range(places):
                from_, to = ENDS[places, place], ENDS[places, place + 1]
                share = (from_ + to) / 2
                x, y = px + share * (qx - px), py + share * (qy - py)
                left, right = own(segments, near, count, x, y, -uy, ux, share, half)
                area += (left + right) * (to - from_) * long
            for end in range(2):
                if piece == (pieces - 1 if end else 0):
                    bend, (x, y) = beads.bends[one + end], (qx, qy) if end else (px, py)
                    area += beads.lost[one + end]
                    if bend != 0:
                        area += fan(segments, near, count, x, y, ux, uy, bend, end, half)
        shares[one] = min(max(area / max(whole, 1e-12), 0.0), 1.0)
