"""The nearest sites of each site."""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, FloatRows, IntArray, IntRows
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled
from v3dcad.geometry.voronoi.bins import (
    CROWDED,
    Bins,
    bin_at,
    gather,
    layer_of,
    sort_by_distance,
)


@compiled(INTERNAL)
def spacing_around(bins: Bins, i: int, j: int, k: int) -> float:
    """The side of a cube that holds one site, by the count in bins i, j, k and all beside them."""
    count, boxes = 0, 0
    for a in range(i - 1, i + 2):
        for b in range(j - 1, j + 2):
            for c in range(k - 1, k + 2):
                periodic = bins.periods[0] > 0
                if not periodic and not (
                    0 <= a < bins.shape[0] and 0 <= b < bins.shape[1] and 0 <= c < bins.shape[2]
                ):
                    continue
                boxes += 1
                site = bins.heads[bin_at(bins, a, b, c)]
                while site >= 0:
                    count += 1
                    site = bins.nexts[site]
    volume = bins.sides[0] * bins.sides[1] * bins.sides[2] * boxes
    return (volume / max(count, 1)) ** (1 / 3)


@compiled(INTERNAL)
def spacing_at(bins: Bins, at: FloatArray) -> float:
    """The side of a cube that holds one site, by the count in the 27 bins around a place (3,)."""
    i, j, k = layer_of(bins, 0, at[0]), layer_of(bins, 1, at[1]), layer_of(bins, 2, at[2])
    return spacing_around(bins, i, j, k)


@compiled(INTERNAL)
def nearest(
    bins: Bins,
    places: FloatRows,
    at: FloatArray,
    wanted: int,
    names: IntArray,
    offsets: FloatRows,
    squares: FloatArray,
) -> int:
    """Find the nearest `wanted` sites of a place (3,).

    Writes more than that, as `gather` does, nearest first; returns how many, or `CROWDED`.
    There must be that many sites, and rooms for some times as many.
    """
    radius = spacing_at(bins, at) * (wanted + 6.0) ** (1 / 3) * 0.65
    while True:
        count = gather(bins, places, at, radius, names, offsets, squares)
        if count >= wanted or count == CROWDED:
            break
        radius *= 1.2
    if count != CROWDED:
        sort_by_distance(count, names, offsets, squares)
    return count


@compiled(ENTRY)
def list_neighbours(
    bins: Bins, places: FloatRows, rows: IntArray, lists: IntRows, reaches: FloatArray, room: int
) -> bool:
    """Write the k nearest others of the sites `rows` (m,) into their rows of `lists` (n, k).

    Nearest first, equally near ones by number. `reaches` (n,) gets the distance up to which a
    list is complete: that of its last site. Returns False where more than `room` sites had to be
    looked at.
    """
    names, offsets, squares = np.empty(room, np.int64), np.empty((room, 3)), np.empty(room)
    wanted = lists.shape[1]
    for row in rows:
        # The site itself comes first.
        count = nearest(bins, places, places[row], wanted + 1, names, offsets, squares)
        if count == CROWDED:
            return False
        for k in range(wanted):  # numba takes two seconds to compile an assignment of slices
            lists[row, k] = names[k + 1]
        reaches[row] = np.sqrt(squares[wanted])
    return True
