"""Areas of sections with their exact arcs, and volumes integrated from them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_VERTEX
from OCP.TopoDS import TopoDS, TopoDS_Shape

from tests.parts import ring_area
from v3dcad.geometry.critical import critical_points
from v3dcad.geometry.surface_mesh import SurfaceMesh, along_edge
from v3dcad.geometry.surfaces import surface_at
from v3dcad.kernel.shapes import FACE, bounds, subshapes
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
            _, _, z, slope = along_edge(mesh.heap, place, curve, mesh.edge_spans[edge], float(end))
            if abs(slope) < 1e-5:
                heights.append(z)
    for triangle, (u, v) in zip(*critical_points(mesh), strict=True):
        heights.append(surface_at(mesh.heap, mesh.surfaces[mesh.faces[triangle]], u, v)[0, 2])
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
