"""Where two loops may be joined: stretches on which they face each other a bead's spacing apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from v3dcad.model import Floats, Ints, Value
from v3dcad.toolpath.cell_loops import Loops

LEAST_GAP = 0.6
"""A bridge is at least so many bead spacings wide."""
SLACK = 0.12
"""Facing loops are one bead spacing apart, but for this share of it."""


@dataclass(frozen=True, eq=False, slots=True)
class Facing(Value):
    """Pairs of segments that face each other, running in opposite directions."""

    loops: Ints
    """(n, 2) the two loops, the lower one first"""
    along: Floats
    """(n, 2) mm along the first loop: where the stretch begins and ends"""
    beyond: Floats
    """(n,) mm along the second loop of what faces the first's 0, so that x faces beyond − x"""


def positions(loops: Loops) -> tuple[Floats, Floats]:
    """(p,) mm along its loop of each point, and (l,) mm of each loop's length."""
    if not len(loops.points):
        return np.zeros(0), np.zeros(0)
    steps = np.hypot(*(_following(loops) - loops.points).T)
    passed = np.cumsum(steps) - steps
    start = loops.first[:-1]
    at = passed - np.repeat(passed[start], np.diff(loops.first))
    return at, np.add.reduceat(steps, start)


def facing(loops: Loops, spacing: float) -> Facing:
    """All stretches on which two loops face each other about one bead `spacing` (mm) apart."""
    here, there = loops.points, _following(loops)
    loop = np.repeat(np.arange(len(loops.owner)), np.diff(loops.first))
    at, _ = positions(loops)
    low, high = np.minimum(here, there), np.maximum(here, there)
    reach = (1 + SLACK) * spacing
    tree = shapely.STRtree(shapely.box(*low.T, *high.T))
    one, other = tree.query(shapely.box(*(low - reach).T, *(high + reach).T))
    chosen = loop[one] < loop[other]
    one, other = one[chosen], other[chosen]

    step = there[one] - here[one]
    length = np.hypot(*step.T)
    unit = step / np.maximum(length, 1e-12)[:, None]
    back = here[other] - there[other]
    straight = (unit * back).sum(axis=1) > 0.98 * np.hypot(*back.T)
    ends = [((point[other] - here[one]) * unit).sum(axis=1) for point in (there, here)]
    low, high = np.maximum(ends[0], 0.0), np.minimum(ends[1], length)
    # At the middle of what faces: how far the other's line is, and where on it.
    middle = (low + high) / 2
    share = (ends[1] - middle) / np.maximum(ends[1] - ends[0], 1e-12)
    across = here[other] - back * share[:, None] - here[one] - unit * middle[:, None]
    apart = np.hypot(*across.T)
    fine = straight & (high > low + 1e-6) & (np.abs(apart - spacing) < SLACK * spacing)
    one, other, low, high, middle = (x[fine] for x in (one, other, low, high, middle))
    faced = at[other] + share[fine] * np.hypot(*back[fine].T)
    return Facing(
        np.column_stack([loop[one], loop[other]]),
        at[one][:, None] + np.column_stack([low, high]),
        faced + at[one] + middle,
    )


def _following(loops: Loops) -> Floats:
    """(p, 2) the point after each, around its loop."""
    after = np.arange(1, len(loops.points) + 1)
    after[loops.first[1:] - 1] = loops.first[:-1]
    return loops.points[after]
