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

    def known(self, walls: Ints) -> tuple[Ints, Floats, Ints]:
        """What is known of walls (n,), for `note`, too.

        Layers (n,) since each had a link, at most `RESTED`; where it stays (n, 2), mm, NaN where
        none does; and until which layer (n,) its link stays then, or a new one would.
        """
        rest, places = np.full(len(walls), RESTED), np.full((len(walls), 2), np.nan)
        until = np.full(len(walls), self.layer + LASTS)
        if len(self._walls):
            place = np.minimum(np.searchsorted(self._walls, walls), len(self._walls) - 1)
            (known,) = np.nonzero(self._walls[place] == walls)
            place = place[known]
            rest[known] = self.layer - self._last[place]
            stay = (rest[known] == 1) & (self._until[place] > self.layer)
            places[known[stay]] = self._places[place[stay]]
            until[known[stay]] = self._until[place[stay]]
        return rest, places, until

    def note(self, walls: Ints, places: Floats, until: Ints) -> None:
        """Remember the walls that have a link on this layer, and where; go on to the next.

        Each stays `until` (n,) some layer, as `known` told.
        """
        if self.layer == 0:  # Those of the first layer do not all go at once.
            until = until - np.arange(len(walls)) % LASTS
        still = self.layer + 1 - self._last < RESTED
        self._walls, first = np.unique(
            np.concatenate([walls, self._walls[still]]), return_index=True
        )
        last = np.full(len(walls), self.layer)
        self._last = np.concatenate([last, self._last[still]])[first]
        self._until = np.concatenate([until, self._until[still]])[first]
        self._places = np.concatenate([places, self._places[still]])[first]
        self.layer += 1
