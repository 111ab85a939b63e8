"""Loops joined into closed curves: one curve for each connected group of loops.

Two loops that face each other are cut where they do, one bead spacing wide, and joined crosswise.
Along a spanning tree of the loops this makes one closed curve of them all. With the gap as wide as
the spacing, links add the length that the cuts take away: two pieces of one spacing each.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstIntArray,
    ConstIntRows,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled
from v3dcad.geometry.loops.facing import SLACK, facing
from v3dcad.geometry.loops.links import RESTED, Linked
from v3dcad.geometry.loops.loops import Loops
from v3dcad.model import Floats, Ints, Value

GOLDEN = (math.sqrt(5) - 1) / 2
ROOM = 0.5
"""Bead spacings between two cuts of a loop."""
LONG = 6.0
"""Bead spacings: a stretch longer than this is no better a place than one of this length."""
SNAP = 0.5
"""Bead spacings from an end of its wall within which a link goes on to lie at that end."""
LEAST_GAP = 0.6
"""A link is at least so many bead spacings wide."""
GRID = 1e-6
"""mm: nothing is shorter."""
OWNERS = 2**32
"""More than there are owners."""
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


def joined(loops: Loops, spacing: float, linked: Linked, shortest: float = 0.0) -> Curves:
    """The loops joined as far as they face each other, in one closed curve for each group.

    Kruskal's spanning forest: links as wide as the `spacing` (mm) first, those that stay where they
    are (`linked` remembers), then walls that have rested longest, then long ones. A new link lies
    at one end of its wall, where it takes the place of two corners, which costs the least time; at
    which end goes by the golden ratio from layer to layer, so that links seldom lie above others.
    Corners nearer than `shortest` (mm) to a cut are left out.
    """
    found = facing(loops, spacing)
    at, length = loops.positions()
    stretch = found.along[:, 1] - found.along[:, 0]
    middle = found.along.mean(axis=1)
    owners = np.sort(loops.owner[found.loops], axis=1)
    walls = owners[:, 0] * OWNERS + owners[:, 1]
    turn = linked.layer * GOLDEN % 1.0
    phase = (middle / length[found.loops[:, 0]] + turn) % 1.0
    rest, places = linked.known(walls)
    away = places - found.middle
    stays = ~np.isnan(away[:, 0])
    order = np.lexsort(
        (
            np.where(stays, (away**2).sum(axis=1), phase),
            np.where(stays, 0, -np.rint(np.minimum(stretch, LONG * spacing) / spacing * 8)),
            np.where(stays, -RESTED - 1, -rest),
            stretch < spacing,
        )
    )
    most = max(len(loops.owner) - 1, 0)
    cuts, link, middles = np.empty((2 * most, 2)), np.empty(most, np.int64), np.empty((most, 2))
    count = _choose(
        loops.points,
        loops.first,
        at,
        length,
        order,
        found.loops,
        found.along,
        found.beyond,
        middle + (away * found.ahead).sum(axis=1),
        spacing,
        turn,
        cuts,
        link,
        middles,
    )
    linked.note(walls[link[:count]], middles[:count])
    on = found.loops[link[:count]].ravel()
    return _walked(loops, at, length, on, cuts[: 2 * count], shortest)


def _walked(
    loops: Loops, at: Floats, length: Floats, on: Ints, cuts: Floats, shortest: float
) -> Curves:
    """The curves that loops cut at `cuts` (2 b, 2), mm along loops `on` (2 b,), are joined to."""
    order = np.lexsort((cuts[:, 0], on))
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    partner = place[order ^ 1]
    cut_first = np.searchsorted(on[order], np.arange(len(loops.owner) + 1))
    room = len(loops.points) + 2 * len(cuts)
    points, owner = np.empty((room, 2)), np.empty(room, np.int64)
    first = np.zeros(len(loops.owner) + 1, np.int64)
    count = _walk(
        loops.points,
        loops.first,
        loops.owner,
        at,
        length,
        on[order],
        cuts[order],
        partner,
        cut_first,
        max(shortest, GRID),
        points,
        owner,
        first,
    )
    size = first[count]
    return Curves(points[:size].copy(), first[: count + 1].copy(), owner[:size].copy())


@compiled(INTERNAL)
def _place(
    points: ConstFloatRows, low: int, high: int, at: ConstFloatArray, length: float, along: float
) -> tuple[float, float]:
    """The point `along` mm on the loop of points low … high; `along` may go round it."""
    along -= math.floor(along / length) * length
    first, last = low, high
    while last - first > 1:
        middle = (first + last) // 2
        if at[middle] <= along:
            first = middle
        else:
            last = middle
    after = first + 1 if first + 1 < high else low
    end = at[first + 1] if first + 1 < high else length
    span = end - at[first]
    share = (along - at[first]) / span if span > 0 else 0.0
    x = points[first, 0] + share * (points[after, 0] - points[first, 0])
    y = points[first, 1] + share * (points[after, 1] - points[first, 1])
    return x, y


@compiled(INTERNAL)
def _root(parent: IntArray, loop: int) -> int:
    while parent[loop] != loop:
        parent[loop] = parent[parent[loop]]
        loop = parent[loop]
    return loop


@compiled(INTERNAL)
def _free(
    loop: int,
    start: float,
    stop: float,
    length: float,
    room: float,
    latest: IntArray,
    earlier: IntArray,
    cuts: FloatRows,
) -> bool:
    """Whether a loop has no cut within `room` of start … stop."""
    if stop - start > length - room:
        return False
    cut = latest[loop]
    while cut >= 0:
        ahead = (cuts[cut, 0] - start) % length
        behind = (start - cuts[cut, 0]) % length
        if ahead < stop - start + room or behind < cuts[cut, 1] - cuts[cut, 0] + room:
            return False
        cut = earlier[cut]
    return True


@compiled(INTERNAL)
def _apart(
    points: ConstFloatRows,
    first: ConstIntArray,
    at: ConstFloatArray,
    length: ConstFloatArray,
    one: int,
    other: int,
    along: float,
    faced: float,
) -> float:
    """Distance of a place on one loop from a place on another."""
    x, y = _place(points, first[one], first[one + 1], at, length[one], along)
    u, v = _place(points, first[other], first[other + 1], at, length[other], faced)
    return math.sqrt((x - u) ** 2 + (y - v) ** 2)


@compiled(ENTRY)
def _choose(
    points: ConstFloatRows,
    first: ConstIntArray,
    at: ConstFloatArray,
    length: ConstFloatArray,
    order: ConstIntArray,
    loops: ConstIntRows,
    along: ConstFloatRows,
    beyond: ConstFloatArray,
    wanted: ConstFloatArray,
    spacing: float,
    turn: float,
    cuts: FloatRows,
    link: IntArray,
    middles: FloatRows,
) -> int:
    """Kruskal's forest: for each link its stretch in `link`, two rows of `cuts`, and its middle.

    Where on the first loop a link is `wanted`, mm along it, is tried first.
    """
    count = 0
    parent = np.arange(len(length))
    latest = np.full(len(length), -1)
    earlier = np.full(len(cuts), -1)
    room = ROOM * spacing
    end = 0.0 if turn < 0.5 else 1.0
    for k in order:
        one, other = loops[k, 0], loops[k, 1]
        if _root(parent, one) == _root(parent, other):
            continue
        low, high = along[k, 0], along[k, 1]
        done = False
        for narrow in range(2):
            gap = min(spacing, high - low) if narrow else spacing
            if done or gap < LEAST_GAP * spacing:
                continue
            slide = max(high - low - gap, 0.0)
            for trial in range(-1, 5):
                if trial >= 0:
                    share = (end, 1 - end, turn, 1 - turn, 0.5)[trial]
                elif math.isnan(wanted[k]):
                    continue
                else:
                    share = (wanted[k] - low - gap / 2) / max(slide, GRID)
                    if share * slide < SNAP * spacing:
                        share = 0.0
                    elif (1 - share) * slide < SNAP * spacing:
                        share = 1.0
                middle = low + gap / 2 + share * slide if slide > 0 else (low + high) / 2
                start, stop = middle - gap / 2, middle + gap / 2
                facing_start, facing_stop = beyond[k] - stop, beyond[k] - start
                near = _apart(points, first, at, length, one, other, start, facing_stop)
                far = _apart(points, first, at, length, one, other, stop, facing_start)
                if max(abs(near - spacing), abs(far - spacing)) > SLACK * spacing:
                    continue
                if not _free(one, start, stop, length[one], room, latest, earlier, cuts):
                    continue
                if not _free(
                    other, facing_start, facing_stop, length[other], room, latest, earlier, cuts
                ):
                    continue
                for side in range(2):
                    loop, cut = loops[k, side], 2 * count + side
                    begin = facing_start if side else start
                    begin -= math.floor(begin / length[loop]) * length[loop]
                    cuts[cut, 0], cuts[cut, 1] = begin, begin + gap
                    earlier[cut] = latest[loop]
                    latest[loop] = cut
                x, y = _place(points, first[one], first[one + 1], at, length[one], middle)
                middles[count, 0], middles[count, 1] = x, y
                link[count] = k
                count += 1
                parent[_root(parent, one)] = _root(parent, other)
                done = True
                break
    return count


@compiled(INTERNAL)
def _arc(
    points: ConstFloatRows,
    low: int,
    high: int,
    at: ConstFloatArray,
    length: float,
    start: float,
    stop: float,
    whose: int,
    shortest: float,
    out: FloatRows,
    owner: IntArray,
    size: int,
) -> int:
    """Write a loop's points from `start` to `stop`, mm along it; no corner near either."""
    start -= math.floor(start / length) * length
    stop -= math.floor((stop - start) / length) * length
    out[size, 0], out[size, 1] = _place(points, low, high, at, length, start)
    owner[size] = whose
    size += 1
    k = low
    while k < high and at[k] <= start:
        k += 1
    for _ in range(high - low):
        round_again = k >= high
        corner = k - (high - low) if round_again else k
        along = at[corner] + (length if round_again else 0.0)
        if along >= stop - shortest:
            break
        if along > start + shortest:
            out[size, 0], out[size, 1] = points[corner, 0], points[corner, 1]
            owner[size] = whose
            size += 1
        k += 1
    out[size, 0], out[size, 1] = _place(points, low, high, at, length, stop)
    owner[size] = LINK
    return size + 1


@compiled(ENTRY)
def _walk(
    points: ConstFloatRows,
    first: ConstIntArray,
    owners: ConstIntArray,
    at: ConstFloatArray,
    length: ConstFloatArray,
    on: ConstIntArray,
    cuts: ConstFloatRows,
    partner: ConstIntArray,
    cut_first: ConstIntArray,
    shortest: float,
    out: FloatRows,
    owner: IntArray,
    begins: IntArray,
) -> int:
    """From the end of a cut on to the next of its loop, and over to that one's partner."""
    curves, size = 0, 0
    seen = np.zeros(len(cuts), np.bool_)
    for loop in range(len(owners)):
        if cut_first[loop] == cut_first[loop + 1]:
            for k in range(first[loop], first[loop + 1]):
                out[size, 0], out[size, 1] = points[k, 0], points[k, 1]
                owner[size] = owners[loop]
                size += 1
            curves += 1
            begins[curves] = size
            continue
        if seen[cut_first[loop]]:
            continue
        cut = cut_first[loop]
        while not seen[cut]:
            seen[cut] = True
            here = on[cut]
            following = cut + 1 if cut + 1 < cut_first[here + 1] else cut_first[here]
            size = _arc(
                points, first[here], first[here + 1], at, length[here],
                cuts[cut, 1], cuts[following, 0], owners[here], shortest, out, owner, size,
            )  # fmt: skip
            cut = partner[following]
        curves += 1
        begins[curves] = size
    return curves
