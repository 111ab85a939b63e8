"""Ribs: walls that grow out of a layer's walls into the cells beside them, along parallel lines.

Ribs lie on the lines y = pitch · j. On each of them loops leave open gaps. A rib grows from either
end of a gap towards its middle, no further from one layer to the next than there is something below
for it to rest on. A loop goes round it, half a bead spacing away on either side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    BoolRows,
    ConstFloatArray,
    ConstFloatRows,
    ConstIntArray,
    ConstIntRows,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.loops import Loops
from v3dcad.geometry.loops.strips import ENDS, Passes, Strips
from v3dcad.model import Floats, Ints, Value

MET = 1e-6
"""mm: tips that have met are two halves of a bead apart, but for rounding."""


@dataclass(frozen=True, eq=False, slots=True)
class Gaps(Value):
    """What is open on each line, from left to right, line by line."""

    line: Ints
    """(g,)"""
    ends: Floats
    """(g, 2) mm: x of begin and end, without ribs"""


@dataclass(frozen=True, eq=False, slots=True)
class Needs(Value):
    """What is to be held up, line by line."""

    line: Ints
    """(n,)"""
    ends: Floats
    """(n, 2) mm: x of begin and end"""
    above: Floats
    """(n,) mm: how far above the layer"""


@dataclass(frozen=True, eq=False, slots=True)
class Ribbed(Value):
    """A layer's loops with ribs."""

    loops: Loops
    gaps: Gaps
    ribs: Floats
    """(r, 2, 2) mm: the middle line of each rib, from its root to the end of the bead at its tip"""


def with_ribs(
    loops: Loops, strips: Strips, needs: Needs, below: Gaps | None, step: float, slope: float
) -> Ribbed:
    """Loops (those around holes clockwise) with ribs as long as needs ask for and as can be.

    A tip goes at most `step` (mm) into a gap `below`; without one, walls are taken to be there as
    they are here. For each mm that a layer lies under what a rib is to hold up, its tip may be
    `slope` mm short of it.
    """
    passes = Passes.of(loops, strips)
    sides, walls = passes.gaps()
    line = passes.line[sides[:, 0]]
    gaps = np.stack([passes.extent[sides[:, 0], 1], passes.extent[sides[:, 1], 0]], axis=1)
    under = Gaps(line, gaps) if below is None else below
    tips = gaps.copy()
    _grow(
        walls,
        _of_lines(needs.line, line),
        needs.ends,
        needs.above,
        _of_lines(under.line, line),
        under.ends,
        strips.half,
        step,
        slope,
        gaps,
        tips,
    )
    grown = tips != gaps
    own = sides[grown]
    root, tip = gaps[grown], tips[grown]
    along = np.broadcast_to(strips.pitch * line[:, None], tips.shape)[grown]
    end = tip + np.copysign(strips.half, tip - root)
    ribs = np.stack([np.stack([root, along], axis=1), np.stack([end, along], axis=1)], axis=1)
    order = np.lexsort((passes.edge[own, 0] + passes.share[own, 0], passes.loop[own]))
    around = _around(loops, strips, passes.taken(own[order]), tip[order])
    return Ribbed(around, Gaps(line, tips), ribs)


def _of_lines(sorted_lines: Ints, line: Ints) -> Ints:
    """(g, 2) where what lies on some lines begins and ends in a sorted list."""
    return np.stack([np.searchsorted(sorted_lines, line, side) for side in ("left", "right")], 1)


def _around(loops: Loops, strips: Strips, passes: Passes, tip: Floats) -> Loops:
    """Loops that go round ribs at some passes, in the loops' order, as far as `tip` (r,), mm."""
    points, first = np.empty((len(loops.points) + 4 * len(tip), 2)), np.empty_like(loops.first)
    count = len(loops.owner) + 1
    own = np.searchsorted(passes.loop, np.arange(count))
    _go_round(loops.points, loops.first, strips, passes, own, tip, points, first)
    return replace(loops, points=points[: first[-1]], first=first)


@compiled(UNCOUNTED)
def _grow(
    walls: BoolRows,
    needs: ConstIntRows,
    needed: ConstFloatRows,
    above: ConstFloatArray,
    unders: ConstIntRows,
    under: ConstFloatRows,
    half: float,
    step: float,
    slope: float,
    gaps: ConstFloatRows,
    tips: FloatRows,
) -> None:
    """How far ribs go into each gap, from either end that is a wall."""
    for k in range(len(gaps)):
        if needs[k, 0] == needs[k, 1]:
            continue
        begin, end = gaps[k, 0], gaps[k, 1]
        # The right half of a gap is the left half of its mirror image.
        for side in range(2):
            if not walls[k, side]:
                continue
            sign = 1.0 if side == 0 else -1.0
            root, far = (begin, end) if side == 0 else (-end, -begin)
            most, middle = _held(root, far, step, half, side, unders[k, 0], unders[k, 1], under)
            if not walls[k, 1 - side]:
                middle = far  # no rib comes from there
            wanted = -math.inf
            for n in range(needs[k, 0], needs[k, 1]):
                one, other = sign * needed[n, side], sign * needed[n, 1 - side]
                reach = min(other, middle)
                if reach >= max(one, root):
                    wanted = max(wanted, reach - slope * above[n])
            tip = min(wanted, min(middle, far) - half, most)
            if tip >= root + half:
                tips[k, side] = sign * tip


@compiled(INTERNAL)
def _held(
    root: float,
    far: float,
    step: float,
    least: float,
    side: int,
    first: int,
    last: int,
    under: ConstFloatRows,
) -> tuple[float, float]:
    """How far a rib may go from its root, and where it meets the one from the gap's `far` end.

    It may go a `step` into the first gap under it, of `first` … `last`, but `least` at least. They
    meet in the middle of what is open there. From the right (`side` 1), everything is mirrored.
    """
    sign = 1.0 if side == 0 else -1.0
    for number in range(last - first):
        k = first + number if side == 0 else last - 1 - number
        begin, end = sign * under[k, side], sign * under[k, 1 - side]
        if begin >= far:
            break
        if end <= root or end - begin <= 2 * max(step, least) + MET:
            continue
        most = max(begin + step, root + least) if begin + step >= root else -math.inf
        return most, (begin + end) / 2
    return math.inf, (root + far) / 2


@compiled(UNCOUNTED)
def _go_round(
    points: ConstFloatRows,
    first: ConstIntArray,
    strips: Strips,
    passes: Passes,
    own: ConstIntArray,
    tip: ConstFloatArray,
    found: FloatRows,
    begins: IntArray,
) -> None:
    """Write loops with four points in place of each of their passes."""
    size = 0
    begins[0] = 0
    for loop in range(len(first) - 1):
        low, high = first[loop], first[loop + 1]
        start, stop = own[loop], own[loop + 1]
        if start == stop:
            for k in range(low, high):
                found[size, 0], found[size, 1] = points[k, 0], points[k, 1]
                size += 1
        for r in range(start, stop):
            y = passes.line[r] * strips.pitch
            enter = y - strips.half if passes.kind[r] == ENDS else y + strips.half
            leave = 2 * y - enter
            found[size, 0], found[size, 1] = passes.side[r, 0], enter
            found[size + 1, 0], found[size + 1, 1] = tip[r], enter
            found[size + 2, 0], found[size + 2, 1] = tip[r], leave
            found[size + 3, 0], found[size + 3, 1] = passes.side[r, 1], leave
            size += 4
            following = r + 1 if r + 1 < stop else start
            here, there = passes.edge[r, 1], passes.edge[following, 0]
            between = (there - here) % (high - low)
            if between == 0 and passes.share[following, 0] < passes.share[r, 1]:
                between = high - low
            for number in range(between):
                k = low + (here - low + 1 + number) % (high - low)
                found[size, 0], found[size, 1] = points[k, 0], points[k, 1]
                size += 1
        begins[loop + 1] = size
