"""Strokes become beads with a volume, and travels join them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from v3dcad.model import (
    BRIDGE,
    EXTRUDE,
    FEATURES,
    NO_FEATURE,
    PERIMETER,
    RETRACT,
    SOLID,
    TRAVEL,
    UNRETRACT,
    Bytes,
    Floats,
    Toolpath,
)
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.bead import bead_areas
from v3dcad.toolpath.stroke import Stroke, way_back
from v3dcad.toolpath.travel import Traveller

APPROACH = 5.0
"""mm above the first layer at which the nozzle comes to the part."""


class Steps(NamedTuple):
    """A stretch of a toolpath: the fields of `Toolpath` but for the layer."""

    points: Floats
    kind: Bytes
    volume: Floats
    speed: Floats
    feature: Bytes
    centre: Floats


class Nozzle:
    """Where the nozzle is, and the steps that brought it there since they were last taken."""

    def __init__(self, settings: PrintSettings) -> None:
        self.settings = settings
        self.position = np.zeros(3)
        self.level = 0.0
        self._areas = np.zeros(FEATURES)
        self._speed = np.zeros(0)
        self._traveller: Traveller
        self.started = False
        self._last = np.empty((0, 2))
        self._steps: list[Steps] = []

    def rise(self, level: float, height: float, traveller: Traveller, *, first: bool) -> None:
        """Go on to a layer of a height, mm: its level, its ways, its beads' area and speed."""
        settings = self.settings
        self.level = level
        self._areas = bead_areas(settings, height, first=first)
        self._speed = np.minimum(_speeds(settings, first=first), settings.most_flow / self._areas)
        self._traveller = traveller

    def print(self, stroke: Stroke) -> None:
        """Travel to a stroke's start and extrude it."""
        self._travel(stroke.points[0])
        ends = stroke.points[1:]
        self._steps.append(
            Steps(
                np.column_stack([ends, np.full(len(ends), self.level)]),
                np.full(len(ends), EXTRUDE, dtype=np.int8),
                stroke.laid * self._areas[stroke.feature],
                self._speed[stroke.feature],
                stroke.feature,
                stroke.centre,
            )
        )
        self.position = self._steps[-1].points[-1]
        self._last = stroke.points

    def taken(self, layer: int) -> Toolpath:
        """The steps so far, as the toolpath of a layer; then there are none."""
        steps, self._steps = [_moves([], TRAVEL, 0.0), *self._steps], []
        points, kind, volume, speed, feature, centre = map(np.concatenate, zip(*steps, strict=True))
        layers = np.full(len(points), layer)
        return Toolpath(points, kind, volume, speed, layers, feature, centre)

    def _travel(self, stop: Floats) -> None:
        settings, level = self.settings, self.level
        x, y = stop
        if not self.started and not self._steps:
            self._go([(x, y, level + APPROACH)], TRAVEL, settings.travel_speed)
            self._go([(x, y, level)], TRAVEL, settings.z_speed)
            if settings.retracts():  # as at the end of what comes before the first layer
                self._go([(x, y, level)], UNRETRACT, settings.retraction_speed)
            return
        here = self.position
        apart = float(np.hypot(*(stop - here[:2])))
        retracts = settings.retracts() and apart > 0 and apart >= settings.retraction_travel
        raised = level + settings.z_hop if retracts else level
        if retracts:
            self._go([tuple(here)], RETRACT, settings.retraction_speed)
            for point in way_back(self._last, settings.wipe):
                self._go([(*point, here[2])], TRAVEL, settings.travel_speed)
            here = self.position
        if here[2] != raised:
            self._go([(here[0], here[1], raised)], TRAVEL, settings.z_speed)
        if apart > 0:
            way = self._traveller.way(here[:2], stop)
            self._go([(*bend, raised) for bend in way], TRAVEL, settings.travel_speed)
        if raised > level:
            self._go([(x, y, level)], TRAVEL, settings.z_speed)
        if retracts:
            self._go([(x, y, level)], UNRETRACT, settings.retraction_speed)

    def _go(self, points: Sequence[tuple[float, ...]], kind: int, speed: float) -> None:
        self._steps.append(_moves(points, kind, speed))
        self.position = self._steps[-1].points[-1]


def _speeds(settings: PrintSettings, *, first: bool) -> Floats:
    """mm/s at which each feature is extruded."""
    if first:
        return np.full(FEATURES, settings.first_layer_speed)
    speeds = np.full(FEATURES, settings.print_speed)
    speeds[PERIMETER], speeds[SOLID] = settings.perimeter_speed, settings.solid_speed
    speeds[BRIDGE] = settings.bridge_speed
    return speeds


def _moves(points: Sequence[tuple[float, ...]], kind: int, speed: float) -> Steps:
    count = len(points)
    return Steps(
        np.array(points, dtype=np.float64).reshape(-1, 3),
        np.full(count, kind, dtype=np.int8),
        np.zeros(count),
        np.full(count, speed),
        np.full(count, NO_FEATURE, dtype=np.int8),
        np.full((count, 2), np.nan),
    )
