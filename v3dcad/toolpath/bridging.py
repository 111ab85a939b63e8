"""Skins over air and over cells: where they are bridges, and which way these are laid."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely

from v3dcad.geometry.loops.segments import Segments
from v3dcad.model import Diagram, Floats
from v3dcad.toolpath.perimeters import inset, opened
from v3dcad.toolpath.scan_lines import ScanLines, gaps
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


class Held(NamedTuple):
    """What holds up bridges."""

    solid: shapely.Geometry
    walls: Floats
    """(n, 2, 2) mm, both ends of walls in the foam"""
    width: float = 0.0
    """mm, of a wall"""

    def near(self, area: shapely.Geometry, margin: float) -> Held:
        """What of it lies in the box of an area and `margin` mm around it; some walls reach out."""
        low, high = np.add(np.reshape(shapely.bounds(area), (2, 2)), [[-margin], [margin]])
        meets = (self.walls.min(axis=1) <= high) & (self.walls.max(axis=1) >= low)
        solid = shapely.clip_by_rect(self.solid, *low, *high)
        return Held(solid, self.walls[meets.all(axis=1)], self.width)


class Below(NamedTuple):
    """What of the layer below holds up the next."""

    area: shapely.Geometry
    foam: shapely.Geometry
    """where of the area there are cells; the rest is perimeters and skins"""
    diagram: Diagram
    wall: float
    """mm: width of a wall between cells"""
    beads: Segments
    """the lines that its beads lie along"""

    def solid(self) -> shapely.Geometry:
        """Perimeters and skins."""
        return shapely.difference(self.area, self.foam)

    def held(self) -> Held:
        """What of the layer holds up the next: solid parts, and walls in the foam."""
        walls = self.diagram.vertices[self.diagram.edges[self.diagram.inner()]]
        return Held(self.solid(), walls, self.wall)


def bridges(
    skin: shapely.Geometry, below: Below, spacing: float
) -> tuple[shapely.Geometry, list[tuple[shapely.Geometry, float]]]:
    """What of a skin rests on solid parts, and its bridges: an area and a direction, degrees, each.

    Beads lie `spacing` apart (mm).
    """
    held = below.held()
    rest, over = resting(skin, held.solid, spacing)
    if over.is_empty:
        return rest, []
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


def direction(area: shapely.Geometry, held: Held, spacing: float) -> float:
    """The direction, degrees, of the bridge over an area with the shortest spans.

    Lines across the area are tried in each of `ANGLES`: of what is not `held` from below, the
    longest span is to be least, and then the sum of their squares. One with a free end counts as
    `FREE` times its length.
    """
    near = held.near(area, spacing + held.width)
    costs = [_cost(area, near, angle, spacing) for angle in ANGLES.tolist()]
    return float(ANGLES[costs.index(min(costs))])


def _cost(area: shapely.Geometry, held: Held, angle: float, spacing: float) -> tuple[float, float]:
    """The longest span, in whole bead spacings, and the sum of squares."""
    lines = ScanLines.across(area, angle, spacing, TRIED)
    reach = spacing / 2  # the round end of a bead
    solid = lines.inside(held.solid) + np.array([-reach, reach])
    walls = lines.over(held.walls, held.width / 2 + reach)
    lengths, loose = gaps(lines.inside(area), np.concatenate([solid, walls]))
    wide = lengths > spacing / 4
    spans = np.where(loose, FREE, 1.0)[wide] * lengths[wide]
    if not len(spans):
        return 0.0, 0.0
    return float(np.rint(spans.max() / spacing)), float((spans**2).sum() * lines.step)
