"""Areas of sections with their exact arcs, and volumes integrated from them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepGProp import BRepGProp, BRepGProp_Domain, BRepGProp_Face, BRepGProp_Vinert
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_REVERSED, TopAbs_VERTEX
from OCP.TopoDS import TopoDS, TopoDS_Shape

from tests.parts import ring_area
from v3dcad.geometry.surface.critical_points import critical_points
from v3dcad.geometry.surface.mesh import SurfaceMesh, along_edge
from v3dcad.geometry.surface.surfaces import surface_at
from v3dcad.kernel.shapes import EDGE, FACE, bounds, subshapes
from v3dcad.model import Floats, Section


def exact_area(section: Section) -> float:
    """Area of a section, mm², with the segments between chords and exact arcs added."""
    area = sum(map(ring_area, section.rings))
    for run in section.runs:
        if run.curve in ("circle", "ellipse"):
            ring = section.rings[run.ring]
            points = ring[np.arange(run.start, run.stop + 1) % len(ring)]
            centre = np.array(run.parameters[:2])
            if run.curve == "circle":
                major, ratio = np.array([run.parameters[2], 0.0]), 1.0
            else:
                major, ratio = np.array(run.parameters[2:4]), run.parameters[4]
            length = np.hypot(*major)
            along = (points - centre) @ major / length**2
            across = (points - centre) @ [-major[1], major[0]] / length**2 / ratio
            angle = np.diff(np.arctan2(across, along))
            angle = (angle + np.pi) % (2 * np.pi) - np.pi
            area += float(np.sum(angle - np.sin(angle)) / 2 * length**2 * ratio)
    return area


def breaks(shape: TopoDS_Shape, mesh: SurfaceMesh) -> Floats:
    """Heights between which the section's area is smooth: of vertices, turns of edges, ends of
    faces, and saddles.
    """
    heights = [
        BRep_Tool.Pnt_s(TopoDS.Vertex_s(vertex)).Z() for vertex in subshapes(shape, TopAbs_VERTEX)
    ]
    for face in subshapes(shape, FACE):
        heights += bounds(face)[:, 2].tolist()
    for edge in np.flatnonzero(mesh.edge_curves >= 0):
        place, curve = mesh.surfaces[mesh.edge_faces[edge]], mesh.edge_curves[edge]
        for end in (0, 1):
            _, _, z, slope = along_edge(
                mesh.coefficients, place, curve, mesh.edge_spans[edge], float(end)
            )
            if abs(slope) < 1e-5:
                heights.append(z)
    for triangle, (u, v) in zip(*critical_points(mesh), strict=True):
        heights.append(
            surface_at(mesh.coefficients, mesh.surfaces[mesh.faces[triangle]], u, v)[0][2]
        )
    ordered = np.unique(np.clip(heights, mesh.nodes[:, 2].min(), mesh.nodes[:, 2].max()))
    return ordered[np.diff(ordered, prepend=-np.inf) > 1e-6]


def integrated(heights: Floats, area: Callable[[Floats], Floats], order: int = 10) -> float:
    """∫ area dh: Gauss's rule between breaks, in an angle that takes away square-root ends."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    angle = (nodes + 1) * np.pi / 2
    low, high = heights[:-1, None], heights[1:, None]
    planes = low + (high - low) * (1 - np.cos(angle)) / 2
    widths = (high - low) * np.sin(angle) / 2 * weights * np.pi / 2
    return float(area(planes.ravel()) @ widths.ravel())


def volume(shape: TopoDS_Shape) -> float:
    """OCCT's volume of a shape, mm³."""
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties, 1e-9)
    return properties.Mass()


def face_volume(shape: TopoDS_Shape, apex: Floats) -> float:
    """OCCT's volume of the cones from a point (3,) over a shape's faces, mm³.

    That is the shape's volume wherever the point lies, if the faces close.
    """
    total = 0.0
    for face in map(TopoDS.Face_s, subshapes(shape, FACE)):
        cones = BRepGProp_Vinert()
        cones.SetLocation(gp_Pnt(*apex.tolist()))
        cones.Perform(BRepGProp_Face(face), BRepGProp_Domain(face), 1e-9)
        total += cones.Mass()
    return total


def closed_volume(shape: TopoDS_Shape, apex: Floats, pieces: int = 256) -> float:
    """`face_volume` with strips between each face's boundary and the edges' own curves."""
    total = face_volume(shape, apex)
    for face in map(TopoDS.Face_s, subshapes(shape, FACE)):
        surface = BRep_Tool.Surface_s(face)
        for edge in map(TopoDS.Edge_s, subshapes(face, EDGE)):
            if BRep_Tool.Degenerated_s(edge):
                continue
            ends = BRepAdaptor_Curve(edge)
            at = np.linspace(ends.FirstParameter(), ends.LastParameter(), pieces + 1)
            if edge.Orientation() == TopAbs_REVERSED:
                at = at[::-1]
            flat = BRep_Tool.CurveOnSurface_s(edge, face, 0.0, 0.0)
            own = BRep_Tool.Curve_s(edge, 0.0, 0.0)
            on_face = [surface.Value(*flat.Value(t).Coord()).Coord() for t in at.tolist()]
            inner = np.array(on_face) - apex
            outer = np.array([own.Value(t).Coord() for t in at.tolist()]) - apex
            for a, b, c in (
                (inner[1:], inner[:-1], outer[:-1]),
                (inner[1:], outer[:-1], outer[1:]),
            ):
                total += float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6
    return total
