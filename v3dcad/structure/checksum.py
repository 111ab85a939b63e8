"""A check sum by which two structures are known to be the same, on any platform.

It is made of the engine's integers (sites in grid steps, weights in steps²) and of topology
(which cells are neighbours): exact, so that no platform rounds them otherwise. Points on the
section's boundary are floats of the kernel's and take no part. Nor do areas; what they decide,
how many cells are born on which layer, is compared with a margin of 1e-9 by the engine itself.
Sites are numbered by birth and place, so that the order in which they were given does not matter.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import numpy as np

from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.model import Checksum, Ints, Layer


def structure_checksum(layers: Iterable[Layer], grid: Grid) -> Checksum:
    """The check sum of a structure's layers, whose sites lie on `grid`.

    One pass, one layer in memory at a time.
    """
    sums = {name: hashlib.sha256() for name in ("sites", "weights", "topology")}
    numbers = np.empty(0, np.int64)
    places, pairs = np.empty((0, 2), np.int64), np.empty((0, 2), np.int64)
    started = layer_count = walls = 0
    for layer in layers:
        state = layer.state
        numbers = _numbered(numbers, grid.snap(state.sites[len(numbers) :]))
        by_number = np.argsort(numbers, kind="stable")
        before, places = places, grid.snap(state.sites)[by_number]
        if not np.array_equal(before, places):
            sums["sites"].update(_bytes(np.array([layer.index])) + _bytes(places))
        heights = np.array([layer.z]).astype("<f8").tobytes()
        sums["weights"].update(heights + _bytes(grid.steps(state.weights)[by_number]))
        before, pairs = pairs, _sorted(numbers[layer.diagram.neighbours])
        if not np.array_equal(before, pairs):
            sums["topology"].update(_bytes(np.array([layer.index])) + _bytes(pairs))
        started = started or len(numbers)
        layer_count += 1
        walls += len(pairs)
    births = len(numbers) - started
    whole = hashlib.sha256(_bytes(np.array([layer_count, births, walls])))
    for part in sums.values():
        whole.update(part.digest())
    sums["sha256"] = whole
    digests = {name: sums[name].hexdigest()[:digits] for name, digits in Checksum.DIGITS.items()}
    return Checksum(layers=layer_count, births=births, walls=walls, **digests)


def _numbered(numbers: Ints, newborn: Ints) -> Ints:
    """The numbers of all sites, newborns (n, 2) next, in the order of their places."""
    ranks = np.empty(len(newborn), np.int64)
    ranks[np.lexsort(newborn.T[::-1])] = np.arange(len(newborn))
    return np.concatenate([numbers, len(numbers) + ranks])


def _sorted(pairs: Ints) -> Ints:
    pairs = np.sort(pairs, axis=1)
    return pairs[np.lexsort(pairs.T[::-1])]


def _bytes(numbers: Ints) -> bytes:
    return numbers.astype("<i8").tobytes()
