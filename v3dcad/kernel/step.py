"""Writing STEP: named shapes in one document, the same bytes for the same shapes."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable
from pathlib import Path

from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.IFSelect import IFSelect_RetDone
from OCP.Interface import Interface_Static
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_DocumentTool

from v3dcad.errors import KernelError


def write_step(shapes: Iterable[tuple[str, TopoDS_Shape]], path: Path, name: str) -> None:
    """Write named shapes as one STEP file (AP214, mm).

    The header carries the time of SOURCE_DATE_EPOCH, or 1970, so that the same shapes make the
    same bytes. Raises `KernelError` where OCCT cannot write.
    """
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    XCAFApp_Application.GetApplication_s().InitDocument(document)
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    for title, shape in shapes:
        label = tool.AddShape(shape, False)
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(title))
    writer = STEPCAFControl_Writer()
    Interface_Static.SetCVal_s("write.step.schema", "AP214IS")
    Interface_Static.SetCVal_s("write.step.product.name", name)
    if not writer.Transfer(document, STEPControl_AsIs):
        raise KernelError(f"{path}: OCCT cannot write these shapes as STEP")
    header = APIHeaderSection_MakeHeader(writer.ChangeWriter().Model())
    epoch = int(os.environ.get("SOURCE_DATE_EPOCH", "0"))
    stamp = time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(epoch))
    header.SetTimeStamp(TCollection_HAsciiString(stamp))
    header.SetName(TCollection_HAsciiString(name))
    if writer.Write(str(path)) != IFSelect_RetDone:
        raise KernelError(f"{path}: OCCT cannot write this file")
