"""The certificate of a print as a whole: what hangs on each layer, as arrays and in words."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from v3dcad.model import Floats, Ints, Value
from v3dcad.toolpath.overhang import HELP, KINDS, span_words

if TYPE_CHECKING:
    from v3dcad.toolpath.report import LayerReport

HOLDS = 5.0
"""mm: longer spans are worth a word; shorter ones print well as a rule."""


@dataclass(frozen=True, eq=False, slots=True)
class PrintedOverhang(Value):
    """What of the printed beads has nothing under it: a row for each layer, a column for each kind.

    A bead hangs where more than half of its width has no bead of the layer below under it. A span
    is a stretch that touches nothing below, from edge to edge of what holds it; it is as long as
    its farthest two places are apart.
    """

    kinds: ClassVar = tuple(KINDS)
    """what is told apart: perimeters, skins, bridges, walls"""
    layer: Ints
    """(l,) indexes of the layers that are printed"""
    level: Floats
    """(l,) mm above the bed, where their beads end"""
    length: Floats
    """(l, 4) mm of bead that hangs"""
    area: Floats
    """(l, 4) mm² that it fills"""
    span: Floats
    """(l, 4) mm: the longest span; 0 where all beads touch the layer below"""
    place: Floats
    """(l, 4, 2) mm, bed coordinates: in the middle of the longest span; NaN where there is none"""
    over_cells: NDArray[np.bool_]
    """(l, 4) whether the part goes on under that place: it spans cells, and air otherwise"""

    def line(self) -> str:
        """The certificate in one line: the longest spans of each kind, and how much hangs."""
        longest = [
            f"{self.span[row, kind]:.1f} mm of {self.kinds[kind]} over {self._over(row, kind)} "
            f"at z {self.level[row]:.4g}"
            for row, kind in self._longest()
        ]
        spans = f"at most {', '.join(longest)}" if longest else "none: every bead touches the last"
        area = float(self.area.sum())
        return f"{spans}; {area:.4g} mm² hang by more than half a bead" if area else spans

    def findings(self) -> list[str]:
        """A sentence for each kind of beads that spans more than `HOLDS` over air, or over cells:
        where, how far, how often, and what helps.
        """
        told = []
        for row, kind in self._longest():
            span, over = float(self.span[row, kind]), self._over(row, kind)
            if span > HOLDS:
                words = span_words(
                    self.kinds[kind], over, span, self.level[row], self.place[row, kind]
                )
                same = self.over_cells[:, kind] == self.over_cells[row, kind]
                count = int(np.count_nonzero(same & (self.span[:, kind] > HOLDS)))
                more = f", {count} layers over {HOLDS:g} mm" if count > 1 else ""
                told.append(f"{words} on layer {self.layer[row]}{more}: {HELP[over]}")
        return told

    def _longest(self) -> list[tuple[int, int]]:
        """Row and kind of the longest span of each kind, over air and over cells."""
        found = []
        for kind in range(len(self.kinds)):
            for cells in (False, True):
                spans = np.where(self.over_cells[:, kind] == cells, self.span[:, kind], 0.0)
                if spans.max(initial=0.0) > 0:
                    found.append((int(np.argmax(spans)), kind))
        return found

    def _over(self, row: int, kind: int) -> str:
        return "cells" if self.over_cells[row, kind] else "air"


def printed_overhang(reports: Iterable[LayerReport]) -> PrintedOverhang:
    """The certificate of a print, from what tracing its layers told."""
    printed = [report for report in reports if report.level]
    kinds = list(KINDS)
    numbers = np.zeros((3, len(printed), len(kinds)))
    place = np.full((len(printed), len(kinds), 2), np.nan)
    over_cells = np.zeros((len(printed), len(kinds)), dtype=bool)
    for row, report in enumerate(printed):
        for found in report.hanging:
            kind = kinds.index(found.what)
            numbers[:, row, kind] = found.length, found.area, found.span
            if found.span:
                place[row, kind] = found.place
                over_cells[row, kind] = found.over == "cells"
    layer = np.array([report.layer for report in printed], dtype=np.int64)
    level = np.array([report.level for report in printed], dtype=np.float64)
    length, area, span = numbers
    return PrintedOverhang(layer, level, length, area, span, place, over_cells)
