"""Shapes to section, made with OCCT."""

from __future__ import annotations

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeWire,
)
from OCP.BRepOffsetAPI import BRepOffsetAPI_ThruSections
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeSphere,
    BRepPrimAPI_MakeTorus,
)
from OCP.GC import GC_MakeArcOfCircle
from OCP.GeomAPI import GeomAPI_Interpolate
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Vec
from OCP.STEPControl import STEPControl_Reader
from OCP.TColgp import TColgp_HArray1OfPnt
from OCP.TopoDS import TopoDS_Shape

from tests.parts import part_file
from v3dcad.kernel.shapes import SOLID, compound, subshapes

UP = (0.0, 0.0, 1.0)
NIST = ["ctc_01_asme1_rd", "ctc_02_asme1_rc", "ctc_03_asme1_rc", "ftc_06_asme1_rd"]
NIST += ["ftc_07_asme1_rd", "ftc_08_asme1_rc", "ftc_11_asme1_rb"]


def axis(at=(0.0, 0.0, 0.0), along=UP) -> gp_Ax2:
    return gp_Ax2(gp_Pnt(*at), gp_Dir(*along))


def box(low, high) -> TopoDS_Shape:
    return BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape()


def cylinder(radius, height, at=(0.0, 0.0, 0.0), along=UP) -> TopoDS_Shape:
    return BRepPrimAPI_MakeCylinder(axis(at, along), radius, height).Shape()


def cone(low, high, height, at=(0.0, 0.0, 0.0), along=UP) -> TopoDS_Shape:
    return BRepPrimAPI_MakeCone(axis(at, along), low, high, height).Shape()


def sphere(radius, at=(0.0, 0.0, 0.0), along=UP) -> TopoDS_Shape:
    return BRepPrimAPI_MakeSphere(axis(at, along), radius).Shape()


def torus(major, minor, at=(0.0, 0.0, 0.0), along=UP) -> TopoDS_Shape:
    return BRepPrimAPI_MakeTorus(axis(at, along), major, minor).Shape()


def fuse(one, other) -> TopoDS_Shape:
    return BRepAlgoAPI_Fuse(one, other).Shape()


def cut(one, other) -> TopoDS_Shape:
    return BRepAlgoAPI_Cut(one, other).Shape()


def common(one, other) -> TopoDS_Shape:
    return BRepAlgoAPI_Common(one, other).Shape()


def loft() -> TopoDS_Shape:
    """A loft through four waving, turned rings: spline surfaces."""
    sections = BRepOffsetAPI_ThruSections(True, False)
    for z, more, phase in ((0, 0, 0), (12, 4, 0.8), (24, -3, 1.7), (40, 2, 2.5)):
        array = TColgp_HArray1OfPnt(1, 16)
        for i, t in enumerate(np.arange(16) * np.pi / 8, start=1):
            r = 15 + 4 * np.sin(3 * t + phase) + more
            array.SetValue(i, gp_Pnt(r * np.cos(t), r * np.sin(t), z))
        spline = GeomAPI_Interpolate(array, True, 1e-6)
        spline.Perform()
        edge = BRepBuilderAPI_MakeEdge(spline.Curve()).Edge()
        sections.AddWire(BRepBuilderAPI_MakeWire(edge).Wire())
    return sections.Shape()


def horn() -> TopoDS_Shape:
    """A prism 60 mm high; two arcs of its outline meet at a tip of 0.02 rad, where chords cross."""

    def on_arc(turned: float, along: float) -> gp_Pnt:
        """A point of an arc of 1 mm about (0, 1, 0), turned about the tip, which is the origin."""
        x, y = np.sin(along), 1 - np.cos(along)
        c, s = np.cos(turned), np.sin(turned)
        return gp_Pnt(c * x - s * y, s * x + c * y, 0)

    def arc(turned: float, length: float) -> TopoDS_Shape:
        points = [on_arc(turned, share * length) for share in (0, 0.5, 1)]
        return BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(*points).Value()).Edge()

    corner = gp_Pnt(5, 5, 0)
    outline = BRepBuilderAPI_MakeWire(
        arc(0.0, 1.0), BRepBuilderAPI_MakeEdge(on_arc(0.0, 1.0), corner).Edge()
    )
    outline.Add(BRepBuilderAPI_MakeEdge(corner, on_arc(0.02, 0.6)).Edge())
    outline.Add(arc(0.02, 0.6))
    face = BRepBuilderAPI_MakeFace(outline.Wire(), True).Face()
    return BRepPrimAPI_MakePrism(face, gp_Vec(0, 0, 60)).Shape()


def nist(name: str) -> TopoDS_Shape:
    """The solids of a NIST test part."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(part_file(f"nist_{name}.stp")))
    reader.TransferRoots()
    return compound(subshapes(reader.OneShape(), SOLID))
