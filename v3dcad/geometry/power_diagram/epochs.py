"""Weights and growths that stay small however long points have grown.

A power diagram does not change when the same number is taken off all weights, and its motion does
not when that number is linear in time. So time is divided into epochs. In each, three numbers
count as 0: the time at its beginning, the weight of the heaviest point then, and the growth of
the slowest point that still had a cell. An epoch lasts until some weight may leave the safe range.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.power_diagram.grid import HEAVIEST
from v3dcad.model import Ints


class Epoch(NamedTuple):
    """What counts as 0 in an epoch."""

    start: int = 0
    """the whole time at which it begins"""
    weight: int = 0
    """steps², of the heaviest point then"""
    growth: int = 0
    """steps² per unit of time, of the slowest point that has a cell then"""

    def counts(self, base: Ints, growth: Ints, born: Ints) -> tuple[Ints, Ints]:
        """The base weights and growths of points (p,) as they count in this epoch, and in its time.

        Points that have no cell anywhere when it begins, if they are lighter than the safe range
        or slower than all that have one, stay as heavy as they are, or at its lower end.

        They have no cell later, either. A point p in the frame has none while its weight is at
        most that of the lower hull there, Σ λ (w − |v − p|²) over the corners v of any triangle
        around p, where λ are p's barycentric coordinates. As the epoch begins take for corners
        the heaviest point (w = 0, at most √2 of the frame's side away) and two sentinels (w = 0,
        at most √50 away): since these stand four sides outside, λ ≥ 4/5 for the first, and the sum
        is at least −(4/5) 2 − (1/5) 50 = −11.6 of the frame's area. The safe range ends at −16.
        After that no weight of an epoch falls, so that the hull does not.
        """
        weight = base + growth * self.start - self.weight
        gone = (born <= self.start) & (weight < -HEAVIEST)
        base = np.where(gone, -HEAVIEST, weight)
        growth = np.where(gone, 0, np.maximum(growth - self.growth, 0))
        return base, growth

    def last(self, growth: Ints) -> int:
        """Until when, in its own time, the epoch lasts with points of such growth (p,) in it.

        No weight is above 0 when it begins, and none gains more than the safe range.
        """
        return HEAVIEST // max(int(growth.max(initial=0)), 1)


FIRST = Epoch()
"""In which everything counts as what it is."""
