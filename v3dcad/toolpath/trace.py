"""From layers to toolpaths: each is planned, then laid with what there is room for, and checked."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import tee
from typing import NamedTuple

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.loops.coverage import covered
from v3dcad.geometry.loops.links import Linked
from v3dcad.geometry.loops.reach import Stretches, far_from
from v3dcad.model import BRIDGE, CELLS, INNER_PERIMETER, PERIMETER, SOLID, Layer, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.beads import Nozzle
from v3dcad.toolpath.bridged_walls import with_bridged_walls
from v3dcad.toolpath.bridging import Below
from v3dcad.toolpath.cooling import cooled
from v3dcad.toolpath.division import divided
from v3dcad.toolpath.overhang import Hanging, hanging, refuse_spans
from v3dcad.toolpath.overlapped import overlapped
from v3dcad.toolpath.plan import Plan
from v3dcad.toolpath.report import LayerReport, layer_report
from v3dcad.toolpath.ribs import Ribs
from v3dcad.toolpath.seam import Seams
from v3dcad.toolpath.stroke import Lines, Stroke, capped, lines_of
from v3dcad.toolpath.travel import Traveller

OF_THE_PART = (CELLS, PERIMETER, INNER_PERIMETER, SOLID, BRIDGE)
"""Features of which a part is made; a skirt and a brim are none."""


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
    as long as it takes to know whether they are among the top ones. A layer is laid while the next
    one is planned. Raises `GeometryError` where layers do not ascend, where beads span more than
    `fail_over`, and at the end where nothing of the part was printed.
    """
    laying = _Laying(settings, told=report is not None)
    traced = made = False
    for toolpath, found in overlapped(laying.laid, _planned(layers, settings, thesis)):
        traced, made = True, made or bool(np.isin(toolpath.feature, OF_THE_PART).any())
        if report is not None and found is not None:
            report(found)
        yield toolpath
    if traced and not made:
        raise GeometryError(
            f"nothing of the part is printed: all of it is narrower than beads of "
            f"{settings.bead_width:g} mm; give a smaller bead width, or --scale to make it larger"
        )


class _Planned(NamedTuple):
    """A layer's strokes, and where they lie."""

    plan: Plan
    strokes: list[Stroke]
    lines: Lines


def _planned(layers: Iterable[Layer], settings: PrintSettings, thesis: bool) -> Iterator[_Planned]:
    """What is printed on each layer, from where the last one ends."""
    linked, seams, here = Linked(), Seams(settings.seam), np.zeros(2)
    below: Below | None = None
    ribs = Ribs(settings)
    # A layer waits for its skin and its ribs, which sections above have a say in.
    waiting, ahead = tee(layers)
    found = divided(((layer.index, layer.section) for layer in ahead), settings)
    for layer, division in ribs.looking_up(zip(waiting, found, strict=True)):
        seams.rise()
        plan = Plan(layer, division, settings, linked, seams, below, ribs, thesis)
        strokes = list(plan.strokes(here)) if division.printed else []
        if strokes:
            here = strokes[-1].points[-1]
        lines = lines_of(strokes, division.spacing)
        if division.printed:
            wall = settings.wall_width()
            below = Below(division, layer.diagram, ribs.walls, wall, lines.segments)
        yield _Planned(plan, strokes, lines)


class _Laying:
    """What lays strokes, layer by layer, in a thread of its own.

    Only here are the areas of divisions asked what they cover: shapely indexes an area as it is
    first asked, which no two threads may do.
    """

    def __init__(self, settings: PrintSettings, *, told: bool) -> None:
        self._settings = settings
        self._told = told
        self._nozzle = Nozzle(settings)

    def laid(self, planned: _Planned) -> tuple[Toolpath, LayerReport | None]:
        """The toolpath of the next layer; and what it comes to, if that is to be told."""
        plan, strokes, lines = planned
        division, below, level = plan.division, plan.below, plan.division.level
        settings, nozzle = self._settings, self._nozzle
        strokes = capped(strokes, covered(*lines, division.spacing))
        if level:
            traveller = Traveller(division.area, settings.bead_width / 4)
            nozzle.rise(level, division.height, traveller, first=division.first)
        before = nozzle.position
        hang: Stretches | None = None
        bridged = 0.0
        if below is not None and settings.wall_beads == 2:  # lines are steps: each is passed once
            hang = far_from(lines.segments.ends, below.beads, settings.bead_width / 2)
            strokes, hang, bridged = with_bridged_walls(
                strokes, hang, settings.bead_width, settings.minimum_edge
            )
        for stroke in strokes:
            nozzle.print(stroke)
        toolpath = nozzle.taken(plan.layer.index)
        told: tuple[Hanging, ...] = ()
        if below is not None and (self._told or not isinstance(settings.fail_over, str)):
            width, under = settings.bead_width, below.division.area
            told = hanging(toolpath, before, below.beads, under, width, division.height, hang)
            refuse_spans(told, plan.layer.index, level, settings.fail_over)
        rest = before if nozzle.started else toolpath.points[:1]
        nozzle.started |= len(toolpath.points) > 0
        toolpath, seconds = cooled(toolpath, rest, settings)
        if not self._told:
            return toolpath, None
        return toolpath, layer_report(toolpath, before, len(strokes), plan, seconds, told, bridged)
