"""Sites scattered at random, none nearer to another than their radius: Poisson-disk sampling."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, FloatRows, IntArray, WordArray
from v3dcad.geometry.compiled.options import ENTRY, INLINED, compiled
from v3dcad.geometry.voronoi.bins import Bins, bin_of, empty_bins, gather, insert
from v3dcad.model import Floats
from v3dcad.structure.foam.random import random_share
from v3dcad.structure.foam.size_grid import FINE, NODES, SizeGrid, limit_slope, side_of, size_at

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


class Targets(NamedTuple):
    """Cubes at which darts are thrown: in a box and so far around it as sites are needed."""

    inside: FloatRows
    """(2, 3) the box"""
    pad: float
    """in radii: how far around it"""
    corner: FloatArray
    """(3,) the lowest corner of all cubes"""
    side: float
    """of a cube"""
    counts: IntArray
    """(3,) how many there are along each axis"""
    shares: FloatArray
    """(n,) how many cubes of the radius are in all cubes up to each; `EXPECTED` of them has a
    site"""


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
def add_shares(grid: SizeGrid, targets: Targets) -> None:
    """Write the shares of targets."""
    inside, counts = targets.inside, targets.counts
    total, cube = 0.0, 0
    for i in range(counts[0]):
        x = targets.corner[0] + (i + 0.5) * targets.side
        for j in range(counts[1]):
            y = targets.corner[1] + (j + 0.5) * targets.side
            for k in range(counts[2]):
                z = targets.corner[2] + (k + 0.5) * targets.side
                radius = size_at(grid, x, y, z)
                reach = targets.pad * radius + targets.side
                if (
                    beyond(x, inside[0, 0], inside[1, 0]) <= reach
                    and beyond(y, inside[0, 1], inside[1, 1]) <= reach
                    and beyond(z, inside[0, 2], inside[1, 2]) <= reach
                ):
                    total += (targets.side / radius) ** 3
                targets.shares[cube] = total
                cube += 1


@compiled(INLINED)
def is_far(targets: Targets, at: FloatArray, radius: float) -> bool:
    """Whether a place is farther outside than the targets' pad."""
    inside = targets.inside
    for axis in range(3):
        if beyond(at[axis], inside[0, axis], inside[1, axis]) > targets.pad * radius:
            return True
    return False


@compiled(ENTRY)
def put(
    bins: Bins,
    grid: SizeGrid,
    targets: Targets,
    wanted: FloatRows,
    clear: float,
    places: FloatRows,
    radii: FloatArray,
) -> int:
    """Put sites where they are wanted (m, 3), with the grid's radii there; returns how many.

    Writes places (n, 3) and radii (n,). One is left out that is farther outside than the targets'
    pad, and one that would stand over or under an earlier one within `clear` radii: a wall would
    lean there.
    """
    names, offsets, squares = np.empty(64, np.int64), np.empty((64, 3)), np.empty(64)
    at, count = np.empty(3), 0
    for row in range(len(wanted)):
        at[:] = wanted[row]
        radius = size_at(grid, at[0], at[1], at[2])
        if is_far(targets, at, radius) or count == len(places):
            continue
        free = True
        for near in range(gather(bins, places, at, clear * radius, names, offsets, squares)):
            free &= 2 * offsets[near, 2] ** 2 < squares[near]
        if free:
            places[count], radii[count] = at, radius
            insert(bins, count, bin_of(bins, at[0], at[1], at[2]))
            count += 1
    return count


@compiled(ENTRY)
def throw_graded(
    bins: Bins,
    grid: SizeGrid,
    targets: Targets,
    darts: int,
    places: FloatRows,
    radii: FloatArray,
    count: int,
    state: WordArray,
) -> int:
    """Throw a number of darts into bins, more where the grid's radii are small; returns how many
    sites there are with those that hit.

    Writes places (n, 3) and radii (n,), after the `count` that are there. A dart misses where an
    earlier one is nearer than the mean of the two radii, and where it is farther outside than the
    targets' pad.
    """
    names, offsets, squares = np.empty(64, np.int64), np.empty((64, 3)), np.empty(64)
    at, shares = np.empty(3), targets.shares
    b, c = targets.counts[1], targets.counts[2]
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
        for axis in range(3):
            at[axis] = targets.corner[axis] + (at[axis] + random_share(state)) * targets.side
        radius = size_at(grid, at[0], at[1], at[2])
        if is_far(targets, at, radius) or count == len(places):
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


def targets_of(grid: SizeGrid, inside: Floats, pad: float) -> Targets:
    """Where darts are thrown for a grid of radii: not farther than about `pad` of them outside the
    box `inside` (2, 3).
    """
    around = pad * float(grid.sizes.max())
    size = np.ptp(inside, axis=0) + 2 * around
    side = max(side_of(size, NODES), FINE * float(grid.sizes.min()))
    counts = np.ceil(size / side).astype(np.int64)
    targets = Targets(inside, pad, inside[0] - around, side, counts, np.empty(int(counts.prod())))
    add_shares(grid, targets)
    return targets


def graded_disk(
    grid: SizeGrid, targets: Targets, random_seed: int, wanted: Floats, clear: float
) -> tuple[Floats, Floats, int]:
    """Sites (n, 3), their radii (n,) as a grid has them, and how many of the first are wanted ones.

    Of wanted sites that stand over each other within `clear` radii only the first are taken. The
    others are random, and none of these is nearer to another site than the mean of their radii.
    As many darts are thrown as `DARTS` says, at random with the density of sites, at the grid's
    targets.
    """
    low = targets.corner
    high = low + targets.side * targets.counts
    cubes = float(targets.shares[-1])
    capacity = int(DENSEST * cubes) + 64
    side = float(np.cbrt(np.prod(high - low) / (EXPECTED * cubes)))
    bins = empty_bins(low, high, side, capacity, periodic=False)
    places, radii = np.empty((capacity, 3)), np.empty(capacity)
    darts = int(DARTS * EXPECTED * cubes) + DARTS
    state = np.array([random_seed], np.uint64)
    first = put(bins, grid, targets, np.ascontiguousarray(wanted), clear, places, radii)
    count = throw_graded(bins, grid, targets, darts, places, radii, first, state)
    return places[:count], radii[:count], first
