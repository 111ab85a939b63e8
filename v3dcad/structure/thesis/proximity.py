"""Which points lie on a section's boundary (Algorithm 2)."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from v3dcad.model import Diagram, Floats, Section
from v3dcad.structure.thesis.cells import present


def near_boundary(points: Floats, section: Section, tolerance: float) -> NDArray[np.bool_]:
    """(k,) which points (k, 2) lie closer than `tolerance` (mm) to a ring of the section."""
    if not section.rings:
        return np.zeros(len(points), dtype=bool)
    closed = [shapely.linestrings(np.vstack([ring, ring[:1]])) for ring in section.rings]
    rings = shapely.multilinestrings(closed)
    shapely.prepare(rings)
    return np.asarray(shapely.distance(rings, shapely.points(points)) < tolerance)


def cells_on_boundary(
    diagram: Diagram, section: Section, count: int, tolerance: float
) -> NDArray[np.bool_]:
    """(count,) which sites' cells have a corner on the section's boundary.

    True also for sites without a cell, which nothing is to be done with either.
    """
    near = near_boundary(diagram.vertices, section, tolerance)
    touching = ~present(diagram, count)
    cells = diagram.edge_sites[near[diagram.edges].any(axis=1)].ravel()
    # An edge with one end on the boundary belongs to two cells, and both have that end.
    touching[cells[cells >= 0]] = True
    return touching
