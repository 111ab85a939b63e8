"""What of the printed beads has nothing under it: the certificate of a print.

It looks at the steps of the toolpath itself, whatever they were planned as. A place of a bead hangs
where more than half of its width has no bead of the layer below under it; it touches nothing where
its whole width has none. A span is a stretch that touches nothing, with what hangs of it at both
ends: from the edge of what it lies on to the next edge. Its length is the distance of its two
places that are farthest apart.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.sparse
import shapely
from scipy.sparse.csgraph import connected_components

from v3dcad.errors import GeometryError
from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    FloatArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import UNCOUNTED, compiled
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
    Ints,
    Toolpath,
)

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
ROUNDING = 1e-6
"""mm: stretches this near to each other are one."""
APART = 1.0
"""mm between two ways of the nozzle where they are put one after the other on one line."""

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


class _Way(NamedTuple):
    """Beads put one after the other on one line; where the nozzle stops, with room between."""

    ends: FloatRows
    """(n, 4) mm: x and y of where each bead begins, x and y of where it ends"""
    kind: IntArray
    """(n,) number of each one's kind; `MOVE` where nothing of the part is laid"""
    at: FloatArray
    """(n,) mm along the line where each begins"""
    length: FloatArray
    """(n,) mm"""

    def points(self, at: Floats) -> Floats:
        """(k, 2) mm: the places at some mm (k,) along the line; corners to the last bit."""
        bead = self.beads(at)
        along = at - self.at[bead]
        start, stop, length = self.ends[bead, :2], self.ends[bead, 2:], self.length[bead]
        share = along / np.maximum(length, ROUNDING)
        found = start + share[:, None] * (stop - start)
        found[along < ROUNDING] = start[along < ROUNDING]
        ends = along > length - ROUNDING
        found[ends] = stop[ends]
        return np.asarray(found)

    def beads(self, at: Floats) -> Ints:
        """(k,) the beads that lie at some mm (k,) along the line, and go on from there."""
        return np.maximum(np.searchsorted(self.at, at + ROUNDING, side="right") - 1, 0)

    def corners(self, spans: Floats) -> tuple[Floats, Ints]:
        """(k, 2) mm: ends and corners of stretches (s, 2) of the line, and (k,) whose each is."""
        first = np.searchsorted(self.at, spans[:, 0] + ROUNDING, side="right")
        last = np.searchsorted(self.at, spans[:, 1] - ROUNDING, side="left")
        count = np.maximum(last - first, 0)
        number = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        every = np.arange(len(spans))
        between = self.ends[np.repeat(first, count) + number, :2]
        return (
            np.vstack([self.points(spans[:, 0]), between, self.points(spans[:, 1])]),
            np.concatenate([every, np.repeat(every, count), every]),
        )


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
    way = _way(before, toolpath.points, np.where(extruding, KIND_OF[toolpath.feature], MOVE))
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
    spans = _spans(way, of, low, high, below, width)
    kind = way.kind[way.beads(spans[:, 0])]
    for number, what in enumerate(KINDS):
        if hangs[number] > ROUNDING:
            span, (x, y) = _longest(way, spans[kind == number])
            over = "cells" if shapely.contains_xy(area_below, x, y) else "air"
            found.append(
                Hanging(what, float(hangs[number]), float(areas[number]), span, (x, y), over)
            )
    return tuple(found)


def _way(before: Floats, points: Floats, kind: Ints) -> _Way:
    """Steps to points (n, 3) from the last one, the first of all from `before` (3,)."""
    way = _Way(np.empty((len(points), 4)), kind, *np.empty((2, len(points))))
    _line_up(before, points, way)
    return way


@compiled(UNCOUNTED)
def _line_up(before: ConstFloatArray, points: ConstFloatRows, way: _Way) -> None:
    x, y, passed = before[0], before[1], 0.0
    for step in range(len(points)):
        u, v = points[step, 0], points[step, 1]
        if step > 0 and way.kind[step] != way.kind[step - 1]:
            passed += APART
        way.ends[step, 0], way.ends[step, 1], way.ends[step, 2], way.ends[step, 3] = x, y, u, v
        way.at[step], way.length[step] = passed, math.sqrt((u - x) ** 2 + (v - y) ** 2)
        passed += way.length[step]
        x, y = u, v


def _spans(way: _Way, of: Ints, low: Floats, high: Floats, under: Segments, width: float) -> Floats:
    """(s, 2) mm along the way, where spans begin and end.

    Stretches of beads `of` (k,) from `low` to `high` hang. What touches nothing is grown by what
    hangs at both ends, but by no more than the width of a bead: so far does the bead's edge come
    in after its middle, where it crosses an edge at 30° or more.
    """
    begins, ends = (way.at[of] + share * way.length[of] for share in (low, high))
    runs = merged(begins, ends)
    start = way.ends[of, :2]
    steps = way.ends[of, 2:] - start
    free = far_from(
        np.hstack([start + low[:, None] * steps, start + high[:, None] * steps]), under, width
    )
    size = (ends - begins)[free.segment]
    from_, to = (begins[free.segment] + share * size for share in (free.low, free.high))
    run = runs[np.searchsorted(runs[:, 0], from_ + ROUNDING, side="right") - 1]
    return merged(np.maximum(from_ - width, run[:, 0]), np.minimum(to + width, run[:, 1]))


def merged(low: Floats, high: Floats) -> Floats:
    """(m, 2) the stretches low … high, (n,) each in order, those that meet as one."""
    if not len(low):
        return np.empty((0, 2))
    begins = np.ones(len(low), dtype=bool)
    begins[1:] = low[1:] > np.maximum.accumulate(high)[:-1] + ROUNDING
    first = np.flatnonzero(begins)
    return np.column_stack([low[first], np.maximum.reduceat(high, first)])


def _longest(way: _Way, spans: Floats) -> tuple[float, tuple[float, float]]:
    """The longest of some spans (s, 2), mm, and a place in its middle.

    Stretches that have a corner in common are one span, as on both sides of a seam. Their lengths
    along the bead bound what they span, so that few have to be measured.
    """
    if not len(spans):
        return 0.0, (0.0, 0.0)
    corners, owner = way.corners(spans)
    _, corner = np.unique(corners.view(np.complex128), return_inverse=True)  # x + iy sorts faster
    linked = scipy.sparse.coo_matrix(
        (np.ones(len(owner), dtype=bool), (owner, len(spans) + corner.ravel())),
        shape=(len(spans) + len(corners),) * 2,
    )
    whole = connected_components(linked, directed=False)[1]
    of = np.unique(whole[: len(spans)], return_inverse=True)[1]
    length = spans[:, 1] - spans[:, 0]
    bound = np.bincount(of, length)
    order = np.argsort(of[owner], kind="stable")
    first = np.searchsorted(of[owner][order], np.arange(len(bound) + 1))
    best, longest = 0.0, 0
    for span in np.argsort(-bound, kind="stable").tolist():
        if bound[span] <= best:
            break
        apart = _diameter(corners[order[first[span] : first[span + 1]]])
        if apart > best:
            best, longest = apart, span
    middle = spans[np.argmax(np.where(of == longest, length, 0.0))].mean()
    ((x, y),) = way.points(np.array([middle])).tolist()
    return best, (x, y)


def _diameter(points: Floats) -> float:
    """The distance of the farthest two of some points (k, 2), which are corners of their hull."""
    if len(points) > 2:
        points = shapely.get_coordinates(shapely.convex_hull(shapely.MultiPoint(points)))
    return float(np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1)).max())


def refuse_spans(found: Sequence[Hanging], layer: int, level: float, limit: float | str) -> None:
    """Raise `GeometryError` where something spans more than a limit, mm; "off" is none."""
    if isinstance(limit, str):
        return
    longest = max(found, key=lambda one: one.span, default=None)
    if longest is not None and longest.span > limit:
        words = span_words(longest.what, longest.over, longest.span, level, longest.place)
        raise GeometryError(
            f"{words}, more than --fail-over {limit:g}: {HELP[longest.over]}", layer=layer
        )


def span_words(
    what: str, over: str, span: float, level: float, place: Floats | tuple[float, float]
) -> str:
    """A span, mm, in words: of what, over what, how far, where."""
    x, y = place
    return f"{what} at z {level:.4g} span {span:.1f} mm over {over} (x {x:.1f}, y {y:.1f})"
