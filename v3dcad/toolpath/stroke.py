"""What the nozzle extrudes without stopping."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.loops.coverage import covered
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


def capped(strokes: Sequence[Stroke], spacing: float) -> tuple[list[Stroke], Segments]:
    """The strokes of a layer with no more bead than there is room for, beads `spacing` (mm) wide.

    Where beads come nearer to each other than that, as in narrow tips, thin parts and junctions of
    walls of one bead, each gets what lies nearest to it. Of a line that is passed twice, half is
    laid each time. Bridges are laid in full: they hang free, with a flow of their own. Beside the
    strokes come all lines that they follow, each once.
    """
    first = [
        np.ones(len(one.laid), np.bool_) if one.other is None
        else np.arange(len(one.laid)) <= one.other
        for one in strokes
    ]  # fmt: skip
    start, stop = (
        np.concatenate([
            np.empty((0, 2)),
            *(one.points[ends][on] for one, on in zip(strokes, first, strict=True)),
        ])
        for ends in (slice(None, -1), slice(1, None))
    )  # fmt: skip
    lines = Segments.of(start, stop, spacing)
    counts = [int(on.sum()) for on in first]
    share = covered(lines, np.repeat(np.arange(len(strokes)), counts), spacing)
    fed = []
    parts = np.split(share, np.cumsum(counts))[:-1]
    for one, on, part in zip(strokes, first, parts, strict=True):
        amount = one.laid.copy()
        amount[on] *= np.where(one.feature[on] == BRIDGE, 1.0, part)
        if one.other is not None:
            amount = np.where(on, amount, amount[one.other])
            amount[one.other != np.arange(len(amount))] /= 2
        fed.append(one._replace(laid=amount))
    return fed, lines
