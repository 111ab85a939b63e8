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
from v3dcad.geometry.loops.ribs import Gaps, Lines, Needs, with_ribs
from v3dcad.model import Ints, Layer
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.cell_loops import cell_loops
from v3dcad.toolpath.division import Division

EARLY = 1.0
"""mm below a skin where ribs have met."""
PAST = 1.0
"""mm that ribs hold beside what is to be held: skins reach a little further."""
LATE = 1 / 3
"""Widths of a cell below a skin in which none opens: ribs would not keep up with its walls."""
NARROW = 0.4
"""Shares of the pitch: cells that are no wider need no ribs; some widen before the skin."""


def reach(area_per_cell: float) -> float:
    """How far under a skin ribs are made, mm, in cells of so many mm².

    In the narrower direction most cells are not wider than twice that.
    """
    return EARLY + math.sqrt(area_per_cell)


class Ribs:
    """What makes the loops of cells with ribs, layer by layer, from the lowest one on."""

    def __init__(self, settings: PrintSettings) -> None:
        self._pitch = settings.rib_pitch()
        self._above: deque[Division] = deque()
        self._level = 0.0
        self._gaps: Gaps | None = None
        self._sites: Ints | None = None
        self._late = np.empty(0, np.int64)
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
            while waiting and division.level - waiting[0][1].level >= self._reach(waiting[0][0]):
                yield waiting.popleft()
        yield from waiting

    def _reach(self, layer: Layer) -> float:
        return reach(layer.area_per_cell) if self._pitch else 0.0

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
        level, height, spacing = division.level, division.height, division.spacing
        rise, self._level = level - self._level, level
        self.walls = np.empty((0, 2, 2))
        if not self.under(level, self._reach(layer)):
            self._gaps = self._sites = None
            return cell_loops(layer, division.foam, spacing)
        loops = cell_loops(layer, division.foam, spacing, self._without(layer))
        slope = min(spacing / 2 / height, 1.0)
        lines = Lines(self._pitch, spacing / 2, NARROW * self._pitch + spacing)
        found = with_ribs(loops, lines, self._needs(), self._gaps, slope * rise, slope)
        self._gaps, self.walls = found.gaps, found.ribs
        return found.loops

    def _without(self, layer: Layer) -> Ints:
        """The sites of cells that have opened too late under a skin; they are left out."""
        sites = layer.diagram.sites()
        if self._sites is not None:
            new = np.setdiff1d(sites, self._sites)
            places, late = layer.state.sites[new, :2], np.zeros(len(new), np.bool_)
            for over in self._above:
                if len(new) and over.level - self._level < LATE * math.sqrt(layer.area_per_cell):
                    late |= over.bands.hold(places)
            self._late = np.concatenate([self._late, new[late]])
        self._sites = sites
        return self._late

    def _needs(self) -> Needs:
        """What is to be held up on the lines at both sides of bands."""
        sides = [(over.level, over.bands, side) for over in self._above for side in (0, 1)]
        line = np.concatenate([bands.band + side for _, bands, side in sides])
        ends = np.concatenate([bands.ends for _, bands, _ in sides])
        level = np.concatenate([np.full(len(bands.band), level) for level, bands, _ in sides])
        order = np.argsort(line, kind="stable")
        wide = ends[order] + np.array([-PAST, PAST])
        return Needs(line[order], wide, np.maximum(level[order] - self._level - EARLY, 0.0))
