"""Which walls have links, on the layers so far, and where."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatRows,
    ConstIntArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.model import Floats, Ints

LASTS = 10
"""Layers for which a link stays where it is."""
RESTED = LASTS
"""Layers after which a wall may have a link as if it never had had one."""


class Links(NamedTuple):
    """The last link of some walls."""

    walls: IntArray
    """(n,) ascending"""
    last: IntArray
    """(n,) the last layer on which each had a link"""
    until: IntArray
    """(n,) the layer until which that stays"""
    places: FloatRows
    """(n, 2) mm, where it was"""

    @classmethod
    def of(cls, count: int) -> Links:
        """Room for so many."""
        walls, last, until = np.empty((3, count), np.int64)
        return cls(walls, last, until, np.empty((count, 2)))


class Linked:
    """Where walls have links, and which had one lately.

    A link stays for some layers, since whenever one comes or goes a little of the beads hangs. Then
    its wall rests, so that links do not lie above each other all the way up.
    """

    def __init__(self) -> None:
        self.layer = 0
        self._links = Links.of(0)

    def known(self, walls: Ints) -> tuple[Ints, Floats, Ints]:
        """What is known of walls (n,), for `note`, too.

        Layers (n,) since each had a link, at most `RESTED`; where it stays (n, 2), mm, NaN where
        none does; and until which layer (n,) its link stays then, or a new one would.
        """
        rest, until = np.empty((2, len(walls)), np.int64)
        places = np.empty((len(walls), 2))
        _recall(self._links, self.layer, walls, rest, places, until)
        return rest, places, until

    def note(self, walls: Ints, places: Floats, until: Ints) -> None:
        """Remember the walls that have a link on this layer, and where; go on to the next.

        Each stays `until` (n,) some layer, as `known` told.
        """
        if self.layer == 0:  # Those of the first layer do not all go at once.
            until = until - np.arange(len(walls)) % LASTS
        order = np.argsort(walls, kind="stable")
        links = Links.of(len(walls) + len(self._links.walls))
        size = _merge(self._links, self.layer, order, walls, places, until, links)
        self._links = Links._make(part[:size] for part in links)
        self.layer += 1


@compiled(UNCOUNTED)
def _recall(
    links: Links,
    layer: int,
    walls: ConstIntArray,
    rest: IntArray,
    places: FloatRows,
    until: IntArray,
) -> None:
    for k in range(len(walls)):
        rest[k], until[k] = RESTED, layer + LASTS
        places[k, 0] = places[k, 1] = np.nan
        found = int(np.searchsorted(links.walls, walls[k]))
        if found == len(links.walls) or links.walls[found] != walls[k]:
            continue
        rest[k] = layer - links.last[found]
        if rest[k] == 1 and links.until[found] > layer:
            places[k, 0], places[k, 1] = links.places[found, 0], links.places[found, 1]
            until[k] = links.until[found]


@compiled(INTERNAL)
def _kept(old: Links, k: int, layer: int, links: Links, size: int) -> int:
    """How many `links` there are with an old one, which goes once its wall has rested."""
    if layer + 1 - old.last[k] >= RESTED:
        return size
    links.walls[size], links.last[size], links.until[size] = old.walls[k], old.last[k], old.until[k]
    links.places[size, 0], links.places[size, 1] = old.places[k, 0], old.places[k, 1]
    return size + 1


@compiled(UNCOUNTED)
def _merge(
    old: Links,
    layer: int,
    order: ConstIntArray,
    walls: ConstIntArray,
    places: ConstFloatRows,
    until: ConstIntArray,
    links: Links,
) -> int:
    """How many `links` there are with those of a layer, whose walls' `order` is given.

    Of two of them that a wall has, the first in order counts; the old one never does.
    """
    size = k = 0
    for new in order:
        wall = walls[new]
        if size > 0 and links.walls[size - 1] == wall:
            continue
        while k < len(old.walls) and old.walls[k] <= wall:
            if old.walls[k] < wall:
                size = _kept(old, k, layer, links, size)
            k += 1
        links.walls[size], links.last[size], links.until[size] = wall, layer, until[new]
        links.places[size, 0], links.places[size, 1] = places[new, 0], places[new, 1]
        size += 1
    for rest in range(k, len(old.walls)):
        size = _kept(old, rest, layer, links, size)
    return size
