"""The sites of one layer of the thesis's method."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from v3dcad.geometry.graphs.spanning_tree import spanning_tree
from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.model import Floats, Ints, Value


@dataclass(frozen=True, eq=False, slots=True)
class PlaneSites(Value):
    """Sites of a plane, on a grid, with weights of their own."""

    grid: Grid
    flat: Floats
    """(n, 2) mm"""
    weights: Floats
    """(n,) mm²"""
    growth: Floats
    """(n,) mm² per mm of height"""

    @property
    def sites(self) -> Floats:
        """(n, 3) mm, z = 0."""
        return np.column_stack([self.flat, np.zeros(len(self.flat))])

    def present(self) -> Ints:
        """(n,) all sites."""
        return np.arange(len(self.weights))

    def spanning_tree(self, pairs: Ints) -> Ints:
        """The minimum spanning forest (k, 2) of pairs (m, 2), i < j, in the order of the sites."""
        tree = spanning_tree(self.grid.snap(self.flat), np.asarray(pairs))
        return np.asarray(tree[np.lexsort(tree.T[::-1])])
