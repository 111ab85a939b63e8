"""Ribs: walls that grow out of a layer's walls into the cells beside them, along parallel lines.

Ribs lie on the lines y = pitch · j. On each of them loops leave open gaps. A rib grows from either
end of a gap towards its middle, no further from one layer to the next than there is something below
for it to rest on. A loop goes round it, half a bead spacing away on either side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    BoolArray,
    ConstFloatArray,
    ConstFloatRows,
    ConstIntArray,
    ConstIntRows,
    FloatRows,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.loops import Loops
from v3dcad.model import Floats, Ints, Value

BEGINS, TOUCHES, ENDS = 0, 1, 2
"""What a loop does at a line: a gap begins right of it; it comes and goes back; a gap ends."""
ROWS = 0.5
"""mm between the places along a gap where it is found how wide it is across."""


class Lines(NamedTuple):
    """Where ribs lie, mm."""

    pitch: float
    """between two lines"""
    half: float
    """between a line and the loop around a rib"""
    span: float
    """between loops on either side of a line: where they are nearer, no rib is needed"""


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


class _Passes(NamedTuple):
    """Where loops pass the strips around lines."""

    line: IntArray
    loop: IntArray
    kind: IntArray
    """`BEGINS`, `TOUCHES` or `ENDS`"""
    edge: IntRows
    """(p, 2) the point after which the loop enters the strip, and that after which it leaves it"""
    share: FloatRows
    """(p, 2) the shares of these edges that lie before"""
    side: FloatRows
    """(p, 2) mm: x there"""
    extent: FloatRows
    """(p, 2) mm: least and greatest x in the strip"""

    @classmethod
    def of(cls, loops: Loops, lines: Lines) -> _Passes:
        """All of them, from left to right, line by line."""
        rise = np.abs(loops.points[loops.after(), 1] - loops.points[:, 1])
        most = int((rise / lines.pitch + 1).sum()) + len(loops.owner)
        line, loop, kind = np.empty((3, most), np.int64)
        edge, (share, side, extent) = np.empty((most, 2), np.int64), np.empty((3, most, 2))
        found = cls(line, loop, kind, edge, share, side, extent)
        count = _pass(loops.points, loops.first, lines, found)
        middle = extent[:count].sum(axis=1)
        return found.taken(np.lexsort((middle, line[:count])))

    def taken(self, which: Ints) -> _Passes:
        """Some of them, in an order."""
        line, loop, kind, edge, share, side, extent = self
        return _Passes(
            line[which],
            loop[which],
            kind[which],
            edge[which],
            share[which],
            side[which],
            extent[which],
        )


def with_ribs(
    loops: Loops, lines: Lines, needs: Needs, below: Gaps | None, step: float, slope: float
) -> Ribbed:
    """Loops (those around holes clockwise) with ribs as long as needs ask for and as can be.

    A tip goes at most `step` (mm) into a gap `below`; without one, walls are taken to be there as
    they are here. For each mm that a layer lies under what a rib is to hold up, its tip may be
    `slope` mm short of it.
    """
    passes = _Passes.of(loops, lines)
    count = len(passes.line)
    pair, free = np.empty((count, 2), np.int64), np.empty(count, np.bool_)
    size = _pair(passes, pair, free)
    pair, free = pair[:size], free[:size]
    line = passes.line[pair[:, 0]]
    gaps = np.stack([passes.extent[pair[:, 0], 1], passes.extent[pair[:, 1], 0]], axis=1)
    y = line * lines.pitch
    under = Gaps(line, gaps) if below is None else below
    tips = gaps.copy()
    _grow(
        loops.points,
        loops.first,
        passes.loop[pair[:, 0]],
        np.asarray(y, np.float64),
        free,
        _of_lines(needs.line, line),
        needs.ends,
        needs.above,
        _of_lines(under.line, line),
        under.ends,
        lines,
        step,
        slope,
        gaps,
        tips,
    )
    grown = tips != gaps
    own = pair[grown]
    root, tip = gaps[grown], tips[grown]
    along = np.broadcast_to(y[:, None], tips.shape)[grown]
    end = tip + np.copysign(lines.half, tip - root)
    ribs = np.stack([np.stack([root, along], axis=1), np.stack([end, along], axis=1)], axis=1)
    order = np.lexsort((passes.edge[own, 0] + passes.share[own, 0], passes.loop[own]))
    around = _around(loops, lines, passes.taken(own[order]), tip[order])
    return Ribbed(around, Gaps(line, tips), ribs)


def _of_lines(sorted_lines: Ints, line: Ints) -> Ints:
    """(g, 2) where what lies on some lines begins and ends in a sorted list."""
    return np.stack([np.searchsorted(sorted_lines, line, side) for side in ("left", "right")], 1)


def _around(loops: Loops, lines: Lines, passes: _Passes, tip: Floats) -> Loops:
    """Loops that go round ribs at some passes, in the loops' order, as far as `tip` (r,), mm."""
    points, first = np.empty((len(loops.points) + 4 * len(tip), 2)), np.empty_like(loops.first)
    count = len(loops.owner) + 1
    own = np.searchsorted(passes.loop, np.arange(count))
    _go_round(loops.points, loops.first, lines, passes, own, tip, points, first)
    return replace(loops, points=points[: first[-1]], first=first)


@compiled(INTERNAL)
def _side(y: float, line: float, half: float) -> int:
    """Where a point lies: below the strip around a line (−1), in it (0), above it (1)."""
    return 1 if y > line + half else (-1 if y < line - half else 0)


@compiled(UNCOUNTED)
def _pass(points: ConstFloatRows, first: ConstIntArray, lines: Lines, found: _Passes) -> int:
    """Find how loops pass strips; tells how often they do."""
    count, half, pitch = 0, lines.half, lines.pitch
    for loop in range(len(first) - 1):
        low, high = first[loop], first[loop + 1]
        bottom, top = math.inf, -math.inf
        for k in range(low, high):
            bottom, top = min(bottom, points[k, 1]), max(top, points[k, 1])
        for line in range(math.ceil((bottom - half) / pitch), math.floor((top + half) / pitch) + 1):
            count = _pass_line(points, low, high, loop, line, line * pitch, half, found, count)
    return count


@compiled(INTERNAL)
def _pass_line(
    points: ConstFloatRows,
    low: int,
    high: int,
    loop: int,
    line: int,
    y: float,
    half: float,
    found: _Passes,
    count: int,
) -> int:
    """One loop and one line: walk round from a point outside the strip, if there is any."""
    k = low
    while k < high - 1 and _side(points[k, 1], y, half) == 0:
        k += 1
    was, came = _side(points[k, 1], y, half), 0
    inside = was == 0
    if inside:
        found.extent[count, 0] = found.extent[count, 1] = points[k, 0]
    for _ in range(high - low):
        after = k + 1 if k + 1 < high else low
        now = _side(points[after, 1], y, half)
        if not inside and now != was:
            came, inside = was, True
            x = _met(points, k, after, y + came * half, found, count, 0)
            found.extent[count, 0] = found.extent[count, 1] = x
        if inside:
            x = points[after, 0]
            if now != 0:
                x = _met(points, k, after, y + now * half, found, count, 1)
            found.extent[count, 0] = min(found.extent[count, 0], x)
            found.extent[count, 1] = max(found.extent[count, 1], x)
        if inside and now != 0:
            found.line[count], found.loop[count] = line, loop
            found.kind[count] = TOUCHES if came == now else (ENDS if came < now else BEGINS)
            count += 1
            inside = False
        was, k = now, after
    if inside:  # all of the loop lies in the strip
        found.line[count], found.loop[count], found.kind[count] = line, loop, TOUCHES
        count += 1
    return count


@compiled(INTERNAL)
def _met(
    points: ConstFloatRows, k: int, after: int, y: float, found: _Passes, count: int, end: int
) -> float:
    """Note where the edge from a point to the next one meets the side of a strip; tells its x."""
    share = (y - points[k, 1]) / (points[after, 1] - points[k, 1])
    x = points[k, 0] + share * (points[after, 0] - points[k, 0])
    found.edge[count, end], found.share[count, end], found.side[count, end] = k, share, x
    return x


@compiled(UNCOUNTED)
def _pair(passes: _Passes, pair: IntRows, free: BoolArray) -> int:
    """The passes, sorted along lines, between which gaps lie; and whether these are free."""
    count, begun, clear = 0, -1, True
    for k in range(len(passes.line)):
        if begun >= 0 and passes.line[begun] != passes.line[k]:
            begun = -1
        if passes.kind[k] == BEGINS:
            begun, clear = k, True
        elif passes.kind[k] == TOUCHES:
            clear = False
        elif begun >= 0:
            if passes.extent[begun, 1] < passes.extent[k, 0]:
                pair[count, 0], pair[count, 1], free[count] = begun, k, clear
                count += 1
            begun = -1
    return count


@compiled(UNCOUNTED)
def _grow(
    points: ConstFloatRows,
    first: ConstIntArray,
    loop: ConstIntArray,
    line: ConstFloatArray,
    free: BoolArray,
    needs: ConstIntRows,
    needed: ConstFloatRows,
    above: ConstFloatArray,
    unders: ConstIntRows,
    under: ConstFloatRows,
    lines: Lines,
    step: float,
    slope: float,
    gaps: ConstFloatRows,
    tips: FloatRows,
) -> None:
    """How far ribs go into each gap, from either end."""
    for k in range(len(gaps)):
        if not free[k] or needs[k, 0] == needs[k, 1]:
            continue
        begin, end = gaps[k, 0], gaps[k, 1]
        low, high = _wide(
            points, first[loop[k]], first[loop[k] + 1], line[k], begin, end, lines.span
        )
        if low > high:
            continue
        # The right half of a gap is the left half of its mirror image.
        for side in range(2):
            sign = 1.0 if side == 0 else -1.0
            root, far = (begin, end) if side == 0 else (-end, -begin)
            near, wide = (low, high) if side == 0 else (-high, -low)
            most, middle = _held(
                root, far, step, lines.half, side, unders[k, 0], unders[k, 1], under
            )
            wanted = -math.inf
            for n in range(needs[k, 0], needs[k, 1]):
                one, other = sign * needed[n, side], sign * needed[n, 1 - side]
                reach = min(other, middle, wide)
                if reach >= max(one, root, near):
                    wanted = max(wanted, reach - slope * above[n])
            tip = min(wanted, middle - lines.half, most)
            if tip >= root + lines.half:
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
        if end <= root or end - begin <= 2 * step:
            continue
        most = max(begin + step, root + least) if begin + step >= root else -math.inf
        return most, (begin + end) / 2
    return math.inf, (root + far) / 2


@compiled(INTERNAL)
def _wide(
    points: ConstFloatRows, low: int, high: int, line: float, begin: float, end: float, span: float
) -> tuple[float, float]:
    """Where along a gap a loop's walls are further apart than `span` across it: from x to x."""
    rows = max(math.ceil((end - begin) / ROWS), 1)
    least, most = math.inf, -math.inf
    for row in range(rows):
        x = begin + (end - begin) * (row + 0.5) / rows
        under, over = -math.inf, math.inf
        for k in range(low, high):
            after = k + 1 if k + 1 < high else low
            if (points[k, 0] > x) == (points[after, 0] > x):
                continue
            share = (x - points[k, 0]) / (points[after, 0] - points[k, 0])
            y = points[k, 1] + share * (points[after, 1] - points[k, 1])
            if y <= line:
                under = max(under, y)
            else:
                over = min(over, y)
        if over - under > span:
            least, most = min(least, x), max(most, x)
    half = (end - begin) / rows / 2
    return least - half, most + half


@compiled(UNCOUNTED)
def _go_round(
    points: ConstFloatRows,
    first: ConstIntArray,
    lines: Lines,
    passes: _Passes,
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
            y = passes.line[r] * lines.pitch
            enter = y - lines.half if passes.kind[r] == ENDS else y + lines.half
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
