"""How far cells reach: a proven bound, by which far pairs of sites share no wall.

A point of a wall is as far from its two sites as from the nearest site of all. So a bound on the
distance from any point to its nearest site bounds how far cells reach, and two sites farther apart
than twice that share no wall. The bound is found by branch and bound: within a cube no point is
farther from its nearest site than the middle is, plus half the cube's diagonal.
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, FloatRows
from v3dcad.geometry.compiled.options import ENTRY, INLINED, compiled
from v3dcad.geometry.voronoi.bins import (
    CROWDED,
    ROOM,
    Bins,
    bin_at,
    bins_of,
    gather,
    homes_of,
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
    half_bin = np.sqrt(sides[0] ** 2 + sides[1] ** 2 + sides[2] ** 2) / 2
    for box in range(len(bounds)):
        bounds[box] = 0.0
        i, rest = divmod(box, bins.shape[1] * bins.shape[2])
        j, k = divmod(rest, bins.shape[2])
        middle[0] = bins.low[0] + (i + 0.5) * sides[0]
        middle[1] = bins.low[1] + (j + 0.5) * sides[1]
        middle[2] = bins.low[2] + (k + 0.5) * sides[2]
        outside = False
        for axis in range(3):
            outside |= middle[axis] + sides[axis] / 2 < low[axis]
            outside |= middle[axis] - sides[axis] / 2 > high[axis]
        if outside:
            continue
        # Any sites give a bound, and the nearest ones the best.
        enough = ENOUGH * spacing_around(bins, i, j, k)
        radius = enough + half_bin
        count = gather(bins, places, middle, radius, names, offsets, squares)
        while count == 0:
            radius *= 2
            count = gather(bins, places, middle, radius, names, offsets, squares)
        if count == CROWDED:
            return box
        met, best, open_cubes = 0.0, 0, 1
        cubes[0, 0], cubes[0, 1], cubes[0, 2], cubes[0, 3] = 0.0, 0.0, 0.0, 1.0
        while open_cubes > 0:
            open_cubes -= 1
            x, y, z, share = cubes[open_cubes]
            half = half_bin * share
            passes = max(enough - half, 0.0) ** 2
            # What is nearest to one cube is mostly near enough to the next one.
            nearest = square_between(offsets, best, x, y, z)
            site = 0
            while nearest > passes and site < count:
                square = square_between(offsets, site, x, y, z)
                if square < nearest:
                    best, nearest = site, square
                site += 1
            nearest = np.sqrt(nearest)
            if half + nearest > enough:
                met = max(met, nearest)
            if nearest + half <= max(enough, TIGHTNESS * met) or share < 2.0**-DEEPEST:
                bounds[box] = max(bounds[box], (nearest + half) * SAFETY)
                continue
            for corner in range(8):
                cubes[open_cubes, 0] = x + sides[0] * share * (0.25 if corner & 1 else -0.25)
                cubes[open_cubes, 1] = y + sides[1] * share * (0.25 if corner & 2 else -0.25)
                cubes[open_cubes, 2] = z + sides[2] * share * (0.25 if corner & 4 else -0.25)
                cubes[open_cubes, 3] = share / 2
                open_cubes += 1
    return -1


@compiled(ENTRY)
def spread_bounds(bins: Bins, bounds: FloatArray, reaches: FloatArray) -> None:
    """For each bin, how far at most the cells of its sites reach: the greatest bound of the bins
    that are so near that their bound lets them hold points of those cells.
    """
    shape, sides, periodic = bins.shape, bins.sides, bins.periods[0] > 0
    reaches[:] = 0.0
    box = -1
    for i in range(shape[0]):
        for j in range(shape[1]):
            for k in range(shape[2]):
                box += 1
                bound = bounds[box]
                if bound == 0:
                    continue
                out_i = np.int64(bound / sides[0]) + 1
                out_j = np.int64(bound / sides[1]) + 1
                out_k = np.int64(bound / sides[2]) + 1
                for a in range(i - out_i, i + out_i + 1):
                    for b in range(j - out_j, j + out_j + 1):
                        for c in range(k - out_k, k + out_k + 1):
                            if not periodic and not (
                                0 <= a < shape[0] and 0 <= b < shape[1] and 0 <= c < shape[2]
                            ):
                                continue
                            other = bin_at(bins, a, b, c)
                            reaches[other] = max(reaches[other], bound)


def cell_reaches(bins: Bins, places: Floats, low: Floats, high: Floats) -> Floats:
    """For each bin, how far the cells of sites in it reach at most from them, within a box.

    `places` (n, 3) are the sites', low and high (3,) the corners of a box within the bins. Two
    sites i, j share a wall in the box only if they are at most twice the smaller reach apart; 0
    where no cell is in it.
    `GeometryError` for sites so uneven that some bin has over `ROOM` sites around.
    """
    bounds, reaches = np.empty(len(bins.heads)), np.empty(len(bins.heads))
    crowded = bound_distances(bins, places, low, high, bounds, ROOM)
    if crowded >= 0:
        raise too_uneven(int(bins.heads[crowded]))
    spread_bounds(bins, bounds, reaches)
    return reaches


def binned_reaches(places: Floats, low: Floats, high: Floats) -> tuple[Bins, Floats]:
    """Bins around sites (n, 3) and the box low … high (3,), and for each its `cell_reaches`."""
    start, end = np.minimum(places.min(axis=0), low), np.maximum(places.max(axis=0), high)
    bins = bins_of(places, start, end, periodic=False)
    return bins, cell_reaches(bins, places, low, high)


def site_reaches(places: Floats, low: Floats, high: Floats) -> Floats:
    """How far the cell of each site (n, 3) reaches at most from it in the box low … high (3,).

    0 where the cell is not in the box. Raises `GeometryError` as `cell_reaches`.
    """
    bins, reaches = binned_reaches(places, low, high)
    return reaches[homes_of(bins, places)]
