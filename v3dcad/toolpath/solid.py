"""Solid layers: an area covered with parallel beads."""

from __future__ import annotations

import math

import numpy as np
import shapely
from shapely.affinity import rotate

from v3dcad.model import Floats
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
    around = inset(turned if room is None else rotate(room, -angle, origin=(0, 0)), -SLACK)
    shapely.prepare(around)
    lines: list[list[Floats]] = []
    before: list[list[Floats]] = []
    rows = shapely.line_merge(shapely.intersection(shapely.linestrings(ends), turned))
    for number, row in enumerate(rows):
        spans = [shapely.get_coordinates(part) for part in shapely.get_parts(row)]
        spans = sorted((span for span in spans if len(span) > 1), key=lambda span: span[0, 0])
        here: list[list[Floats]] = []
        for span in spans if number % 2 == 0 else [span[::-1] for span in spans]:
            line = next((a for a in before if _goes_on(around, a[-1][-1], span[0], spacing)), None)
            if line is None:
                line = []
                lines.append(line)
            else:
                before = [other for other in before if other is not line]
            line.append(span)
            here.append(line)
        before = here
    turn = math.radians(angle)
    back = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    return [np.vstack(line) @ back for line in lines]


def _goes_on(area: shapely.Geometry, here: Floats, there: Floats, spacing: float) -> bool:
    near = np.hypot(*(there - here)) <= REACH * spacing
    return bool(near and area.covers(shapely.LineString([here, there])))
