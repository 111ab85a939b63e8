"""Perimeters inside a section's contour, and which of their edges are arcs."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
import shapely

from v3dcad.model import PERIMETER, Floats, Section
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.graph import PathGraph, loops_graph

MITRE_LIMIT = 3.0
"""Corners sharper than this many distances are cut off, as slicers do."""
ONE = 1e-9
"""mm: corners nearer to each other are one."""


@lru_cache(maxsize=64)
def inset(area: shapely.Geometry, distance: float) -> shapely.Geometry:
    """What of an area lies deeper than `distance` (mm) inside it; negative: the area grown.

    Upright walls have the same section on many layers, whose insets are kept for a while.
    """
    if distance == 0:
        return area
    try:
        with np.errstate(divide="raise", invalid="raise"):
            return _grown(area, -distance)
    except FloatingPointError:  # GEOS divides by the distance of two corners, and cuts them off
        with np.errstate(divide="ignore", invalid="ignore"):
            return _grown(shapely.set_precision(area, ONE), -distance)


def _grown(area: shapely.Geometry, distance: float) -> shapely.Geometry:
    return area.buffer(distance, join_style="mitre", mitre_limit=MITRE_LIMIT)


def opened(area: shapely.Geometry, radius: float) -> shapely.Geometry:
    """An area without its parts narrower than twice a radius (mm)."""
    return inset(inset(area, radius), -radius)


def outermost_depth(settings: PrintSettings) -> float:
    """How deep inside the contour the outermost perimeter's centre line runs, mm."""
    return settings.bead_width / 2 if settings.contour == "inset" else 0.0


def loops(area: shapely.Geometry) -> list[Floats]:
    """The closed lines around an area, each by its points (k, 2), mm."""
    rings = shapely.get_rings(shapely.get_parts(area))
    return [shapely.get_coordinates(ring)[:-1] for ring in rings]


@lru_cache(maxsize=64)
def perimeter(area: shapely.Geometry, depth: float) -> PathGraph:
    """The perimeter `depth` mm inside an area, without arcs; kept for a while, as insets are."""
    return loops_graph(loops(inset(area, depth)), PERIMETER)


def rings(area: shapely.Geometry) -> list[Floats]:
    """The same lines, the area on the left of each."""
    found = []
    for part in shapely.get_parts(area):
        if part.is_empty:
            continue
        for number, ring in enumerate((part.exterior, *part.interiors)):
            points = shapely.get_coordinates(ring)[:-1]
            found.append(points if ring.is_ccw == (number == 0) else points[::-1])
    return found


def with_arcs(graph: PathGraph, section: Section, distance: float) -> PathGraph:
    """The graph with its perimeter, `distance` (mm) inside the section, told its circular arcs.

    A circle's perimeter is a circle about the same centre. Vertices of the perimeter within
    the error of the section's own polygon are moved onto it, and the edges between them get
    its centre.
    """
    vertices, centres = graph.vertices.copy(), graph.centre.copy()
    perimeter = graph.feature == PERIMETER
    rim = np.unique(graph.edges[perimeter])
    for run in section.runs:
        if run.curve != "circle":
            continue
        centre, radius = np.array(run.parameters[:2]), run.parameters[2]
        ring = section.rings[run.ring]
        points = ring[np.arange(run.start, run.stop + 1) % len(ring)] - centre
        turned = points[:-1, 0] * points[1:, 1] - points[:-1, 1] * points[1:, 0]
        within = radius - distance if turned.sum() > 0 else radius + distance
        longest = float(np.hypot(*np.diff(points, axis=0).T).max())
        half_angle = math.asin(min(longest / (2 * radius), 1.0))
        if within <= 0 or half_angle > math.pi / 4:
            continue
        error = 2 * (radius + distance) * (1 / math.cos(half_angle) - 1) + 1e-6
        away = vertices[rim] - centre
        reach = np.hypot(*away.T)
        near = np.abs(reach - within) < error
        on = np.zeros(len(vertices), dtype=bool)
        on[rim[near]] = True
        chord = np.hypot(*np.diff(vertices[graph.edges], axis=1)[:, 0].T)
        arc = perimeter & on[graph.edges].all(axis=1)
        arc &= (chord < 2 * within * math.sin(half_angle) + 2 * error) & np.isnan(centres[:, 0])
        moved = np.zeros(len(vertices), dtype=bool)
        moved[graph.edges[arc]] = True
        moved = moved[rim]
        vertices[rim[moved]] = centre + away[moved] * (within / reach[moved])[:, None]
        centres[arc] = centre
    return replace(graph, vertices=vertices, centre=centres)
