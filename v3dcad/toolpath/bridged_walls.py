"""Walls that hang become bridges: printed with the speed, the flow and the fan of these.

The foam's rim lies over open cells where a roof leans little, since it comes in with the contour on
each layer; so does a wall that moves by a whole bead at once, where a cell opens beside a
perimeter.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from v3dcad.geometry.loops.reach import far_from
from v3dcad.geometry.loops.segments import Segments
from v3dcad.model import BRIDGE, CELLS, INNER_PERIMETER, Floats, Ints
from v3dcad.toolpath.overhang import merged
from v3dcad.toolpath.stroke import Stroke

LEAST = 1.0
"""Widths of a bead: what is shorter than a bead is wide is held from both of its ends."""


class Bridged(NamedTuple):
    """Strokes whose walls are bridges where they hang."""

    strokes: list[Stroke]
    held: NDArray[np.bool_]
    """(n,) of all their steps, whether each lies on the layer below with half of its width"""
    length: float
    """mm of walls and inner perimeters that are bridges now"""


def with_bridged_walls(
    strokes: Sequence[Stroke], lines: Segments, below: Segments, width: float, shortest: float
) -> Bridged:
    """The strokes, with stretches of walls and inner perimeters that hang as bridges.

    Such a stretch has less than half of its `width` (mm) over the beads `below`, for at least
    `LEAST` widths. It begins and ends at a corner that is nearer than `shortest` (mm). No stroke
    passes a line twice: `lines` are their steps, as `capped` gives them.
    """
    hang = far_from(lines.ends, below, width / 2)
    found, held, length = list(strokes), [np.empty(0, np.bool_)], 0.0
    first = np.cumsum([0, *(len(stroke.laid) for stroke in strokes)])
    begins = np.searchsorted(hang.segment, first)
    for number, stroke in enumerate(strokes):
        own = slice(begins[number], begins[number + 1])
        of = hang.segment[own] - first[number]
        lies = np.ones(len(stroke.laid), np.bool_)
        lies[of] = False
        walls = (stroke.feature[of] == CELLS) | (stroke.feature[of] == INNER_PERIMETER)
        if walls.any():
            x, y = np.diff(stroke.points, axis=0).T
            long = np.sqrt(x * x + y * y)
            at, of = np.concatenate([[0.0], np.cumsum(long)]), of[walls]
            low, high = hang.low[own][walls], hang.high[own][walls]
            spans = merged(at[of] + low * long[of], at[of] + high * long[of])
            spans = _snapped(spans[np.diff(spans)[:, 0] >= LEAST * width], at, shortest)
            spans = spans[np.diff(spans)[:, 0] > 0]
            if len(spans):
                found[number], whole = _cut(stroke, at, spans)
                lies = lies[whole]
                length += float(np.diff(spans).sum())
        held.append(lies)
    return Bridged(found, np.concatenate(held), length)


def _snapped(places: Floats, at: Floats, shortest: float) -> Floats:
    """Places along a line, mm, those nearer than `shortest` to a corner `at` some mm on it."""
    after = np.clip(np.searchsorted(at, places), 1, len(at) - 1)
    nearest = np.where(places - at[after - 1] < at[after] - places, at[after - 1], at[after])
    return np.where(np.abs(places - nearest) < shortest, nearest, places)


def _cut(stroke: Stroke, at: Floats, spans: Floats) -> tuple[Stroke, Ints]:
    """A stroke, whose points lie `at` some mm along it, with a bridge on each of the spans (s, 2).

    Steps that a span begins or ends within are cut there; beside the stroke comes which step each
    one was.
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
    bridged = passed[:-1] % 2 == 1  # between the first and the second edge, and so on
    feature = stroke.feature[whole]
    feature[bridged] = BRIDGE
    return Stroke(points, feature, laid, stroke.centre[whole]), whole
