"""Writing STEP and BREP: named, coloured shapes, the same bytes for the same shapes."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.BRepTools import BRepTools
from OCP.IFSelect import IFSelect_RetDone
from OCP.Interface import Interface_Static
from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_ColorGen, XCAFDoc_DocumentTool

from v3dcad.errors import KernelError, SettingError

SCHEMAS = {"AP214": "AP214IS", "AP242": "AP242DIS"}

TEAL = (0.12, 0.44, 0.55)

Colour = tuple[float, float, float]
"""Red, green and blue, 0 … 1 (sRGB)."""


class Named(NamedTuple):
    """A shape with what a file says of it besides its geometry."""

    name: str
    shape: TopoDS_Shape
    colour: Colour | None = None


def write_step(
    shapes: Iterable[Named],
    path: Path,
    name: str,
    *,
    schema: str = "AP214",
    surfaces_only: bool = False,
) -> None:
    """Write named shapes as one STEP file of a schema (AP214 or AP242), mm.

    `surfaces_only` leaves out curves in the surfaces' parameters, which plane faces do not need.
    The same shapes make the same bytes. Raises `SettingError` for another schema, `KernelError`
    where OCCT cannot write.
    """
    check_schema(schema)
    writer = STEPCAFControl_Writer()
    Interface_Static.SetCVal_s("write.step.schema", SCHEMAS[schema])
    Interface_Static.SetCVal_s("write.step.product.name", name)
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0 if surfaces_only else 1)
    if not writer.Transfer(_document(shapes), STEPControl_AsIs):
        raise KernelError(f"{path}: OCCT cannot write these shapes as STEP")
    header = APIHeaderSection_MakeHeader(writer.ChangeWriter().Model())
    header.SetTimeStamp(TCollection_HAsciiString(timestamp()))
    header.SetName(TCollection_HAsciiString(name))
    if writer.Write(str(path)) != IFSelect_RetDone:
        raise KernelError(f"{path}: OCCT cannot write this file")
    path.write_bytes(_settled(path.read_bytes()))


def check_schema(schema: str) -> None:
    """Raise `SettingError` for a schema that is not written."""
    if schema not in SCHEMAS:
        raise SettingError("schema", f"schema {schema!r}: give {' or '.join(SCHEMAS)}")


def timestamp() -> str:
    """When a file says it was made: at the time of SOURCE_DATE_EPOCH, or in 1970."""
    epoch = int(os.environ.get("SOURCE_DATE_EPOCH", "0"))
    return time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(epoch))


STYLE = re.compile(
    rb"(PRESENTATION_REPRESENTATION\('',\(\s*#\d+\),)(#\d+)"
    rb"(\);\s*#\d+ = STYLED_ITEM\('color',\(#\d+\),)(#\d+)(?=\))"
)
"""A colour's entry in a file: after the first and the third group stand what it is given to."""


def _settled(text: bytes) -> bytes:
    """The file with its colours given in the order of the shapes.

    OCCT gives them in the order of addresses in memory, another one in each run.
    """
    found = sorted((pair[1::2] for pair in STYLE.findall(text)), key=lambda pair: int(pair[1][1:]))
    ordered = iter(found)

    def given(entry: re.Match[bytes]) -> bytes:
        context, item = next(ordered)
        return entry[1] + context + entry[3] + item

    return STYLE.sub(given, text)


def write_brep(shape: TopoDS_Shape, path: Path) -> None:
    """Write a shape as OCCT's own text format. Raises `KernelError` where OCCT cannot."""
    if not BRepTools.Write_s(shape, str(path)):
        raise KernelError(f"{path}: OCCT cannot write this shape as BREP")


def _document(shapes: Iterable[Named]) -> TDocStd_Document:
    """An XCAF document with one free shape for each of the shapes."""
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    XCAFApp_Application.GetApplication_s().InitDocument(document)
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    for title, shape, colour in shapes:
        label = tool.AddShape(shape, False)
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(title))
        if colour is not None:
            colours.SetColor(label, Quantity_Color(*colour, Quantity_TOC_sRGB), XCAFDoc_ColorGen)
    return document
