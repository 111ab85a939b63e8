"""The mesh of B-rep solids whose nodes are shared by id: closed without any tolerance.

OCCT divides every edge once, for all faces beside it, and says which of a face's nodes are
points of which edge. A node is thus known as a vertex, as the i-th point of an edge, or as the
i-th inner point of a face; a mesh edge as the i-th stretch of an edge, or as a pair of nodes
inside one face. Nothing is compared by its coordinates.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Tool
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepClass import BRepClass_FaceClassifier
from OCP.BRepLib import BRepLib
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.gp import gp_Pnt2d
from OCP.TopAbs import (
    TopAbs_IN,
    TopAbs_REVERSED,
    TopAbs_VERTEX,
)
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape

from v3dcad.errors import KernelError
from v3dcad.geometry.mesh.section import pair_sides
from v3dcad.geometry.surface.critical_points import critical_points
from v3dcad.geometry.surface.curves import curve_points
from v3dcad.geometry.surface.gaps import MIN_GAP
from v3dcad.geometry.surface.mesh import SurfaceMesh
from v3dcad.geometry.surface.poles import with_meridians
from v3dcad.geometry.surface.refinement import refined
from v3dcad.geometry.surface.surfaces import surface_points
from v3dcad.kernel.flattening import Flattener
from v3dcad.kernel.shapes import EDGE, FACE, SOLID, own_copy, subshapes
from v3dcad.model import Floats, Ints, Mesh
from v3dcad.words import counted

DEFLECTION = 0.002
"""Sag of the first mesh as a share of the part's diagonal. It only has to be a sound triangulation
of every face: sections do not become more exact with a finer one."""

ANGLE = 0.5
"""Largest turn between two neighbours on the first mesh, radians."""

FINER = 2
"""How often a mesh that does not close is made again, with half the sag and half the angle."""


def surface_mesh(shape: TopoDS_Shape) -> SurfaceMesh:
    """The faces of a shape's solids as a mesh on their true surfaces, ready to be sectioned.

    Faces are numbered as they are met, solid by solid. `KernelError` where a face cannot be
    meshed, or where edges do not have a face on either side (an open shell).
    """
    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box, False)
    if box.IsVoid():
        raise KernelError("the part has no face to be sectioned")
    sag = DEFLECTION * box.CornerMin().Distance(box.CornerMax())
    mesh, faces = _meshed(shape, sag, ANGLE)
    triangles, parameters = critical_points(mesh)
    inside = [
        _is_inside(faces[mesh.faces[triangle]], u, v)
        for triangle, (u, v) in zip(triangles, parameters, strict=True)
    ]
    return refined(mesh, triangles[inside], parameters[inside])


def triangle_mesh(
    shape: TopoDS_Shape, sag: float, angle: float, faces: tuple[int, ...] | None = None
) -> Mesh:
    """The surface of a shape's solids as closed triangles, within `sag` (mm) of the true one.

    `angle` (radians) is the largest turn between neighbours; `faces` picks some by their numbers,
    as they are met, from 0. Raises as `surface_mesh` does.
    """
    mesh, _ = _meshed(shape, sag, angle)
    a, b, c = mesh.triangles.T
    kept = (a != b) & (b != c) & (c != a)
    if faces is not None:
        kept &= np.isin(mesh.faces, faces)
    return Mesh(mesh.nodes, mesh.triangles[kept])


def _meshed(
    shape: TopoDS_Shape, sag: float, angle: float, finer: int = FINER
) -> tuple[SurfaceMesh, list[TopoDS_Face]]:
    """A shape's mesh, and its faces by their numbers.

    Chords of two arcs that meet at a sharp tip may cross; OCCT then leaves the tip out. So a finer
    mesh is tried before a part is said to be open.
    """
    try:
        collector = _collected(shape, sag, angle)
        return collector.mesh(), collector.faces
    except KernelError:
        if not finer:
            raise
    return _meshed(shape, sag / 2, angle / 2, finer - 1)


def _collected(shape: TopoDS_Shape, sag: float, angle: float) -> _Collector:
    shape = own_copy(shape)  # the caller's keeps its own triangulation
    BRepLib.BuildCurves3d_s(shape)
    BRepMesh_IncrementalMesh(shape, sag, False, angle, False)
    collector = _Collector()
    for solid in subshapes(shape, SOLID):
        collector.add_solid(solid)
    return collector


def _is_inside(face: TopoDS_Face, u: float, v: float) -> bool:
    """Whether (u, v) lies inside a face and not on its boundary."""
    return bool(BRepClass_FaceClassifier(face, gp_Pnt2d(u, v), 1e-9).State() == TopAbs_IN)


class _Corners(NamedTuple):
    """The triangles of all faces, and their corners."""

    triangles: Ints
    """(t, 3) corner ids"""
    uv: Floats
    """(c, 2) parameters of each corner on its face"""
    faces: Ints
    """(t,) the face of each triangle"""
    nodes: Ints
    """(c,) node id of each corner"""


class _Collector:
    """Triangles of face after face. A "corner" is a node of one face's own triangulation.

    Numbers are gathered flat: thousands of small tuples would keep Python's garbage collector busy.
    """

    def __init__(self) -> None:
        self.flattener = Flattener()
        self.faces: list[TopoDS_Face] = []
        self.surfaces: list[int] = []
        self.gaps: list[float] = []
        self.triangles: list[Ints] = []
        self.corner_uv: list[float] = []
        self.corner_node: list[int] = []
        self.corner_face: list[int] = []
        self.poles: list[int] = []
        self.nodes: list[tuple[float, float, float]] = []
        self.stretches: list[tuple[int, float, float]] = []
        self.stretch_ends: list[tuple[int, int, int]] = []

    def add_solid(self, solid: TopoDS_Shape) -> None:
        vertices, edges = TopTools_IndexedMapOfShape(), TopTools_IndexedMapOfShape()
        TopExp.MapShapes_s(solid, TopAbs_VERTEX, vertices)
        TopExp.MapShapes_s(solid, EDGE, edges)
        self.vertices = vertices
        self.vertex_node = len(self.nodes) - 1
        for i in range(1, vertices.Extent() + 1):
            self.nodes.append(BRep_Tool.Pnt_s(TopoDS.Vertex_s(vertices.FindKey(i))).Coord())
        self.edges = edges
        self.divided: dict[int, tuple[int, int]] = {}
        for face in subshapes(solid, FACE):
            self._add_face(TopoDS.Face_s(face))

    def _add_face(self, face: TopoDS_Face) -> None:
        place = TopLoc_Location()
        facets = BRep_Tool.Triangulation_s(face, place)
        if facets is None:
            raise KernelError(
                f"face {len(self.faces) + 1} cannot be triangulated: "
                "heal the part where it was made"
            )
        first = len(self.corner_node) - 1
        count = facets.NbNodes()
        for i in range(1, count + 1):
            self.corner_uv += facets.UVNode(i).Coord()
        self.corner_node += [-1] * count
        self.corner_face += [len(self.faces)] * count
        tolerance = 0.0
        for edge in map(TopoDS.Edge_s, subshapes(face, EDGE)):
            tolerance = max(tolerance, BRep_Tool.Tolerance_s(edge))
            polygon = BRep_Tool.PolygonOnTriangulation_s(edge, facets, place)
            if polygon is not None:
                self._add_boundary(edge, polygon, first)
        corners: list[int] = []
        for i in range(1, facets.NbTriangles() + 1):
            corners += facets.Triangle(i).Get()
        triangles = np.array(corners, np.int64).reshape(-1, 3) + first
        if face.Orientation() == TopAbs_REVERSED:
            triangles = triangles[:, [0, 2, 1]]
        self.triangles.append(triangles)
        self.faces.append(face)
        self.gaps.append(tolerance if tolerance > MIN_GAP else 0.0)
        self.surfaces.append(self.flattener.surface(BRep_Tool.Surface_s(face)))

    def _add_boundary(self, edge: TopoDS_Edge, polygon: Any, first: int) -> None:
        """Give the corners along an edge the edge's nodes, and their sides its stretches."""
        count = polygon.NbNodes()
        corners = [first + polygon.Node(i) for i in range(1, count + 1)]
        ends = [
            self.vertex_node + self.vertices.FindIndex(vertex)
            for vertex in (TopExp.FirstVertex_s(edge), TopExp.LastVertex_s(edge))
        ]
        if BRep_Tool.Degenerated_s(edge):
            self.poles += corners
            for corner in corners:
                self.corner_node[corner] = ends[0]
            return
        node, stretch = self._divide(edge, polygon, count)
        inner = range(node, node + count - 2)
        for corner, number in zip(corners, [ends[0], *inner, ends[1]], strict=True):
            self.corner_node[corner] = number
        self.stretch_ends += [(corners[i], corners[i + 1], stretch + i) for i in range(count - 1)]

    def _divide(self, edge: TopoDS_Edge, polygon: Any, count: int) -> tuple[int, int]:
        """The first inner node and the first stretch of an edge, made when first met."""
        name = self.edges.FindIndex(edge)
        known = self.divided.get(name)
        if known is None:
            known = self.divided[name] = (len(self.nodes), len(self.stretches))
            curve = self.flattener.curve(BRep_Tool.Curve_s(edge, 0.0, 0.0))
            shares = [polygon.Parameter(i) for i in range(1, count + 1)]
            self.nodes += [(np.nan, curve, share) for share in shares[1:-1]]
            self.stretches += [(curve, start, stop) for start, stop in pairwise(shares)]
        return known

    def mesh(self) -> SurfaceMesh:
        coefficients = self.flattener.coefficients()
        surfaces = np.array(self.surfaces, np.int64)
        triangles = np.concatenate([np.empty((0, 3), np.int64), *self.triangles])
        uv = np.array(self.corner_uv).reshape(-1, 2)
        owner = np.repeat(np.arange(len(self.faces)), [len(found) for found in self.triangles])
        node_of = np.array(self.corner_node, np.int64)
        inner = np.flatnonzero(node_of < 0)
        node_of[inner] = len(self.nodes) + np.arange(len(inner))
        nodes = np.array(self.nodes + [(0.0, 0.0, 0.0)] * len(inner))
        on_edge = np.flatnonzero(np.isnan(nodes[:, 0]))
        curves = nodes[on_edge, 1].astype(np.int64)
        nodes[on_edge] = curve_points(coefficients, curves, nodes[on_edge, 2])
        beneath = surfaces[np.array(self.corner_face, np.int64)[inner]]
        nodes[node_of[inner]] = surface_points(coefficients, beneath, uv[inner])
        joined = self._joined(coefficients, nodes, _Corners(triangles, uv, owner, node_of))
        return with_meridians(joined, np.isin(triangles, self.poles))

    def _joined(self, coefficients: Floats, nodes: Floats, corners: _Corners) -> SurfaceMesh:
        """Pair the sides of the triangles into mesh edges."""
        triangles, uv, owner, node_of = corners
        tail, head = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
        name = np.minimum(tail, head) * len(uv) + np.maximum(tail, head)
        ends = np.array(self.stretch_ends, np.int64).reshape(-1, 3)
        end_name = np.minimum(ends[:, 0], ends[:, 1]) * len(uv) + np.maximum(ends[:, 0], ends[:, 1])
        order = np.argsort(end_name)
        at = np.minimum(np.searchsorted(end_name[order], name), len(ends) - 1)
        found = order[at]
        on_edge = end_name[found] == name
        stretch = np.where(on_edge, ends[found, 2], -1)
        backward = np.where(on_edge, ends[found, 0] != tail, tail > head)
        inner_names = np.unique(name)
        key = np.where(on_edge, stretch, len(self.stretches) + np.searchsorted(inner_names, name))
        kept = np.flatnonzero(node_of[tail] != node_of[head])
        forward, partner, unpaired = pair_sides(key[kept], backward[kept])
        if unpaired:
            raise KernelError(
                f"the part is not closed, with a face on one side only along "
                f"{counted(unpaired, 'stretch')} of edges; heal or sew it where it was made"
            )
        forward, partner = kept[forward], kept[partner]
        sides = np.full(len(tail), -1, np.int64)
        sides[forward] = sides[partner] = np.arange(len(forward))
        curve = np.array(self.stretches).reshape(-1, 3)
        lies = on_edge[forward]
        spans = np.column_stack([uv[tail[forward]], uv[head[forward]]])
        spans[lies] = 0.0
        spans[lies, :2] = curve[stretch[forward[lies]], 1:]
        curves = np.full(len(forward), -1, np.int64)
        curves[lies] = curve[stretch[forward[lies]], 0]
        return SurfaceMesh(
            coefficients=coefficients,
            surfaces=np.array(self.surfaces, np.int64),
            nodes=nodes,
            triangles=node_of[triangles],
            corners=uv[triangles],
            faces=owner,
            sides=sides.reshape(-1, 3),
            edge_nodes=np.column_stack([node_of[tail[forward]], node_of[head[forward]]]),
            edge_faces=owner[forward // 3],
            edge_curves=curves,
            edge_spans=spans,
            gaps=np.array(self.gaps),
        )
