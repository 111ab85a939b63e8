"""How far cells reach: a proven bound, by which far pairs of sites share no wall.

A point of a wall is as far from its two sites as from the nearest site of all. So a bound on the
distance from any point to its nearest site bounds how far cells reach, and two sites farther apart
than twice that share no wall. The bound is found by branch and bound: within a cube no point is
farther from its nearest site than the middle is, plus half the cube's diagonal.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, FloatRows
from v3dcad.geometry.compiled.options import ENTRY, INLINED, INTERNAL, compiled
from v3dcad.geometry.voronoi.bins import (
    CROWDED,
    ROOM,
    Bins,
    bin_at,
    bin_of,
    bins_of,
    gather,
    layer_of,
    too_uneven,
)
from v3dcad.geometry.voronoi.neighbours import spacing_around
from v3dcad.model import Floats

TIGHTNESS = 1.1
"""By which factor a bin's bound may exceed the greatest distance that was met in it."""

ENOUGH = 1.1
"""In spacings of sites: bounds up to here need not be better. Cells of even sites reach about as
far, and to prove less would take longer than it saves."""

SAFETY = 1 + 1e-9
"""What bounds are multiplied by, so that no rounding makes them too small."""

DEEPEST = 40
"""How often a cube is halved at most."""


@compiled(INLINED)
def square_between(offsets: FloatRows, site: int, x: float, y: float, z: float) -> float:
    """The squared distance of a site from a place."""
    dx, dy, dz = offsets[site, 0] - x, offsets[site, 1] - y, offsets[site, 2] - z
    return dx * dx + dy * dy + dz * dz


class Bin(NamedTuple):
    """One bin in which distances are bounded, and the sites near it."""

    sides: FloatArray
    """(3,)"""
    half: float
    """half its diagonal"""
    offsets: FloatRows
    """(m, 3) the sites around, from the bin's middle"""
    near: int
    """how many these are"""
    enough: float
    """a bound that need not be bettered"""
    low: FloatArray
    high: FloatArray
    """(3,) the box that points count in, from the bin's middle"""


@compiled(INLINED)
def is_outside(middle: float, half: float, low: float, high: float) -> bool:
    """Whether an interval around its middle has no point from low to high."""
    return middle + half < low or middle - half > high


@compiled(INTERNAL)
def bound_in(around: Bin, cubes: FloatRows) -> float:
    """A bound on how far a bin's points in the box are from the nearest of the sites around it.

    `cubes` is room to work in.
    """
    offsets, sides, enough = around.offsets, around.sides, around.enough
    low, high = around.low, around.high
    bound, met, best, open_cubes = 0.0, 0.0, 0, 1
    cubes[0, 0], cubes[0, 1], cubes[0, 2], cubes[0, 3] = 0.0, 0.0, 0.0, 1.0
    while open_cubes > 0:
        open_cubes -= 1
        x, y, z, share = cubes[open_cubes]
        if (
            is_outside(x, sides[0] * share / 2, low[0], high[0])
            or is_outside(y, sides[1] * share / 2, low[1], high[1])
            or is_outside(z, sides[2] * share / 2, low[2], high[2])
        ):
            continue
        half = around.half * share
        passes = max(enough - half, 0.0) ** 2
        # What is nearest to one cube is mostly near enough to the next one.
        nearest = square_between(offsets, best, x, y, z)
        site = 0
        while nearest > passes and site < around.near:
            square = square_between(offsets, site, x, y, z)
            if square < nearest:
                best, nearest = site, square
            site += 1
        nearest = np.sqrt(nearest)
        if half + nearest > enough:
            met = max(met, nearest)
        if nearest + half <= max(enough, TIGHTNESS * met) or share < 2.0**-DEEPEST:
            bound = max(bound, (nearest + half) * SAFETY)
            continue
        for corner in range(8):
            cubes[open_cubes, 0] = x + sides[0] * share * (0.25 if corner & 1 else -0.25)
            cubes[open_cubes, 1] = y + sides[1] * share * (0.25 if corner & 2 else -0.25)
            cubes[open_cubes, 2] = z + sides[2] * share * (0.25 if corner & 4 else -0.25)
            cubes[open_cubes, 3] = share / 2
            open_cubes += 1
    return bound


@compiled(ENTRY)
def bound_distances(
    bins: Bins, places: FloatRows, low: FloatArray, high: FloatArray, bounds: FloatArray, room: int
) -> int:
    """For each bin a bound on how far its points in the box low … high are from their nearest site.

    0 for bins outside of the box. Returns −1, or a bin around which there are more than `room`
    sites.
    """
    names, offsets, squares = np.empty(room, np.int64), np.empty((room, 3)), np.empty(room)
    cubes, middle, sides = np.empty((8 * DEEPEST + 8, 4)), np.empty(3), bins.sides
    half = np.sqrt(sides[0] ** 2 + sides[1] ** 2 + sides[2] ** 2) / 2
    box_low, box_high = np.empty(3), np.empty(3)
    for box in range(len(bounds)):
        bounds[box] = 0.0
        i, rest = divmod(box, bins.shape[1] * bins.shape[2])
        j, k = divmod(rest, bins.shape[2])
        middle[0] = bins.low[0] + (i + 0.5) * sides[0]
        middle[1] = bins.low[1] + (j + 0.5) * sides[1]
        middle[2] = bins.low[2] + (k + 0.5) * sides[2]
        outside = False
        for axis in range(3):
            box_low[axis], box_high[axis] = low[axis] - middle[axis], high[axis] - middle[axis]
            outside |= is_outside(0.0, sides[axis] / 2, box_low[axis], box_high[axis])
        if outside:
            continue
        # Any sites give a bound, and the nearest ones the best: those no farther from the middle
        # than the bound and half the bin.
        enough = ENOUGH * spacing_around(bins, i, j, k)
        radius = enough + half
        if enough > half:  # so few sites around say little of their spacing
            enough = 0.0
        bound = np.inf
        while bound + half > radius:
            if bound < np.inf:
                radius = (bound + half) * SAFETY
            count = gather(bins, places, middle, radius, names, offsets, squares)
            while count == 0:
                radius *= 2
                count = gather(bins, places, middle, radius, names, offsets, squares)
            if count == CROWDED:
                return box
            around = Bin(sides, half, offsets, count, enough, box_low, box_high)
            bound = min(bound, bound_in(around, cubes))
        bounds[box] = bound
    return -1


@compiled(ENTRY)
def spread_bounds(bins: Bins, bounds: FloatArray, farthest: FloatArray) -> None:
    """For each bin the greatest bound of the bins that are so near that their bound lets them hold
    points of its sites' cells.
    """
    shape, sides = bins.shape, bins.sides
    farthest[:] = 0.0
    box = -1
    for i in range(shape[0]):
        for j in range(shape[1]):
            for k in range(shape[2]):
                box += 1
                bound = bounds[box]
                if bound == 0:
                    continue
                out_i = int(bound / sides[0]) + 1
                out_j = int(bound / sides[1]) + 1
                out_k = int(bound / sides[2]) + 1
                for a in range(max(i - out_i, 0), min(i + out_i + 1, shape[0])):
                    for b in range(max(j - out_j, 0), min(j + out_j + 1, shape[1])):
                        for c in range(max(k - out_k, 0), min(k + out_k + 1, shape[2])):
                            other = bin_at(bins, a, b, c)
                            farthest[other] = max(farthest[other], bound)


@compiled(INTERNAL)
def gap(bins: Bins, axis: int, layer: int, place: float) -> float:
    """How far a place is from a layer of bins along an axis."""
    start = bins.low[axis] + layer * bins.sides[axis]
    return max(start - place, place - start - bins.sides[axis], 0.0)


@compiled(ENTRY)
def reach_of_sites(
    bins: Bins, bounds: FloatArray, farthest: FloatArray, places: FloatRows, reaches: FloatArray
) -> None:
    """For each site the greatest bound of the bins that are no farther from it than their bound.

    `farthest` is what `spread_bounds` wrote; where sizes differ, it alone would be much too far.
    """
    shape, first, last = bins.shape, np.empty(3, np.int64), np.empty(3, np.int64)
    for site in range(len(places)):
        x, y, z = places[site, 0], places[site, 1], places[site, 2]
        reaches[site] = 0.0
        radius = farthest[bin_of(bins, x, y, z)]
        for axis in range(3):
            first[axis] = layer_of(bins, axis, places[site, axis] - radius)
            last[axis] = layer_of(bins, axis, places[site, axis] + radius)
        for i in range(first[0], last[0] + 1):
            square_i = gap(bins, 0, i, x) ** 2
            for j in range(first[1], last[1] + 1):
                square_j = square_i + gap(bins, 1, j, y) ** 2
                for k in range(first[2], last[2] + 1):
                    bound = bounds[(i * shape[1] + j) * shape[2] + k]
                    if bound <= reaches[site]:
                        continue
                    if square_j + gap(bins, 2, k, z) ** 2 <= bound * bound:
                        reaches[site] = bound


def cell_reaches(places: Floats, low: Floats, high: Floats) -> tuple[Bins, Floats]:
    """How far the cell of each site (n, 3) reaches at most from it in the box low … high (3,).

    Two sites share a wall in the box only if they are at most twice the smaller reach apart; 0
    where a cell is not in it. Also returns bins of the sites. `GeometryError` for sites so uneven
    that some bin has over `ROOM` sites around.
    """
    start, end = np.minimum(places.min(axis=0), low), np.maximum(places.max(axis=0), high)
    bins = bins_of(places, start, end, periodic=False)
    bounds, farthest = np.empty(len(bins.heads)), np.empty(len(bins.heads))
    crowded = bound_distances(bins, places, low, high, bounds, ROOM)
    if crowded >= 0:
        raise too_uneven(int(bins.heads[crowded]))
    spread_bounds(bins, bounds, farthest)
    reaches = np.empty(len(places))
    reach_of_sites(bins, bounds, farthest, places, reaches)
    return bins, reaches
