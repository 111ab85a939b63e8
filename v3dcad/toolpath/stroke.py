"""What the nozzle extrudes without stopping."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from v3dcad.geometry.loops.segments import Segments
from v3dcad.model import BRIDGE, Bytes, Floats, Ints


class Stroke(NamedTuple):
    """One stroke of the nozzle: `points` (k + 1, 2), mm, and for each of the k steps

    its feature, how many mm of full bead are laid, the centre (k, 2) where it is an arc (else NaN),
    and the other step along the same line: itself, where that is passed once. None: all are.
    """

    points: Floats
    feature: Bytes
    laid: Floats
    centre: Floats
    other: Ints | None = None


def way_back(points: Floats, length: float) -> Floats:
    """Points (m, 2) on the way back over a stroke (k, 2) from its end, at most `length` mm."""
    back = points[::-1]
    steps = np.hypot(*np.diff(back, axis=0).T) if len(back) else np.empty(0)
    reached = np.concatenate([[0.0], np.cumsum(steps)])
    if length <= 0 or reached[-1] <= 0:
        return points[:0]
    stop = min(length, float(reached[-1]))
    last = [np.interp(stop, reached, back[:, axis]) for axis in (0, 1)]
    passed = (reached > 0) & (reached < stop)
    return np.vstack([back[passed], last])


class Lines(NamedTuple):
    """The lines that the strokes of a layer follow, each once."""

    segments: Segments
    stroke: Ints
    """(n,) whose each is"""


def lines_of(strokes: Sequence[Stroke], spacing: float) -> Lines:
    """The lines of strokes, for beads that lie `spacing` apart, mm."""
    start, stop = [np.empty((0, 2))], [np.empty((0, 2))]
    for one in strokes:
        on = _first(one)
        start.append(one.points[:-1][on])
        stop.append(one.points[1:][on])
    counts = [len(points) for points in start[1:]]
    segments = Segments.of(np.concatenate(start), np.concatenate(stop), spacing)
    return Lines(segments, np.repeat(np.arange(len(strokes)), counts))


def capped(strokes: Sequence[Stroke], room: Floats) -> list[Stroke]:
    """The strokes of a layer with no more bead than there is room for.

    `room` (n,) is the share that each of their lines has to itself, as `covered` tells. Of a line
    that is passed twice, half is laid each time. Bridges are laid in full: they hang free, with a
    flow of their own.
    """
    fed, used = [], 0
    for one in strokes:
        on, amount = _first(one), one.laid.copy()
        bridge = one.feature[on] == BRIDGE
        amount[on] *= np.where(bridge, 1.0, room[used : used + len(bridge)])
        if one.other is not None:
            each = np.arange(len(amount))
            amount = amount[np.minimum(each, one.other)]
            amount[one.other != each] /= 2
        fed.append(one._replace(laid=amount))
        used += len(bridge)
    return fed


def _first(stroke: Stroke) -> NDArray[np.bool_] | slice:
    """Which steps are the first to pass their line."""
    if stroke.other is None:
        return slice(None)
    return np.arange(len(stroke.other)) <= stroke.other
