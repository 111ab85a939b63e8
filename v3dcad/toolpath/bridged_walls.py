"""Walls that hang become bridges: printed with the speed, the flow and the fan of these.

The foam's rim lies over open cells where a roof leans little, since it comes in with the contour on
each layer; so does a wall that moves by a whole bead at once, where a cell opens beside a
perimeter.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

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
    found, stretches, length, steps = [], [], 0.0, 0
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
    edges = spans.ravel()
    step = np.searchsorted(at, edges, side="right") - 1
    inside = at[step] != edges
    cuts, step = edges[inside], step[inside]
    share = (cuts - at[step]) / (at[step + 1] - at[step])
    # Each corner, and after it the cuts of the step that it begins.
    corner = np.repeat(np.arange(len(at)), 1 + np.bincount(step, minlength=len(at)))
    new = step + 1 + np.arange(len(step))
    along, points, whole = at[corner], stroke.points[corner], corner[:-1]
    along[new] = cuts
    points[new] += share[:, None] * (stroke.points[step + 1] - stroke.points[step])
    laid = stroke.laid[whole]
    parts = np.union1d(new - 1, new)
    laid[parts] *= np.diff(along)[parts] / np.diff(at)[whole[parts]]
    passed = np.cumsum(np.bincount(np.searchsorted(along, edges), minlength=len(along)))
    feature = stroke.feature[whole]
    feature[passed[:-1] % 2 == 1] = BRIDGE  # between the first edge and the second, and so on
    return Stroke(points, feature, laid, stroke.centre[whole]), along


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
