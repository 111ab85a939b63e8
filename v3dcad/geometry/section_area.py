"""A section as shapely's geometry: its contours as lines, its material as an area."""

from __future__ import annotations

import numpy as np
import shapely

from v3dcad.model import Floats, Section

ROUNDING = 1e-6
"""By which share areas of the same rings may differ."""

GRID = 1e-6
"""mm: on a grid of this mesh lines are divided where they meet, so that no piece is rounding."""


def contour_lines(section: Section) -> shapely.Geometry:
    """The section's rings, closed, as one multilinestring; empty where it has none."""
    return shapely.MultiLineString([np.vstack([ring, ring[:1]]) for ring in section.rings])


def section_area(section: Section) -> shapely.Geometry:
    """The section's area as a polygon or several; every second nested ring is a hole.

    Contours of a faulty part may run along themselves for a stretch. shapely, which takes crossings
    in the midst of lines for none, then finds no polygon; so where it misses what the rings
    enclose, by Green's theorem, they are divided where they meet.
    """
    lines = contour_lines(section)
    area = shapely.build_area(lines)
    enclosed = sum(_enclosed(ring) for ring in section.rings)
    if abs(area.area - enclosed) > ROUNDING * enclosed:
        return shapely.build_area(shapely.union_all([lines], grid_size=GRID))
    return area


def _enclosed(ring: Floats) -> float:
    """mm² on the left of a ring (k, 2), from its first corner on, so that little is rounded."""
    x, y = (ring - ring[0]).T
    return float(x[:-1] @ y[1:] - x[1:] @ y[:-1]) / 2
