"""The sites of a foam as whole numbers, on the grid of its structure.

A slice of the Voronoi diagram of sites (x, y, z) under the metric Δx² + Δy² + Δz² / s² is a power
diagram. With heights divided by the stretch s and counted in steps of the grid of x and y, a site
at k steps weighs k · t − k² steps² at a height of t / 2 steps (for all sites that is t² / 4 more
than by the metric, which changes nothing). So s is not in the predicates, and t = 2 z / (s · pitch)
rounded is the engine's time: heights are snapped to half steps, s · pitch / 2 mm.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from v3dcad.geometry.graphs.spanning_tree import spanning_tree_of
from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.model import Floats, Ints, Value
from v3dcad.structure.sweep.sites import ALWAYS, SweptSites

HEIGHTS = 4
"""A block of the sweep is as high as so many of the highest cells."""

COLUMN = 1 << 50
"""The only block, in time units, where no cell ever closes."""


@dataclass(frozen=True, eq=False, slots=True)
class FoamSites(Value):
    """Sites in the stretched space, in grid steps, and between which heights each has a cell."""

    grid: Grid
    """of x and y"""
    stretch: float
    """mm of height to a mm of the stretched space"""
    places: Ints
    """(n, 3) x and y from the grid's corner, z from the bed"""
    spans: Ints
    """(n, 2) lowest and highest z that the cell may reach; from −`ALWAYS` to `ALWAYS` where nothing
    is known, the other way round where it is known to lie outside the part"""

    @property
    def step(self) -> float:
        """The height of one step, mm."""
        return self.stretch * self.grid.pitch

    def millimetres(self) -> Floats:
        """The sites (n, 3), mm, bed coordinates."""
        flat = self.grid.millimetres(self.places[:, :2])
        return np.column_stack([flat, self.places[:, 2] * self.step])

    def nearest(self, points: Floats) -> Ints:
        """The nearest site (k,) to points (k, 3), mm, in the stretched space."""
        squeezed = np.array([1, 1, 1 / self.stretch])
        tree = KDTree(self.millimetres() * squeezed)
        return np.asarray(tree.query(points * squeezed)[1], np.int64)

    def times(self, heights: Floats) -> Ints:
        """The whole times (k,) of heights (k,), mm."""
        return np.rint(2 * heights / self.step).astype(np.int64)

    def block(self) -> int:
        """The length of the sweep's blocks, in time units."""
        low = self.spans[:, 0]
        if (low <= -ALWAYS).any():
            return COLUMN
        reach = np.abs(self.spans - self.places[:, 2:])[low < ALWAYS].max(initial=0)
        return 2 * HEIGHTS * int(reach) + 2

    def swept(self) -> SweptSites:
        """The sites as the sweep takes them."""
        opens, closes = np.clip(2 * self.spans, -ALWAYS, ALWAYS).T
        numbers = np.arange(len(self.places))
        flat, heights = self.places[:, :2], self.places[:, 2]
        return SweptSites(flat, heights, np.zeros_like(numbers), opens, closes, numbers)


@dataclass(frozen=True, eq=False, slots=True)
class SlicedSites:
    """The state of a foam's sites on one layer: weights are computed when they are asked for."""

    foam: FoamSites
    sites: Floats
    """(n, 3) mm"""
    time: int
    """twice the layer's height, in steps"""

    @property
    def weights(self) -> Floats:
        """(n,) mm²: −((z − zᵢ) / s)² at the snapped height z: powers are squared distances."""
        above = (self.time - 2 * self.foam.places[:, 2]) * (self.foam.grid.pitch / 2)
        return np.asarray(-(above**2), np.float64)

    @property
    def growth(self) -> Floats:
        """(n,) mm² per mm of height: 2 zᵢ / s², without the −2 z / s² that all have."""
        return np.asarray(2 * self.foam.places[:, 2] * (self.foam.grid.pitch / self.foam.stretch))

    def present(self) -> Ints:
        """(p,) the sites between whose lowest and highest corner the layer lies."""
        low, high = self.foam.spans.T
        return np.flatnonzero((2 * low <= self.time) & (2 * high >= self.time))

    def spanning_tree(self, pairs: Ints) -> Ints:
        """The minimum spanning forest (k, 2) of pairs (m, 2), i < j, by distance in x and y."""
        return spanning_tree_of(self.foam.places[:, :2], pairs)
