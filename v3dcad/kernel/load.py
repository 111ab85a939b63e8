"""Reading STEP and BREP files."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from OCP.BinTools import BinTools
from OCP.BRep import BRep_Builder
from OCP.BRepTools import BRepTools
from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPControl import STEPControl_Reader
from OCP.TopoDS import TopoDS_Shape

from v3dcad.errors import FormatError
from v3dcad.kernel.part import SolidPart, solid_part
from v3dcad.words import counted

TAIL = 4096
"""Bytes at the end of a STEP file in which its end marker must be."""


WORDS = ("name)", "description)")
"""How OCCT names parameters that hold nothing but words for people."""


def load_step(path: Path, factor: float = 1.0) -> SolidPart:
    """The solids of a STEP file, in mm whatever the file's unit, assemblies in place.

    They are made larger by `factor`, about the origin.

    Raises `FormatError` where the file is not STEP, is cut off or cannot be read, `KernelError`
    where it contains no closed solid.
    """
    with path.open("rb") as file:
        if not file.read(256).lstrip().startswith(b"ISO-10303-21"):
            raise FormatError(
                "not a STEP file (it does not begin with ISO-10303-21); export it again",
                path=str(path),
            )
        file.seek(max(path.stat().st_size - TAIL, 0))
        if b"END-ISO-10303-21" not in file.read():
            raise FormatError(
                "cut off: it does not end with END-ISO-10303-21; export it again", path=str(path)
            )
    reader = STEPControl_Reader()
    done = reader.ReadFile(str(path)) == IFSelect_RetDone
    reader.SetSystemLengthUnit(1.0)  # mm, whatever unit another library has set for the process
    if not done or not reader.TransferRoots():
        raise FormatError("OCCT cannot read this STEP file; export it again", path=str(path))
    part = solid_part(reader.OneShape(), path.stem, str(path), factor)
    unread = sum(map(_matters, _unread(reader.Model())))
    lost = (f"{counted(unread, 'entity')} of the file could not be read",) if unread else ()
    return replace(part, findings=(*lost, *part.findings))


def _unread(model: Any) -> Iterator[Any]:
    """What OCCT reports of each entity of a STEP model that it cannot read, or not all of."""
    for k in range(1, model.NbEntities() + 1):
        if model.IsUnknownEntity(k) or model.IsRedefinedContent(k):
            yield model.ReportEntity(k)


def _matters(report: Any) -> bool:
    """Whether what could not be read may belong to the shape: it is no colour, and not just a name.

    Several CAD programs write colours and names that OCCT's reader takes exception to.
    """
    check = report.Check()
    fails = [check.CFail(k) for k in range(1, check.NbFails() + 1)]
    only_words = bool(fails) and all(any(word in fail for word in WORDS) for fail in fails)
    return not (type(report.Concerned()).__name__.startswith("StepVisual_") or only_words)


def load_brep(path: Path, factor: float = 1.0) -> SolidPart:
    """The solids of a BREP file, text or binary, as `load_step` has them, and raises."""
    with path.open("rb") as file:
        head = file.read(512)
    shape = TopoDS_Shape()
    if b"Open CASCADE Topology" in head:
        BinTools.Read_s(shape, str(path))
    elif b"CASCADE Topology" in head or head.startswith(b"DBRep_DrawableShape"):
        BRepTools.Read_s(shape, str(path), BRep_Builder())
    if shape.IsNull():
        raise FormatError("OCCT cannot read this as BREP; export it again", path=str(path))
    return solid_part(shape, path.stem, str(path), factor)
