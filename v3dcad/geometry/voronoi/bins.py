"""Sites in a grid of boxes, as linked lists: who is near a place.

A bin holds its first site, every site the next one of its bin, so that a site comes in, moves and
is found in constant time. With periods the space repeats without end: each site stands for all its
copies.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.compiled.arrays import FloatArray, FloatRows, IntArray
from v3dcad.geometry.compiled.options import ENTRY, INLINED, INTERNAL, compiled
from v3dcad.model import Floats

NOBODY = -1
"""Ends a bin's list."""

CROWDED = -1
"""What `gather` returns where there is no room for all that it finds."""


ROOM = 4096
"""How many sites there may be around a place, within a cell's neighbourhood."""


EACH = 4
"""How many sites a bin holds on average: with fewer, looking at empty bins takes the time."""


class Bins(NamedTuple):
    """A grid of boxes over space, and the sites in them."""

    low: FloatArray
    """(3,) float64: the grid's lower corner"""
    sides: FloatArray
    """(3,) float64: of one bin"""
    periods: FloatArray
    """(3,) float64: of the space along each axis; zeros where it does not repeat"""
    shape: IntArray
    """(3,) int64: how many bins there are along each axis"""
    heads: IntArray
    """(bins,) int64: the first site of each bin, or `NOBODY`"""
    nexts: IntArray
    """(n,) int64: the next site of the same bin, or `NOBODY`"""


def too_uneven(site: int) -> GeometryError:
    """What to raise for a site around which there is no room for all others."""
    return GeometryError(f"over {ROOM} sites are near it: too uneven", site=site)


def empty_bins(low: Floats, high: Floats, side: float, capacity: int, *, periodic: bool) -> Bins:
    """Bins of about a side over the box low … high (3,), for up to `capacity` sites.

    Periodic ones repeat the box without end; otherwise sites outside belong to the outermost bins.
    """
    size = np.asarray(high - low, np.float64)
    count = size / side
    whole = np.floor(count) if periodic else np.ceil(count)
    shape = np.asarray(np.maximum(whole, 1.0), np.int64)
    sides = np.where(size > 0, size, side) / shape
    return Bins(
        np.asarray(low, np.float64),
        sides,
        size if periodic else np.zeros(3),
        shape,
        np.full(int(shape.prod()), NOBODY),
        np.full(capacity, NOBODY),
    )


def bins_of(places: Floats, low: Floats, high: Floats, *, periodic: bool) -> Bins:
    """Bins over the box low … high (3,) that hold sites at places (n, 3), about `EACH` of them."""
    size = np.asarray(high - low, np.float64)
    widest = float(size.max())
    size = np.where(size > 0, size, widest or 1.0)
    side = float((EACH * float(size.prod()) / max(1, len(places))) ** (1 / 3))
    bins = empty_bins(low, high, side, len(places), periodic=periodic)
    fill(bins, places)
    return bins


@compiled(INLINED)
def layer_of(bins: Bins, axis: int, coordinate: float) -> int:
    """Which layer of bins along an axis a coordinate is in; with periods, also beyond the grid."""
    layer = int(np.floor((coordinate - bins.low[axis]) / bins.sides[axis]))
    if bins.periods[axis] == 0:
        layer = max(0, min(layer, bins.shape[axis] - 1))
    return layer


@compiled(INLINED)
def bin_at(bins: Bins, i: int, j: int, k: int) -> int:
    """The number of the bin in layers i, j, k."""
    shape = bins.shape
    return ((i % shape[0]) * shape[1] + j % shape[1]) * shape[2] + k % shape[2]


@compiled(INTERNAL)
def bin_of(bins: Bins, x: float, y: float, z: float) -> int:
    """The number of the bin that a place is in."""
    return bin_at(bins, layer_of(bins, 0, x), layer_of(bins, 1, y), layer_of(bins, 2, z))


@compiled(INTERNAL)
def insert(bins: Bins, site: int, box: int) -> None:
    """Put a site into a bin."""
    bins.nexts[site] = bins.heads[box]
    bins.heads[box] = site


@compiled(INTERNAL)
def remove(bins: Bins, site: int, box: int) -> None:
    """Take a site out of its bin."""
    if bins.heads[box] == site:
        bins.heads[box] = bins.nexts[site]
        return
    before = bins.heads[box]
    while bins.nexts[before] != site:
        before = bins.nexts[before]
    bins.nexts[before] = bins.nexts[site]


@compiled(ENTRY)
def fill(bins: Bins, places: FloatRows) -> None:
    """Put sites at places (n, 3) into empty bins; each bin lists them in ascending order."""
    for site in range(len(places) - 1, -1, -1):
        insert(bins, site, bin_of(bins, places[site, 0], places[site, 1], places[site, 2]))


@compiled(ENTRY)
def homes_of(bins: Bins, places: FloatRows) -> IntArray:
    """The bins (n,) that places (n, 3) are in."""
    homes = np.empty(len(places), np.int64)
    for site in range(len(places)):
        homes[site] = bin_of(bins, places[site, 0], places[site, 1], places[site, 2])
    return homes


@compiled(INTERNAL)
def gather(
    bins: Bins,
    places: FloatRows,
    at: FloatArray,
    radius: float,
    names: IntArray,
    offsets: FloatRows,
    squares: FloatArray,
) -> int:
    """Find all sites within a radius of the place `at` (3,).

    Writes their numbers, offsets (m, 3) from `at`, and squared distances; in the order of the
    bins. Returns how many, or `CROWDED`.
    """
    count, limit = 0, radius * radius
    shape, periods = bins.shape, bins.periods
    first, last = layer_of(bins, 2, at[2] - radius), layer_of(bins, 2, at[2] + radius)
    for i in range(layer_of(bins, 0, at[0] - radius), layer_of(bins, 0, at[0] + radius) + 1):
        shift_x = (i // shape[0]) * periods[0] - at[0]
        for j in range(layer_of(bins, 1, at[1] - radius), layer_of(bins, 1, at[1] + radius) + 1):
            shift_y = (j // shape[1]) * periods[1] - at[1]
            shift_z = (first // shape[2]) * periods[2] - at[2]
            row, layer = bin_at(bins, i, j, 0), first % shape[2]
            # Divisions would take most of the time: none along a row.
            for _ in range(first, last + 1):
                if layer == shape[2]:
                    layer = 0
                    shift_z += periods[2]
                site = bins.heads[row + layer]
                layer += 1
                while site != NOBODY:
                    x = places[site, 0] + shift_x
                    y = places[site, 1] + shift_y
                    z = places[site, 2] + shift_z
                    square = x * x + y * y + z * z
                    if square <= limit:
                        if count == len(names):
                            return CROWDED
                        offsets[count, 0], offsets[count, 1], offsets[count, 2] = x, y, z
                        names[count], squares[count] = site, square
                        count += 1
                    site = bins.nexts[site]
    return count


@compiled(INTERNAL)
def near_first(
    count: int, radius: float, names: IntArray, offsets: FloatRows, squares: FloatArray
) -> None:
    """Bring those of what `gather` found that are within a radius to the front."""
    front = 0
    for row in range(count):
        if squares[row] <= radius * radius:
            names[front], names[row] = names[row], names[front]
            squares[front], squares[row] = squares[row], squares[front]
            for axis in range(3):
                offset = offsets[front, axis]
                offsets[front, axis] = offsets[row, axis]
                offsets[row, axis] = offset
            front += 1


@compiled(INTERNAL)
def sort_by_distance(count: int, names: IntArray, offsets: FloatRows, squares: FloatArray) -> None:
    """Sort what `gather` found: nearest first, equally near ones by number."""
    for row in range(1, count):
        name, square = names[row], squares[row]
        x, y, z = offsets[row, 0], offsets[row, 1], offsets[row, 2]
        free = row
        while free > 0 and (
            squares[free - 1] > square or (squares[free - 1] == square and names[free - 1] > name)
        ):
            names[free], squares[free] = names[free - 1], squares[free - 1]
            for axis in range(3):
                offsets[free, axis] = offsets[free - 1, axis]
            free -= 1
        names[free], squares[free] = name, square
        offsets[free, 0], offsets[free, 1], offsets[free, 2] = x, y, z
