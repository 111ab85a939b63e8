"""Toolpaths as the arrays that the page draws: points one after the other, each with its time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.print_time import step_seconds
from v3dcad.model import EXTRUDE, INNER_PERIMETER, PERIMETER, Floats, Ints, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.view.page.segments import Arrays, fractions

UNSEEN, TRAVELLED, BEAD, PERIMETER_BEAD, SEAM = range(5)
"""What the way to a point is: nothing to be seen (a layer's toolpath starts there, or the way is
passed again), a move without extrusion, a bead, a bead of a perimeter, one where a perimeter
begins."""

CHORD = np.radians(6)
"""The largest angle of an arc that is drawn as one straight line."""

TICK = 1000
"""Parts of a second that times are whole numbers of."""


class Motion(NamedTuple):
    """What the nozzle does on one layer."""

    points: Floats
    """(p, 3) mm; the first is where it comes from"""
    roles: Ints
    """(p,) what the way to each point is: `UNSEEN`, `TRAVELLED`, …"""
    seconds: Floats
    """(p,) how long the way to each point takes"""


def motion(toolpath: Toolpath, before: Floats, settings: PrintSettings) -> Motion:
    """A layer's toolpath that begins at `before` (3,), mm, its arcs as short straight lines."""
    extruding = toolpath.kind == EXTRUDE
    roles = np.where(extruding, BEAD, TRAVELLED)
    roles[extruding & np.isin(toolpath.feature, (PERIMETER, INNER_PERIMETER))] = PERIMETER_BEAD
    begins = np.diff(extruding.astype(int), prepend=0) > 0
    roles[begins & (toolpath.feature == PERIMETER)] = SEAM
    start = np.vstack([before, toolpath.points[:-1]])[: len(toolpath.points)]
    points, step = _chords(start, toolpath.points, toolpath.centre)
    seconds = step_seconds(toolpath, before, settings) / np.bincount(step, minlength=len(roles))
    shown = roles[step]
    later = np.diff(step, prepend=-1) == 0  # chords of an arc after its first
    shown[later & (shown == SEAM)] = PERIMETER_BEAD
    return Motion(
        np.vstack([before, points]),
        np.append(UNSEEN, shown),
        np.concatenate([[0.0], seconds[step]]),
    )


def motion_arrays(motions: Sequence[Motion]) -> Arrays:
    """The arrays of one or more layers: places as fractions of the box around them all."""
    points = np.concatenate([one.points for one in motions])
    box = np.array([points.min(axis=0), points.max(axis=0)])
    ticks = np.rint(np.concatenate([one.seconds for one in motions]) * TICK)
    return {
        "path_box": box.astype(np.float32),
        "path": fractions(points, box),
        "path_roles": np.concatenate([one.roles for one in motions]),
        "path_ticks": ticks.astype(np.int64),
        "path_from": np.cumsum([0, *(len(one.points) for one in motions)]),
    }


def _chords(start: Floats, stop: Floats, centre: Floats) -> tuple[Floats, Ints]:
    """The ends of the straight lines that steps are drawn as, and to which step each belongs.

    Steps go from start (p, 3) to stop (p, 3), on arcs about centre (p, 2) or straight where it is
    NaN. An arc is the shorter of the two between its ends.
    """
    middle = np.where(np.isnan(centre), 0.0, centre)
    (ax, ay), (bx, by) = (start[:, :2] - middle).T, (stop[:, :2] - middle).T
    turn = np.where(np.isnan(centre[:, 0]), 0.0, np.arctan2(ax * by - ay * bx, ax * bx + ay * by))
    count = np.maximum(np.ceil(np.abs(turn) / CHORD), 1).astype(np.int64)
    step = np.repeat(np.arange(len(stop)), count)
    last = np.cumsum(count) - 1
    place = np.arange(len(step)) - (last - count + 1)[step] + 1
    points = stop[step]
    angle = turn[step] * place / count[step]
    turned = np.column_stack(
        [
            ax[step] * np.cos(angle) - ay[step] * np.sin(angle),
            ax[step] * np.sin(angle) + ay[step] * np.cos(angle),
        ]
    )
    bent = place < count[step]
    points[bent, :2] = (turned + middle[step])[bent]
    return points, step
