"""How much of the plane each bead covers alone, so that no more plastic is laid than has room.

What is nearer to one bead's line than to all others is that bead's own, up to half a bead from the
line. On either side of a point of the line this ends where a circle that touches the line there
meets another line: at their medial axis (Blum 1967).
"""

from __future__ import annotations

import math

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstIntArray,
    FloatArray,
    IntArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.segment_bins import bin_range, row_span, segment_bins
from v3dcad.model import Floats, Ints

NEAR = 0.95
"""Lines nearer to each other than so many bead widths share room."""
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
STEP = 0.5
"""Bead widths between two places at which room is measured."""


def covered(start: Floats, stop: Floats, stroke: Ints, width: float) -> Floats:
    """(n,) what share of its room each straight bead has to itself; 1 where none is near.

    Beads run from `start` (n, 2) to `stop` (n, 2), mm, and are `width` wide; those of one `stroke`
    (n,) follow each other where ends meet. A bend to the left covers its inside twice and leaves a
    notch outside, which what is too much fills: it counts as even. To the right, where loops have
    their hollow, nothing closes the notch, and it is taken off.
    """
    if not len(start):
        return np.zeros(0)
    steps = stop - start
    length = np.hypot(*steps.T)
    passed = np.cumsum(length) - length
    bends = np.zeros(len(start) + 1)
    follows = (stroke[1:] == stroke[:-1]) & (start[1:] == stop[:-1]).all(axis=1)
    run = np.concatenate([[0], np.cumsum(~follows)])
    (x, y), (u, v) = steps[:-1].T, steps[1:].T
    bends[1:-1] = np.where(follows, np.arctan2(x * v - y * u, x * u + y * v), 0.0)

    areas = length * width
    kite = np.tan(np.minimum(np.abs(bends), FLAT) / 2)
    lost = kite - np.where(bends < 0, np.abs(bends) / 2, np.minimum(kite, MITRE))
    areas -= (lost[:-1] + lost[1:]) * width**2 / 8
    # Where a kite is longer than its bead, it is no kite.
    crowded = (length < np.maximum(kite[:-1], kite[1:]) * width / 2).astype(np.int64)
    bins = segment_bins(start, stop, width)
    stamp, near = np.full(len(start), -1), np.empty(len(start), np.int64)
    _find_crowded(start, stop, run, passed, length, *bins, width, stamp, crowded)
    _measure(start, stop, bends, length, *bins, width, stamp, near, crowded, areas)
    return np.asarray(np.clip(areas / np.maximum(length * width, 1e-12), 0.0, 1.0))


@compiled(INTERNAL)
def _point_apart(x: float, y: float, ax: float, ay: float, bx: float, by: float) -> float:
    """The square of a point's distance from the segment a → b."""
    dx, dy = bx - ax, by - ay
    share = ((x - ax) * dx + (y - ay) * dy) / max(dx * dx + dy * dy, 1e-300)
    share = min(max(share, 0.0), 1.0)
    return (ax + share * dx - x) ** 2 + (ay + share * dy - y) ** 2


@compiled(INTERNAL)
def _apart(
    ax: float, ay: float, bx: float, by: float, cx: float, cy: float, dx: float, dy: float
) -> float:
    """The square of the distance of the segments a → b and c → d, which do not cross."""
    return min(
        _point_apart(cx, cy, ax, ay, bx, by),
        _point_apart(dx, dy, ax, ay, bx, by),
        _point_apart(ax, ay, cx, cy, dx, dy),
        _point_apart(bx, by, cx, cy, dx, dy),
    )


@compiled(INTERNAL)
def _room(
    x: float, y: float, nx: float, ny: float, ax: float, ay: float, bx: float, by: float
) -> float:
    """Radius of the circle that touches (x, y), its middle towards the unit (nx, ny), and a → b.

    The least of |q − p|² ÷ 2 (q − p) · n over the points q of the segment: along it a convex
    function, least where its derivative, a quadratic, is zero.
    """
    ux, uy, vx, vy = ax - x, ay - y, bx - ax, by - ay
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


@compiled(UNCOUNTED)
def _find_crowded(
    start: ConstFloatRows,
    stop: ConstFloatRows,
    run: ConstIntArray,
    passed: ConstFloatArray,
    length: ConstFloatArray,
    frame: FloatArray,
    shape: IntArray,
    bin_first: IntArray,
    items: IntArray,
    width: float,
    stamp: IntArray,
    crowded: IntArray,
) -> None:
    """Mark all beads that others come near to."""
    side, reach = frame[2], NEAR * width
    for one in range(len(start)):
        ax, ay, bx, by = start[one, 0], start[one, 1], stop[one, 0], stop[one, 1]
        west, east = min(ax, bx) - reach, max(ax, bx) + reach
        south, north = min(ay, by) - reach, max(ay, by) + reach
        below, above = bin_range(min(ay, by), max(ay, by), frame[1], side, shape[1])
        for row in range(below, above + 1):
            y = frame[1] + row * side
            left, right = row_span(ax, ay, bx, by, y, y + side)
            first, last = bin_range(left, right, frame[0], side, shape[0])
            for bin_ in range(row * shape[0] + first, row * shape[0] + last + 1):
                for k in range(bin_first[bin_], bin_first[bin_ + 1]):
                    other = items[k]
                    if other <= one or stamp[other] == one:
                        continue
                    stamp[other] = one
                    cx, cy = start[other, 0], start[other, 1]
                    dx, dy = stop[other, 0], stop[other, 1]
                    if max(cx, dx) < west or min(cx, dx) > east:
                        continue
                    if max(cy, dy) < south or min(cy, dy) > north:
                        continue
                    if _apart(ax, ay, bx, by, cx, cy, dx, dy) > reach * reach:
                        continue
                    # A bead that goes on, or bends no more than round, does not meet itself.
                    ahead = passed[other] - passed[one] - length[one]
                    if run[other] == run[one] and ahead < ROUND * width:
                        along = (bx - ax) * (dx - cx) + (by - ay) * (dy - cy)
                        if ahead < 1e-9 or along > BACK * length[one] * length[other]:
                            continue
                    crowded[one] = crowded[other] = 1


@compiled(UNCOUNTED)
def _measure(
    start: ConstFloatRows,
    stop: ConstFloatRows,
    bends: ConstFloatArray,
    length: ConstFloatArray,
    frame: FloatArray,
    shape: IntArray,
    bin_first: IntArray,
    items: IntArray,
    width: float,
    stamp: IntArray,
    near: IntArray,
    crowded: ConstIntArray,
    areas: FloatArray,
) -> None:
    """The area that each crowded bead has to itself, from places along it."""
    side, half = frame[2], width / 2
    visit = len(start)
    for one in range(len(start)):
        if not crowded[one] or length[one] < 1e-9:
            continue
        along_x, along_y = stop[one, 0] - start[one, 0], stop[one, 1] - start[one, 1]
        ux, uy = along_x / length[one], along_y / length[one]
        # By pieces, so that few others are near.
        pieces = math.ceil(length[one] / (PIECE * width))
        places = math.ceil(length[one] / (pieces * STEP * width))
        total, fans = 0.0, 0.0
        for piece in range(pieces):
            low, high = piece / pieces, (piece + 1) / pieces
            ax, ay = start[one, 0] + low * along_x, start[one, 1] + low * along_y
            bx, by = start[one, 0] + high * along_x, start[one, 1] + high * along_y
            found = 0
            visit += 1
            below, above = bin_range(min(ay, by), max(ay, by), frame[1], side, shape[1])
            for row in range(below, above + 1):
                y = frame[1] + row * side
                left, right = row_span(ax, ay, bx, by, y, y + side)
                first, last = bin_range(left, right, frame[0], side, shape[0])
                for bin_ in range(row * shape[0] + first, row * shape[0] + last + 1):
                    for k in range(bin_first[bin_], bin_first[bin_ + 1]):
                        other = items[k]
                        if other == one or stamp[other] == visit:
                            continue
                        stamp[other] = visit
                        near[found] = other
                        found += 1
            for place in range(places):
                # Close together at the ends, where others come in.
                from_ = (1 - math.cos(math.pi * place / places)) / 2
                to = (1 - math.cos(math.pi * (place + 1) / places)) / 2
                share = (from_ + to) / 2
                x, y = ax + share * (bx - ax), ay + share * (by - ay)
                left, right = half, half
                for k in range(found):
                    other = near[k]
                    cx, cy = start[other, 0], start[other, 1]
                    dx, dy = stop[other, 0], stop[other, 1]
                    left = min(left, _room(x, y, -uy, ux, cx, cy, dx, dy))
                    right = min(right, _room(x, y, uy, -ux, cx, cy, dx, dy))
                total += (left + right) * (to - from_)
            # The notch outside a bend, a fan of which either bead has one half.
            for end in range(2):
                bend = bends[one + end]
                if bend == 0 or piece != (pieces - 1 if end else 0):
                    continue
                x, y = (bx, by) if end else (ax, ay)
                outward = -1.0 if bend > 0 else 1.0
                for ray in range(1, 4, 2):
                    angle = (bend if end else -bend) * ray / 8
                    sine, cosine = outward * math.sin(angle), outward * math.cos(angle)
                    nx, ny = -uy * cosine - ux * sine, ux * cosine - uy * sine
                    radius = half
                    for k in range(found):
                        other = near[k]
                        cx, cy = start[other, 0], start[other, 1]
                        dx, dy = stop[other, 0], stop[other, 1]
                        radius = min(radius, _room(x, y, nx, ny, cx, cy, dx, dy))
                    fans += abs(bend) / 8 * radius * radius
        areas[one] = total * length[one] / pieces + fans
