"""Loops joined into closed curves: one curve for each connected group of loops.

Two loops that face each other are cut where they do, one bead spacing wide, and joined crosswise.
Along a spanning tree of the loops this makes one closed curve of them all. With the gap as wide as
the spacing, links add the length that the cuts take away: two pieces of one spacing each.
"""

from __future__ import annotations

import math

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstIntArray,
    ConstIntRows,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.curves import GRID, Curves, crossed
from v3dcad.geometry.loops.facing import SLACK, facing
from v3dcad.geometry.loops.links import RESTED, Linked
from v3dcad.geometry.loops.loops import Loops, Measured, place_on

GOLDEN = (math.sqrt(5) - 1) / 2
ROOM = 0.5
"""Bead spacings between two cuts of a loop."""
LONG = 6.0
"""Bead spacings: a stretch longer than this is no better a place than one of this length."""
SNAP = 0.5
"""Bead spacings from an end of its wall within which a link goes on to lie at that end."""
LEAST_GAP = 0.6
"""A link is at least so many bead spacings wide."""
TRIALS = 6
"""Places on a wall at which a link is tried."""
OWNERS = 2**32
"""More than there are owners."""


def joined(loops: Loops, spacing: float, linked: Linked, shortest: float = 0.0) -> Curves:
    """The loops joined as far as they face each other, in one closed curve for each group.

    Kruskal's spanning forest: links as wide as the `spacing` (mm) first, those that stay where they
    are (`linked` remembers), then walls that have rested longest, then long ones. A new link lies
    at one end of its wall, where it takes the place of two corners, which costs the least time; at
    which end goes by the golden ratio from layer to layer, so that links seldom lie above others.
    Corners nearer than `shortest` (mm) to a cut are left out.
    """
    measured = loops.measured()
    found = facing(loops, measured, spacing)
    stretch = found.along[:, 1] - found.along[:, 0]
    middle = (found.along[:, 0] + found.along[:, 1]) / 2
    one, other = loops.owner[found.loops].T
    walls = np.minimum(one, other) * OWNERS + np.maximum(one, other)
    turn = linked.layer * GOLDEN % 1.0
    phase = (middle / measured.length[found.loops[:, 0]] + turn) % 1.0
    rest, places, until = linked.known(walls)
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
        measured,
        order,
        found.loops,
        found.along,
        found.beyond,
        middle + (away * found.ahead).sum(axis=1),
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


@compiled(INTERNAL)
def _root(parent: IntArray, loop: int) -> int:
    while parent[loop] != loop:
        parent[loop] = parent[parent[loop]]
        loop = parent[loop]
    return loop


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
def _share(trial: int, wanted: float, slide: float, turn: float, spacing: float) -> float:
    """At which share of a wall's length a link is tried, where it can `slide` so far; NaN: not."""
    end = 0.0 if turn < 0.5 else 1.0
    if trial > 0:
        return (end, 1 - end, turn, 1 - turn, 0.5)[trial - 1]
    share = wanted / max(slide, GRID)
    if share * slide < SNAP * spacing:
        return 0.0
    if (1 - share) * slide < SNAP * spacing:
        return 1.0
    return share


@compiled(UNCOUNTED)
def _choose(
    loops: Measured,
    order: ConstIntArray,
    pairs: ConstIntRows,
    along: ConstFloatRows,
    beyond: ConstFloatArray,
    wanted: ConstFloatArray,
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

    Where on the first loop a link is `wanted`, mm along it, is tried first. `parent` has the trees
    so far, `latest` the last cut of each loop, `earlier` the one before each cut.
    """
    count, room, least = 0, ROOM * spacing, LEAST_GAP * spacing
    for k in order:
        one, other = pairs[k, 0], pairs[k, 1]
        if _root(parent, one) == _root(parent, other):
            continue
        low, high = along[k, 0], along[k, 1]
        for narrow in range(2):
            gap = min(spacing, high - low) if narrow else spacing
            slide, done = max(high - low - gap, 0.0), False
            for trial in range(TRIALS if gap >= least else 0):
                share = _share(trial, wanted[k] - low - gap / 2, slide, turn, spacing)
                if math.isnan(share):
                    continue
                middle = low + gap / 2 + share * slide if slide > 0 else (low + high) / 2
                start, stop = middle - gap / 2, middle + gap / 2
                faced_start, faced_stop = beyond[k] - stop, beyond[k] - start
                near = _apart(loops, one, other, start, faced_stop)
                far = _apart(loops, one, other, stop, faced_start)
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
            parent[_root(parent, one)] = _root(parent, other)
            break
    return count
