"""A triangle mesh as a B-rep with plane faces (thesis, section 3.1.1)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
)
from OCP.gp import gp_Ax3, gp_Dir, gp_Pln, gp_Pnt
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
from OCP.TopoDS import (
    TopoDS_Edge,
    TopoDS_Shape,
    TopoDS_Shell,
    TopoDS_Solid,
    TopoDS_Vertex,
    TopoDS_Wire,
)

from v3dcad.errors import GeometryError
from v3dcad.geometry.mesh.bodies import bodies_of, containers, signed_volumes
from v3dcad.kernel.part import SolidPart, solid_part
from v3dcad.kernel.shapes import FACE, TOLERANCE, compound, subshapes
from v3dcad.model import Floats, Ints, Mesh
from v3dcad.words import counted

MAX_TRIANGLES = 20_000
"""A B-rep of more plane faces than this is slow everywhere, without an advantage over the mesh."""


def solid_of_mesh(mesh: Mesh, name: str, findings: tuple[str, ...] = ()) -> SolidPart:
    """A closed mesh, wound outwards, as solids with plane faces; coplanar triangles are one face.

    Vertices and edges are shared by id, nothing is sewn by tolerance. `GeometryError` for more
    than `MAX_TRIANGLES` triangles, or an edge that more than two of them share.
    """
    count = len(mesh.triangles)
    if count > MAX_TRIANGLES:
        raise GeometryError(
            f"{name}: a mesh of {count:,} triangles is too large for a B-rep "
            f"(at most {MAX_TRIANGLES:,}): fill it as a mesh, or simplify it first"
        )
    body = bodies_of(mesh.triangles)
    volumes = signed_volumes(mesh.vertices, mesh.triangles, body)
    within = containers(mesh.vertices, mesh.triangles, body)
    shells = _Shells(mesh)
    solids: dict[int, TopoDS_Solid] = {}
    builder = BRep_Builder()
    # Outer shells first; a cavity then goes into the smallest of them that holds it.
    for number in np.argsort(volumes < 0, kind="stable").tolist():
        owner = number
        if volumes[number] < 0:
            around = np.flatnonzero(within[:, number] & (volumes > 0))
            owner = int(around[np.argmin(volumes[around])])
        elif number not in solids:
            solids[number] = TopoDS_Solid()
            builder.MakeSolid(solids[number])
        builder.Add(solids[owner], shells.shell(mesh.triangles[body == number]))
    whole = compound(solids.values())
    unifier = ShapeUpgrade_UnifySameDomain(whole, True, True, False)
    unifier.Build()
    part = solid_part(unifier.Shape(), name, name)
    faces = counted(sum(1 for _ in subshapes(part.shape, FACE)), "plane face")
    made = f"made a B-rep of {faces} of {counted(count, 'triangle')}"
    return replace(part, findings=(*findings, *part.findings, made))


class _Shells:
    """Vertices and edges made once each, and shells of plane triangles on them."""

    def __init__(self, mesh: Mesh) -> None:
        self.points = mesh.vertices
        self.vertices: dict[int, TopoDS_Vertex] = {}
        self.edges: dict[tuple[int, int], TopoDS_Edge] = {}
        self.uses: dict[tuple[int, int], int] = {}
        self.builder = BRep_Builder()

    def shell(self, triangles: Ints) -> TopoDS_Shape:
        shell = TopoDS_Shell()
        self.builder.MakeShell(shell)
        for triangle in triangles.tolist():
            self.builder.Add(shell, self._face(triangle))
        shell.Closed(True)
        return shell

    def _face(self, triangle: list[int]) -> TopoDS_Shape:
        wire = TopoDS_Wire()
        self.builder.MakeWire(wire)
        for start, stop in zip(triangle, triangle[1:] + triangle[:1], strict=True):
            self.builder.Add(wire, self._edge(start, stop))
        wire.Closed(True)
        return BRepBuilderAPI_MakeFace(self._plane(self.points[triangle]), wire).Face()

    def _plane(self, corners: Floats) -> gp_Pln:
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        along = corners[1] - corners[0]
        if not np.any(normal):
            x, y, z = corners[0]
            raise GeometryError(
                f"the triangle at ({x:.4g}, {y:.4g}, {z:.4g}) has no area: "
                "such a mesh can be filled, but not made into a B-rep"
            )
        frame = gp_Ax3(
            gp_Pnt(*corners[0].tolist()), gp_Dir(*normal.tolist()), gp_Dir(*along.tolist())
        )
        return gp_Pln(frame)

    def _edge(self, start: int, stop: int) -> TopoDS_Shape:
        name = (min(start, stop), max(start, stop))
        self.uses[name] = self.uses.get(name, 0) + 1
        if self.uses[name] > 2:
            x, y, z = self.points[start]
            raise GeometryError(
                f"more than two triangles share the edge at ({x:.4g}, {y:.4g}, {z:.4g}): "
                "such a mesh can be filled, but not made into a B-rep"
            )
        if name not in self.edges:
            ends = self._vertex(name[0]), self._vertex(name[1])
            self.edges[name] = BRepBuilderAPI_MakeEdge(*ends).Edge()
        edge = self.edges[name]
        return edge if start == name[0] else edge.Reversed()

    def _vertex(self, number: int) -> TopoDS_Vertex:
        if number not in self.vertices:
            vertex = self.vertices[number] = TopoDS_Vertex()
            self.builder.MakeVertex(vertex, gp_Pnt(*self.points[number].tolist()), TOLERANCE)
        return self.vertices[number]
