"""Which walls have links, on the layers so far, and where."""

from __future__ import annotations

import numpy as np

from v3dcad.model import Floats, Ints

LASTS = 10
"""Layers for which a link stays where it is."""
RESTED = LASTS
"""Layers after which a wall may have a link as if it never had had one."""


class Linked:
    """Where walls have links, and which had one lately.

    A link stays for some layers, since whenever one comes or goes a little of the beads hangs. Then
    its wall rests, so that links do not lie above each other all the way up.
    """

    def __init__(self) -> None:
        self.layer = 0
        self._walls = np.empty(0, np.int64)
        self._last = np.empty(0, np.int64)
        self._until = np.empty(0, np.int64)
        self._places = np.empty((0, 2))

    def known(self, walls: Ints) -> tuple[Ints, Floats]:
        """(n,) layers since each wall had a link, at most `RESTED`; and (n, 2) where it stays, mm.

        NaN where no link does.
        """
        rest, places = np.full(len(walls), RESTED), np.full((len(walls), 2), np.nan)
        if len(self._walls):
            place = np.minimum(np.searchsorted(self._walls, walls), len(self._walls) - 1)
            (known,) = np.nonzero(self._walls[place] == walls)
            place = place[known]
            rest[known] = self.layer - self._last[place]
            stay = (rest[known] == 1) & (self._until[place] > self.layer)
            places[known[stay]] = self._places[place[stay]]
        return rest, places

    def note(self, walls: Ints, places: Floats) -> None:
        """Remember the walls that have a link on this layer, and where; go on to the next."""
        until = np.full(len(walls), self.layer + LASTS)
        if self.layer == 0:  # Those of the first layer do not all go at once.
            until -= np.arange(len(walls)) % LASTS
        _, stays = self.known(walls)
        (old,) = np.nonzero(~np.isnan(stays[:, 0]))
        until[old] = self._until[np.searchsorted(self._walls, walls[old])]
        still = self.layer + 1 - self._last < RESTED
        self._walls, first = np.unique(
            np.concatenate([walls, self._walls[still]]), return_index=True
        )
        last = np.full(len(walls), self.layer)
        self._last = np.concatenate([last, self._last[still]])[first]
        self._until = np.concatenate([until, self._until[still]])[first]
        self._places = np.concatenate([places, self._places[still]])[first]
        self.layer += 1
