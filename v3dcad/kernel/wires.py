"""Layers as B-rep wires: contours on their exact curves, walls as lines, sharing their vertices."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.Geom import Geom_Curve
from OCP.gp import gp_Pnt
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopoDS import TopoDS_Compound, TopoDS_Edge, TopoDS_Vertex, TopoDS_Wire

from v3dcad.geometry.drawing import Conic, Drawing, Spline
from v3dcad.geometry.graphs.trails import trails
from v3dcad.geometry.surface.contour_curves import Stretch, contours
from v3dcad.kernel.curves import hit, plain_curve, point_at, run_curve, span
from v3dcad.kernel.shapes import TOLERANCE, compound, location
from v3dcad.model import Floats, Ints, Layer, Placement


def layer_wires(layer: Layer, placement: Placement) -> TopoDS_Compound:
    """One compound of a layer's wires, where the source lies.

    Every contour is one closed wire of lines, arcs and splines that end where walls do; every
    wall is one wire of one edge; all share their vertices.
    """
    drawing = _drawn(layer, placement)
    corners = _Corners(drawing.points)
    wires = [corners.wire(contour, closed=True) for contour in drawing.contours]
    walls = (Arc(wall, None, 0.0, 0.0) for wall in drawing.walls.tolist())
    wires += [corners.wire([wall], closed=False) for wall in walls]
    return compound(wire for wire in wires if wire is not None)


def layer_curves(layer: Layer, placement: Placement, name: str) -> Drawing:
    """The same curves for a small file: straight ones chained into few polylines."""
    drawing = _drawn(layer, placement)
    arcs = [arc for contour in drawing.contours for arc in contour]
    straight = [pair for arc in arcs if arc.curve is None for pair in pairwise(arc.chain)]
    edges = np.concatenate([drawing.walls, np.array(straight, np.int64).reshape(-1, 2)])
    far = np.ptp(drawing.points[edges], axis=1).max(axis=1, initial=0.0) > TOLERANCE
    curved = [plain_curve(arc.curve, arc.first, arc.last) for arc in arcs if arc.curve is not None]
    return Drawing(
        name,
        drawing.points,
        trails(edges[far]),
        [curve for curve in curved if isinstance(curve, Conic)],
        [curve for curve in curved if isinstance(curve, Spline)],
    )


class Arc(NamedTuple):
    """A stretch of a contour, in the source's coordinates."""

    chain: list[int]
    """vertex ids along it"""
    curve: Geom_Curve | None
    """None where it is straight from vertex to vertex"""
    first: float
    last: float

    def pieces(self) -> list[tuple[int, int, Arc | None]]:
        """The edges it makes: one on a curve, and one for each straight segment."""
        if self.curve is not None:
            return [(self.chain[0], self.chain[-1], self)]
        return [(a, b, None) for a, b in pairwise(self.chain)]


class _Drawing(NamedTuple):
    """The points and curves of a layer."""

    points: Floats
    """(v, 3) the diagram's vertices where the source lies; walls end on the exact contour"""
    walls: Ints
    """(m, 2) vertex ids"""
    contours: list[list[Arc]]


def _drawn(layer: Layer, placement: Placement) -> _Drawing:
    diagram, section = layer.diagram, layer.section
    points = np.column_stack([diagram.vertices, np.full(len(diagram.vertices), layer.z)])
    walls = diagram.edges[diagram.inner()]
    behind = dict(np.concatenate([walls, walls[:, ::-1]]).tolist())
    found = contours(section, diagram)
    runs = dict.fromkeys(stretch.run for contour in found for stretch in contour)
    curves = {run: run_curve(run, section) for run in runs}
    for stretch, following in (pair for contour in found for pair in _pairs_around(contour)):
        end, curve = stretch.chain[-1], curves[stretch.run]
        if curve is not None and following.run == stretch.run and end in behind:
            points[end] = hit(curve, points[end], points[end] - points[behind[end]])
    drawn = [
        [_arc(stretch, curves[stretch.run], points) for stretch in contour] for contour in found
    ]
    back = location(placement).Inverted().Transformation()
    for curve in curves.values():
        if curve is not None:
            curve.Transform(back)
    return _Drawing(placement.to_source(points), walls, drawn)


def _pairs_around(contour: list[Stretch]) -> Iterator[tuple[Stretch, Stretch]]:
    return zip(contour, contour[1:] + contour[:1], strict=True)


def _arc(stretch: Stretch, curve: Geom_Curve | None, points: Floats) -> Arc:
    """A stretch's curve between its ends.

    Walls that end micrometres apart may pass each other when they are moved to the curve; what is
    between them is then straight, not the rest of the circle.
    """
    if curve is None:
        return Arc(stretch.chain, None, 0.0, 0.0)
    ends = points[stretch.chain[0]], points[stretch.chain[-1]]
    first, last = span(curve, *ends)
    length = np.linalg.norm(np.diff(points[stretch.chain], axis=0), axis=1).sum()
    if np.linalg.norm(point_at(curve, (first + last) / 2) - ends[0]) > length:
        return Arc([stretch.chain[0], stretch.chain[-1]], None, 0.0, 0.0)
    return Arc(stretch.chain, curve, first, last)


class _Corners:
    """Vertices made once each, and wires along them."""

    def __init__(self, points: Floats) -> None:
        self.points = points
        self.made: dict[int, TopoDS_Vertex] = {}
        self.builder = BRep_Builder()

    def wire(self, arcs: list[Arc], closed: bool) -> TopoDS_Wire | None:
        """A wire along arcs, each starting where the one before ends.

        A segment no longer than the tolerance is left out: its ends are one vertex. None where
        nothing is left.
        """
        wire = TopoDS_Wire()
        self.builder.MakeWire(wire)
        pieces = [piece for arc in arcs for piece in arc.pieces()]
        edges, start = 0, pieces[0][0]
        for number, (_, stop, arc) in enumerate(pieces, start=1):
            if arc is None and self._one(start, stop):
                if number < len(pieces):
                    continue
                break
            edge = self._line(start, stop) if arc is None else self._edge(start, stop, arc)
            self.builder.Add(wire, edge)
            edges += 1
            start = stop
        wire.Closed(closed)
        return wire if edges else None

    def _one(self, start: int, stop: int) -> bool:
        return bool(np.linalg.norm(self.points[stop] - self.points[start]) <= TOLERANCE)

    def _line(self, start: int, stop: int) -> TopoDS_Edge:
        return BRepBuilderAPI_MakeEdge(self._vertex(start), self._vertex(stop)).Edge()

    def _edge(self, start: int, stop: int, arc: Arc) -> TopoDS_Edge:
        edge = TopoDS_Edge()
        self.builder.MakeEdge(edge, arc.curve, TOLERANCE)
        self.builder.Add(edge, self._vertex(start))
        self.builder.Add(edge, self._vertex(stop).Oriented(TopAbs_REVERSED))
        self.builder.Range(edge, arc.first, arc.last)
        return edge

    def _vertex(self, index: int) -> TopoDS_Vertex:
        vertex = self.made.get(index)
        if vertex is None:
            vertex = self.made[index] = TopoDS_Vertex()
            self.builder.MakeVertex(vertex, gp_Pnt(*self.points[index].tolist()), TOLERANCE)
        return vertex
