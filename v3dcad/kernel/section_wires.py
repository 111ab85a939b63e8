"""Sections as B-rep wires: lines, circles and ellipses exact, other runs as splines."""

from __future__ import annotations

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.Geom import Geom_Curve, Geom_Line
from OCP.gp import gp_Dir, gp_Pnt
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Vertex, TopoDS_Wire

from v3dcad.kernel.curves import run_curve, span
from v3dcad.kernel.shapes import TOLERANCE, location
from v3dcad.model import CurveRun, Floats, Placement, Section


def section_wires(section: Section, placement: Placement | None = None) -> list[TopoDS_Wire]:
    """One closed wire for each ring, the material on its left, where the source lies.

    Lines, circles and ellipses are exact. Other runs are cubic splines through the ring's points,
    which lie on the true surface; between them splines are about as close as the chords, or
    closer. A section without runs (of triangles) gives polygons.
    """
    wires = []
    runs: dict[int, list[CurveRun]] = {}
    for run in section.runs:
        runs.setdefault(run.ring, []).append(run)
    for number, ring in enumerate(section.rings):
        lines = [CurveRun(number, k, k + 1, "line", -1, ()) for k in range(len(ring))]
        wires.append(_wire(ring, section, runs.get(number, lines)))
    if placement is not None:
        motion = location(placement).Inverted()
        wires = [TopoDS.Wire_s(wire.Moved(motion)) for wire in wires]
    return wires


def _wire(ring: Floats, section: Section, runs: list[CurveRun]) -> TopoDS_Wire:
    builder = BRep_Builder()
    wire = TopoDS_Wire()
    builder.MakeWire(wire)
    vertices = []
    for run in runs:
        vertex = TopoDS_Vertex()
        builder.MakeVertex(vertex, gp_Pnt(*ring[run.start].tolist(), section.z), TOLERANCE)
        vertices.append(vertex)
    for k, run in enumerate(runs):
        points = ring[np.arange(run.start, run.stop + 1) % len(ring)]
        edge = _edge(builder, points, section, run, vertices[k], vertices[(k + 1) % len(runs)])
        builder.Add(wire, edge)
    wire.Closed(True)
    return wire


def _edge(
    builder: BRep_Builder,
    points: Floats,
    section: Section,
    run: CurveRun,
    first: TopoDS_Vertex,
    last: TopoDS_Vertex,
) -> TopoDS_Edge:
    curve, start, stop = _curve(points, section, run)
    edge = TopoDS_Edge()
    builder.MakeEdge(edge, curve, TOLERANCE)
    builder.Range(edge, start, stop)
    for vertex, point, parameter, way in (
        (first, points[0], start, TopAbs_FORWARD),
        (last, points[-1], stop, TopAbs_REVERSED),
    ):
        distance = gp_Pnt(*point.tolist(), section.z).Distance(curve.Value(parameter))
        if distance > TOLERANCE:
            builder.UpdateVertex(vertex, 1.01 * distance)
        builder.Add(edge, vertex.Oriented(way))
    return edge


def _curve(points: Floats, section: Section, run: CurveRun) -> tuple[Geom_Curve, float, float]:
    """The curve of a run, and its parameters at the run's first and last point."""
    curve = run_curve(run, section)
    if curve is None:
        way = points[-1] - points[0]
        line = Geom_Line(gp_Pnt(*points[0].tolist(), section.z), gp_Dir(*way.tolist(), 0.0))
        return line, 0.0, float(np.hypot(*way))
    if run.curve == "points":
        return curve, curve.FirstParameter(), curve.LastParameter()
    ends = np.column_stack([points[[0, -1]], [section.z, section.z]])
    return curve, *span(curve, ends[0], ends[1])
