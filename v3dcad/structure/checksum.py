"""A check sum by which two structures are known to be the same, on any platform.

It is made of the engine's integers (sites in grid steps, weights in steps²) and of topology
(which cells are neighbours): exact, so that no platform rounds them otherwise. Points on the
section's boundary are floats of the kernel's and take no part.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import numpy as np

from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.model import Checksum, Ints, Layer
from v3dcad.structure.foam.sites import FoamSites


class _Sums:
    """The running sums of sites, weights and topology."""

    def __init__(self) -> None:
        self.hashes = {name: hashlib.sha256() for name in ("sites", "weights", "topology")}
        self.layers = self.walls = 0
        self._pairs = np.empty((0, 2), np.int64)

    def add(self, name: str, *numbers: Ints) -> None:
        for array in numbers:
            self.hashes[name].update(array.astype("<i8").tobytes())

    def add_layer(self, layer: Layer, pairs: Ints) -> None:
        """Count a layer, and add its pairs of neighbours (m, 2) if they are others than before."""
        before, self._pairs = self._pairs, _sorted(pairs)
        if not np.array_equal(before, self._pairs):
            self.add("topology", np.array([layer.index]), self._pairs)
        self.layers += 1
        self.walls += len(pairs)

    def checksum(self, sites: int) -> Checksum:
        whole = hashlib.sha256(np.array([self.layers, sites, self.walls]).astype("<i8").tobytes())
        for part in self.hashes.values():
            whole.update(part.digest())
        sums = {**self.hashes, "sha256": whole}
        digests = {name: sums[name].hexdigest()[:size] for name, size in Checksum.DIGITS.items()}
        return Checksum(layers=self.layers, cells=sites, walls=self.walls, **digests)


def foam_checksum(layers: Iterable[Layer], foam: FoamSites) -> Checksum:
    """The check sum of a foam's layers: its sites, each layer's time and neighbours.

    One pass, one layer in memory at a time.
    """
    sums = _Sums()
    sums.add("sites", foam.places)
    for layer in layers:
        sums.add("weights", foam.times(np.array([layer.z])))
        sums.add_layer(layer, layer.diagram.neighbours)
    return sums.checksum(len(foam.places))


def thesis_checksum(layers: Iterable[Layer], grid: Grid) -> Checksum:
    """The check sum of layers whose sites lie on `grid`, each with weights of its own.

    Sites are numbered by insertion and place, so that the order in which they were given does not
    matter. One pass, one layer in memory at a time.
    """
    sums = _Sums()
    numbers, places = np.empty(0, np.int64), np.empty((0, 2), np.int64)
    for layer in layers:
        flat = layer.state.sites[:, :2]
        numbers = _numbered(numbers, grid.snap(flat[len(numbers) :]))
        by_number = np.argsort(numbers, kind="stable")
        before, places = places, grid.snap(flat)[by_number]
        if not np.array_equal(before, places):
            sums.add("sites", np.array([layer.index]), places)
        sums.hashes["weights"].update(np.array([layer.z]).astype("<f8").tobytes())
        sums.add("weights", grid.snap_weights(layer.state.weights)[by_number])
        sums.add_layer(layer, numbers[layer.diagram.neighbours])
    return sums.checksum(len(numbers))


def _numbered(numbers: Ints, inserted: Ints) -> Ints:
    """The numbers of all sites, inserted ones (n, 2) next, in the order of their places."""
    ranks = np.empty(len(inserted), np.int64)
    ranks[np.lexsort(inserted.T[::-1])] = np.arange(len(inserted))
    return np.concatenate([numbers, len(numbers) + ranks])


def _sorted(pairs: Ints) -> Ints:
    pairs = np.sort(pairs, axis=1)
    return pairs[np.lexsort(pairs.T[::-1])]
