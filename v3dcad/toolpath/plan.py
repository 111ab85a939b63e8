"""What is printed on a layer and in which order: strokes, still flat and without volume."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import shapely

from v3dcad.geometry.loops.links import Linked
from v3dcad.model import (
    BRIDGE,
    BRIM,
    PERIMETER,
    SKIRT,
    SOLID,
    Floats,
    Ints,
    Layer,
)
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.bridging import Below, bridges
from v3dcad.toolpath.division import Division, perimeter_depths
from v3dcad.toolpath.first_layer import brim_width
from v3dcad.toolpath.graph import (
    PathGraph,
    diagram_graph,
    loops_graph,
    with_short_edges_joined,
)
from v3dcad.toolpath.joined_route import from_seams, in_order, joined_curves
from v3dcad.toolpath.perimeters import inset, loops, perimeter, with_arcs
from v3dcad.toolpath.ribs import Ribs
from v3dcad.toolpath.route import closed_strokes, minimum_join
from v3dcad.toolpath.seam import Seams
from v3dcad.toolpath.solid import hatch
from v3dcad.toolpath.stroke import Stroke
from v3dcad.toolpath.tree_route import tree_walks
from v3dcad.toolpath.trim import trimmed


@dataclass(slots=True)
class Plan:
    """A layer's strokes as they come, and what is known once all have come."""

    layer: Layer
    division: Division
    settings: PrintSettings
    linked: Linked
    seams: Seams
    below: Below | None
    """the layer below; None on the bed"""
    ribs: Ribs
    thesis: bool
    """whether walls of one bead are printed in the thesis's order"""
    joined: int = 0
    retraced: float = 0.0
    here: Floats = field(default_factory=lambda: np.zeros(2))

    def strokes(self, here: Floats) -> Iterator[Stroke]:
        """The strokes in printing order, the first one from near `here` (2,), mm."""
        self.here = here
        if not self.layer.section.rings:
            return
        if self.division.first:
            yield from self._around()
        division = self.division
        depths = perimeter_depths(self.settings, division.spacing)
        if self.settings.wall_beads == 2:
            yield from self._in_closed_strokes(depths)
        else:
            whole = division.rest.is_empty and division.over.is_empty
            yield from self._in_walks(depths, whole=whole)
        yield from self._solid()

    def _in_walks(self, depths: list[float], *, whole: bool) -> Iterator[Stroke]:
        """Perimeters and cells of one bead; where foam is not the `whole` inside, with a rim.

        The rim lies beside a skin, or beside the innermost perimeter, a bead deeper than that.
        """
        outer = [self._perimeter(depth) for depth in depths[: -1 if whole else None]]
        area, spacing = self.division.area, self.division.spacing
        depth = depths[-1] if whole else depths[-1] + spacing
        innermost = inset(area, depth) if whole else inset(self.division.foam, spacing / 2)
        graph, self.joined = with_short_edges_joined(
            self._arced(self._cells_within(innermost, depth), depth), self.settings.minimum_edge
        )
        outline = graph.feature == PERIMETER
        order = [*outer, graph]
        if self.settings.perimeter_order == "before":
            order = [*outer, graph.only(outline), graph.only(~outline)]
        elif self.settings.perimeter_order == "after":
            order = [graph.only(~outline), graph.only(outline), *outer[::-1]]
        for part in order:
            yield from self._routed(part)

    def _solid(self) -> Iterator[Stroke]:
        """Skins as parallel beads, those over air and cells as bridges; the nearest line next."""
        rest, over, spacing = self.division.rest, self.division.over, self.division.spacing
        angle = 45.0 if self.layer.index % 2 else -45.0
        parts = [(rest, angle, SOLID)]
        if self.below is None:  # what a layer takes is asked for, not which way it is laid
            parts.append((over, angle, SOLID))
        else:
            parts += [(a, turned, BRIDGE) for a, turned in bridges(over, self.below, spacing)]
        lines = [
            (line, what)
            for area, turned, what in parts
            for line in hatch(inset(area, spacing / 2), spacing, turned, area)
        ]
        ends = np.array([[line[0], line[-1]] for line, _ in lines]).reshape(-1, 2, 2)
        for _ in range(len(lines)):
            apart = np.hypot(*np.moveaxis(ends - self.here, -1, 0))
            nearest, end = np.unravel_index(int(np.argmin(apart)), apart.shape)
            ends[nearest] = np.inf
            line, what = lines[nearest]
            yield self._moved_to(_line(line[::-1] if end else line, what))

    def _in_closed_strokes(self, depths: list[float]) -> Iterator[Stroke]:
        """Outer perimeters unbroken; what lies further in is joined to one curve a region."""
        shortest = self.settings.minimum_edge
        curves = joined_curves(
            self.layer, self.division, depths[1:], self.linked, shortest, self.ribs
        )
        outer = from_seams(self._perimeter(depths[0]), self.seams)
        for stroke in in_order(outer, curves, self.division.spacing, self.here, shortest):
            yield self._moved_to(stroke)

    def _around(self) -> Iterator[Stroke]:
        """Skirt and brim, from the outside in."""
        settings, width = self.settings, self.settings.bead_width
        outline = shapely.union_all(
            [shapely.Polygon(part.exterior) for part in shapely.get_parts(self.division.area)]
        )
        edge = 0.0 if settings.contour == "inset" else width / 2
        brim = math.ceil(brim_width(self.division.area, settings) / width)
        skirt = edge + brim * width + settings.skirt_distance
        for number in reversed(range(settings.skirt_loops)):
            yield from self._outside(outline, skirt + (number + 0.5) * width, SKIRT)
        for number in reversed(range(brim)):
            yield from self._outside(outline, edge + (number + 0.5) * width, BRIM)

    def _outside(self, outline: shapely.Geometry, distance: float, what: int) -> Iterator[Stroke]:
        grown = [shapely.Polygon(p.exterior) for p in shapely.get_parts(inset(outline, -distance))]
        yield from self._routed(loops_graph(loops(shapely.union_all(grown)), what))

    def _cells_within(self, innermost: shapely.Geometry, depth: float) -> PathGraph:
        if depth == 0:
            return diagram_graph(self.layer.diagram)
        return trimmed(self.layer.diagram, innermost, loops(innermost))

    def _perimeter(self, depth: float) -> PathGraph:
        """The perimeter `depth` mm inside the contours."""
        return self._arced(perimeter(self.division.area, depth), depth)

    def _arced(self, graph: PathGraph, depth: float) -> PathGraph:
        return with_arcs(graph, self.layer.section, depth) if self.settings.arcs else graph

    def _routed(self, graph: PathGraph) -> Iterator[Stroke]:
        laid = graph.lengths()
        if self.thesis:
            for vertices, edges in tree_walks(graph, self.here, self.layer.tree):
                yield self._moved_to(_stroke(graph, vertices, edges, laid))
            return
        join = minimum_join(graph)
        self.retraced += join.length
        for walk in closed_strokes(graph, join, self.here):
            stroke = _stroke(graph, walk.vertices, walk.edges, laid)
            yield self._moved_to(stroke._replace(other=walk.other))

    def _moved_to(self, stroke: Stroke) -> Stroke:
        self.here = stroke.points[-1]
        return stroke


def _stroke(graph: PathGraph, vertices: Ints, edges: Ints, laid: Floats) -> Stroke:
    return Stroke(graph.vertices[vertices], graph.feature[edges], laid[edges], graph.centre[edges])


def _line(points: Floats, feature: int) -> Stroke:
    steps = np.diff(points, axis=0)
    return Stroke(
        np.ascontiguousarray(points),
        np.full(len(steps), feature, dtype=np.int8),
        np.hypot(*steps.T),
        np.full(steps.shape, np.nan),
    )
