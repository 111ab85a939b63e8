"""Sections as B-rep wires: lines, circles and ellipses exact, other runs as splines."""

from __future__ import annotations

from typing import Any

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.Geom import Geom_Circle, Geom_Ellipse, Geom_Line
from OCP.GeomAPI import GeomAPI_Interpolate
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Elips, gp_Pnt
from OCP.TColgp import TColgp_HArray1OfPnt
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Vertex, TopoDS_Wire

from v3dcad.kernel.shapes import location
from v3dcad.model import Floats, Placement, Run, Section

TOLERANCE = 1e-7
"""mm: OCCT's confusion. Vertices are given more where a run's end lies farther from its curve."""


def section_wires(section: Section, placement: Placement | None = None) -> list[TopoDS_Wire]:
    """One closed wire for each ring, the material on its left, where the source lies.

    Lines, circles and ellipses are exact. Other runs are cubic splines through the ring's points,
    which lie on the true surface; between them splines are about as close as the chords, or
    closer. A section without runs (of triangles) gives polygons.
    """
    wires = []
    runs: dict[int, list[Run]] = {}
    for run in section.runs:
        runs.setdefault(run.ring, []).append(run)
    for number, ring in enumerate(section.rings):
        lines = [Run(number, k, k + 1, "line", -1, ()) for k in range(len(ring))]
        wires.append(_wire(ring, section.z, runs.get(number, lines)))
    if placement is not None:
        motion = location(placement).Inverted()
        wires = [TopoDS.Wire_s(wire.Moved(motion)) for wire in wires]
    return wires


def _wire(ring: Floats, z: float, runs: list[Run]) -> TopoDS_Wire:
    builder = BRep_Builder()
    wire = TopoDS_Wire()
    builder.MakeWire(wire)
    vertices = []
    for run in runs:
        vertex = TopoDS_Vertex()
        builder.MakeVertex(vertex, gp_Pnt(*ring[run.start].tolist(), z), TOLERANCE)
        vertices.append(vertex)
    for k, run in enumerate(runs):
        points = ring[np.arange(run.start, run.stop + 1) % len(ring)]
        edge = _edge(builder, points, z, run, vertices[k], vertices[(k + 1) % len(runs)])
        builder.Add(wire, edge)
    wire.Closed(True)
    return wire


def _edge(
    builder: BRep_Builder,
    points: Floats,
    z: float,
    run: Run,
    first: TopoDS_Vertex,
    last: TopoDS_Vertex,
) -> TopoDS_Edge:
    curve, start, stop = _curve(points, z, run)
    edge = TopoDS_Edge()
    builder.MakeEdge(edge, curve, TOLERANCE)
    builder.Range(edge, start, stop)
    for vertex, point, parameter, way in (
        (first, points[0], start, TopAbs_FORWARD),
        (last, points[-1], stop, TopAbs_REVERSED),
    ):
        gap = gp_Pnt(*point.tolist(), z).Distance(curve.Value(parameter))
        if gap > TOLERANCE:
            builder.UpdateVertex(vertex, 1.01 * gap)
        builder.Add(edge, vertex.Oriented(way))
    return edge


def _curve(points: Floats, z: float, run: Run) -> tuple[Any, float, float]:
    """The curve of a run, and its parameters at the run's first and last point."""
    if run.curve in ("circle", "ellipse"):
        return _conic(points, z, run)
    if run.curve == "line" or len(points) == 2:
        way = points[-1] - points[0]
        line = Geom_Line(gp_Pnt(*points[0].tolist(), z), gp_Dir(*way.tolist(), 0.0))
        return line, 0.0, float(np.hypot(*way))
    closed = np.array_equal(points[0], points[-1])
    knots = _apart(points[:-1] if closed else points)
    if len(knots) == 2:
        return _curve(knots, z, run)
    array = TColgp_HArray1OfPnt(1, len(knots))
    for i, point in enumerate(knots.tolist(), start=1):
        array.SetValue(i, gp_Pnt(*point, z))
    interpolation = GeomAPI_Interpolate(array, closed, TOLERANCE)
    interpolation.Perform()
    spline = interpolation.Curve()
    return spline, spline.FirstParameter(), spline.LastParameter()


def _apart(points: Floats) -> Floats:
    """The points (k, 2) of a run but those that OCCT would take for the same as one before."""
    kept = [0]
    for place in range(1, len(points)):
        if np.hypot(*(points[place] - points[kept[-1]])) > 2 * TOLERANCE:
            kept.append(place)
    # The end stays where it is, even if what comes before it has to give way.
    kept[max(len(kept) - 1, 1) :] = [len(points) - 1]
    return points[kept]


def _conic(points: Floats, z: float, run: Run) -> tuple[Any, float, float]:
    centre = np.array(run.parameters[:2])
    if run.curve == "circle":
        major, ratio = np.array([run.parameters[2], 0.0]), 1.0
    else:
        major, ratio = np.array(run.parameters[2:4]), run.parameters[4]
    along = (points - centre) @ major
    across = (points - centre) @ np.array([-major[1], major[0]]) / ratio
    angle = np.unwrap(np.arctan2(across, along))
    side = 1.0 if angle[-1] > angle[0] else -1.0
    frame = gp_Ax2(gp_Pnt(*centre.tolist(), z), gp_Dir(0, 0, side), gp_Dir(*major.tolist(), 0.0))
    radius = float(np.hypot(*major))
    curve = (
        Geom_Circle(gp_Circ(frame, radius))
        if run.curve == "circle"
        else Geom_Ellipse(gp_Elips(frame, radius, radius * ratio))
    )
    return curve, side * float(angle[0]), side * float(angle[-1])
