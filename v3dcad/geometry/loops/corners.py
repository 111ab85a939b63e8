"""Corners at links cut off, so that the nozzle need not slow down so much at them."""

from __future__ import annotations

import math

import numpy as np

from v3dcad.geometry.loops.curves import LINK, Curves
from v3dcad.geometry.loops.loops import following

BEND = math.radians(20)
"""A smaller turn is no corner: it is taken at full speed."""
MOST_SHARE = 0.3
"""The share of a step that a cut takes: so half a turn round a link is half an octagon."""


def links_rounded(curves: Curves, shortest: float) -> Curves:
    """The curves with two corners of half the turn in place of each corner at a link.

    A printer takes a corner of 45° twice as fast as one of 90°. Corners between walls stay: what is
    cut off there would leave the walls bare. So do those where the piece put in would be shorter
    than `shortest` (mm).
    """
    points, owner = curves.points, curves.owner
    after = following(curves.first)
    before = np.empty_like(after)
    before[after] = np.arange(len(points))
    (corner,) = np.nonzero((owner == LINK) | (owner[before] == LINK))

    arriving, leaving = (
        points[corner] - points[before[corner]],
        points[after[corner]] - points[corner],
    )
    gone, left = (np.maximum(np.sqrt((way**2).sum(axis=1)), 1e-12) for way in (arriving, leaving))
    arriving, leaving = arriving / gone[:, None], leaving / left[:, None]
    cosine = np.clip((arriving * leaving).sum(axis=1), -1, 1)
    away = MOST_SHARE * np.minimum(gone, left)
    # The piece put in is 2 · away · cos(turn ÷ 2) long.
    cut = (cosine < math.cos(BEND)) & (away * np.sqrt(2 + 2 * cosine) >= shortest)

    copies = np.ones(len(points), np.int64)
    copies[corner[cut]] = 2
    ends = np.cumsum(copies)
    found = np.repeat(points, copies, axis=0)
    found[ends[corner[cut]] - 2] -= away[cut, None] * arriving[cut]
    found[ends[corner[cut]] - 1] += away[cut, None] * leaving[cut]
    return Curves(found, np.concatenate([[0], ends])[curves.first], np.repeat(owner, copies))
