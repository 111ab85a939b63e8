"""Walls that hang become bridges: printed with the speed, the flow and the fan of these.

The foam's rim lies over open cells where a roof leans little, since it comes in with the contour on
each layer; so do some walls beside a cell that opens.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    BoolArray,
    ConstFloatArray,
    ConstFloatRows,
    ConstInt8Array,
    ConstIntArray,
    FloatArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.loops.reach import Stretches
from v3dcad.model import BRIDGE, CELLS, INNER_PERIMETER, Floats
from v3dcad.toolpath.spans import merged
from v3dcad.toolpath.stroke import Stroke

LEAST = 1.0
"""Widths of a bead: what is shorter than a bead is wide is held from both of its ends."""


class Bridged(NamedTuple):
    """Strokes whose walls are bridges where they hang."""

    strokes: list[Stroke]
    hang: Stretches
    """of all their steps"""
    length: float
    """mm of walls and inner perimeters that are bridges now"""


def with_bridged_walls(
    strokes: Sequence[Stroke], hang: Stretches, width: float, shortest: float
) -> Bridged:
    """The strokes, with stretches of walls and inner perimeters that hang as bridges.

    Such a stretch has less than half of its `width` (mm) over the beads below, as told by those of
    all steps that `hang`, for at least `LEAST` widths. It begins and ends at a corner that is
    nearer than `shortest` (mm).
    """
    found, length, steps = [], 0.0, 0
    stretches = [(np.empty(0, np.int64), np.empty(0), np.empty(0))]
    first = np.cumsum([0, *(len(stroke.laid) for stroke in strokes)])
    begins = np.searchsorted(hang.segment, first).tolist()
    for number, stroke in enumerate(strokes):
        own = slice(begins[number], begins[number + 1])
        of, low, high = hang.segment[own] - first[number], hang.low[own], hang.high[own]
        at, places, spans = np.empty(len(stroke.points)), *np.empty((2, len(of), 2))
        count = _wall_spans(
            stroke.points, stroke.feature, of, low, high, LEAST * width, shortest, at, places, spans
        )
        if count:
            spans = spans[:count]
            length += float(np.diff(spans).sum())
            stroke, at = _cut(stroke, at, spans)
            room = 2 * len(of) + len(at)
            of, low, high = np.empty(room, np.int64), *np.empty((2, room))
            size = _part(places, at, of, low, high)
            of, low, high = of[:size], low[:size], high[:size]
        found.append(stroke)
        stretches.append((steps + of, low, high))
        steps += len(stroke.laid)
    return Bridged(found, Stretches(*map(np.concatenate, zip(*stretches, strict=True))), length)


@compiled(INTERNAL)
def _snapped(place: float, at: ConstFloatArray, shortest: float) -> float:
    """A place on a line, mm; or a corner, which lie `at` some mm on it, nearer than `shortest`."""
    after = min(max(int(np.searchsorted(at, place)), 1), len(at) - 1)
    before_it, after_it = place - at[after - 1], at[after] - place
    nearest = at[after - 1] if before_it < after_it else at[after]
    return nearest if abs(place - nearest) < shortest else place


@compiled(UNCOUNTED)
def _wall_spans(
    points: ConstFloatRows,
    feature: ConstInt8Array,
    of: ConstIntArray,
    low: ConstFloatArray,
    high: ConstFloatArray,
    least: float,
    shortest: float,
    at: FloatArray,
    places: FloatRows,
    spans: FloatRows,
) -> int:
    """On how many `spans`, mm along a stroke, walls and inner perimeters hang, `least` mm or more.

    Stretches from `low` to `high` of steps `of` (n,) hang: at some `places` (n, 2), mm along the
    stroke, whose points lie `at` some mm.
    """
    at[0] = 0.0
    for k in range(len(feature)):
        x, y = points[k + 1, 0] - points[k, 0], points[k + 1, 1] - points[k, 1]
        at[k + 1] = at[k] + math.sqrt(x * x + y * y)
    count = 0
    for k in range(len(of)):
        step = of[k]
        x, y = points[step + 1, 0] - points[step, 0], points[step + 1, 1] - points[step, 1]
        long = math.sqrt(x * x + y * y)
        begin, end = at[step] + low[k] * long, at[step] + high[k] * long
        places[k, 0], places[k, 1] = begin, end
        if feature[step] == CELLS or feature[step] == INNER_PERIMETER:
            count = merged(begin, end, spans, count)
    kept = 0
    for k in range(count):
        if spans[k, 1] - spans[k, 0] >= least:
            begin, end = _snapped(spans[k, 0], at, shortest), _snapped(spans[k, 1], at, shortest)
            spans[kept, 0], spans[kept, 1] = begin, end
            kept += end > begin
    return kept


def _cut(stroke: Stroke, at: Floats, spans: Floats) -> tuple[Stroke, Floats]:
    """A stroke, whose points lie `at` some mm along it, with a bridge on each of the spans (s, 2).

    Steps that a span begins or ends within are cut there; beside the stroke comes where its points
    lie then.
    """
    most = len(at) + spans.size
    points, along = np.empty((most, 2)), np.empty(most)
    whole, laid, bridged = np.empty(most, np.int64), np.empty(most), np.empty(most, np.bool_)
    count = _cut_steps(
        stroke.points, stroke.laid, at, spans.ravel(), points, along, whole, laid, bridged
    )
    whole = whole[:count]
    feature = np.where(bridged[:count], BRIDGE, stroke.feature[whole]).astype(np.int8)
    cut = Stroke(points[: count + 1], feature, laid[:count], stroke.centre[whole])
    return cut, along[: count + 1]


@compiled(UNCOUNTED)
def _cut_steps(
    points: ConstFloatRows,
    laid: ConstFloatArray,
    at: ConstFloatArray,
    edges: ConstFloatArray,
    found: FloatRows,
    along: FloatArray,
    whole: IntArray,
    parts: FloatArray,
    inside: BoolArray,
) -> int:
    """Number of steps once they are cut at `edges` (e,), mm, in order.

    For each comes where it begins, the step that it was, what is laid, and whether it lies between
    the first edge and the second, or the third and the fourth, and so on.
    """
    size = edge = 0
    between = False
    for step in range(len(at) - 1):
        x, y, long = points[step, 0], points[step, 1], at[step + 1] - at[step]
        dx, dy = points[step + 1, 0] - x, points[step + 1, 1] - y
        start = at[step]
        while True:
            while edge < len(edges) and edges[edge] <= start:
                between = not between
                edge += 1
            stop = min(edges[edge], at[step + 1]) if edge < len(edges) else at[step + 1]
            share = (start - at[step]) / long if start > at[step] else 0.0
            found[size, 0], found[size, 1] = x + share * dx, y + share * dy
            along[size], whole[size], inside[size] = start, step, between
            parts[size] = laid[step]
            if stop - start < long:
                parts[size] *= (stop - start) / long
            size += 1
            start = stop
            if start >= at[step + 1]:
                break
    last = len(at) - 1
    found[size, 0], found[size, 1], along[size] = points[last, 0], points[last, 1], at[last]
    return size


@compiled(UNCOUNTED)
def _part(
    places: ConstFloatRows, at: ConstFloatArray, of: IntArray, low: FloatArray, high: FloatArray
) -> int:
    """Number of stretches once those at `places` (n, 2), mm along a stroke, are told by its steps.

    The stroke's points lie `at` some mm. For each comes its step, and where on that it begins and
    ends, in shares of it.
    """
    size = first = 0
    for k in range(len(places)):
        begin, end = places[k, 0], places[k, 1]
        while first + 2 < len(at) and at[first + 1] <= begin:
            first += 1
        step = first
        while True:
            start, long = at[step], max(at[step + 1] - at[step], 1e-300)
            of[size] = step
            low[size] = max((begin - start) / long, 0.0)
            high[size] = min((end - start) / long, 1.0)
            size += 1
            step += 1
            if step + 1 == len(at) or at[step] >= end:
                break
    return size
