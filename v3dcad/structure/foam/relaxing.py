"""Sites moved until no wall leans too much.

Walls that lean too much stand in clusters, and each cluster is solved apart (`cluster.py`), with a
time step of its own. τ is lowered in steps, each solved to the end, since the way there from afar
leads into knots. So the time grows with the number of sites, and not with the hardest of them.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import count

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.voronoi.bins import ROOM, Bins, bins_of, homes_of
from v3dcad.geometry.voronoi.wall import polygon_room
from v3dcad.model import Floats, Ints
from v3dcad.structure.foam.cluster import check_all, solve_cluster
from v3dcad.structure.foam.energy import Foam

NEIGHBOURS, GRADED_NEIGHBOURS = 56, 80
"""How many of the nearest sites are looked at: all within 2.6 radii; where sizes differ, as far on
the coarse side."""

TOGETHER = 300
"""Steps that all sites at bad walls take together at first, at each stage."""

APART = 200
"""Steps that a cluster takes before the next one has its turn."""

REACH = 3.0
"""In radii: how far from its first site a cluster is solved. What is farther is the next one's."""

SMALLEST_BOX = 4.0
"""In radii: in a smaller box sites are neighbours of their own copies."""

STAGES = (2.0, 1.67, 1.5, 1.41, 1.35, 1.3, 1.25, 1.2, 1.15, 1.1)
"""The values of τ on the way down."""


def periodic_foam(
    places: Floats, radii: Floats, box: Floats, random_seed: int
) -> tuple[Foam, Ints]:
    """Sites (n, 3) in a periodic box (3,), ready to be relaxed, and the bins that they are in."""
    bins = bins_of(places, np.zeros(3), box, periodic=True)
    everywhere = np.array([[-np.inf] * 3, [np.inf] * 3])
    return _foam_of(bins, places, radii, everywhere, NEIGHBOURS, random_seed, 0)


def _foam_of(
    bins: Bins,
    places: Floats,
    radii: Floats,
    inside: Floats,
    neighbours: int,
    random_seed: int,
    held: int,
) -> tuple[Foam, Ints]:
    """Sites in bins, ready to be relaxed, so many of the first of them held where they are; walls
    count in the box `inside` (2, 3).
    """
    sites = len(places)
    neighbours = min(neighbours, sites - 1)
    foam = Foam(
        bins=bins,
        places=places.copy(),
        held=held,
        radii=radii,
        low=inside[0].copy(),
        high=inside[1].copy(),
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


Progress = Callable[[float, int], object]
"""Gets the τ of a stage, and how many sites are at bad walls."""


def relax(
    places: Floats,
    radii: Floats,
    box: Floats,
    tau: float,
    *,
    stages: tuple[float, ...] = STAGES,
    margin: float = 0.005,
    slack: float = 0.0,
    random_seed: int = 0,
    effort: int = 20_000,
    progress: Progress = lambda stage, bad: None,
) -> Floats:
    """Sites (n, 3) in a periodic box (3,) moved until no wall leans more than τ allows.

    Sites keep a distance of about their radii (n,). Walls lean less than that by a share, the
    margin; and walls count that would be there with bisectors `slack` squared radii looser: so that
    sites can still be rounded. Deterministic; the result is to be certified (`steepest_wall`).
    `GeometryError` where sites have been moved `effort` times on average at one stage, and some
    walls still lean too much; and for a box that is too small to relax in.
    """
    if (box < SMALLEST_BOX * radii.max()).any():
        raise GeometryError(f"the periodic box is less than {SMALLEST_BOX:g} radii wide")
    foam, homes = periodic_foam(places, radii, box, random_seed)
    return _relaxed(foam, homes, tau, stages, margin, slack, effort, progress)


def relax_inside(
    places: Floats,
    radii: Floats,
    inside: Floats,
    tau: float,
    *,
    held: int = 0,
    margin: float = 0.005,
    slack: float = 0.0,
    random_seed: int = 0,
    effort: int = 20_000,
    progress: Progress = lambda stage, bad: None,
) -> Floats:
    """Sites (n, 3) in and around a box (2, 3) moved until no wall in it leans more than τ allows.

    Their radii (n,) may differ. The first `held` sites stay where they are. All else as `relax`.
    """
    low, high = places.min(axis=0), places.max(axis=0)
    bins = bins_of(places, low, high, periodic=False)
    foam, homes = _foam_of(bins, places, radii, inside, GRADED_NEIGHBOURS, random_seed, held)
    return _relaxed(foam, homes, tau, STAGES, margin, slack, effort, progress)


def _relaxed(
    foam: Foam,
    homes: Ints,
    tau: float,
    stages: tuple[float, ...],
    margin: float,
    slack: float,
    effort: int,
    progress: Progress,
) -> Floats:
    for stage in [*(stage for stage in stages if stage > tau), tau]:
        lean, work = (1 + margin) / stage, 0
        for turn in count():
            check_all(foam, lean, slack)
            seeds = np.flatnonzero(foam.steep)
            progress(stage, len(seeds))
            if not len(seeds):
                break
            if work > effort * len(foam.places):
                raise GeometryError(
                    f"walls at {len(seeds)} of {len(foam.places)} sites still lean more than "
                    f"τ = {stage:g}; take another random seed or a larger τ",
                    site=int(seeds[0]),
                )
            if turn == 0:
                work += solve_cluster(foam, homes, seeds[0], np.inf, lean, slack, TOGETHER)
                continue
            for seed in seeds.tolist():
                if foam.steep[seed]:
                    work += solve_cluster(foam, homes, seed, REACH, lean, slack, APART)
    return np.asarray(foam.places)
