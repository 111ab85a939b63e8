"""Faces without area, as CAD leaves them by rounding: parts are read as if they were not there."""

from __future__ import annotations

import numpy as np
import pytest
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeVertex,
    BRepBuilderAPI_MakeWire,
)
from OCP.Geom import Geom_Plane
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
from OCP.TopoDS import (
    TopoDS_Edge,
    TopoDS_Face,
    TopoDS_Shape,
    TopoDS_Shell,
    TopoDS_Solid,
    TopoDS_Wire,
)

import v3dcad
from v3dcad.kernel.part import solid_part
from v3dcad.kernel.shapes import volume

SIDES = ["000 010 110 100", "001 101 111 011", "000 100 101 001"]
SIDES += ["010 011 111 110", "000 001 011 010", "100 110 111 101"]


def block(*, sliver: bool) -> TopoDS_Shape:
    """A cube of 10 mm; its front upper edge is two, on each other, with a face between them."""
    corners = {
        name: BRepBuilderAPI_MakeVertex(gp_Pnt(*(10.0 * int(c) for c in name))).Vertex()
        for name in " ".join(SIDES).split()
    }
    builder, shell, solid = BRep_Builder(), TopoDS_Shell(), TopoDS_Solid()
    builder.MakeShell(shell)
    edges: dict[frozenset[str], TopoDS_Edge] = {}
    front = frozenset(["001", "101"])
    again = BRepBuilderAPI_MakeEdge(corners["001"], corners["101"]).Edge()
    for number, side in enumerate(SIDES):
        wire = BRepBuilderAPI_MakeWire()
        names = side.split()
        for ends in zip(names, names[1:] + names[:1], strict=True):
            key = frozenset(ends)
            if key not in edges:
                edges[key] = BRepBuilderAPI_MakeEdge(*(corners[end] for end in ends)).Edge()
            wire.Add(again if sliver and key == front and number == 1 else edges[key])
        builder.Add(shell, BRepBuilderAPI_MakeFace(wire.Wire(), True).Face())
    if sliver:
        between, face = TopoDS_Wire(), TopoDS_Face()
        builder.MakeWire(between)
        builder.Add(between, edges[front])
        builder.Add(between, again.Reversed())
        builder.MakeFace(face, Geom_Plane(gp_Pln(gp_Pnt(0, 0, 10), gp_Dir(0, 0, 1))), 1e-7)
        builder.Add(face, between)
        builder.Add(shell, face)
    shell.Closed(True)
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    return solid


def test_a_face_without_area_is_left_out() -> None:
    plain = solid_part(block(sliver=False), "a", "a file")
    part = solid_part(block(sliver=True), "a", "a file")
    assert part.contents()["faces"] == "6"
    assert volume(part.shape) == pytest.approx(1000)
    np.testing.assert_allclose(part.bounds, plain.bounds, atol=1e-6)
    assert "left out 1 face without area, and sewed what is around" in part.findings
    assert v3dcad.fill(part, cell_size=4, layer_height=1).properties().volume > 0


def test_a_face_that_the_part_needs_is_not_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where OCCT does not mesh a face of some size, the part is refused, and the face is named."""
    solid = block(sliver=False)
    for room in ("mesh", "slivers"):
        monkeypatch.setattr(f"v3dcad.kernel.{room}.BRepMesh_IncrementalMesh", lambda *_: None)
    with pytest.raises(v3dcad.KernelError, match="a file: face 1 cannot be triangulated"):
        solid_part(solid, "a", "a file")
