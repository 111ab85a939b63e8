"""Skins over air and over cells: where they are bridges, and which way these are laid."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely

from v3dcad.model import Diagram
from v3dcad.toolpath.perimeters import inset, opened
from v3dcad.toolpath.skins import NOTHING

ANGLES = np.arange(0.0, 180.0, 15.0)
"""Directions of bridges that are tried, degrees."""
TRIED = 60
"""Most lines by which a direction is tried."""
ANCHOR = 3.0
"""Bead spacings by which a bridge goes on over what holds it."""
LEAST_BRIDGE = 2.0
"""Bead spacings: a narrower strip over air is held from both sides."""
FREE = 4.0
"""Times its length: what a line with a free end counts as."""


class Below(NamedTuple):
    """What of the layer below holds up the next."""

    area: shapely.Geometry
    foam: shapely.Geometry
    """where of the area there are cells; the rest is perimeters and skins"""
    diagram: Diagram
    wall: float
    """mm: width of a wall between cells"""

    def solid(self) -> shapely.Geometry:
        """Perimeters and skins."""
        return shapely.difference(self.area, self.foam)

    def held(self, area: shapely.Geometry) -> shapely.Geometry:
        """What of the layer holds up an area on it: solid parts, and walls in the foam."""
        inner = self.diagram.edges[self.diagram.inner()]
        lines = shapely.linestrings(self.diagram.vertices[inner])
        near = lines[shapely.intersects(lines, shapely.intersection(self.foam, area))]
        walls = shapely.intersection(
            shapely.union_all(shapely.buffer(near, self.wall / 2)), self.foam
        )
        return shapely.union(self.solid(), walls)


def bridges(
    skin: shapely.Geometry, below: Below, spacing: float
) -> tuple[shapely.Geometry, list[tuple[shapely.Geometry, float]]]:
    """What of a skin rests on solid parts, and its bridges: an area and a direction, degrees, each.

    Beads lie `spacing` apart (mm).
    """
    rest, over = resting(skin, below.solid(), spacing)
    if over.is_empty:
        return rest, []
    held = below.held(over)
    parts = [part for part in shapely.get_parts(over) if part.geom_type == "Polygon"]
    return rest, [(part, direction(part, held, spacing)) for part in parts]


def resting(
    skin: shapely.Geometry, solid: shapely.Geometry, spacing: float
) -> tuple[shapely.Geometry, shapely.Geometry]:
    """What of a skin rests on what is `solid` below, and what is a bridge, ends and all."""
    radius = LEAST_BRIDGE * spacing / 2
    bare = inset(shapely.difference(skin, solid), radius)
    if bare.is_empty:
        return skin, NOTHING
    grown = inset(bare, -radius - ANCHOR * spacing)
    rest = opened(shapely.difference(skin, grown), radius)
    return rest, shapely.difference(skin, rest)


def direction(area: shapely.Geometry, held: shapely.Geometry, spacing: float) -> float:
    """The direction, degrees, of the bridge over an area with the shortest spans.

    Lines across the area are tried in each of `ANGLES`: of what is not `held` from below, the
    longest span is to be least, and then the sum of their squares. One with a free end counts as
    `FREE` times its length.
    """
    costs = [_cost(area, held, angle, spacing) for angle in ANGLES.tolist()]
    return float(ANGLES[costs.index(min(costs))])


def _cost(
    area: shapely.Geometry, held: shapely.Geometry, angle: float, spacing: float
) -> tuple[float, float]:
    """The longest span, in whole bead spacings, and the sum of squares."""
    turn = np.radians(angle)
    along, across = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    points = shapely.get_coordinates(area)
    (left, right), (low, high) = ((x.min(), x.max()) for x in (points @ along, points @ across))
    count = int(np.clip(round((high - low) / spacing), 1, TRIED))
    step = (high - low) / count
    rows = (low + (np.arange(count) + 0.5) * step)[:, None] * across
    lines = shapely.linestrings(
        np.stack([rows + (left - 1) * along, rows + (right + 1) * along], axis=1)
    )
    inside = shapely.get_parts(shapely.get_parts(shapely.intersection(lines, area)))
    # All lines at once: each by itself would go through all walls in the foam again.
    crossing = shapely.multilinestrings(inside[shapely.length(inside) > 0])
    free = shapely.get_parts(shapely.difference(crossing, held))
    free = free[shapely.length(free) > spacing / 4]
    if not len(free):
        return 0.0, 0.0
    ends = [shapely.get_point(free, number) for number in (0, -1)]
    loose = ~np.all([shapely.dwithin(end, held, spacing / 10) for end in ends], axis=0)
    spans = np.where(loose, FREE, 1.0) * shapely.length(free)
    return float(np.rint(spans.max() / spacing)), float((spans**2).sum() * step)
