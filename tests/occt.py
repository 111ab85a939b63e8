"""What OCCT itself says of a shape: the tests' yardstick."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from OCP.Bnd import Bnd_Box
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepGProp import BRepGProp
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_LabelSequence
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SOLID
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape
from OCP.XCAFDoc import XCAFDoc_DocumentTool

from v3dcad.model import Floats


def is_valid(shape: TopoDS_Shape) -> bool:
    return bool(BRepCheck_Analyzer(shape).IsValid())


def _mass(shape: TopoDS_Shape, measure: Any) -> float:
    properties = GProp_GProps()
    measure(shape, properties)
    return float(properties.Mass())


def length_of(shape: TopoDS_Shape) -> float:
    return sum(_mass(edge, BRepGProp.LinearProperties_s) for edge in edges_of(shape))


def area_of(shape: TopoDS_Shape) -> float:
    return _mass(shape, lambda *given: BRepGProp.SurfaceProperties_s(*given, 1e-13))


def volume_of(shape: TopoDS_Shape) -> float:
    return _mass(shape, lambda *given: BRepGProp.VolumeProperties_s(*given, 1e-13))


def distinct(shape: TopoDS_Shape, kind: Any) -> list[TopoDS_Shape]:
    found = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(shape, kind, found)
    return [found(i + 1) for i in range(found.Extent())]


def occurrences(shape: TopoDS_Shape, kind: Any) -> int:
    explorer, count = TopExp_Explorer(shape, kind), 0
    while explorer.More():
        count += 1
        explorer.Next()
    return count


def edges_of(shape: TopoDS_Shape) -> list[Any]:
    return [TopoDS.Edge_s(edge) for edge in distinct(shape, TopAbs_EDGE)]


def faces_of(shape: TopoDS_Shape) -> list[Any]:
    return [TopoDS.Face_s(face) for face in distinct(shape, TopAbs_FACE)]


def solids_of(shape: TopoDS_Shape) -> list[Any]:
    return [TopoDS.Solid_s(solid) for solid in distinct(shape, TopAbs_SOLID)]


def box_of(shape: TopoDS_Shape) -> Floats:
    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    return np.array([[low.X(), low.Y(), low.Z()], [high.X(), high.Y(), high.Z()]])


def distance_to(point: Floats, shape: TopoDS_Shape) -> float:
    """How far a point (3,) lies from the nearest face, mm."""
    vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*point.tolist())).Vertex()
    return min(BRepExtrema_DistShapeShape(vertex, face).Value() for face in faces_of(shape))


def read_step(path: Path) -> dict[str, TopoDS_Shape]:
    """The named shapes of a STEP file."""
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    reader.ReadFile(str(path))
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    assert reader.Transfer(document)
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    labels = TDF_LabelSequence()
    tool.GetFreeShapes(labels)
    shapes = {}
    for place in range(1, labels.Length() + 1):
        name = TDataStd_Name()
        assert labels.Value(place).FindAttribute(TDataStd_Name.GetID_s(), name)
        shapes[name.Get().ToExtString()] = tool.GetShape_s(labels.Value(place))
    return shapes
