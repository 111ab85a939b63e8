"""From layers to toolpaths: strokes become beads with a volume, and travels join them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import tee
from typing import NamedTuple

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.loops.links import Linked
from v3dcad.geometry.loops.segments import Segments
from v3dcad.model import (
    BRIDGE,
    CELLS,
    EXTRUDE,
    FEATURES,
    INNER_PERIMETER,
    NO_FEATURE,
    PERIMETER,
    RETRACT,
    SOLID,
    TRAVEL,
    UNRETRACT,
    Bytes,
    Floats,
    Layer,
    Toolpath,
)
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.bead import bead_areas, bead_spacing
from v3dcad.toolpath.bridged_walls import with_bridged_walls
from v3dcad.toolpath.bridging import Below
from v3dcad.toolpath.cooling import cooled
from v3dcad.toolpath.first_layer import cuts
from v3dcad.toolpath.overhang import Hanging, hanging, refuse_spans
from v3dcad.toolpath.plan import Plan
from v3dcad.toolpath.report import LayerReport, layer_report
from v3dcad.toolpath.seam import Seams
from v3dcad.toolpath.skins import shells
from v3dcad.toolpath.stroke import Stroke, capped, way_back
from v3dcad.toolpath.travel import Traveller

OF_THE_PART = (CELLS, PERIMETER, INNER_PERIMETER, SOLID, BRIDGE)
"""Features of which a part is made; a skirt and a brim are none."""

APPROACH = 5.0
"""mm above the first layer at which the nozzle comes to the part."""


def trace(
    layers: Iterable[Layer],
    settings: PrintSettings,
    report: Callable[[LayerReport], None] | None = None,
    *,
    thesis: bool = False,
) -> Iterator[Toolpath]:
    """One toolpath a layer: every cell edge and perimeter extruded.

    The first layer with something to print lies on the bed, as high as the first layer's beads;
    the others as far above it as their sections are, each filling the height to the one below.
    Layers under it get empty toolpaths. Walls of one bead of a `thesis` structure are printed in
    the thesis's order. `report` is told of each layer as soon as it is traced. Layers are held only
    as long as it takes to know whether they are among the top ones. Raises `GeometryError` where
    layers do not ascend, where beads span more than `fail_over`, and at the end where nothing of
    the part was printed.
    """
    nozzle, linked, seams = Nozzle(settings), Linked(), Seams(settings.seam)
    below: Below | None = None
    laid: Segments | None = None
    certified = report is not None or not isinstance(settings.fail_over, str)
    traced = made = False
    # A layer waits for its skin, which sections above have a say in.
    waiting, ahead = tee(layers)
    areas = cuts((layer.section for layer in ahead), settings)
    found = shells(areas, *settings.solid_layers())
    for layer, ((area, printed), skin) in zip(waiting, found, strict=True):
        first = nozzle.level == 0
        if printed:
            nozzle.rise(layer, Traveller(area, settings.bead_width / 4))
        seams.rise()
        plan = Plan(
            layer, area, skin, settings, first, nozzle.spacing, linked, seams, below, thesis
        )
        before = nozzle.position
        planned = list(plan.strokes(before[:2])) if printed else []
        strokes, lines = capped(planned, nozzle.spacing)
        bridged = 0.0
        if printed and laid is not None:
            strokes, bridged = with_bridged_walls(
                strokes, laid, settings.bead_width, settings.minimum_edge
            )
        for stroke in strokes:
            nozzle.print(stroke)
        toolpath = nozzle.taken(layer.index)
        hang: tuple[Hanging, ...] = ()
        if certified and printed and laid is not None and below is not None:
            hang = hanging(toolpath, before, laid, below.area, settings.bead_width, nozzle.height)
            refuse_spans(hang, layer.index, nozzle.level, settings.fail_over)
        if printed:
            laid = lines
            below = Below(area, plan.foam, layer.diagram, settings.wall_width())
        rest = before if nozzle.started else toolpath.points[:1]
        nozzle.started |= len(toolpath.points) > 0
        toolpath, seconds = cooled(toolpath, rest, settings)
        traced, made = True, made or bool(np.isin(toolpath.feature, OF_THE_PART).any())
        if report is not None:
            level = nozzle.level if printed else 0.0
            report(layer_report(toolpath, before, len(strokes), plan, seconds, level, hang, bridged))
        yield toolpath
    if traced and not made:
        raise GeometryError(
            f"nothing of the part is printed: all of it is narrower than beads of "
            f"{settings.bead_width:g} mm; give a smaller bead width, or --scale to make it larger"
        )


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
        self.height = 0.0
        self._above = 0.0
        self._areas = np.zeros(FEATURES)
        self.spacing = 0.0
        self._speed = np.zeros(0)
        self._traveller: Traveller
        self.started = False
        self._last = np.empty((0, 2))
        self._steps: list[Steps] = []

    def rise(self, layer: Layer, traveller: Traveller) -> None:
        """Go on to a layer: its level, its ways, the area of its beads and their speed."""
        settings, below = self.settings, self.level
        if below == 0:
            self._above = settings.first_layer_height - layer.z
        self.level = layer.z + self._above
        if self.level <= below:
            raise GeometryError(
                f"its section at {layer.z:g} mm is not above the one below; "
                "give layers in ascending order",
                layer=layer.index,
            )
        self.height = self.level - below
        self.spacing = bead_spacing(settings, self.height)
        self._areas = bead_areas(settings, self.height, first=not below)
        self._speed = np.minimum(
            _speeds(settings, first=not below), settings.most_flow / self._areas
        )
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
