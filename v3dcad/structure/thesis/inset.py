"""Inserted cells drawn in (Algorithm 8), with Clipper's offset."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pyclipper
import shapely
from numpy.typing import NDArray

from v3dcad.model import Diagram, Floats, Section
from v3dcad.structure.thesis.cells import area, is_convex, rings
from v3dcad.structure.thesis.proximity import near_boundary
from v3dcad.structure.thesis.state import UNTOUCHED, State

STEP = 0.1
"""mm; the thesis's offsetResolution."""

LEAST_AREA = 2.0
"""mm²; no cell is drawn in to less."""

SCALE = float(1 << 24)
"""Clipper computes in integers: so many of them a millimetre."""


def inset(
    state: State, diagram: Diagram, section: Section, tolerance: float
) -> tuple[State, Diagram]:
    """The state with each cell's inset noted, and the diagram after it: vertices moved, no more.

    On the first meeting a cell is drawn in as far as it keeps its number of corners and
    2 mm²; later as far as it was then, or as far as it still can. Corners on the section's
    boundary (closer than `tolerance`, mm) stay; the others move to the inset polygon's, and
    with them the corners of the cells around. Cells that are not one convex polygon are left.
    """
    inserted = state.inserted().tolist()
    if not inserted:
        return state, diagram
    vertices = np.array(diagram.vertices)
    fixed = near_boundary(vertices, section, tolerance)
    for site in inserted:
        found = rings(diagram, site)
        if len(found) != 1 or not is_convex(vertices[found[0]]):
            continue
        ring = found[0]
        steps = int(state.inset_steps[site])
        if steps == UNTOUCHED:
            steps = most_steps(vertices[ring])
        else:
            steps = kept_steps(vertices[ring], steps)
        state = state.with_values(site, inset_steps=steps)
        if steps:
            vertices[ring] = moved(vertices[ring], steps, fixed[ring])
    return state, replace(diagram, vertices=vertices)


def drawn_in(polygon: Floats, steps: int) -> Floats | None:
    """A convex polygon (k, 2), mm, offset inwards; None where nothing or little is left of it.

    Little is less than 2 mm² or fewer corners. The corners come in the polygon's order, each at
    the place of the one that it was (that rotation of them which moves them least).
    """
    if not steps:
        return polygon
    offset = pyclipper.PyclipperOffset(miter_limit=1e3)
    offset.AddPath(
        np.rint(polygon * SCALE).astype(np.int64).tolist(),
        pyclipper.JT_MITER,
        pyclipper.ET_CLOSEDPOLYGON,
    )
    paths = offset.Execute(-steps * STEP * SCALE)
    if len(paths) != 1 or len(paths[0]) != len(polygon):
        return None
    corners = np.array(paths[0], dtype=np.float64) / SCALE
    if area(corners) < LEAST_AREA:
        return None
    turns = [np.roll(corners, turn, axis=0) for turn in range(len(corners))]
    return min(turns, key=lambda turned: float(((turned - polygon) ** 2).sum()))


def most_steps(polygon: Floats) -> int:
    """By how many steps of 0.1 mm a polygon can be drawn in (Algorithm 8, lines 12 to 23)."""
    steps = 0
    while drawn_in(polygon, steps + 1) is not None:
        steps += 1
    return steps


def kept_steps(polygon: Floats, steps: int) -> int:
    """The steps of an earlier layer, or as many of them as the polygon still allows."""
    while drawn_in(polygon, steps) is None:
        steps -= 1
    return steps


def moved(polygon: Floats, steps: int, fixed: NDArray[np.bool_]) -> Floats:
    """Where the corners (k, 2) of a cell go, those on the boundary staying (lines 27 to 41).

    The cell becomes the convex hull of them all; a corner that the hull leaves out is put on
    its edge, so that the cell and those around it still meet.
    """
    inner = drawn_in(polygon, steps)
    if inner is None:
        raise ValueError("the polygon cannot be drawn in so far")
    corners = np.where(fixed[:, None], polygon, inner)
    edge = shapely.boundary(shapely.convex_hull(shapely.multipoints(corners)))
    points = shapely.points(corners)
    left_out = shapely.distance(edge, points) > 1e-9
    along = shapely.line_locate_point(edge, points[left_out])
    corners[left_out] = shapely.get_coordinates(shapely.line_interpolate_point(edge, along))
    return corners
