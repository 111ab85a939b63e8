"""Small operations on OCCT shapes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Builder
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy, BRepBuilderAPI_Transform
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_Line, GeomAbs_Plane
from OCP.gp import gp_Trsf
from OCP.GProp import GProp_GProps
from OCP.ShapeFix import ShapeFix_Shape
from OCP.ShapeUpgrade import ShapeUpgrade_ShapeDivideAngle
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape

from v3dcad.model import Floats, Placement

SOLID, SHELL, FACE, EDGE = TopAbs_SOLID, TopAbs_SHELL, TopAbs_FACE, TopAbs_EDGE

TOLERANCE = 1e-7
"""OCCT's confusion, mm: points closer than this are one."""

ACCURACY = 1e-12
"""Relative error at which OCCT's adaptive integration may stop. Without one it takes a fixed Gauss
rule for each face, which is exact for polygons, and ten times quicker: but a fillet's volume comes
out 2e-6 wrong, a spline loft's 1 %. With 1e-9 it stops too early on surfaces of revolution
(4e-7)."""


def subshapes(shape: TopoDS_Shape, kind: Any, outside: Any = None) -> Iterator[TopoDS_Shape]:
    """Every subshape of a kind, once per occurrence; with `outside`, those in no such shape."""
    explorer = (
        TopExp_Explorer(shape, kind) if outside is None else TopExp_Explorer(shape, kind, outside)
    )
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def count(shape: TopoDS_Shape, kind: Any) -> int:
    """How many subshapes of a kind there are, each shared one counted once."""
    found = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, kind, found)
    return int(found.Extent())


def compound(shapes: Iterable[TopoDS_Shape]) -> TopoDS_Compound:
    """The shapes, as they are, in one compound."""
    builder = BRep_Builder()
    result = TopoDS_Compound()
    builder.MakeCompound(result)
    for shape in shapes:
        builder.Add(result, shape)
    return result


def bounds(shape: TopoDS_Shape) -> Floats:
    """(2, 3) least and greatest coordinates of a shape, mm, from its exact geometry."""
    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    gap = box.GetGap()
    return np.array(
        [
            [low.X() + gap, low.Y() + gap, low.Z() + gap],
            [high.X() - gap, high.Y() - gap, high.Z() - gap],
        ]
    )


def volume(shape: TopoDS_Shape) -> float:
    """Volume of a shape's solids, mm³."""
    return measured(shape)[0]


def measured(shape: TopoDS_Shape) -> tuple[float, Floats]:
    """Volume of a shape's solids, mm³, and its centre (3,), mm."""
    properties = GProp_GProps()
    accuracy = () if all(map(_is_polygon, subshapes(shape, FACE))) else (ACCURACY,)
    BRepGProp.VolumeProperties_s(shape, properties, *accuracy)
    return float(properties.Mass()), np.array(properties.CentreOfMass().Coord())


def area(shape: TopoDS_Shape) -> float:
    """Area of a shape's faces, mm²; faces that occur twice count twice."""
    polygons: list[TopoDS_Shape] = []
    others: list[TopoDS_Shape] = []
    properties = GProp_GProps()
    for face in subshapes(shape, FACE):
        (polygons if _is_polygon(face) else others).append(face)
    BRepGProp.SurfaceProperties_s(compound(polygons), properties)
    total = float(properties.Mass())
    BRepGProp.SurfaceProperties_s(compound(others), properties, ACCURACY)
    return total + float(properties.Mass())


def _is_polygon(face: TopoDS_Shape) -> bool:
    """Whether a face is plane and its edges are straight."""
    return BRepAdaptor_Surface(TopoDS.Face_s(face), False).GetType() == GeomAbs_Plane and all(
        BRepAdaptor_Curve(TopoDS.Edge_s(edge)).GetType() == GeomAbs_Line
        for edge in subshapes(face, EDGE)
    )


def quartered(shape: TopoDS_Shape) -> TopoDS_Shape:
    """A copy of a shape whose faces of revolution turn by no more than a quarter each."""
    divided = ShapeUpgrade_ShapeDivideAngle(math.pi / 2, shape)
    divided.SetPrecision(1e-7)
    divided.Perform()
    mended = ShapeFix_Shape(divided.Result())  # which OCCT leaves with faces turned inside out
    mended.Perform()
    return mended.Shape()


def own_copy(shape: TopoDS_Shape) -> TopoDS_Shape:
    """A copy of a shape on the same surfaces and curves, so that no flag of the caller's changes.

    Even to be put into a compound changes one: that a shape is free.
    """
    return BRepBuilderAPI_Copy(shape, False, False).Shape()


def scaled(shape: TopoDS_Shape, factor: float) -> TopoDS_Shape:
    """A copy of a shape that is larger by a factor, about the origin."""
    larger = gp_Trsf()
    larger.SetScaleFactor(factor)
    return BRepBuilderAPI_Transform(shape, larger, True).Shape()


def location(placement: Placement) -> TopLoc_Location:
    """A placement as OCCT's location."""
    motion = gp_Trsf()
    rows = np.column_stack([placement.rotation, placement.translation])
    motion.SetValues(*(float(value) for value in rows.ravel()))
    return TopLoc_Location(motion)


def placed_back(shape: TopoDS_Shape, placement: Placement) -> TopoDS_Shape:
    """A shape on the bed, moved back to where its source lies."""
    moved = shape.Moved(location(placement).Inverted())
    motion = moved.Location().Transformation()
    stays = all(
        abs(motion.Value(row, column) - (row == column)) < 1e-12
        for row in range(1, 4)
        for column in range(1, 5)
    )
    # Two motions that cancel out are none.
    return moved.Located(TopLoc_Location()) if stays else moved
