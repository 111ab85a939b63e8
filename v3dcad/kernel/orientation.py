"""Solids as they are meant: faces outward, as their location has them, sewn of loose faces."""

from __future__ import annotations

from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeSolid,
    BRepBuilderAPI_Sewing,
    BRepBuilderAPI_Transform,
)
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Shape

from v3dcad.errors import KernelError
from v3dcad.kernel.shapes import FACE, SHELL, compound, subshapes

SEWING = 1e-4
"""mm: edges of loose faces that are nearer than this are sewn."""


def upright(solid: TopoDS_Shape, findings: list[str]) -> TopoDS_Shape:
    """A solid as its location places it, its faces outward: itself, where nothing is amiss.

    OCCT's geometry ignores that a location scales or mirrors, so that such a one is worked into it.
    """
    motion = solid.Location().Transformation()
    if motion.IsNegative() or abs(motion.ScaleFactor() - 1) > 1e-12:
        rest = solid.Located(TopLoc_Location())
        solid = BRepBuilderAPI_Transform(rest, motion, True).Shape()
    if _signed_volume(solid) >= 0:
        return solid
    findings.append("a solid was inside out: it was turned")
    return solid.Reversed()


def _signed_volume(solid: TopoDS_Shape) -> float:
    """Volume with a sign, mm³, by OCCT's fixed rule: quick, and right in the first digits."""
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, properties)
    return float(properties.Mass())


def sewn(shape: TopoDS_Shape, where: str, findings: list[str]) -> list[TopoDS_Shape]:
    """The solids that the faces of a shape without solids enclose.

    `KernelError`, naming `where`, where they enclose nothing.
    """
    faces = sum(1 for _ in subshapes(shape, FACE))
    if not faces:
        raise KernelError(f"{where}: contains no solid and no face; export a solid")
    sewing = BRepBuilderAPI_Sewing(SEWING)
    sewing.Add(shape)
    sewing.Perform()
    shells = list(subshapes(compound([sewing.SewedShape()]), SHELL))
    closed = [shell for shell in shells if BRep_Tool.IsClosed_s(shell)]
    if not closed:
        raise KernelError(
            f"{where}: contains no solid, only {faces} faces that enclose nothing: "
            f"{sewing.NbFreeEdges()} of their edges are open, even when sewn within {SEWING:g} mm; "
            "close the surface where it was made, and export a solid"
        )
    findings.append(f"sewed {faces} faces, which no solid had, to {len(closed)} solids")
    unsaid: list[str] = []
    return [
        upright(BRepBuilderAPI_MakeSolid(TopoDS.Shell_s(shell)).Solid(), unsaid) for shell in closed
    ]
