"""How much plastic the layers of a part take, before all of them are traced.

Perimeters, skins and cells have a room each in a section. How full beads make it hardly differs
from layer to layer: so rooms are measured on all layers, and beads are laid on some of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.loops.coverage import covered
from v3dcad.geometry.loops.links import Linked
from v3dcad.model import (
    BRIDGE,
    CELLS,
    FEATURES,
    INNER_PERIMETER,
    PERIMETER,
    SOLID,
    Floats,
    Ints,
    Layer,
    Section,
)
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.bead import bead_areas
from v3dcad.toolpath.division import Division, divided
from v3dcad.toolpath.plan import Plan
from v3dcad.toolpath.ribs import Ribs, reach, slope
from v3dcad.toolpath.seam import Seams
from v3dcad.toolpath.stroke import capped, lines_of

SAMPLED = 24
"""Layers on which beads are laid, for each kind of room."""

COARSE = 1.0
"""mm between the layers on which ribs are grown."""

KINDS = ((PERIMETER, INNER_PERIMETER), (SOLID, BRIDGE), (CELLS,))
"""The features that fill each kind of room. Brim and skirt are not the part's."""


class Plastic(NamedTuple):
    """What a part takes, mm³."""

    perimeters: float
    skins: float
    cells: float

    def total(self) -> float:
        """All of it, mm³."""
        return sum(self)


class _Printed(NamedTuple):
    """A layer that is printed."""

    layer: int
    """its index"""
    division: Division
    skin_flow: float
    """of the layer's flow: less than 1 where bridges among its skins get less"""


class Rooms:
    """The rooms that a part's sections have for perimeters, skins and cells."""

    def __init__(
        self, sections: Iterable[Section], layer_height: float, settings: PrintSettings
    ) -> None:
        """Measure sections, ascending in z, of layers of a height (mm)."""
        self.settings = settings
        self.volume = 0.0
        """mm³ of the part"""
        self._printed: list[_Printed] = []
        rooms = [np.zeros((0, len(KINDS)))]
        for index, division in enumerate(divided(enumerate(sections), settings)):
            area, cells = float(division.area.area), division.foam.area
            self.volume += area * layer_height
            if not division.printed:
                continue
            flow = settings.first_layer_flow if division.first else settings.flow
            rest, over = division.rest.area, division.over.area
            whole, skins = rest + over, rest + over * settings.bridge_flow / flow
            walls = area - whole - cells
            rooms.append(np.array([[walls, skins, cells]]) * division.height * flow / 100)
            self._printed.append(_Printed(index, division, skins / whole if whole else 1.0))
        self._rooms = np.concatenate(rooms)
        self._some = [_spread(room) for room in self._rooms.T]

    def whole(self) -> Plastic:
        """What would fill all rooms, mm³."""
        return Plastic(*self._rooms.sum(axis=0).tolist())

    def plastic(self, layers: Sequence[Layer]) -> Plastic:
        """What layers with these sections take, mm³, from beads laid on some of them."""
        laid, widest = np.zeros_like(self._rooms), 0.0
        for number in np.unique(np.concatenate(self._some)).tolist():
            layer = layers[self._printed[number].layer]
            laid[number], widest = self._laid(layer, number), max(widest, layer.area_per_cell)
        found = [
            rooms.sum() * float(np.mean(volume[some] / rooms[some])) if len(some) else 0.0
            for rooms, volume, some in zip(self._rooms.T, laid.T, self._some, strict=True)
        ]
        perimeters, skins, cells = found
        return Plastic(perimeters, skins, cells + self._ribs(layers, widest))

    def _ribs(self, layers: Sequence[Layer], area_per_cell: float) -> float:
        """What ribs take, mm³, grown on some of the layers, in cells of at most so many mm²."""
        ribs, volume = Ribs(self.settings), 0.0
        last: float | None = None  # mm, the level of the last one of them under a skin
        for printed in self._printed:
            ribs.note(printed.division)
        for number, division, _ in self._printed:
            level = division.level
            if not ribs.under(level, reach(area_per_cell, slope(division))):
                last = None
            elif last is None or level - last >= COARSE:
                ribs.loops(layers[number], division)
                length = float(np.hypot(*np.diff(ribs.walls, axis=1)[:, 0].T).sum())
                rise = division.height if last is None else level - last
                volume += 2 * length * division.spacing * rise
                last = level
        return volume * self.settings.flow / 100

    def _laid(self, layer: Layer, number: int) -> list[float]:
        """What one of the printed layers takes, mm³ for each kind of room."""
        settings, (_, division, skin_flow) = self.settings, self._printed[number]
        seams, ribs = Seams(settings.seam), Ribs(settings)
        plan = Plan(layer, division, settings, Linked(), seams, None, ribs, False)
        lengths = np.zeros(FEATURES)
        spacing, strokes = division.spacing, list(plan.strokes(np.zeros(2)))
        for stroke in capped(strokes, covered(*lines_of(strokes, spacing), spacing)):
            np.add.at(lengths, stroke.feature, stroke.laid)
        volumes = lengths * bead_areas(settings, division.height, first=division.first)
        volumes[SOLID] *= skin_flow
        return [float(volumes[list(features)].sum()) for features in KINDS]


def _spread(amounts: Floats) -> Ints:
    """Places in a row of amounts (k,) at which equal shares of their sum have their middles."""
    passed = np.cumsum(amounts)
    if not passed[-1:].any():
        return np.empty(0, np.int64)
    shares = (np.arange(SAMPLED) + 0.5) / SAMPLED * passed[-1]
    return np.asarray(np.searchsorted(passed, shares), np.int64)
