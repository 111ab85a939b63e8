"""Ribs under skins: where cells are too wide for a skin to span, walls grow into them from below.

A rib is a wall that ends in a cell. Its tip leans by no more than 45°, so that it needs no support.
Ribs begin as late as can be: just under the skin those from both sides meet.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Iterator

import numpy as np

from v3dcad.geometry.loops.loops import Loops
from v3dcad.geometry.loops.ribs import Gaps, Needs, with_ribs
from v3dcad.geometry.loops.strips import Strips
from v3dcad.model import Layer
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.cell_loops import cell_loops
from v3dcad.toolpath.division import Division

EARLY = 1.0
"""mm below a skin where ribs have met."""
PAST = 1.0
"""mm that ribs hold beside what is to be held: skins reach a little further."""


def slope(division: Division) -> float:
    """How far a rib's tip goes on for each mm that layers rise: at most half a bead a layer."""
    return min(division.spacing / 2 / division.height, 1.0)


def reach(area_per_cell: float, slope: float) -> float:
    """How far under a skin ribs are made, mm, in cells of so many mm².

    In the narrower direction most cells are not wider than twice the square root of that.
    """
    return EARLY + math.sqrt(area_per_cell) / slope


class Ribs:
    """What makes the loops of cells with ribs, layer by layer, from the lowest one on."""

    def __init__(self, settings: PrintSettings) -> None:
        self._pitch = settings.rib_pitch()
        self._above: deque[Division] = deque()
        self._level = 0.0
        self._gaps: Gaps | None = None
        self.walls = np.empty((0, 2, 2))
        """(r, 2, 2) mm, both ends of the last layer's ribs"""

    def looking_up(
        self, found: Iterable[tuple[Layer, Division]]
    ) -> Iterator[tuple[Layer, Division]]:
        """Layers as they are divided, each as soon as those within its `reach` are known."""
        waiting: deque[tuple[Layer, Division]] = deque()
        for layer, division in found:
            waiting.append((layer, division))
            self.note(division)
            while waiting and division.level - waiting[0][1].level >= self._reach(*waiting[0]):
                yield waiting.popleft()
        yield from waiting

    def _reach(self, layer: Layer, division: Division) -> float:
        if not self._pitch or not division.printed:
            return 0.0
        return reach(layer.area_per_cell, slope(division))

    def note(self, division: Division) -> None:
        """Take note of what is to be held up on the next layer above."""
        if len(division.bands.band):
            self._above.append(division)

    def under(self, level: float, reach: float) -> bool:
        """Whether there is something to hold up at most `reach` over a level, mm."""
        while self._above and self._above[0].level <= level:
            self._above.popleft()
        return bool(self._above) and self._above[0].level - level < reach

    def loops(self, layer: Layer, division: Division) -> Loops:
        """The loops of a layer's cells, with ribs where something above is to be held up."""
        rise, self._level = division.level - self._level, division.level
        self.walls = np.empty((0, 2, 2))
        loops = cell_loops(layer, division.foam, division.spacing)
        if not self.under(division.level, self._reach(layer, division)):
            self._gaps = None
            return loops
        strips, steep = Strips(self._pitch, division.spacing / 2), slope(division)
        found = with_ribs(loops, strips, self._needs(), self._gaps, steep * rise, steep)
        self._gaps, self.walls = found.gaps, found.ribs
        return found.loops

    def _needs(self) -> Needs:
        """What is to be held up on the lines at both sides of bands."""
        sides = [(over.level, over.bands, side) for over in self._above for side in (0, 1)]
        line = np.concatenate([bands.band + side for _, bands, side in sides])
        ends = np.concatenate([bands.ends for _, bands, _ in sides])
        level = np.concatenate([np.full(len(bands.band), level) for level, bands, _ in sides])
        order = np.argsort(line, kind="stable")
        wide = ends[order] + np.array([-PAST, PAST])
        return Needs(line[order], wide, np.maximum(level[order] - self._level - EARLY, 0.0))
