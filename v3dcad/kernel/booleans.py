"""OCCT's booleans, with checks that its `IsDone` does not make."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from OCP.BRepAlgoAPI import (
    BRepAlgoAPI_Common,
    BRepAlgoAPI_Cut,
    BRepAlgoAPI_Fuse,
    BRepAlgoAPI_Splitter,
)
from OCP.TopoDS import TopoDS_Shape
from OCP.TopTools import TopTools_ListOfShape

from v3dcad.errors import KernelError


def common(arguments: Iterable[TopoDS_Shape], tools: Iterable[TopoDS_Shape]) -> TopoDS_Shape:
    """The intersection of the arguments and the tools; may be empty."""
    return _done(BRepAlgoAPI_Common(), arguments, tools, "intersecting")


def cut(arguments: Iterable[TopoDS_Shape], tools: Iterable[TopoDS_Shape]) -> TopoDS_Shape:
    """The arguments without the tools."""
    return _done(BRepAlgoAPI_Cut(), arguments, tools, "cutting")


def fused(arguments: Iterable[TopoDS_Shape], tools: Iterable[TopoDS_Shape]) -> TopoDS_Shape:
    """The arguments and the tools in one."""
    return _done(BRepAlgoAPI_Fuse(), arguments, tools, "uniting")


def split(arguments: Iterable[TopoDS_Shape], tools: Iterable[TopoDS_Shape]) -> TopoDS_Shape:
    """The arguments in the pieces that the tools part them into."""
    return _done(BRepAlgoAPI_Splitter(), arguments, tools, "splitting")


def _done(
    boolean: Any, arguments: Iterable[TopoDS_Shape], tools: Iterable[TopoDS_Shape], what: str
) -> TopoDS_Shape:
    boolean.SetArguments(_list(arguments))
    boolean.SetTools(_list(tools))
    # The user's own part must not have its tolerances raised.
    boolean.SetNonDestructive(True)
    boolean.Build()
    if not boolean.IsDone() or boolean.Shape().IsNull():
        raise KernelError(f"OCCT failed at {what} shapes; change a site or the offset slightly")
    return boolean.Shape()


def _list(shapes: Iterable[TopoDS_Shape]) -> TopTools_ListOfShape:
    listed = TopTools_ListOfShape()
    for shape in shapes:
        listed.Append(shape)
    return listed
