"""What of the printed beads has nothing under it: the certificate of a print.

It looks at the steps of the toolpath itself, whatever they were planned as. A place of a bead hangs
where more than half of its width has no bead of the layer below under it; it touches nothing where
its whole width has none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from v3dcad.errors import GeometryError
from v3dcad.geometry.loops.reach import Stretches, far_from
from v3dcad.geometry.loops.segments import Segments
from v3dcad.model import (
    BRIDGE,
    CELLS,
    EXTRUDE,
    FEATURES,
    INNER_PERIMETER,
    PERIMETER,
    SOLID,
    Floats,
    Toolpath,
)
from v3dcad.toolpath.spans import ROUNDING, longest, spans_of, way_of

KINDS = {
    "perimeters": (PERIMETER, INNER_PERIMETER),
    "skins": (SOLID,),
    "bridges": (BRIDGE,),
    "walls": (CELLS,),
}
"""What is told apart, and the features that it is made of."""
MOVE = -1
"""The kind of a step that lays nothing of the part."""
KIND_OF = np.full(FEATURES + 1, MOVE)
"""The number of each feature's kind; the last one stands for steps of no feature."""
for _number, _features in enumerate(KINDS.values()):
    KIND_OF[list(_features)] = _number

HELP = {
    "air": "turn the part (--up, --rotate), or give it a slope or a support there in CAD",
    "cells": "smaller cells (--cell-size, --roof-size) hold it up",
}
"""What a span lies over, and what helps."""


@dataclass(frozen=True, slots=True)
class Hanging:
    """What hangs of one kind of beads on one layer, lengths in mm."""

    what: str
    """one of `KINDS`"""
    length: float
    """of bead that hangs by more than half of its width"""
    area: float
    """mm² that it fills: volume ÷ height"""
    span: float
    """the longest span; 0 where all beads touch the layer below"""
    place: tuple[float, float]
    """x and y in its middle, bed coordinates"""
    over: str
    """"air" or, where the section below goes on under that place, "cells" """


def hanging(
    toolpath: Toolpath,
    before: Floats,
    below: Segments,
    area_below: shapely.Geometry,
    width: float,
    height: float,
    hang: Stretches | None = None,
) -> tuple[Hanging, ...]:
    """What of a layer's toolpath hangs over the beads `below`, for each kind of which some does.

    The toolpath begins at `before` (3,); its beads and those below are `width` wide, and it is
    `height` above them; mm. Which stretches of its steps that extrude `hang` may be known already.
    Steps on arcs count as straight: they are a chord tolerance off. Exact but for that, in time
    linear in the number of beads.
    """
    extruding = toolpath.kind == EXTRUDE
    way = way_of(before, toolpath.points, np.where(extruding, KIND_OF[toolpath.feature], MOVE))
    if hang is None:
        of, low, high = far_from(way.ends, below, width / 2, way.kind != MOVE)
    else:
        of = np.flatnonzero(extruding)[hang.segment]
        of, low, high = (part[way.kind[of] != MOVE] for part in (of, hang.low, hang.high))
    if not len(of):
        return ()
    kind, length = way.kind[of], way.length[of] * (high - low)
    per_mm = toolpath.volume[of] / np.maximum(way.length[of], ROUNDING) / height
    hangs = np.bincount(kind, length, len(KINDS))
    areas = np.bincount(kind, length * per_mm, len(KINDS))
    shapely.prepare(area_below)
    found = []
    spans = spans_of(way, of, low, high, below, width)
    kind = way.kind[way.beads(spans[:, 0])]
    for number, what in enumerate(KINDS):
        if hangs[number] > ROUNDING:
            span, (x, y) = longest(way, spans[kind == number])
            over = "cells" if shapely.contains_xy(area_below, x, y) else "air"
            found.append(
                Hanging(what, float(hangs[number]), float(areas[number]), span, (x, y), over)
            )
    return tuple(found)


def refuse_spans(found: Sequence[Hanging], layer: int, level: float, limit: float | str) -> None:
    """Raise `GeometryError` where something spans more than a limit, mm; "off" is none."""
    if isinstance(limit, str):
        return
    worst = max(found, key=lambda one: one.span, default=None)
    if worst is not None and worst.span > limit:
        words = span_words(worst.what, worst.over, worst.span, level, worst.place)
        raise GeometryError(
            f"{words}, more than --fail-over {limit:g}: {HELP[worst.over]}", layer=layer
        )


def span_words(
    what: str, over: str, span: float, level: float, place: Floats | tuple[float, float]
) -> str:
    """A span, mm, in words: of what, over what, how far, where."""
    x, y = place
    return f"{what} at z {level:.4g} span {span:.1f} mm over {over} (x {x:.1f}, y {y:.1f})"
