"""A section as shapely's geometry: its contours as lines, its material as an area."""

from __future__ import annotations

import numpy as np
import shapely

from v3dcad.model import Section


def contour_lines(section: Section) -> shapely.Geometry:
    """The section's rings, closed, as one multilinestring; empty where it has none."""
    return shapely.MultiLineString([np.vstack([ring, ring[:1]]) for ring in section.rings])


def section_area(section: Section) -> shapely.Geometry:
    """The section's area as a polygon or several; every second nested ring is a hole."""
    return shapely.build_area(contour_lines(section))
