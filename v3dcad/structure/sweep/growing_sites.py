"""Sites whose weights grow linearly: in the engine's whole numbers, and in mm for each layer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.model import Floats, Ints, SiteState, Value


@dataclass(frozen=True, eq=False, slots=True)
class Timed(Value):
    """Sites whose weights are linear in a whole time, in grid units. Rows are the engine's points:
    sites along a curve first, newborns after them.
    """

    places: Ints
    """(n, 2) grid steps"""
    base: Ints
    """(n,) steps²: weight at time 0"""
    growth: Ints
    """(n,) steps² per unit of time"""
    born: Ints
    """(n,) time of birth, or `ALWAYS`"""
    born_at: Floats
    """(n,) mm, height of birth; 0 for those that were there from the start"""
    site_of: Ints
    """(n,) site numbers"""

    def rows(self, rows: Ints | slice) -> Timed:
        """Some rows only, or in another order."""
        return Timed(
            self.places[rows],
            self.base[rows],
            self.growth[rows],
            self.born[rows],
            self.born_at[rows],
            self.site_of[rows],
        )

    def and_newborn(self, others: Sequence[Timed]) -> Timed:
        """These and others after them."""
        parts = [self, *others]
        return Timed(
            np.concatenate([part.places for part in parts]),
            np.concatenate([part.base for part in parts]),
            np.concatenate([part.growth for part in parts]),
            np.concatenate([part.born for part in parts]),
            np.concatenate([part.born_at for part in parts]),
            np.concatenate([part.site_of for part in parts]),
        )

    def by_site(self) -> Timed:
        """In the order of the sites' numbers."""
        return self.rows(np.argsort(self.site_of, kind="stable"))


class SiteStates:
    """The states of layers: views of columns that newborns are added to."""

    def __init__(self, grid: Grid, growth_step: float, sites: Timed) -> None:
        """Hold sites that gain `growth_step` mm² per mm and unit of growth."""
        self._grid = grid
        self._growth_step = growth_step
        self._count = 0
        whole = np.empty(0, np.int64)
        self._columns: list[NDArray[Any]] = [
            np.empty((0, 2)), np.empty(0), np.empty(0), whole, whole
        ]  # fmt: skip
        self._views = self._columns
        self.add(sites.by_site())

    def __len__(self) -> int:
        return self._count

    def add(self, sites: Timed) -> None:
        """Add sites with the next numbers."""
        new = [
            self._grid.millimetres(sites.places),
            self._growth_step * sites.growth,
            sites.born_at,
            sites.base,
            sites.growth,
        ]
        before, self._count = self._count, self._count + len(sites.growth)
        if self._count > len(self._columns[1]):
            self._columns = [
                np.concatenate([old[:before], now, np.empty_like(old[:before])])
                for old, now in zip(self._columns, new, strict=True)
            ]
            self._views = [column.view() for column in self._columns]
            for view in self._views:
                view.flags.writeable = False  # so that the values need no views of their own
        else:
            for column, now in zip(self._columns, new, strict=True):
                column[before : self._count] = now

    def at(self, count: int, time: int) -> SiteState:
        """The state of the first `count` sites at a whole time."""
        places, speed, born_at, base, growth = (column[:count] for column in self._views)
        weights = growth * time
        weights += base
        return SiteState(places, weights * self._grid.pitch**2, speed, born_at)
