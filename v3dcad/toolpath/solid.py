"""Solid layers: an area covered with parallel beads."""

from __future__ import annotations

import math

import numpy as np
import shapely
from shapely.affinity import rotate

from v3dcad.model import Floats, Ints
from v3dcad.toolpath.perimeters import inset

REACH = 4.0
"""Line spacings of a step between two lines: along a side that leans 15° from them, or more."""
SLACK = 1e-6
"""mm: a step this far outside, by rounding, lies on the boundary."""


def hatch(
    area: shapely.Geometry, spacing: float, angle: float, room: shapely.Geometry | None = None
) -> list[Floats]:
    """Polylines (k, 2), mm, that cover an area with lines `spacing` apart at `angle` (degrees).

    Lines lie on one grid through the origin for all layers. They are drawn to and fro; each piece
    of a line goes on from one on the line before where the step between them is short and stays
    inside (or in a larger `room`), so that there are few polylines where the area has holes or
    bays, too.
    """
    turned = rotate(area, -angle, origin=(0, 0))
    if turned.is_empty:
        return []
    left, low, right, high = turned.bounds
    grid = np.arange(math.ceil(low / spacing), math.floor(high / spacing) + 1) * spacing
    ends = np.empty((len(grid), 2, 2))
    ends[..., 0] = [left - 1, right + 1]
    ends[..., 1] = grid[:, None]
    left, right, row = _spans(shapely.intersection(shapely.linestrings(ends), turned))
    # To and fro: every second row runs from right to left.
    fro = row % 2 == 1
    begin, end = np.where(fro, right, left), np.where(fro, left, right)
    y = grid[row]
    around = inset(turned if room is None else rotate(room, -angle, origin=(0, 0)), -SLACK)
    before = _before(around, begin, end, row, y, spacing)
    turn = math.radians(angle)
    back = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    points = np.stack([np.column_stack([x, y]) for x in (begin, end)], axis=1) @ back
    lines: list[list[int]] = []
    line_of = np.empty(len(row), np.int64)
    for span, last in enumerate(before.tolist()):
        if last < 0:
            line_of[span] = len(lines)
            lines.append([span])
        else:
            line_of[span] = line_of[last]
            lines[line_of[span]].append(span)
    return [points[line].reshape(-1, 2) for line in lines]


def _spans(rows: Floats) -> tuple[Floats, Floats, Ints]:
    """(n,) from where to where along x the lines of some rows run, and in which row, in order."""
    parts, row = shapely.get_parts(shapely.line_merge(rows), return_index=True)
    left, _, right, _ = shapely.bounds(parts).T
    order = np.lexsort((left, row))
    order = order[(right > left)[order]]
    return left[order], right[order], row[order]


def _before(
    area: shapely.Geometry, begin: Floats, end: Floats, row: Ints, y: Floats, spacing: float
) -> Ints:
    """(n,) the span of the row before that each span goes on from; -1 where it begins a polyline.

    Spans go from `begin` to `end` along x, at `y`, row by row, from left to right in each. A step
    between two is short, and lies inside the area.
    """
    if not len(row):
        return np.empty(0, np.int64)
    reach = math.sqrt(REACH**2 - 1) * spacing
    wide = 4 * reach + float(np.ptp([begin, end]))
    keys, wanted = row * wide + end, (row - 1) * wide + begin
    first = np.searchsorted(keys, wanted - reach)
    count = np.searchsorted(keys, wanted + reach, side="right") - first
    after = np.repeat(np.arange(len(row)), count)
    last = np.arange(len(after)) + np.repeat(first - np.cumsum(count) + count, count)
    ends = np.stack([end[last], y[last], begin[after], y[after]], axis=1).reshape(-1, 2, 2)
    shapely.prepare(area)
    inside = shapely.covers(area, shapely.linestrings(ends))
    before, used = np.full(len(row), -1), np.zeros(len(row), np.bool_)
    for span, other in zip(after[inside].tolist(), last[inside].tolist(), strict=True):
        if before[span] < 0 and not used[other]:
            before[span], used[other] = other, True
    return before
