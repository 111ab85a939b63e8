"""Loops joined into closed curves: one curve for each connected group of loops.

Two loops that face each other are cut where they do, about one bead spacing wide, and joined
crosswise. Along a spanning tree of the loops this makes one closed curve of them all. Links are
hardly longer than what the cuts take away.
"""

from __future__ import annotations

import math

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    BoolArray,
    ConstFloatArray,
    ConstFloatRows,
    ConstIntArray,
    ConstIntRows,
    FloatArray,
    FloatRows,
    Int16Array,
    IntArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.curves import Curves, crossed
from v3dcad.geometry.loops.facing import SLACK, facing
from v3dcad.geometry.loops.links import RESTED, Linked
from v3dcad.geometry.loops.loops import Loops, Measured, place_on
from v3dcad.geometry.loops.union_find import root
from v3dcad.geometry.loops.wall_ends import wall_ends

GOLDEN = (math.sqrt(5) - 1) / 2
ROOM = 0.5
"""Bead spacings between two cuts of a loop."""
WIDE = 0.9
"""Bead spacings of a cut: somewhat less than one, so that less hangs over it where walls move."""
LEAST_GAP = 0.6
"""A link is at least so many bead spacings wide."""
TRIALS = 5
"""Places on a wall at which a link is tried."""
COSTS = 8
"""Links whose costs differ by less than one part in so many are as good as each other."""
DEAR = 1 + 8 * COSTS
"""More than costs can differ by."""
OWNERS = 2**32
"""More than there are owners."""


def joined(loops: Loops, spacing: float, linked: Linked, shortest: float = 0.0) -> Curves:
    """The loops joined as far as they face each other, in one closed curve for each group.

    Kruskal's spanning forest: walls longer than the `spacing` (mm) first, of these the ones whose
    link stays (`linked` remembers), then those that have rested; of these the ones where a link
    costs least. A link lies at an end of its wall and goes from corner to corner, whose place it
    takes; a new one at the end where that costs less, one that stays at the end where it is.
    Corners nearer than `shortest` (mm) to a cut are left out.
    """
    measured = loops.measured()
    found = facing(loops, measured, spacing)
    ends = wall_ends(measured, found, spacing)
    count = len(found.loops)
    walls, begins = np.empty(count, np.int64), np.empty(count, np.bool_)
    rank, last = np.empty(count, np.int16), np.empty(count)
    _name(loops.owner, found.loops, walls)
    rest, places, until = linked.known(walls)
    turn = linked.layer * GOLDEN % 1.0
    _rank(
        measured,
        found.loops,
        found.along,
        found.middle,
        found.ahead,
        ends.cost,
        rest,
        places,
        spacing,
        turn,
        begins,
        rank,
        last,
    )
    order = np.lexsort((last, rank))
    most = max(len(loops.owner) - 1, 0)
    cuts, link, middles = np.empty((2 * most, 2)), np.empty(most, np.int64), np.empty((most, 2))
    count = _choose(
        measured,
        order,
        found.loops,
        found.along,
        found.beyond,
        begins,
        ends.shift,
        spacing,
        turn,
        np.arange(len(loops.owner)),
        np.full(len(loops.owner), -1),
        np.full(2 * most, -1),
        cuts,
        link,
        middles,
    )
    link = link[:count]
    linked.note(walls[link], middles[:count], until[link])
    on = found.loops[link].ravel()
    return crossed(loops, measured, on, cuts[: 2 * count], shortest)


@compiled(UNCOUNTED)
def _name(owner: ConstIntArray, pairs: ConstIntRows, walls: IntArray) -> None:
    """Give each wall a number that it has on all layers, by the owners on both sides."""
    for k in range(len(pairs)):
        one, other = owner[pairs[k, 0]], owner[pairs[k, 1]]
        walls[k] = min(one, other) * OWNERS + max(one, other)


@compiled(UNCOUNTED)
def _rank(
    loops: Measured,
    pairs: ConstIntRows,
    along: ConstFloatRows,
    middle: ConstFloatRows,
    ahead: ConstFloatRows,
    cost: ConstFloatRows,
    rest: ConstIntArray,
    places: ConstFloatRows,
    spacing: float,
    turn: float,
    begins: BoolArray,
    rank: Int16Array,
    last: FloatArray,
) -> None:
    """In which order stretches are tried: by `rank`, and then by what is `last`.

    And whether each is tried first where its wall `begins`.
    """
    for k in range(len(pairs)):
        long = along[k, 1] - along[k, 0]
        x, y = places[k, 0] - middle[k, 0], places[k, 1] - middle[k, 1]
        if math.isnan(x):  # no link stays
            first, second = np.rint(cost[k, 0] * COSTS), np.rint(cost[k, 1] * COSTS)
            begins[k] = first < second
            rank[k] = DEAR * (1 + (rest[k] < RESTED)) + int(min(first, second))
            share = (along[k, 0] + along[k, 1]) / 2 / loops.length[pairs[k, 0]]
            last[k] = (share + turn) % 1.0
        else:
            begins[k] = x * ahead[k, 0] + y * ahead[k, 1] < 0
            rank[k] = 0
            last[k] = x * x + y * y
        if long < spacing:
            rank[k] += 3 * DEAR


@compiled(INTERNAL)
def _free(
    start: float,
    stop: float,
    length: float,
    room: float,
    latest: int,
    earlier: ConstIntArray,
    cuts: ConstFloatRows,
) -> bool:
    """Whether a loop has no cut within `room` of start … stop; `latest` is the last one made."""
    if stop - start > length - room:
        return False
    cut = latest
    while cut >= 0:
        ahead = (cuts[cut, 0] - start) % length
        behind = (start - cuts[cut, 0]) % length
        if ahead < stop - start + room or behind < cuts[cut, 1] - cuts[cut, 0] + room:
            return False
        cut = earlier[cut]
    return True


@compiled(INTERNAL)
def _apart(loops: Measured, one: int, other: int, along: float, faced: float) -> float:
    """Distance of a place on one loop from a place on another."""
    x, y = place_on(loops, one, along)
    u, v = place_on(loops, other, faced)
    return math.sqrt((x - u) ** 2 + (y - v) ** 2)


@compiled(INTERNAL)
def _share(trial: int, begins: bool, turn: float) -> float:
    """At which share of its wall's length a link is tried."""
    end = 0.0 if begins else 1.0
    return (end, 1 - end, turn, 1 - turn, 0.5)[trial]


@compiled(UNCOUNTED)
def _choose(
    loops: Measured,
    order: ConstIntArray,
    pairs: ConstIntRows,
    along: ConstFloatRows,
    beyond: ConstFloatArray,
    begins: BoolArray,
    shift: ConstFloatRows,
    spacing: float,
    turn: float,
    parent: IntArray,
    latest: IntArray,
    earlier: IntArray,
    cuts: FloatRows,
    link: IntArray,
    middles: FloatRows,
) -> int:
    """Kruskal's forest: for each link its stretch in `link`, two rows of `cuts`, and its middle.

    Whether a link is tried first where its wall `begins` is given; how far a cut at either end of a
    wall is moved, by `shift`. `parent` has the trees so far, `latest` the last cut of each loop,
    `earlier` the one before each cut.
    """
    count, room, least, wide = 0, ROOM * spacing, LEAST_GAP * spacing, WIDE * spacing
    for k in order:
        one, other = pairs[k, 0], pairs[k, 1]
        if root(parent, one) == root(parent, other):
            continue
        low, high = along[k, 0], along[k, 1]
        for narrow in range(2):
            gap = min(wide, high - low) if narrow else wide
            slide, done = max(high - low - gap, 0.0), False
            for trial in range(TRIALS if gap >= least else 0):
                share = _share(trial, begins[k], turn)
                middle = low + gap / 2 + share * slide if slide > 0 else (low + high) / 2
                start, stop = middle - gap / 2, middle + gap / 2
                faced_start, faced_stop = beyond[k] - stop, beyond[k] - start
                near = _apart(loops, one, other, start, faced_stop)
                far = _apart(loops, one, other, stop, faced_start)
                if share == 0 or share == 1:
                    end = 2 * int(share)
                    start, stop = start + shift[k, end], stop + shift[k, end]
                    faced_start += shift[k, end + 1]
                    faced_stop += shift[k, end + 1]
                done = (
                    max(abs(near - spacing), abs(far - spacing)) <= SLACK * spacing
                    and _free(start, stop, loops.length[one], room, latest[one], earlier, cuts)
                    and _free(
                        faced_start, faced_stop, loops.length[other], room, latest[other],
                        earlier, cuts,
                    )
                )  # fmt: skip
                if done:
                    break
            if not done:
                continue
            for side in range(2):
                loop, cut = pairs[k, side], 2 * count + side
                begin = faced_start if side else start
                begin -= math.floor(begin / loops.length[loop]) * loops.length[loop]
                cuts[cut, 0], cuts[cut, 1] = begin, begin + gap
                earlier[cut] = latest[loop]
                latest[loop] = cut
            middles[count, 0], middles[count, 1] = place_on(loops, one, middle)
            link[count] = k
            count += 1
            parent[root(parent, one)] = root(parent, other)
            break
    return count
