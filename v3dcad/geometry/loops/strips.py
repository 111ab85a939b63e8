"""Strips along parallel lines, and how loops pass them.

Line j is y = pitch · j; the strip around it reaches `half` to either side.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from v3dcad.geometry.compiled.arrays import (
    ConstFloatRows,
    ConstIntArray,
    FloatRows,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.loops import Loops
from v3dcad.model import Ints

BEGINS, TOUCHES, ENDS = 0, 1, 2
"""What a loop does at a line: a gap begins right of it; it comes and goes back; a gap ends."""
TIE = 1e-6
"""mm: a loop this far inside a strip's side lies beside it, as one around a skin that ends on a
line."""


class Strips(NamedTuple):
    """Where strips lie, mm."""

    pitch: float
    """between two lines"""
    half: float
    """between a line and either side of its strip"""


class Passes(NamedTuple):
    """Where loops pass strips."""

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
    def of(cls, loops: Loops, strips: Strips) -> Passes:
        """All of them, from left to right, line by line."""
        rise = np.abs(loops.points[loops.after(), 1] - loops.points[:, 1])
        most = int((rise / strips.pitch + 1).sum()) + len(loops.owner)
        line, loop, kind = np.empty((3, most), np.int64)
        edge, (share, side, extent) = np.empty((most, 2), np.int64), np.empty((3, most, 2))
        found = cls(line, loop, kind, edge, share, side, extent)
        count = _pass(loops.points, loops.first, strips, found)
        middle = extent[:count].sum(axis=1)
        return found.taken(np.lexsort((middle, line[:count])))

    def gaps(self) -> tuple[Ints, NDArray[np.bool_]]:
        """(g, 2) the passes on both sides of each gap; and at which of them a wall ends it.

        At the others a loop only pokes into the strip.
        """
        sides, walls = np.empty((2, len(self.line), 2), np.int64)
        count = _pair(self, sides, walls)
        return sides[:count], walls[:count] > 0

    def taken(self, which: Ints) -> Passes:
        """Some of them, in an order."""
        line, loop, kind, edge, share, side, extent = self
        return Passes(
            line[which],
            loop[which],
            kind[which],
            edge[which],
            share[which],
            side[which],
            extent[which],
        )


@compiled(INTERNAL)
def _side(y: float, line: float, half: float) -> int:
    """Where a point lies: below the strip around a line (−1), in it (0), above it (1)."""
    inner = half - TIE
    return 1 if y > line + inner else (-1 if y < line - inner else 0)


@compiled(UNCOUNTED)
def _pass(points: ConstFloatRows, first: ConstIntArray, strips: Strips, found: Passes) -> int:
    """Find how loops pass strips; tells how often they do."""
    count, half, pitch = 0, strips.half, strips.pitch
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
    found: Passes,
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
    points: ConstFloatRows, k: int, after: int, y: float, found: Passes, count: int, end: int
) -> float:
    """Note where the edge from a point to the next one meets the side of a strip; tells its x."""
    share = min(max((y - points[k, 1]) / (points[after, 1] - points[k, 1]), 0.0), 1.0)
    x = points[k, 0] + share * (points[after, 0] - points[k, 0])
    found.edge[count, end], found.share[count, end], found.side[count, end] = k, share, x
    return x


@compiled(UNCOUNTED)
def _pair(passes: Passes, sides: IntRows, walls: IntRows) -> int:
    """Fill in the passes, sorted along lines, between which gaps lie; tells how many gaps."""
    count, begun = 0, -1
    for k in range(len(passes.line)):
        if begun >= 0 and passes.line[begun] != passes.line[k]:
            begun = -1
        kind = passes.kind[k]
        if begun >= 0 and kind != BEGINS and passes.extent[begun, 1] < passes.extent[k, 0]:
            sides[count, 0], sides[count, 1] = begun, k
            walls[count, 0], walls[count, 1] = passes.kind[begun] == BEGINS, kind == ENDS
            count += 1
        if kind == BEGINS or (kind == TOUCHES and begun >= 0):
            begun = k
        elif kind == ENDS:
            begun = -1
    return count
