"""Solid layers: an area covered with parallel beads."""

from __future__ import annotations

import math

import numpy as np
import shapely
from shapely.affinity import rotate

from v3dcad.model import Floats


def hatch(area: shapely.Geometry, spacing: float, angle: float) -> list[Floats]:
    """Polylines (k, 2), mm, that cover an area with lines `spacing` apart at `angle` (degrees).

    Lines lie on one grid through the origin for all layers. They are drawn to and fro; a line
    goes on from the one before where the step between them is short and stays inside.
    """
    turned = rotate(area, -angle, origin=(0, 0))
    if turned.is_empty:
        return []
    left, low, right, high = turned.bounds
    rows = np.arange(math.ceil(low / spacing), math.floor(high / spacing) + 1) * spacing
    ends = np.empty((len(rows), 2, 2))
    ends[..., 0] = [left - 1, right + 1]
    ends[..., 1] = rows[:, None]
    shapely.prepare(turned)
    lines: list[Floats] = []
    for number, row in enumerate(shapely.intersection(shapely.linestrings(ends), turned)):
        spans = [shapely.get_coordinates(part) for part in shapely.get_parts(row)]
        spans = sorted((span for span in spans if len(span) > 1), key=lambda span: span[0, 0])
        for span in spans if number % 2 == 0 else [span[::-1] for span in reversed(spans)]:
            if lines and _goes_on(turned, lines[-1][-1], span[0], spacing):
                lines[-1] = np.vstack([lines[-1], span])
            else:
                lines.append(span)
    turn = math.radians(angle)
    back = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    return [line @ back for line in lines]


def _goes_on(area: shapely.Geometry, here: Floats, there: Floats, spacing: float) -> bool:
    near = np.hypot(*(there - here)) <= 2 * spacing
    return bool(near and area.covers(shapely.LineString([here, there])))
