"""Skins over air and over cells: where they are bridges, and which way these are laid."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely

from v3dcad.geometry.loops.segments import Segments
from v3dcad.model import Diagram, Floats
from v3dcad.toolpath.division import Division
from v3dcad.toolpath.perimeters import inset
from v3dcad.toolpath.scan_lines import ScanLines, gaps

ANGLES = np.arange(0.0, 180.0, 15.0)
"""Directions of bridges that are tried, degrees."""
TRIED = 60
"""Most lines by which a direction is tried."""
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

    division: Division
    diagram: Diagram
    ribs: Floats
    """(r, 2, 2) mm, both ends of walls that end in cells"""
    wall: float
    """mm: width of a wall between cells"""
    beads: Segments
    """the lines that its beads lie along"""

    def held(self) -> Held:
        """What of the layer holds up the next: solid parts, the foam's rim, and walls in it."""
        division = self.division
        inside = inset(division.foam, division.spacing)
        walls = self.diagram.vertices[self.diagram.edges[self.diagram.inner()]]
        solid = shapely.difference(division.area, inside)
        return Held(solid, np.concatenate([walls, self.ribs]), self.wall)


def bridges(
    over: shapely.Geometry, below: Below, spacing: float
) -> list[tuple[shapely.Geometry, float]]:
    """The bridges of skins over cells and air: an area and a direction, degrees, each.

    Beads lie `spacing` apart (mm).
    """
    if over.is_empty:
        return []
    held = below.held()
    parts = [part for part in shapely.get_parts(over) if part.geom_type == "Polygon"]
    return [(part, direction(part, held, spacing)) for part in parts]


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
