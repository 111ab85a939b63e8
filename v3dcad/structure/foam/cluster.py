"""One cluster of walls that lean too much, solved apart.

Only sites at such walls and those around them move; the cluster takes in what they spoil. Sites
that stay bad for long are kicked, with those around them. All work is that of sites that move.
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, IntArray
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled
from v3dcad.geometry.voronoi.bins import CROWDED
from v3dcad.geometry.voronoi.neighbours import nearest
from v3dcad.geometry.voronoi.wall import wall
from v3dcad.structure.foam.energy import (
    ACTIVE,
    CHECKED,
    TOUCHED,
    Foam,
    add_gradients,
    is_listed,
    look_around,
    touch,
)
from v3dcad.structure.foam.fire import FIRST_MIX, FIRST_STEP, descend, settle_in_bins
from v3dcad.structure.foam.random import random_share

AROUND = 24
"""How many of the nearest sites move along with a site at a bad wall, and are looked at again where
a site has moved. `check_all` finds what that misses."""

KICKED = 10
"""How many of the nearest sites are kicked along with a bad one."""

KICK = 0.26
"""In radii: how far at most, along each axis."""

PATIENCE = 100
"""For how many steps a site may stay bad before it is kicked."""

BESIDE = 1.5
"""In radii: how far beside the box whose walls count a site may have a wall in it."""

INNER = 5
"""Steps between two looks at which walls are bad."""


@compiled(INTERNAL)
def check(foam: Foam, site: int) -> None:
    """Put a site on the list of those whose walls may have changed."""
    if not foam.checked[site]:
        foam.checked[site] = True
        foam.checked_rows[foam.counts[CHECKED]] = site
        foam.counts[CHECKED] += 1


@compiled(INTERNAL)
def activate(foam: Foam, site: int) -> None:
    """Put a site on the list of those whose walls are looked at."""
    if not foam.active[site]:
        foam.active[site] = True
        foam.active_rows[foam.counts[ACTIVE]] = site
        foam.counts[ACTIVE] += 1


@compiled(INTERNAL)
def list_touched(foam: Foam) -> None:
    """Find the neighbours of touched sites anew."""
    wanted = foam.lists.shape[1]
    for index in range(foam.counts[TOUCHED]):
        site = foam.touched_rows[index]
        found = nearest(
            foam.bins,
            foam.places,
            foam.places[site],
            wanted + 1,
            foam.names,
            foam.offsets,
            foam.squares,
        )
        if found != CROWDED:
            for row in range(wanted):
                foam.lists[site, row] = foam.names[row + 1]


@compiled(INTERNAL)
def counts_at(foam: Foam, site: int) -> bool:
    """Whether a site is so near the box whose walls count that it may have a wall there."""
    reach = BESIDE * foam.radii[site]
    for axis in range(3):
        place = foam.places[site, axis]
        if place < foam.low[axis] - reach or place > foam.high[axis] + reach:
            return False
    return True


@compiled(INTERNAL)
def find_steep(foam: Foam, lean: float, slack: float) -> None:
    """Decide for all checked sites which have a wall that leans too much."""
    neighbours = foam.lists.shape[1]
    for index in range(foam.counts[CHECKED]):
        foam.steep[foam.checked_rows[index]] = False
    for index in range(foam.counts[CHECKED]):
        site = foam.checked_rows[index]
        near = counts_at(foam, site)
        look_around(foam, site)
        for row in range(neighbours):
            other = foam.lists[site, row]
            if foam.steep[site] and foam.steep[other]:
                continue
            x, y, z = foam.offsets[row, 0], foam.offsets[row, 1], foam.offsets[row, 2]
            if x * x + y * y >= lean * lean * z * z:
                continue
            if other < site and foam.checked[other] and is_listed(foam, site, other):
                continue
            if not near and not counts_at(foam, other):
                continue
            radius = min(foam.radii[site], foam.radii[other])
            reach = 4 * max(foam.radii[site], foam.radii[other])
            loose = slack * radius * radius
            if wall(foam.offsets, neighbours, row, reach, loose, foam.polygon) > 0:
                foam.steep[site] = True
                foam.steep[other] = True
    for index in range(foam.counts[CHECKED]):
        site = foam.checked_rows[index]
        if not foam.steep[site]:
            foam.ages[site] = 0


@compiled(INTERNAL)
def kick(foam: Foam, site: int) -> None:
    """Move a site at random, and let it rest; one that is held stays."""
    touch(foam, site)
    if site < foam.held:
        return
    for axis in range(3):
        way = KICK * foam.radii[site] * (2 * random_share(foam.random) - 1)
        foam.places[site, axis] += way
        foam.speeds[site, axis] = 0.0


@compiled(INTERNAL)
def is_near(foam: Foam, middle: FloatArray, site: int, reach: float) -> bool:
    """Whether a site is within a reach, in its radii, of the place middle (3,)."""
    periods, square = foam.bins.periods, 0.0
    for axis in range(3):
        offset = foam.places[site, axis] - middle[axis]
        if periods[axis] > 0:
            offset -= periods[axis] * np.floor(offset / periods[axis] + 0.5)
        square += offset * offset
    return bool(square <= (reach * foam.radii[site]) ** 2)


@compiled(INTERNAL)
def activate_steep(foam: Foam, middle: FloatArray, reach: float) -> None:
    """Make the checked sites at bad walls and those around them the active ones; kick the stuck.

    Only bad sites within a reach, in radii, of the place middle (3,) count.
    """
    for index in range(foam.counts[ACTIVE]):
        foam.active[foam.active_rows[index]] = False
    foam.counts[ACTIVE] = 0
    for index in range(foam.counts[CHECKED]):
        site = foam.checked_rows[index]
        if foam.steep[site] and is_near(foam, middle, site, reach):
            activate(foam, site)
            for row in range(AROUND):
                activate(foam, foam.lists[site, row])
    for index in range(foam.counts[TOUCHED]):
        site = foam.touched_rows[index]
        foam.touched[site] = False
        if not foam.active[site]:
            foam.speeds[site] = 0.0
    foam.counts[TOUCHED] = 0
    for index in range(foam.counts[ACTIVE]):
        touch(foam, foam.active_rows[index])
    for index in range(foam.counts[CHECKED]):
        site = foam.checked_rows[index]
        if foam.steep[site] and is_near(foam, middle, site, reach):
            foam.ages[site] += INNER
            if foam.ages[site] >= PATIENCE:
                foam.ages[site] = 0
                kick(foam, site)
                for row in range(KICKED):
                    kick(foam, foam.lists[site, row])


@compiled(ENTRY)
def solve_cluster(
    foam: Foam, homes: IntArray, seed: int, reach: float, lean: float, slack: float, budget: int
) -> int:
    """Relax the cluster of bad walls around a site, in `budget` steps at most.

    Returns how many sites have been moved how often, in all.
    """
    foam.counts[:] = 0
    check(foam, seed)
    middle = foam.places[seed].copy()
    pace = np.array([FIRST_STEP, FIRST_MIX, 0.0])
    work = 0
    for _ in range(0, budget, INNER):
        activate_steep(foam, middle, reach)
        if foam.counts[ACTIVE] == 0:
            break
        for _ in range(INNER):
            add_gradients(foam, lean, slack)
            descend(foam, pace)
        work += foam.counts[ACTIVE] * INNER
        settle_in_bins(foam, homes)
        list_touched(foam)
        for index in range(foam.counts[CHECKED]):
            foam.checked[foam.checked_rows[index]] = False
        foam.counts[CHECKED] = 0
        for index in range(foam.counts[TOUCHED]):
            site = foam.touched_rows[index]
            check(foam, site)
            for row in range(AROUND):
                check(foam, foam.lists[site, row])
        find_steep(foam, lean, slack)
    for index in range(foam.counts[CHECKED]):
        foam.checked[foam.checked_rows[index]] = False
    for index in range(foam.counts[ACTIVE]):
        foam.active[foam.active_rows[index]] = False
    for index in range(foam.counts[TOUCHED]):
        foam.touched[foam.touched_rows[index]] = False
        foam.speeds[foam.touched_rows[index]] = 0.0
    return work


@compiled(ENTRY)
def check_all(foam: Foam, lean: float, slack: float) -> None:
    """Find all neighbours anew, and all sites at bad walls."""
    foam.counts[:] = 0
    for site in range(len(foam.places)):
        touch(foam, site)
        check(foam, site)
    list_touched(foam)
    find_steep(foam, lean, slack)
    foam.touched[:] = False
    foam.checked[:] = False
