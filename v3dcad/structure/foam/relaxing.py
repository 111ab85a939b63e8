"""Sites moved until no wall leans too much.

Walls that lean too much stand in clusters, and each cluster is solved apart: its sites descend the
energy (`energy.py`) by FIRE (Bitzek et al., "Structural relaxation made simple", Phys. Rev. Lett.
2006) with a time step of their own; only sites at such walls and those around them move. A cluster
takes in what it spoils. Sites that stay bad for long are kicked, with those around them. τ is
lowered in steps, each solved to the end, since the way there from afar leads into knots.

The work is that of the sites that move, so that the time grows with the number of sites.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import count

import numpy as np
from numba import njit, types

from v3dcad.errors import GeometryError
from v3dcad.geometry.exact import COMPILED, INTERNAL, WORD
from v3dcad.geometry.voronoi.bins import (
    CROWDED,
    ROOM,
    bin_of,
    bins_of,
    homes_of,
    insert,
    remove,
)
from v3dcad.geometry.voronoi.neighbours import nearest
from v3dcad.geometry.voronoi.wall import polygon_room, wall
from v3dcad.geometry.walk import FLOAT, FLOATS, INTS
from v3dcad.model import Floats, Ints
from v3dcad.structure.foam.energy import (
    ACTIVE,
    CHECKED,
    FOAM,
    TOUCHED,
    Foam,
    add_gradients,
    look_around,
    touch,
)
from v3dcad.structure.foam.random import random_share

NEIGHBOURS = 56
"""How many of the nearest sites are looked at: all within 2.6 radii."""

AROUND = 24
"""How many of the nearest sites move along with a site at a bad wall."""

KICKED = 10
"""How many of the nearest sites are kicked along with a bad one."""

KICK = 0.26
"""In radii: how far at most, along each axis."""

PATIENCE = 100
"""For how many steps a site may stay bad before it is kicked."""

INNER = 5
"""Steps between two looks at which walls are bad."""

FIRST_STEP, LEAST_STEP, LARGEST_STEP = 0.05, 0.01, 0.3
"""The time steps of FIRE."""

FIRST_MIX, MIX_DECAY, CALM, FASTER, SLOWER = 0.1, 0.99, 5, 1.1, 0.5
"""FIRE's own constants: how much of the speed turns downhill, and how the time step changes."""

STRONGEST, LONGEST = 2.0, 0.08
"""The largest force, and the largest step in radii."""

MARGIN = 0.02
"""How much less than τ relaxed walls lean."""

TOGETHER = 300
"""Steps that all sites at bad walls take together at first, at each stage."""

APART = 200
"""Steps that a cluster takes before the next one has its turn."""

REACH = 3.0
"""In radii: how far from its first site a cluster is solved. What is farther is the next one's."""

STAGES = (2.0, 1.67, 1.5, 1.41, 1.35, 1.3, 1.25, 1.2, 1.15, 1.1)
"""The values of τ on the way down."""


@njit(types.void(FOAM, WORD), **INTERNAL)
def check(foam, site):  # type: ignore[no-untyped-def]
    """Put a site on the list of those whose walls may have changed."""
    if not foam.checked[site]:
        foam.checked[site] = True
        foam.checked_rows[foam.counts[CHECKED]] = site
        foam.counts[CHECKED] += 1


@njit(types.void(FOAM, WORD), **INTERNAL)
def activate(foam, site):  # type: ignore[no-untyped-def]
    """Put a site on the list of those whose walls are looked at."""
    if not foam.active[site]:
        foam.active[site] = True
        foam.active_rows[foam.counts[ACTIVE]] = site
        foam.counts[ACTIVE] += 1


@njit(types.void(FOAM), **INTERNAL)
def list_touched(foam):  # type: ignore[no-untyped-def]
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


@njit(types.void(FOAM, FLOAT, FLOAT), **INTERNAL)
def find_steep(foam, lean, slack):  # type: ignore[no-untyped-def]
    """Decide for all checked sites which have a wall that leans too much."""
    neighbours = foam.lists.shape[1]
    for index in range(foam.counts[CHECKED]):
        foam.steep[foam.checked_rows[index]] = False
    for index in range(foam.counts[CHECKED]):
        site = foam.checked_rows[index]
        radius = foam.radii[site]
        look_around(foam, site)
        for row in range(neighbours):
            other = foam.lists[site, row]
            if other < site and foam.checked[other]:
                continue
            if foam.steep[site] and foam.steep[other]:
                continue
            x, y, z = foam.offsets[row, 0], foam.offsets[row, 1], foam.offsets[row, 2]
            if x * x + y * y >= lean * lean * z * z:
                continue
            loose = slack * radius * radius
            if wall(foam.offsets, neighbours, row, 4 * radius, loose, foam.polygon) > 0:
                foam.steep[site] = True
                foam.steep[other] = True
    for index in range(foam.counts[CHECKED]):
        site = foam.checked_rows[index]
        if not foam.steep[site]:
            foam.ages[site] = 0


@njit(types.void(FOAM, WORD), **INTERNAL)
def kick(foam, site):  # type: ignore[no-untyped-def]
    """Move a site at random, and let it rest."""
    touch(foam, site)
    for axis in range(3):
        way = KICK * foam.radii[site] * (2 * random_share(foam.random) - 1)
        foam.places[site, axis] += way
        foam.speeds[site, axis] = 0.0


@njit(types.boolean(FOAM, FLOATS, WORD, FLOAT), **INTERNAL)
def is_near(foam, middle, site, reach):  # type: ignore[no-untyped-def]
    """Whether a site is within a reach, in its radii, of the place middle (3,)."""
    periods, square = foam.bins.periods, 0.0
    for axis in range(3):
        offset = foam.places[site, axis] - middle[axis]
        if periods[axis] > 0:
            offset -= periods[axis] * np.floor(offset / periods[axis] + 0.5)
        square += offset * offset
    return square <= (reach * foam.radii[site]) ** 2


@njit(types.void(FOAM, FLOATS, FLOAT), **INTERNAL)
def activate_steep(foam, middle, reach):  # type: ignore[no-untyped-def]
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


@njit(types.void(FOAM, FLOATS), **INTERNAL)
def descend(foam, pace):  # type: ignore[no-untyped-def]
    """One step of FIRE for all touched sites; pace (3,) holds time step, mix and calm steps."""
    gradients, speeds = foam.gradients, foam.speeds
    power, forces, motion = 0.0, 0.0, 0.0
    for index in range(foam.counts[TOUCHED]):
        site = foam.touched_rows[index]
        force = 0.0
        for axis in range(3):
            gradients[site, axis] *= -foam.radii[site]
            force += gradients[site, axis] ** 2
        if force > STRONGEST**2:
            for axis in range(3):
                gradients[site, axis] *= STRONGEST / np.sqrt(force)
        for axis in range(3):
            power += gradients[site, axis] * speeds[site, axis]
            forces += gradients[site, axis] ** 2
            motion += speeds[site, axis] ** 2
    keep, turn = 0.0, 0.0
    if power > 0:
        keep, turn = 1 - pace[1], pace[1] * np.sqrt(motion / forces)
        pace[2] += 1
        if pace[2] > CALM:
            pace[0] = min(pace[0] * FASTER, LARGEST_STEP)
            pace[1] *= MIX_DECAY
    else:
        pace[0], pace[1], pace[2] = max(pace[0] * SLOWER, LEAST_STEP), FIRST_MIX, 0
    for index in range(foam.counts[TOUCHED]):
        site = foam.touched_rows[index]
        length = 0.0
        for axis in range(3):
            force = gradients[site, axis]
            speeds[site, axis] = keep * speeds[site, axis] + (turn + pace[0]) * force
            length += speeds[site, axis] ** 2
            gradients[site, axis] = 0.0
        length = pace[0] * np.sqrt(length)
        step = pace[0] * foam.radii[site] * min(1.0, LONGEST / max(length, 1e-300))
        for axis in range(3):
            foam.places[site, axis] += step * speeds[site, axis]


@njit(types.void(FOAM, INTS), **INTERNAL)
def settle_in_bins(foam, homes):  # type: ignore[no-untyped-def]
    """Bring touched sites back into the periods and into their bins; homes (n,) are these."""
    periods, low = foam.bins.periods, foam.bins.low
    for index in range(foam.counts[TOUCHED]):
        site = foam.touched_rows[index]
        for axis in range(3):
            if periods[axis] > 0:
                place = foam.places[site, axis] - low[axis]
                place -= periods[axis] * np.floor(place / periods[axis])
                foam.places[site, axis] = low[axis] + (place if place < periods[axis] else 0.0)
        x, y, z = foam.places[site, 0], foam.places[site, 1], foam.places[site, 2]
        home = bin_of(foam.bins, x, y, z)
        if home != homes[site]:
            remove(foam.bins, site, homes[site])
            insert(foam.bins, site, home)
            homes[site] = home


@njit(WORD(FOAM, INTS, WORD, FLOAT, FLOAT, FLOAT, WORD), **COMPILED)
def solve_cluster(foam, homes, seed, reach, lean, slack, budget):  # type: ignore[no-untyped-def]
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
            for row in range(foam.lists.shape[1]):
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


@njit(types.void(FOAM, FLOAT, FLOAT), **COMPILED)
def check_all(foam, lean, slack):  # type: ignore[no-untyped-def]
    """Find all neighbours anew, and all sites at bad walls."""
    foam.counts[:] = 0
    for site in range(len(foam.places)):
        touch(foam, site)
        check(foam, site)
    list_touched(foam)
    find_steep(foam, lean, slack)
    foam.touched[:] = False
    foam.checked[:] = False


def foam_of(places: Floats, radii: Floats, box: Floats, random_seed: int) -> tuple[Foam, Ints]:
    """Sites (n, 3) in a periodic box (3,), ready to be relaxed, and the bins that they are in."""
    sites = len(places)
    neighbours = min(NEIGHBOURS, sites - 1)
    bins = bins_of(places, np.zeros(3), box, periodic=True)
    foam = Foam(
        bins=bins,
        places=places.copy(),
        radii=radii,
        lists=np.zeros((sites, neighbours), np.int64),
        steep=np.zeros(sites, np.bool_),
        ages=np.zeros(sites, np.int64),
        speeds=np.zeros((sites, 3)),
        gradients=np.zeros((sites, 3)),
        active=np.zeros(sites, np.bool_),
        touched=np.zeros(sites, np.bool_),
        checked=np.zeros(sites, np.bool_),
        active_rows=np.empty(sites, np.int64),
        touched_rows=np.empty(sites, np.int64),
        checked_rows=np.empty(sites, np.int64),
        counts=np.zeros(3, np.int64),
        names=np.empty(ROOM, np.int64),
        offsets=np.empty((ROOM, 3)),
        squares=np.empty(ROOM),
        polygon=polygon_room(),
        points=np.empty((len(polygon_room().edges), 3)),
        pulls=np.empty((len(polygon_room().edges), 3)),
        random=np.array([random_seed], np.uint64),
    )
    return foam, homes_of(bins, foam.places)


def relax(
    places: Floats,
    radii: Floats,
    box: Floats,
    tau: float,
    *,
    stages: tuple[float, ...] = STAGES,
    slack: float = 0.0,
    random_seed: int = 0,
    effort: int = 20_000,
    progress: Callable[[float, int], object] = lambda stage, bad: None,
) -> Floats:
    """Sites (n, 3) in a periodic box (3,) moved until no wall leans more than τ allows.

    Sites keep a distance of about their radii (n,). Walls count that would be there with
    bisectors `slack` squared radii looser, so that sites can still be rounded. `progress` gets the
    stage's τ and how many sites are at bad walls. Deterministic; the result is to be certified
    (`steepest_wall`). `GeometryError` where sites have been moved `effort` times on average at one
    stage, and some walls still lean too much.
    """
    foam, homes = foam_of(places, radii, box, random_seed)
    for stage in [*(stage for stage in stages if stage > tau), tau]:
        lean, work = (1 + MARGIN) / stage, 0
        for turn in count():
            check_all(foam, lean, slack)
            seeds = np.flatnonzero(foam.steep)
            progress(stage, len(seeds))
            if not len(seeds):
                break
            if work > effort * len(places):
                raise GeometryError(
                    f"walls at {len(seeds)} of {len(places)} sites still lean more than "
                    f"τ = {stage:g}; take another random seed or a larger τ",
                    site=int(seeds[0]),
                )
            if turn == 0:
                work += solve_cluster(foam, homes, seeds[0], np.inf, lean, slack, TOGETHER)
                continue
            for seed in seeds.tolist():
                if foam.steep[seed]:
                    work += solve_cluster(foam, homes, seed, REACH, lean, slack, APART)
    return foam.places
