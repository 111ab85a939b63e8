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
    """Sites whose weights at a whole time t are base + growth · t, in grid units.

    A site of the foam at k steps of the stretched space has base −k² and growth k: t is twice the
    height, in steps. A site that stays as it is has growth 0.
    """

    places: Ints
    """(n, 2) grid steps"""
    base: Ints
    """(n,) steps²"""
    growth: Ints
    """(n,) steps² per unit of time"""
    opens: Ints
    """(n,) no cell before this time; −`ALWAYS` where nothing is known"""
    closes: Ints
    """(n,) no cell after this time; `ALWAYS` where nothing is known"""
    numbers: Ints
    """(n,) the sites' numbers"""

    def present(self, first: int, last: int) -> SweptSites:
        """Those that may have a cell from time to time."""
        return self._rows(np.flatnonzero((self.opens <= last) & (self.closes >= first)))

    def since(self, origin: int) -> SweptSites:
        """The same with times counted from an even origin, 2 h.

        All weights lose h · t − h², which changes no diagram: so those of the foam's sites become
        what they would be with their heights counted from h, and stay small.
        """
        h = origin // 2
        return SweptSites(
            self.places,
            self.base + self.growth * origin - h * h,
            self.growth - h,
            self.opens - origin,
            self.closes - origin,
            self.numbers,
        )

    def in_order(self, times: Ints) -> tuple[SweptSites, int]:
        """In the order in which they may enter at ascending times (k,), those of one time along a
        curve; and how many are there at the first.
        """
        layer = np.searchsorted(times, self.opens)
        layer[self.opens <= times[0]] = 0
        along = np.empty(len(layer), np.int64)
        along[curve_order(self.places)] = np.arange(len(layer))
        order = np.lexsort((along, layer))
        return self._rows(order), int(np.count_nonzero(layer == 0))

    def _rows(self, rows: Ints) -> SweptSites:
        return SweptSites(
            self.places[rows],
            self.base[rows],
            self.growth[rows],
            self.opens[rows],
            self.closes[rows],
            self.numbers[rows],
        )
