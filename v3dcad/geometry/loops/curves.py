"""Loops cut at links and joined crosswise there: the closed curves that come of it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    BoolArray,
    ConstFloatRows,
    ConstIntArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.loops import Loops, Measured, place_on
from v3dcad.model import Floats, Ints, Value

GRID = 1e-6
"""mm: nothing is shorter."""
LINK = 2**62
"""The "owner" of a step that crosses from one loop to another."""


@dataclass(frozen=True, eq=False, slots=True)
class Curves(Value):
    """Closed curves."""

    points: Floats
    """(p, 2) mm; those of curve k are first[k] … first[k + 1]"""
    first: Ints
    """(c + 1,)"""
    owner: Ints
    """(p,) the owner of the loop that the step on from a point follows, or `LINK`"""


def crossed(loops: Loops, measured: Measured, on: Ints, cuts: Floats, shortest: float) -> Curves:
    """The curves that loops are joined to.

    Cut k goes from cuts[k, 0] to cuts[k, 1], mm along loop on[k]; cuts 2 k and 2 k + 1 are the two
    ends of a link. Corners nearer than `shortest` (mm) to a cut are left out.
    """
    begins = np.zeros(len(loops.owner) + 2, np.int64)
    order, place = np.empty((2, len(on)), np.int64)
    _sort(on, cuts, begins, order, place)
    room = len(loops.points) + 2 * len(cuts)
    points, owner = np.empty((room, 2)), np.empty(room, np.int64)
    first = np.zeros(len(loops.owner) + 1, np.int64)
    count = _walk(
        measured,
        loops.owner,
        on,
        cuts,
        begins,
        order,
        place,
        max(shortest, GRID),
        np.zeros(len(cuts), np.bool_),
        points,
        owner,
        first,
    )
    size = first[count]
    return Curves(points[:size].copy(), first[: count + 1].copy(), owner[:size].copy())


@compiled(UNCOUNTED)
def _sort(
    on: ConstIntArray, cuts: ConstFloatRows, begins: IntArray, order: IntArray, place: IntArray
) -> None:
    """Put the cuts of each loop in order, and fill in each one's `place` in that.

    Those of loop k come to be order[begins[k]] … order[begins[k + 1]]. `begins` comes as zeros, one
    more than there are ends of loops.
    """
    for cut in range(len(on)):
        begins[on[cut] + 2] += 1
    for loop in range(2, len(begins)):
        begins[loop] += begins[loop - 1]
    for cut in range(len(on)):
        order[begins[on[cut] + 1]] = cut
        begins[on[cut] + 1] += 1
    for k in range(len(on)):
        cut, here = order[k], k
        while here > begins[on[cut]] and cuts[order[here - 1], 0] > cuts[cut, 0]:
            order[here] = order[here - 1]
            here -= 1
        order[here] = cut
    for k in range(len(on)):
        place[order[k]] = k


@compiled(INTERNAL)
def _arc(
    loops: Measured,
    loop: int,
    start: float,
    stop: float,
    whose: int,
    shortest: float,
    out: FloatRows,
    owner: IntArray,
    size: int,
) -> int:
    """Write a loop's points from `start` to `stop`, mm along it; no corner near either."""
    low, high, length = loops.first[loop], loops.first[loop + 1], loops.length[loop]
    start -= math.floor(start / length) * length
    stop -= math.floor((stop - start) / length) * length
    out[size, 0], out[size, 1] = place_on(loops, loop, start)
    owner[size] = whose
    size += 1
    k = low
    while k < high and loops.at[k] <= start:
        k += 1
    for _ in range(high - low):
        round_again = k >= high
        corner = k - (high - low) if round_again else k
        along = loops.at[corner] + (length if round_again else 0.0)
        if along >= stop - shortest:
            break
        if along > start + shortest:
            out[size, 0], out[size, 1] = loops.points[corner, 0], loops.points[corner, 1]
            owner[size] = whose
            size += 1
        k += 1
    out[size, 0], out[size, 1] = place_on(loops, loop, stop)
    owner[size] = LINK
    return size + 1


@compiled(UNCOUNTED)
def _walk(
    loops: Measured,
    owners: ConstIntArray,
    on: ConstIntArray,
    cuts: ConstFloatRows,
    begins: ConstIntArray,
    order: ConstIntArray,
    place: ConstIntArray,
    shortest: float,
    seen: BoolArray,
    out: FloatRows,
    owner: IntArray,
    first: IntArray,
) -> int:
    """From the end of a cut on to the next of its loop, and over to that one's partner."""
    curves, size = 0, 0
    for loop in range(len(owners)):
        if begins[loop] == begins[loop + 1]:
            for k in range(loops.first[loop], loops.first[loop + 1]):
                out[size, 0], out[size, 1] = loops.points[k, 0], loops.points[k, 1]
                owner[size] = owners[loop]
                size += 1
            curves += 1
            first[curves] = size
            continue
        cut = order[begins[loop]]
        if seen[cut]:
            continue
        while not seen[cut]:
            seen[cut] = True
            here = on[cut]
            after = place[cut] + 1
            following = order[after if after < begins[here + 1] else begins[here]]
            size = _arc(
                loops, here, cuts[cut, 1], cuts[following, 0], owners[here], shortest,
                out, owner, size,
            )  # fmt: skip
            cut = following ^ 1
        curves += 1
        first[curves] = size
    return curves


@compiled(UNCOUNTED)
def nearest_step(
    points: ConstFloatRows, first: ConstIntArray, done: BoolArray, x: float, y: float
) -> tuple[int, float, float]:
    """Which step of closed curves that are not `done` (c,) comes nearest to (x, y), mm.

    Its number, which is that of the point (p, 2) that it begins at; the share of it that lies
    before the nearest place; and how far away that is, mm. Curve c has the points first[c] …
    first[c + 1]. -1 where all are done.
    """
    found, before, least = -1, 0.0, math.inf
    for curve in range(len(done)):
        if done[curve]:
            continue
        low, high = first[curve], first[curve + 1]
        for k in range(low, high):
            after = k + 1 if k + 1 < high else low
            dx, dy = points[after, 0] - points[k, 0], points[after, 1] - points[k, 1]
            ax, ay = x - points[k, 0], y - points[k, 1]
            share = (ax * dx + ay * dy) / max(dx * dx + dy * dy, 1e-300)
            share = min(max(share, 0.0), 1.0)
            ax, ay = ax - share * dx, ay - share * dy
            apart = ax * ax + ay * ay
            if apart < least:
                found, before, least = k, share, apart
    return found, before, math.sqrt(least)


@compiled(UNCOUNTED)
def opened(
    points: ConstFloatRows,
    owner: ConstIntArray,
    step: int,
    share: float,
    shortest: float,
    out: FloatRows,
    whose: IntArray,
) -> int:
    """Write a closed curve from a place on it round to it again; tells how many steps it has.

    The place is the `share` of a step (p,) that lies before it. A corner within `shortest` mm
    stands for it, so that no shorter step is made. `out` (p + 2, 2) gets the points, the first one
    again as the last, `whose` (p + 1,) the `owner` of each step.
    """
    count, size = len(points), 0
    after = step + 1 if step + 1 < count else 0
    dx, dy = points[after, 0] - points[step, 0], points[after, 1] - points[step, 1]
    x, y = points[step, 0] + share * dx, points[step, 1] + share * dy
    passed = math.sqrt((x - points[step, 0]) ** 2 + (y - points[step, 1]) ** 2)
    left = math.sqrt((x - points[after, 0]) ** 2 + (y - points[after, 1]) ** 2)
    begin = after
    if min(passed, left) >= shortest:  # the place is a corner of its own
        out[0, 0], out[0, 1], whose[0] = x, y, owner[step]
        size = 1
    elif passed <= left:
        begin = step
    for number in range(count):
        k = begin + number if begin + number < count else begin + number - count
        out[size, 0], out[size, 1], whose[size] = points[k, 0], points[k, 1], owner[k]
        size += 1
    out[size, 0], out[size, 1] = out[0, 0], out[0, 1]
    return size
