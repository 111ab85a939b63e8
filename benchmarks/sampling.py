"""Points on the walls of a layer, and how far they lie from the layer below: by sampling, with
GEOS, and so with nothing in common with the certificate of overhang.
"""

from __future__ import annotations

import numpy as np
import shapely

from v3dcad.geometry.section_area import section_area
from v3dcad.model import Floats, Layer


def points_along(ends: Floats, spacing: float) -> Floats:
    """Points (p, 2) on segments (s, 2, 2), both ends among them, at most a spacing apart, mm."""
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    steps = np.ceil(lengths / spacing).astype(int) + 1
    edge = np.repeat(np.arange(len(ends)), steps + 1)
    number = np.arange(len(edge)) - np.repeat(np.cumsum(steps + 1) - steps - 1, steps + 1)
    share = (number / steps[edge])[:, None]
    return np.asarray(ends[edge, 0] * (1 - share) + ends[edge, 1] * share)


def distances_below(layer: Layer, below: Layer, spacing: float) -> Floats:
    """How far (p,), mm, points on a layer's walls lie from walls and contours of the layer below.

    Those outside the section below are left out: they are the part's own overhang.
    """
    inner = layer.diagram.inner()
    points = points_along(layer.diagram.vertices[layer.diagram.edges[inner]], spacing)
    area = section_area(below.section)
    shapely.prepare(area)
    points = points[shapely.contains_xy(area, points)]
    lines = shapely.linestrings(below.diagram.vertices[below.diagram.edges])
    if not len(points) or not len(lines):
        return np.zeros(0)
    nearest = shapely.STRtree(lines).query_nearest(
        shapely.points(points), return_distance=True, all_matches=False
    )
    return np.asarray(nearest[1])
