"""Faces without an inside, which OCCT's mesher leaves out: what lies around them is sewn."""

from __future__ import annotations

from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Shape

from v3dcad.errors import KernelError
from v3dcad.kernel.sewing import sewn
from v3dcad.kernel.shapes import EDGE, FACE, SOLID, compound, own_copy, subshapes
from v3dcad.words import counted

SAG, ANGLE = 0.1, 0.5
"""mm, radians: how coarse the mesh is that shows which faces have an inside."""


def without_slivers(shape: TopoDS_Shape, where: str, findings: list[str]) -> TopoDS_Shape:
    """A shape's solids without the faces that no triangle fits in, sewn where these were.

    Rounding in CAD leaves such faces: their edges lie on each other, within the tolerances stored
    with them, so that no sliver is wider than these. The shape itself where it has none, or where
    what is left of a solid does not close: then the face was no sliver.
    """
    meshed = own_copy(shape)
    BRepMesh_IncrementalMesh(meshed, SAG, False, ANGLE, False)
    solids: list[TopoDS_Shape] = []
    left_out = 0
    for solid in subshapes(meshed, SOLID):
        faces = list(subshapes(solid, FACE))
        slivers = [face for face in faces if _is_empty(face)]
        if not slivers:
            solids.append(solid)
            continue
        edges = (TopoDS.Edge_s(edge) for face in slivers for edge in subshapes(face, EDGE))
        gap = 2 * max(BRep_Tool.Tolerance_s(edge) for edge in edges)
        others = [face for face in faces if not _is_empty(face)]
        try:
            solids += sewn(compound(others), where, [], gap)
        except KernelError:
            return shape
        left_out += len(slivers)
    if not left_out:
        return shape
    findings.append(f"left out {counted(left_out, 'face')} without area, and sewed what is around")
    return compound(solids)


def _is_empty(face: TopoDS_Shape) -> bool:
    return BRep_Tool.Triangulation_s(TopoDS.Face_s(face), TopLoc_Location()) is None
