"""How sizes and areas of cells are distributed over the height."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from v3dcad.model import OUTSIDE, Floats, Ints, Layer, Value

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
"""The shares of cells that are smaller."""

NO_CELL = np.full(len(QUANTILES), np.nan)


@dataclass(frozen=True, eq=False, slots=True)
class SizeDistribution(Value):
    """How large the cells of each layer are, of those that no contour cuts."""

    z: Floats
    """(k,) mm above the bed"""
    cells: Ints
    """(k,) how many cells the layer has that no contour cuts"""
    areas: Floats
    """(k, 5) mm²: the quantiles `QUANTILES` of their areas; NaN where there is no such cell"""

    @property
    def sizes(self) -> Floats:
        """(k, 5) mm: the same of the sides of squares of the same areas."""
        return np.sqrt(self.areas)


def size_distribution(layers: Iterable[Layer]) -> SizeDistribution:
    """Measure the whole cells of each layer. Goes through the layers once."""
    heights: list[float] = []
    counts: list[int] = []
    areas: list[Floats] = []
    for layer in layers:
        diagram = layer.diagram
        cut = diagram.edge_sites[diagram.edge_sites[:, 0] == OUTSIDE, 1]
        whole = np.setdiff1d(diagram.sites(), cut)
        found = diagram.areas(len(layer.state.sites))[whole]
        heights.append(layer.z)
        counts.append(len(whole))
        areas.append(np.quantile(found, QUANTILES) if len(whole) else NO_CELL)
    return SizeDistribution(
        np.array(heights), np.array(counts, np.int64), np.reshape(areas, (-1, len(QUANTILES)))
    )
