"""Plane faces on shared vertices and edges: walls and convex polyhedra as B-rep.

Built with `BRep_Builder` on our own vertex and edge ids: quicker than sewing, and nothing is
joined or separated by a tolerance. Plane faces need no curves in their parameters.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.Geom import Geom_Line, Geom_Plane
from OCP.gp import gp_Ax3, gp_Dir, gp_Pnt
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopoDS import (
    TopoDS,
    TopoDS_Edge,
    TopoDS_Face,
    TopoDS_Shape,
    TopoDS_Shell,
    TopoDS_Solid,
    TopoDS_Vertex,
    TopoDS_Wire,
)
from OCP.TopTools import TopTools_IndexedMapOfShape
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from v3dcad.geometry.solid.convex_cells import Polyhedron
from v3dcad.geometry.solid.facets import Facets
from v3dcad.kernel.shapes import EDGE, TOLERANCE, subshapes
from v3dcad.model import Floats

FLAT = 1e-6
"""A polygon whose height is less than this times its width is taken to have no area."""


def wall_faces(walls: Facets) -> list[TopoDS_Face]:
    """One plane face for each wall that has an area."""
    corners = _Corners(walls.points, TOLERANCE + walls.slack)
    rings = np.split(walls.corners, walls.starts[1:-1])
    faces = (corners.face(ring.tolist()) for ring in rings if len(ring))
    return [face for face in faces if face is not None]


def convex_solid(polyhedron: Polyhedron) -> TopoDS_Solid:
    """A convex polyhedron as a solid of one shell."""
    corners = _Corners(polyhedron.points, np.full(len(polyhedron.points), TOLERANCE))
    builder, solid = BRep_Builder(), TopoDS_Solid()
    builder.MakeSolid(solid)
    builder.Add(solid, shell_of(face for face in map(corners.face, polyhedron.faces) if face))
    return solid


def shell_of(faces: Iterable[TopoDS_Shape]) -> TopoDS_Shell:
    """The faces in one shell, as they are."""
    builder, shell = BRep_Builder(), TopoDS_Shell()
    builder.MakeShell(shell)
    for face in faces:
        builder.Add(shell, face)
    return shell


def connected_shells(faces: list[TopoDS_Face]) -> list[TopoDS_Shell]:
    """One shell for each set of faces connected by shared edges."""
    known, rows, columns = TopTools_IndexedMapOfShape(), [], []
    for row, face in enumerate(faces):
        for edge in subshapes(face, EDGE):
            rows.append(row)
            columns.append(known.Add(edge) - 1)
    joined = coo_array((np.ones(len(rows)), (rows, columns)), (len(faces), known.Extent()))
    piece = connected_components(joined @ joined.T, directed=False)[1]
    return [
        shell_of(faces[row] for row in np.nonzero(piece == number)[0].tolist())
        for number in range(int(piece.max()) + 1)
    ]


class _Corners:
    """Vertices and edges made once each, and plane faces on them."""

    def __init__(self, points: Floats, tolerances: Floats) -> None:
        self.points, self.tolerances = points, tolerances
        self.builder = BRep_Builder()
        self.vertices: dict[int, TopoDS_Vertex] = {}
        self.edges: dict[tuple[int, int], TopoDS_Edge] = {}

    def face(self, ring: list[int]) -> TopoDS_Face | None:
        """The face whose corners (point ids) run counter-clockwise; None where it has no area."""
        corners = self.points[ring]
        middle = corners.mean(axis=0)
        normal = np.cross(corners - middle, np.roll(corners, -1, axis=0) - middle).sum(axis=0)
        size = float(np.linalg.norm(normal))
        if not size > FLAT * float(np.ptp(corners, axis=0).max()) ** 2:
            return None
        # A welded corner lies a bit off the plane, and so do the edges at it.
        off = TOLERANCE + float(np.abs((corners - middle) @ normal).max()) / size
        wire, face = TopoDS_Wire(), TopoDS_Face()
        self.builder.MakeWire(wire)
        for start, stop in zip(ring, ring[1:] + ring[:1], strict=True):
            edge = self._edge(start, stop)
            self.builder.UpdateEdge(edge, off)
            self.builder.UpdateVertex(self._vertex(start), off)
            self.builder.Add(wire, edge)
        wire.Closed(True)
        frame = gp_Ax3(gp_Pnt(*middle.tolist()), gp_Dir(*normal.tolist()))
        self.builder.MakeFace(face, Geom_Plane(frame), TOLERANCE)
        self.builder.Add(face, wire)
        return face

    def _edge(self, start: int, stop: int) -> TopoDS_Edge:
        a, b = (start, stop) if start < stop else (stop, start)
        edge = self.edges.get((a, b))
        if edge is None:
            along = self.points[b] - self.points[a]
            length = float(np.linalg.norm(along))
            line = Geom_Line(gp_Pnt(*self.points[a].tolist()), gp_Dir(*along.tolist()))
            edge = self.edges[a, b] = TopoDS_Edge()
            self.builder.MakeEdge(edge, line, TOLERANCE)
            self.builder.Add(edge, self._vertex(a))
            self.builder.Add(edge, self._vertex(b).Oriented(TopAbs_REVERSED))
            self.builder.Range(edge, 0.0, length)
        return edge if start < stop else TopoDS.Edge_s(edge.Oriented(TopAbs_REVERSED))

    def _vertex(self, index: int) -> TopoDS_Vertex:
        vertex = self.vertices.get(index)
        if vertex is None:
            vertex = self.vertices[index] = TopoDS_Vertex()
            at = gp_Pnt(*self.points[index].tolist())
            self.builder.MakeVertex(vertex, at, float(self.tolerances[index]))
        return vertex
