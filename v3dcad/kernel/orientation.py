"""Solids as they are meant: faces outward, as their location has them."""

from __future__ import annotations

from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape


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
