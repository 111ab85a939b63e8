"""Sites scattered at random, none nearer to another than their radius: Poisson-disk sampling."""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatRows, WordArray
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.geometry.voronoi.bins import Bins, bin_of, empty_bins, gather, insert
from v3dcad.model import Floats
from v3dcad.structure.foam.random import random_share

MISSES = 30_000
"""So many darts in a row that find no room end the throwing."""

DENSEST = 1.5
"""More sites than this in a cube of the radius keep no distance of a radius: √2 are the most."""


@compiled(ENTRY)
def throw(bins: Bins, places: FloatRows, radius: float, misses: int, state: WordArray) -> int:
    """Throw darts into periodic bins until so many in a row miss; returns how many hit.

    Writes places (n, 3). A dart misses where an earlier one is nearer than the radius.
    """
    names, offsets, squares = np.empty(64, np.int64), np.empty((64, 3)), np.empty(64)
    at = np.empty(3)
    count, missed = 0, 0
    while missed < misses and count < len(places):
        for axis in range(3):
            at[axis] = bins.low[axis] + random_share(state) * bins.periods[axis]
        if gather(bins, places, at, radius, names, offsets, squares) != 0:
            missed += 1
            continue
        places[count] = at
        insert(bins, count, bin_of(bins, at[0], at[1], at[2]))
        count, missed = count + 1, 0
    return count


def poisson_disk(box: Floats, radius: float, random_seed: int) -> Floats:
    """Random sites (n, 3) in a periodic box (3,), none nearer than a radius to another.

    Darts are thrown until `MISSES` in a row find no room (Cook, "Stochastic sampling in computer
    graphics", ACM Trans. Graphics 1986); some 0.7 sites come into a cube of the radius.
    """
    capacity = int(DENSEST * np.prod(box / radius)) + 1
    bins = empty_bins(np.zeros(3), box, radius, capacity, periodic=True)
    places = np.empty((capacity, 3))
    count = throw(bins, places, radius, MISSES, np.array([random_seed], np.uint64))
    return places[:count]
