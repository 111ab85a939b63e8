"""Sites as the engine takes them: whole numbers, and when each may have a cell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from v3dcad.geometry.power_diagram.grid import curve_order
from v3dcad.model import Ints, Value

ALWAYS = 1 << 60
"""Times as early and as late as this are no limits."""


@dataclass(frozen=True, eq=False, slots=True)
class SweptSites(Value):
    """Sites that a plane sweeps over; at a whole time t it is t / 2 steps high.

    A site at k steps with a weight w of its own weighs w + k · t − k² then, in steps².
    """

    places: Ints
    """(n, 2) grid steps"""
    heights: Ints
    """(n,) grid steps: how much weight a site gains in one unit of time"""
    weights: Ints
    """(n,) steps², of each site itself"""
    opens: Ints
    """(n,) no cell before this time; −`ALWAYS` where nothing is known"""
    closes: Ints
    """(n,) no cell after this time; `ALWAYS` where nothing is known"""
    numbers: Ints
    """(n,) the sites' numbers"""

    def weights_at(self, time: int) -> Ints:
        """(n,) what they weigh at a time, steps²."""
        return np.asarray(self.weights + self.heights * (time - self.heights))

    def present(self, first: int, last: int) -> SweptSites:
        """Those that may have a cell from time to time."""
        return self._rows(np.flatnonzero((self.opens <= last) & (self.closes >= first)))

    def since(self, origin: int) -> SweptSites:
        """The same with times counted from an even origin, and heights from the plane there.

        With h = origin / 2, all weights lose h · t − h², which changes no diagram.
        """
        return SweptSites(
            self.places,
            self.heights - origin // 2,
            self.weights,
            self.opens - origin,
            self.closes - origin,
            self.numbers,
        )

    def in_order(self, times: Ints) -> tuple[SweptSites, int]:
        """In the order in which they may enter at ascending times (k,), those of one time along a
        curve; and how many are there at the first.
        """
        layer = np.searchsorted(times, self.opens)
        along = np.empty(len(layer), np.int64)
        along[curve_order(self.places)] = np.arange(len(layer))
        order = np.lexsort((along, layer))
        return self._rows(order), int(np.count_nonzero(layer == 0))

    def _rows(self, rows: Ints) -> SweptSites:
        return SweptSites(
            self.places[rows],
            self.heights[rows],
            self.weights[rows],
            self.opens[rows],
            self.closes[rows],
            self.numbers[rows],
        )
