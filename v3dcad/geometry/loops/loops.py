"""Closed lines in one array."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatRows,
    ConstIntArray,
    FloatArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.model import Floats, Ints, Value


def following(first: Ints) -> Ints:
    """(p,) the number of the point after each of closed lines first[k] … first[k + 1]."""
    after = np.arange(1, first[-1] + 1)
    after[first[1:] - 1] = first[:-1]
    return after


class Measured(NamedTuple):
    """Closed lines, and how far along each its points lie."""

    points: ConstFloatRows
    """(p, 2) mm"""
    first: ConstIntArray
    """(l + 1,) the points of loop k are first[k] … first[k + 1]"""
    at: FloatArray
    """(p,) mm along its loop of each point"""
    length: FloatArray
    """(l,) mm"""


@dataclass(frozen=True, eq=False, slots=True)
class Loops(Value):
    """Closed lines that do not meet."""

    points: Floats
    """(p, 2) mm; those of loop k are first[k] … first[k + 1]"""
    first: Ints
    """(l + 1,)"""
    owner: Ints
    """(l,) whose each loop is"""

    @classmethod
    def of(cls, lines: list[Floats], owners: list[int]) -> Loops:
        """Loops by their rings (k, 2)."""
        return cls(
            np.concatenate([np.empty((0, 2)), *lines]),
            np.cumsum([0, *map(len, lines)]),
            np.array(owners, dtype=np.int64),
        )

    def ring(self, loop: int) -> Floats:
        """The points (k, 2) of one loop."""
        return self.points[self.first[loop] : self.first[loop + 1]]

    def after(self) -> Ints:
        """(p,) the number of the point after each, around its loop."""
        return following(self.first)

    def measured(self) -> Measured:
        """The loops with how far along each its points lie."""
        found = Measured(
            self.points, self.first, np.empty(len(self.points)), np.empty(len(self.owner))
        )
        _measure(found)
        return found

    def and_these(self, others: Loops) -> Loops:
        """These loops and, after them, others."""
        return Loops(
            np.concatenate([self.points, others.points]),
            np.concatenate([self.first, self.first[-1] + others.first[1:]]),
            np.concatenate([self.owner, others.owner]),
        )

    def thinned(self, shortest: float) -> Loops:
        """The loops without points nearer than `shortest` (mm) to the last; three of each stay."""
        points, first = np.empty_like(self.points), np.empty_like(self.first)
        _thin(self.points, self.first, shortest, points, first)
        return Loops(points[: first[-1]], first, self.owner)


@compiled(INTERNAL)
def point_before(loops: Measured, loop: int, along: float) -> int:
    """The number of the last point of a loop that lies not beyond `along` mm on it."""
    first, last = loops.first[loop], loops.first[loop + 1]
    while last - first > 1:
        middle = (first + last) // 2
        if loops.at[middle] <= along:
            first = middle
        else:
            last = middle
    return first


@compiled(INTERNAL)
def place_on(loops: Measured, loop: int, along: float) -> tuple[float, float]:
    """The point `along` mm on a loop; `along` may go round it."""
    length = loops.length[loop]
    along -= math.floor(along / length) * length
    first = point_before(loops, loop, along)
    ends = first + 1 == loops.first[loop + 1]
    after = loops.first[loop] if ends else first + 1
    span = (length if ends else loops.at[after]) - loops.at[first]
    share = (along - loops.at[first]) / span if span > 0 else 0.0
    points = loops.points
    x = points[first, 0] + share * (points[after, 0] - points[first, 0])
    y = points[first, 1] + share * (points[after, 1] - points[first, 1])
    return x, y


@compiled(UNCOUNTED)
def _measure(loops: Measured) -> None:
    points = loops.points
    for loop in range(len(loops.length)):
        low, high, passed = loops.first[loop], loops.first[loop + 1], 0.0
        for k in range(low, high):
            loops.at[k] = passed
            after = k + 1 if k + 1 < high else low
            x, y = points[after, 0] - points[k, 0], points[after, 1] - points[k, 1]
            passed += math.sqrt(x * x + y * y)
        loops.length[loop] = passed


@compiled(UNCOUNTED)
def _thin(
    points: ConstFloatRows, first: ConstIntArray, shortest: float, kept: FloatRows, begins: IntArray
) -> None:
    size = 0
    begins[0] = 0
    least = shortest * shortest
    for loop in range(len(first) - 1):
        start = size
        for k in range(first[loop], first[loop + 1]):
            x, y = points[k, 0], points[k, 1]
            if size > start:
                dx, dy = x - kept[size - 1, 0], y - kept[size - 1, 1]
                if dx * dx + dy * dy < least:
                    continue
            kept[size, 0], kept[size, 1] = x, y
            size += 1
        while size > start + 3:
            dx, dy = kept[start, 0] - kept[size - 1, 0], kept[start, 1] - kept[size - 1, 1]
            if dx * dx + dy * dy >= least:
                break
            size -= 1
        if size < start + 3:
            size = start
            for k in range(first[loop], first[loop + 1]):
                kept[size, 0], kept[size, 1] = points[k, 0], points[k, 1]
                size += 1
        begins[loop + 1] = size
