"""Plane faces on shared vertices and edges: walls and convex polyhedra as B-rep.

Built with `BRep_Builder` on our own vertex and edge ids: quicker than sewing, and nothing is
joined or separated by a tolerance. Plane faces need no curves in their parameters.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

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
from v3dcad.model import Floats, Ints

FLAT = 1e-6
"""A polygon whose height is less than this times its width is taken to have no area."""


def wall_faces(walls: Facets, wanted: Ints) -> dict[int, TopoDS_Face]:
    """A plane face for each wanted wall (k,) that has an area, by its number."""
    corners = _Corners(walls.points, TOLERANCE + walls.slack)
    planes = _planes(walls.points, walls.corners, walls.starts)
    rings = np.split(walls.corners, walls.starts[1:-1])
    return {
        wall: corners.face(rings[wall].tolist(), plane)
        for wall in wanted.tolist()
        if (plane := planes[wall])
    }


def convex_solid(polyhedron: Polyhedron) -> TopoDS_Solid:
    """A convex polyhedron as a solid of one shell."""
    corners = _Corners(polyhedron.points, np.full(len(polyhedron.points), TOLERANCE))
    starts = np.cumsum([0, *map(len, polyhedron.faces)])
    planes = _planes(polyhedron.points, np.concatenate(polyhedron.faces), starts)
    rings = zip(polyhedron.faces, planes, strict=True)
    return solid_within(corners.face(ring, plane) for ring, plane in rings if plane)


def solid_within(faces: Iterable[TopoDS_Shape]) -> TopoDS_Solid:
    """The solid within faces that close around it, turned outward."""
    builder, solid, shell = BRep_Builder(), TopoDS_Solid(), shell_of(faces)
    shell.Closed(True)
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
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


class _Plane(NamedTuple):
    """Where a polygon lies."""

    middle: list[float]
    normal: list[float]
    off: float
    """mm: how far its corners may be off the plane"""


def _planes(points: Floats, corners: Ints, starts: Ints) -> list[_Plane | None]:
    """The planes of polygons, given as a `Facets`' walls are; None for those without an area."""
    polygon = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    ring = points[corners]
    middles = np.add.reduceat(ring, starts[:-1]) / np.diff(starts)[:, None]
    around = ring - middles[polygon]
    following = np.roll(around, -1, axis=0)
    following[starts[1:] - 1] = around[starts[:-1]]
    normals = np.add.reduceat(np.cross(around, following), starts[:-1])
    sizes = np.linalg.norm(normals, axis=1)
    extents = np.maximum.reduceat(ring, starts[:-1]) - np.minimum.reduceat(ring, starts[:-1])
    flat = ~(sizes > FLAT * extents.max(axis=1) ** 2)
    normals /= np.where(flat, 1.0, sizes)[:, None]
    # A welded corner lies a bit off the plane, and so do the edges at it.
    offs = np.maximum.reduceat(np.abs((around * normals[polygon]).sum(axis=1)), starts[:-1])
    rows = zip(middles.tolist(), normals.tolist(), (TOLERANCE + offs).tolist(), strict=True)
    return [None if none else _Plane(*row) for row, none in zip(rows, flat.tolist(), strict=True)]


class _Corners:
    """Vertices and edges made once each, and plane faces on them."""

    def __init__(self, points: Floats, tolerances: Floats) -> None:
        self.points, self.tolerances = points.tolist(), tolerances.tolist()
        self.builder = BRep_Builder()
        self.vertices: dict[int, TopoDS_Vertex] = {}
        self.edges: dict[tuple[int, int], TopoDS_Edge] = {}

    def face(self, ring: list[int], plane: _Plane) -> TopoDS_Face:
        """The face whose corners (point ids) run counter-clockwise on a plane."""
        wire, face = TopoDS_Wire(), TopoDS_Face()
        self.builder.MakeWire(wire)
        for start, stop in zip(ring, ring[1:] + ring[:1], strict=True):
            edge = self._edge(start, stop)
            self.builder.UpdateEdge(edge, plane.off)
            self.builder.UpdateVertex(self._vertex(start), plane.off)
            self.builder.Add(wire, edge)
        wire.Closed(True)
        frame = gp_Ax3(gp_Pnt(*plane.middle), gp_Dir(*plane.normal))
        self.builder.MakeFace(face, Geom_Plane(frame), TOLERANCE)
        self.builder.Add(face, wire)
        return face

    def _edge(self, start: int, stop: int) -> TopoDS_Edge:
        a, b = (start, stop) if start < stop else (stop, start)
        edge = self.edges.get((a, b))
        if edge is None:
            start_at, stop_at = self.points[a], self.points[b]
            along = gp_Dir(*(to - of for of, to in zip(start_at, stop_at, strict=True)))
            line = Geom_Line(gp_Pnt(*start_at), along)
            edge = self.edges[a, b] = TopoDS_Edge()
            self.builder.MakeEdge(edge, line, TOLERANCE)
            self.builder.Add(edge, self._vertex(a))
            self.builder.Add(edge, self._vertex(b).Oriented(TopAbs_REVERSED))
            self.builder.Range(edge, 0.0, math.dist(start_at, stop_at))
        return edge if start < stop else TopoDS.Edge_s(edge.Oriented(TopAbs_REVERSED))

    def _vertex(self, index: int) -> TopoDS_Vertex:
        vertex = self.vertices.get(index)
        if vertex is None:
            vertex = self.vertices[index] = TopoDS_Vertex()
            at = gp_Pnt(*self.points[index])
            self.builder.MakeVertex(vertex, at, self.tolerances[index])
        return vertex
