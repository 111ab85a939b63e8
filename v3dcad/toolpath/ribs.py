"""Ribs under skins: where cells are too wide for a skin to span, walls grow into them from below.

A rib is a wall that ends in a cell. Its tip leans by no more than 45°, so that ribs need no
support. They begin as late as can be: where the skin is reached, those from both sides meet.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.loops.loops import Loops
from v3dcad.geometry.loops.ribs import Gaps, Lines, Needs, with_ribs
from v3dcad.model import Layer
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.bands import Bands
from v3dcad.toolpath.division import Division

REACH = 12.0
"""mm below a skin in which ribs are made: enough for cells of twice as much."""
EARLY = 1.0
"""mm below a skin where ribs have met."""
PAST = 1.0
"""mm by which they hold more than the skin takes."""


class _Above(NamedTuple):
    """What is to be held up, and how high."""

    level: float
    bands: Bands


class Ribs:
    """What makes the ribs of a print, layer by layer."""

    def __init__(self, settings: PrintSettings) -> None:
        self._pitch = settings.rib_pitch()
        self._above: deque[_Above] = deque()
        self._gaps: Gaps | None = None
        self.walls = np.empty((0, 2, 2))
        """(r, 2, 2) mm, both ends of the last layer's ribs"""

    def looking_up(
        self, found: Iterable[tuple[Layer, Division]]
    ) -> Iterator[tuple[Layer, Division]]:
        """Layers with what they are divided into, as soon as those `REACH` above are known."""
        waiting: deque[tuple[Layer, Division]] = deque()
        for layer, division in found:
            waiting.append((layer, division))
            if len(division.bands.band):
                self._above.append(_Above(division.level, division.bands))
            while not self._pitch or division.level - waiting[0][1].level >= REACH:
                yield waiting.popleft()
                if not waiting:
                    break
        yield from waiting

    def grown(self, loops: Loops, division: Division) -> Loops:
        """The loops of a layer's cells, with the ribs that are to hold up what is above."""
        level, height, spacing = division.level, division.height, division.spacing
        while self._above and self._above[0].level <= level:
            self._above.popleft()
        self.walls = np.empty((0, 2, 2))
        if not self._above or self._above[0].level - level >= REACH:
            self._gaps = None
            return loops
        step = min(height, spacing / 2)
        lines = Lines(self._pitch, spacing / 2, 0.8 * self._pitch + spacing)
        needs = self._needs(level)
        found = with_ribs(loops, lines, needs, self._gaps, step, step / height)
        self._gaps, self.walls = found.gaps, found.ribs
        return found.loops

    def _needs(self, level: float) -> Needs:
        """What is to be held up over a level (mm), on the lines at both sides of bands."""
        line = np.concatenate([over.bands.band + side for over in self._above for side in (0, 1)])
        ends = np.concatenate([over.bands.ends for over in self._above for _ in range(2)])
        above = np.repeat(
            [over.level - level - EARLY for over in self._above],
            [2 * len(over.bands.band) for over in self._above],
        )
        order = np.argsort(line, kind="stable")
        wide = ends[order] + np.array([-PAST, PAST])
        return Needs(line[order], wide, np.maximum(above[order], 0.0))
