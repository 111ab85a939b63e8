"""Walls that hang become bridges: printed with the speed, the flow and the fan of these.

The foam's rim lies over open cells where a roof leans little, since it comes in with the contour on
each layer; so does a wall that moves by a whole bead at once, where a cell opens beside a
perimeter.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from v3dcad.geometry.loops.reach import far_from
from v3dcad.geometry.loops.segments import Segments
from v3dcad.model import BRIDGE, CELLS, INNER_PERIMETER, Floats
from v3dcad.toolpath.overhang import merged
from v3dcad.toolpath.stroke import Stroke

LEAST = 1.0
"""Widths of a bead: what is shorter than a bead is wide is held from both of its ends."""


def with_bridged_walls(
    strokes: Sequence[Stroke], below: Segments, width: float, shortest: float
) -> tuple[list[Stroke], float]:
    """The strokes, with stretches of walls and inner perimeters that hang as bridges; mm of them.

    Such a stretch has less than half of its `width` (mm) over the beads `below`, for at least
    `LEAST` widths. It begins and ends at a corner that is nearer than `shortest` (mm). No stroke
    passes a line twice.
    """
    found, length = list(strokes), 0.0
    for number, stroke in enumerate(strokes):
        chosen = np.flatnonzero(np.isin(stroke.feature, (CELLS, INNER_PERIMETER)))
        if not len(chosen):
            continue
        start, steps = stroke.points[:-1], np.diff(stroke.points, axis=0)
        long = np.hypot(*steps.T)
        at = np.concatenate([[0.0], np.cumsum(long)])
        of, low, high = far_from(start[chosen], stroke.points[1:][chosen], below, width / 2)
        of = chosen[of]
        spans = merged(at[of] + low * long[of], at[of] + high * long[of])
        spans = _snapped(spans[np.diff(spans)[:, 0] >= LEAST * width], at, shortest)
        spans = spans[np.diff(spans)[:, 0] > 0]
        if len(spans):
            found[number] = _cut(stroke, at, spans)
            length += float(np.diff(spans).sum())
    return found, length


def _snapped(places: Floats, at: Floats, shortest: float) -> Floats:
    """Places along a line, mm, those nearer than `shortest` to a corner `at` some mm on it."""
    after = np.clip(np.searchsorted(at, places), 1, len(at) - 1)
    nearest = np.where(places - at[after - 1] < at[after] - places, at[after - 1], at[after])
    return np.where(np.abs(places - nearest) < shortest, nearest, places)


def _cut(stroke: Stroke, at: Floats, spans: Floats) -> Stroke:
    """A stroke, whose points lie `at` some mm along it, with a bridge on each of the spans (s, 2).

    Steps that a span begins or ends within are cut there.
    """
    cuts = np.setdiff1d(spans, at)
    step = np.searchsorted(at, cuts, side="right") - 1
    share = (cuts - at[step]) / (at[step + 1] - at[step])
    places = stroke.points[step] + share[:, None] * (stroke.points[step + 1] - stroke.points[step])
    along = np.insert(at, step + 1, cuts)
    whole = np.repeat(np.arange(len(stroke.laid)), 1 + np.bincount(step, minlength=len(at) - 1))
    part = np.diff(along) / np.maximum(np.diff(at), 1e-12)[whole]
    middle = (along[:-1] + along[1:]) / 2
    span = np.maximum(np.searchsorted(spans[:, 0], middle) - 1, 0)
    bridged = (spans[span, 0] < middle) & (middle < spans[span, 1])
    return Stroke(
        np.insert(stroke.points, step + 1, places, axis=0),
        np.where(bridged, BRIDGE, stroke.feature[whole]).astype(np.int8),
        stroke.laid[whole] * np.minimum(part, 1.0),
        stroke.centre[whole],
    )
