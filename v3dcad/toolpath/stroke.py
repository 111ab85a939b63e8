"""What the nozzle extrudes without stopping."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.loops.coverage import covered
from v3dcad.model import BRIDGE, RETRACED, Bytes, Floats


class Stroke(NamedTuple):
    """One stroke of the nozzle: `points` (k + 1, 2), mm, and for each of the k steps

    its feature (RETRACED where nothing is extruded), how many mm of full bead are laid, and
    the centre (k, 2) where it is an arc (else NaN).
    """

    points: Floats
    feature: Bytes
    laid: Floats
    centre: Floats


def capped(strokes: Sequence[Stroke], spacing: float) -> list[Stroke]:
    """The strokes of a layer with no more bead than there is room for, beads `spacing` (mm) wide.

    Where beads come nearer to each other than that, as in narrow tips, thin parts and junctions of
    walls of one bead, each gets what lies nearest to it. Bridges are laid in full: they hang free,
    with a flow of their own.
    """
    if not strokes:
        return []
    laid = [stroke.feature != RETRACED for stroke in strokes]
    share = covered(
        np.concatenate([stroke.points[:-1][on] for stroke, on in zip(strokes, laid, strict=True)]),
        np.concatenate([stroke.points[1:][on] for stroke, on in zip(strokes, laid, strict=True)]),
        np.repeat(np.arange(len(strokes)), [int(on.sum()) for on in laid]),
        spacing,
    )
    ends = np.cumsum([on.sum() for on in laid])[:-1]
    fed = []
    for stroke, on, part in zip(strokes, laid, np.split(share, ends), strict=True):
        amount = stroke.laid.copy()
        amount[on] *= np.where(stroke.feature[on] == BRIDGE, 1.0, part)
        fed.append(stroke._replace(laid=amount))
    return fed
