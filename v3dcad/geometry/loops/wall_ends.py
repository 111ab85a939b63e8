"""The two ends of each wall as places for a link: how far on its corners lie, and what it saves.

At the end of a wall a link from corner to corner takes the place of both, and the nozzle goes on
along the third cell. How much time that saves goes by how its direction changes: a printer slows
down at a corner by about the length of the change of its unit direction.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstIntRows,
    FloatRows,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.curves import GRID
from v3dcad.geometry.loops.facing import Facing
from v3dcad.geometry.loops.loops import Measured, place_on, point_before

BEYOND = 0.75
"""Bead spacings from the end of what faces within which both corners lie, if a link joins them."""


class WallEnds(NamedTuple):
    """What a link at the first and at the last end of each stretch comes to."""

    shift: FloatRows
    """(n, 4) mm along each loop from the stretch's end to the corner there: of the first loop and

    the second at the first end, of both at the last; 0 where a link does not go on to corners"""
    cost: FloatRows
    """(n, 2) how much more the nozzle's unit direction changes, in all, with a link at that end"""


def wall_ends(loops: Measured, found: Facing, spacing: float) -> WallEnds:
    """The ends of stretches on which loops face each other, one bead `spacing` (mm) apart."""
    shift, cost = np.zeros((len(found.loops), 4)), np.empty((len(found.loops), 2))
    _weigh(loops, found.loops, found.along, found.beyond, BEYOND * spacing, shift, cost)
    return WallEnds(shift, cost)


@compiled(INTERNAL)
def _direction(loops: Measured, loop: int, k: int) -> tuple[float, float]:
    """The unit vector from point k of a loop to the next; k may be one off either end."""
    first, last = loops.first[loop], loops.first[loop + 1]
    k = last - 1 if k < first else (first if k == last else k)
    after = k + 1 if k + 1 < last else first
    x = loops.points[after, 0] - loops.points[k, 0]
    y = loops.points[after, 1] - loops.points[k, 1]
    length = max(math.sqrt(x * x + y * y), 1e-12)
    return x / length, y / length


@compiled(INTERNAL)
def _change(one: tuple[float, float], other: tuple[float, float]) -> float:
    """How long the difference of two vectors is."""
    return math.sqrt((other[0] - one[0]) ** 2 + (other[1] - one[1]) ** 2)


@compiled(UNCOUNTED)
def _weigh(
    loops: Measured,
    pairs: ConstIntRows,
    along: ConstFloatRows,
    beyond: ConstFloatArray,
    reach: float,
    shift: FloatRows,
    cost: FloatRows,
) -> None:
    for k in range(len(pairs)):
        middle = (along[k, 0] + along[k, 1]) / 2
        for end in range(2):
            # One loop comes to the wall's end from the third cell, one goes from it on.
            come, go = pairs[k, end], pairs[k, 1 - end]
            comes_at, goes_at = along[k, 0], beyond[k] - along[k, 0]
            on_come, on_go = middle, beyond[k] - middle
            if end == 1:
                comes_at, goes_at = beyond[k] - along[k, 1], along[k, 1]
                on_come, on_go = beyond[k] - middle, middle
            begin, step = point_before(loops, come, on_come), point_before(loops, go, on_go)
            ends = step + 1 == loops.first[go + 1]
            back = comes_at - loops.at[begin]
            on = (loops.length[go] if ends else loops.at[step + 1]) - goes_at
            before, wall = _direction(loops, come, begin - 1), _direction(loops, come, begin)
            along_wall, after = _direction(loops, go, step), _direction(loops, go, step + 1)
            if (
                max(back, on) <= reach
                and before[0] * wall[1] > before[1] * wall[0]
                and along_wall[0] * after[1] > along_wall[1] * after[0]
            ):
                comes_at, goes_at = comes_at - back, goes_at + on
                shift[k, 3 * end] = -back
                shift[k, 1 + end] = on
            else:  # A loop that has no corner there goes straight on.
                before = wall if back > GRID else before
                after = along_wall if on > GRID else after
            x, y = place_on(loops, come, comes_at)
            u, v = place_on(loops, go, goes_at)
            long = max(math.sqrt((u - x) ** 2 + (v - y) ** 2), 1e-12)
            link = (u - x) / long, (v - y) / long
            cost[k, end] = (
                _change(before, link) + _change(link, after)
                - _change(before, wall) - _change(along_wall, after)
            )  # fmt: skip
