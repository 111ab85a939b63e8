"""Sites scattered at random, none nearer to another than their radius: Poisson-disk sampling."""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, FloatRows, WordArray
from v3dcad.geometry.compiled.options import ENTRY, INLINED, compiled
from v3dcad.geometry.voronoi.bins import Bins, bin_of, empty_bins, gather, insert
from v3dcad.model import Floats
from v3dcad.structure.foam.random import random_share
from v3dcad.structure.foam.size_grid import SizeGrid, limit_slope, size_at

MISSES = 30_000
"""So many darts in a row that find no room end the throwing."""

DARTS = 80
"""How many darts are thrown for each site that is expected, where radii differ."""

EXPECTED = 0.7
"""How many sites come into a cube of the radius."""

CELLS = 1.055
"""Cells in a square of the radius of a horizontal section: counted at τ = 1.67 in cubes of 16 radii
(two seeds: 1.050 and 1.055), where τ = 1.41 makes 1 % more."""

CROWDING = 0.45
"""Where sizes have a slope, cells of the same radii come out finer by this share of its square:
counted sideways and upward at slopes of 0.2 and 0.29 (four seeds each: 1.8 and 3.7 %)."""

STEEPEST = 0.33
"""The steepest gradient of a radius: that of sizes, with what radii are larger."""

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
    graphics", ACM Trans. Graphics 1986); `EXPECTED` sites come into a cube of the radius.
    """
    capacity = int(DENSEST * np.prod(box / radius)) + 1
    bins = empty_bins(np.zeros(3), box, radius, capacity, periodic=True)
    places = np.empty((capacity, 3))
    count = throw(bins, places, radius, MISSES, np.array([random_seed], np.uint64))
    return places[:count]


@compiled(INLINED)
def beyond(place: float, low: float, high: float) -> float:
    """How far a place is outside an interval."""
    return max(low - place, place - high, 0.0)


@compiled(ENTRY)
def add_shares(grid: SizeGrid, inside: FloatRows, pad: float, shares: FloatArray) -> None:
    """Write what `shares_of` returns."""
    a, b, c = grid.sizes.shape
    total, cube = 0.0, 0
    for i in range(a - 1):
        x = grid.corner[0] + (i + 0.5) * grid.side
        for j in range(b - 1):
            y = grid.corner[1] + (j + 0.5) * grid.side
            for k in range(c - 1):
                z = grid.corner[2] + (k + 0.5) * grid.side
                radius = size_at(grid, x, y, z)
                reach = pad * radius + grid.side
                if (
                    beyond(x, inside[0, 0], inside[1, 0]) <= reach
                    and beyond(y, inside[0, 1], inside[1, 1]) <= reach
                    and beyond(z, inside[0, 2], inside[1, 2]) <= reach
                ):
                    total += (grid.side / radius) ** 3
                shares[cube] = total
                cube += 1


@compiled(ENTRY)
def throw_graded(
    bins: Bins,
    grid: SizeGrid,
    shares: FloatArray,
    inside: FloatRows,
    pad: float,
    darts: int,
    places: FloatRows,
    radii: FloatArray,
    state: WordArray,
) -> int:
    """Throw a number of darts into bins, more where the grid's radii are small; returns how many
    hit.

    Writes places (n, 3) and radii (n,). A dart misses where an earlier one is nearer than the
    mean of the two radii, and where it is more than `pad` radii outside the box `inside` (2, 3).
    """
    names, offsets, squares = np.empty(64, np.int64), np.empty((64, 3)), np.empty(64)
    at, count = np.empty(3), 0
    b, c = grid.sizes.shape[1] - 1, grid.sizes.shape[2] - 1
    for _ in range(darts):
        share = random_share(state) * shares[-1]
        low, high = 0, len(shares) - 1
        while low < high:
            middle = (low + high) // 2
            if shares[middle] <= share:
                low = middle + 1
            else:
                high = middle
        at[0], at[1], at[2] = low // (b * c), low // c % b, low % c
        far = False
        for axis in range(3):
            at[axis] = grid.corner[axis] + (at[axis] + random_share(state)) * grid.side
        radius = size_at(grid, at[0], at[1], at[2])
        for axis in range(3):
            far |= beyond(at[axis], inside[0, axis], inside[1, axis]) > pad * radius
        if far or count == len(places):
            continue
        free = True
        reach = radius / (1 - STEEPEST / 2)  # no farther site's radius is large enough
        for row in range(gather(bins, places, at, reach, names, offsets, squares)):
            free &= squares[row] >= ((radius + radii[names[row]]) / 2) ** 2
        if free:
            places[count], radii[count] = at, radius
            insert(bins, count, bin_of(bins, at[0], at[1], at[2]))
            count += 1
    return count


def radii_for(sizes: SizeGrid) -> SizeGrid:
    """The radii with which darts come to make cells of sizes that are no steeper than `SLOPE`."""
    slopes = np.gradient(sizes.sizes, sizes.side)
    squares = slopes[0] ** 2 + slopes[1] ** 2 + slopes[2] ** 2
    radii = sizes._replace(sizes=np.sqrt(CELLS) * sizes.sizes * (1 + CROWDING * squares))
    limit_slope(radii, STEEPEST)
    return radii


def shares_of(grid: SizeGrid, inside: Floats, pad: float) -> Floats:
    """How many cubes of the radius are in a grid's cubes, up to each of them (n,), in all.

    Only those within about `pad` radii of the box `inside` (2, 3) count. `EXPECTED` of them has a
    site.
    """
    shares = np.empty(int(np.prod(np.array(grid.sizes.shape) - 1)))
    add_shares(grid, inside, pad, shares)
    return shares


def graded_disk(
    grid: SizeGrid, shares: Floats, inside: Floats, pad: float, random_seed: int
) -> tuple[Floats, Floats]:
    """Random sites (n, 3) in and around a box (2, 3) and their radii (n,), as a grid has them.

    None is nearer to another than the mean of their radii, none more than `pad` of its radii
    outside the box. As many darts are thrown as `DARTS` says, at random with the density of sites:
    by `shares_of` the same grid.
    """
    low = grid.corner
    high = low + grid.side * (np.array(grid.sizes.shape) - 1)
    cubes = float(shares[-1])
    capacity = int(DENSEST * cubes) + 64
    side = float(np.cbrt(np.prod(high - low) / (EXPECTED * cubes)))
    bins = empty_bins(low, high, side, capacity, periodic=False)
    places, radii = np.empty((capacity, 3)), np.empty(capacity)
    darts = int(DARTS * EXPECTED * cubes) + DARTS
    state = np.array([random_seed], np.uint64)
    count = throw_graded(bins, grid, shares, inside, pad, darts, places, radii, state)
    return places[:count], radii[:count]
