"""Walls that hang become bridges: printed with the speed, the flow and the fan of these.

The foam's rim lies over open cells where a roof leans little, since it comes in with the contour on
each layer; so does a wall that moves by a whole bead at once, where a cell opens beside a
perimeter.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    BoolArray,
    ConstFloatArray,
    ConstFloatRows,
    FloatArray,
    FloatRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import UNCOUNTED, compiled
from v3dcad.geometry.loops.reach import Stretches
from v3dcad.model import BRIDGE, CELLS, INNER_PERIMETER, Floats, Ints
from v3dcad.toolpath.overhang import merged
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
        walls = (stroke.feature[of] == CELLS) | (stroke.feature[of] == INNER_PERIMETER)
        if walls.any():
            x, y = np.diff(stroke.points, axis=0).T
            long = np.sqrt(x * x + y * y)
            at = np.concatenate([[0.0], np.cumsum(long)])
            low, high = at[of] + low * long[of], at[of] + high * long[of]
            spans = merged(low[walls], high[walls])
            spans = _snapped(spans[np.diff(spans)[:, 0] >= LEAST * width], at, shortest)
            spans = spans[np.diff(spans)[:, 0] > 0]
            length += float(np.diff(spans).sum())
            if len(spans):
                stroke, at = _cut(stroke, at, spans)
            of, low, high = _parted(low, high, at)
        found.append(stroke)
        stretches.append((steps + of, low, high))
        steps += len(stroke.laid)
    return Bridged(found, Stretches(*map(np.concatenate, zip(*stretches, strict=True))), length)


def _snapped(places: Floats, at: Floats, shortest: float) -> Floats:
    """Places along a line, mm, those nearer than `shortest` to a corner `at` some mm on it."""
    after = np.clip(np.searchsorted(at, places), 1, len(at) - 1)
    nearest = np.where(places - at[after - 1] < at[after] - places, at[after - 1], at[after])
    return np.where(np.abs(places - nearest) < shortest, nearest, places)


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


def _parted(low: Floats, high: Floats, at: Floats) -> tuple[Ints, Floats, Floats]:
    """Stretches `low` … `high` (n,), mm, of a stroke whose points lie `at` some mm: by its steps.

    The number of each one's step, and where on that it begins and ends, in shares of it.
    """
    first = np.searchsorted(at, low, side="right") - 1
    count = np.maximum(np.searchsorted(at, high) - first, 1)
    begins = np.cumsum(count) - count
    step = np.repeat(first - begins, count) + np.arange(count.sum())
    start, size = at[step], np.maximum(at[step + 1] - at[step], 1e-300)
    return (
        step,
        np.maximum((np.repeat(low, count) - start) / size, 0.0),
        np.minimum((np.repeat(high, count) - start) / size, 1.0),
    )
