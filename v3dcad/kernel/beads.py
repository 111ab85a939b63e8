"""Beads as B-rep: what a printer lays along the lines of a layer, edge by edge."""

from __future__ import annotations

import numpy as np
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeWire,
)
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism, BRepPrimAPI_MakeRevol
from OCP.GC import GC_MakeArcOfCircle
from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Quaternion, gp_Trsf, gp_Vec
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from v3dcad.arguments import above_zero
from v3dcad.errors import SettingError
from v3dcad.kernel.shapes import TOLERANCE, compound, location
from v3dcad.model import Layer, Placement

PROFILES = ("rectangle", "rounded")


def layer_beads(
    layer: Layer, placement: Placement, width: float, height: float, profile: str = "rounded",
    base: float = 0.0,
) -> TopoDS_Compound:  # fmt: skip
    """One compound of a layer's beads, where the source lies.

    The profile is swept along every edge, and turned about every vertex, so that beads end round
    and overlap where they meet. It stands `base` over the layer's height: a rectangle `width` by
    `height`, mm, or, `rounded`, one whose sides are half circles. Raises `SettingError` for a size
    of 0, another profile, or a rounded one that is higher than wide.
    """
    above_zero("width", width)
    above_zero("height", height)
    if profile not in PROFILES:
        raise SettingError("profile", f"profile {profile!r}: give {' or '.join(PROFILES)}")
    if profile == "rounded" and height > width:
        raise SettingError(
            "width", f"a rounded bead {width:g} mm wide cannot be {height:g} mm high; widen it"
        )
    left, right = _profile(width, height, profile, -1.0), _profile(width, height, profile, 0.0)
    joint = BRepPrimAPI_MakeRevol(right, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape()
    diagram, z = layer.diagram, layer.z + base
    ends = diagram.vertices[diagram.edges[diagram.lengths() > TOLERANCE]]
    made: list[TopoDS_Shape] = []
    for (x, y), (to_x, to_y) in ends.tolist():
        along = gp_Vec(to_x - x, to_y - y, 0)
        turned = gp_Trsf()
        turned.SetRotation(gp_Quaternion(gp_Vec(0, 1, 0), along))
        made.append(BRepPrimAPI_MakePrism(left.Moved(_to(x, y, z, turned)), along).Shape())
    for x, y in diagram.vertices[np.unique(diagram.edges)].tolist():
        made.append(joint.Moved(_to(x, y, z, gp_Trsf())))
    return TopoDS.Compound_s(compound(made).Moved(location(placement).Inverted()))


def _profile(width: float, height: float, profile: str, left: float) -> TopoDS_Face:
    """The profile in the plane y = 0 on z = 0: from x = 0 (left = 0) or both halves (left = −1)."""
    side = width / 2 - (height / 2 if profile == "rounded" else 0.0)
    low, high = gp_Pnt(side, 0, 0), gp_Pnt(side, 0, height)
    far_low, far_high = gp_Pnt(left * side, 0, 0), gp_Pnt(left * side, 0, height)
    edges = BRepBuilderAPI_MakeWire()
    if side > 0:
        edges.Add(BRepBuilderAPI_MakeEdge(far_low, low).Edge())
    edges.Add(_flank(low, high, width / 2, profile))
    if side > 0:
        edges.Add(BRepBuilderAPI_MakeEdge(high, far_high).Edge())
    if left:
        edges.Add(_flank(far_high, far_low, -width / 2, profile))
    else:
        edges.Add(BRepBuilderAPI_MakeEdge(far_high, far_low).Edge())
    return BRepBuilderAPI_MakeFace(edges.Wire()).Face()


def _flank(start: gp_Pnt, stop: gp_Pnt, reach: float, profile: str) -> TopoDS_Edge:
    """One side of a profile: straight, or a half circle out to x = reach."""
    if profile == "rectangle":
        return BRepBuilderAPI_MakeEdge(start, stop).Edge()
    middle = gp_Pnt(reach, 0, (start.Z() + stop.Z()) / 2)
    return BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(start, middle, stop).Value()).Edge()


def _to(x: float, y: float, z: float, turned: gp_Trsf) -> TopLoc_Location:
    shift = gp_Trsf()
    shift.SetTranslation(gp_Vec(x, y, z))
    return TopLoc_Location(shift.Multiplied(turned))
