"""STEP and shapes as parts: assemblies, stray faces, healing, and what is no solid."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from OCP.BRep import BRep_Builder
from OCP.BRepTools import BRepTools
from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.Interface import Interface_Static
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shell, TopoDS_Solid
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_DocumentTool

import v3dcad
from tests.kernel import shapes
from tests.parts import ring_area
from v3dcad.kernel.part import solid_part
from v3dcad.kernel.shapes import FACE, compound, subshapes
from v3dcad.kernel.step import Named, write_step


def moved(shape, x: float, turns: float = 0.0):
    turn, shift = gp_Trsf(), gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), turns)
    shift.SetTranslation(gp_Vec(x, 0, 0))
    return shape.Moved(TopLoc_Location(shift.Multiplied(turn)))


def open_solid():
    """A box whose solid lacks a face."""
    builder, shell, solid = BRep_Builder(), TopoDS_Shell(), TopoDS_Solid()
    builder.MakeShell(shell)
    for face in list(subshapes(shapes.box((0, 0, 0), (1, 2, 3)), FACE))[1:]:
        builder.Add(shell, face)
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    return solid


def test_assemblies_are_flattened_with_their_placements(tmp_path: Path) -> None:
    box = shapes.box((0, 0, 0), (2, 1, 5))
    pair = compound([box, moved(box, 4, np.pi / 2)])
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    XCAFApp_Application.GetApplication_s().InitDocument(document)
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    tool.AddShape(compound([pair, moved(pair, 10)]), True)
    writer = STEPCAFControl_Writer()
    writer.Transfer(document, STEPControl_AsIs)
    writer.Write(str(tmp_path / "a.step"))
    text = (tmp_path / "a.step").read_text()
    assert text.count("MANIFOLD_SOLID_BREP(") == 1, "one solid, placed four times"
    part = v3dcad.part_from(tmp_path / "a.step")
    assert part.contents()["solids"] == "4"
    (section,) = part.sections(np.array([2.0]))
    corners = sorted(tuple(ring.min(axis=0).round(6)) for ring in section.rings)
    assert corners == [(0, 0), (3, 0), (10, 0), (13, 0)]
    assert [ring_area(ring) for ring in section.rings] == pytest.approx([2] * 4)


def test_stray_faces_are_told_and_left_out() -> None:
    sheet = next(subshapes(shapes.box((5, 5, 5), (9, 9, 9)), FACE))
    part = solid_part(compound([shapes.box((0, 0, 0), (1, 1, 1)), sheet]), "a", "a")
    assert part.findings == ("left out 1 face of no solid",)
    assert part.bounds == pytest.approx(np.array([[0, 0, 0], [1, 1, 1]]))


def inverted_face() -> TopoDS_Solid:
    """A box, 1 × 2 × 3 mm, of which one face is inside out."""
    builder, shell, solid = BRep_Builder(), TopoDS_Shell(), TopoDS_Solid()
    builder.MakeShell(shell)
    box = shapes.box((0, 0, 0), (1, 2, 3))
    for place, face in enumerate(subshapes(box, FACE)):
        builder.Add(shell, face.Reversed() if place == 2 else face)
    shell.Closed(True)
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    return solid


def test_faults_are_healed_and_told() -> None:
    part = solid_part(inverted_face(), "a", "a")
    assert part.findings == ("OCCT found faults in the shape and healed them",)
    (section,) = part.sections(np.array([1.0]))
    assert sum(map(ring_area, section.rings)) == pytest.approx(2)
    assert solid_part(shapes.box((0, 0, 0), (1, 2, 3)), "a", "a").findings == ()


@pytest.mark.parametrize(
    ("shape", "says"),
    [
        (
            next(subshapes(shapes.box((0, 0, 0), (1, 1, 1)), FACE)),
            "only 1 face without an inside, with 4 open edges",
        ),
        (compound([]), "contains no solid and no face"),
        (next(subshapes(open_solid(), FACE)), "without an inside"),
    ],
)
def test_what_is_no_solid_is_named(shape, says: str) -> None:
    with pytest.raises(v3dcad.KernelError, match=f"a file: .*{says}"):
        solid_part(shape, "a", "a file")


def test_an_open_shell_is_refused(tmp_path: Path) -> None:
    with pytest.raises(v3dcad.KernelError, match=r"a file: .*not closed, .* along 4 stretches"):
        solid_part(open_solid(), "a", "a file")
    write_step([Named("open", open_solid())], tmp_path / "open.step", "open")
    with pytest.raises(v3dcad.KernelError, match=r"open\.step: "):
        v3dcad.part_from(tmp_path / "open.step")


@pytest.mark.parametrize("share", [0.05, 0.3, 0.7, 0.99])
def test_a_cut_off_file_is_refused(share: float, samples: Path, tmp_path: Path) -> None:
    data = (samples / "bracket.step").read_bytes()
    (tmp_path / "cut.step").write_bytes(data[: int(share * len(data))])
    with pytest.raises(v3dcad.FormatError, match=r"cut\.step: cut off"):
        v3dcad.part_from(tmp_path / "cut.step")


def without(word: bytes, path: Path, samples: Path) -> Path:
    """The bracket with one entity, in the midst of the file, of a kind that nobody knows."""
    data = (samples / "bracket.step").read_bytes()
    middle = data.index(word, len(data) // 2)
    path.write_bytes(data[:middle] + b"X" + data[middle + 1 :])
    return path


@pytest.mark.parametrize("word", [b"CARTESIAN_POINT", b"VECTOR", b"DIRECTION"])
def test_what_cannot_be_read_of_a_file_is_told(word: bytes, samples: Path, tmp_path: Path) -> None:
    part = v3dcad.part_from(without(word, tmp_path / "a.step", samples))
    assert part.findings[0] == "1 entity of the file could not be read"


@pytest.mark.parametrize(
    ("sample", "before", "after"),
    [
        ("islands", b"ITEM_DEFINED_TRANSFORMATION('','',", b"ITEM_DEFINED_TRANSFORMATION($,$,"),
        ("bracket", b"ENDSEC;\nEND-ISO", b"#9999 = CURVE_STYLE('',$,$,$);\nENDSEC;\nEND-ISO"),
    ],
)
def test_colours_and_names_are_not_missed(
    sample: str, before: bytes, after: bytes, samples: Path, tmp_path: Path
) -> None:
    """CAD programs write some that OCCT does not read: no note for what no print shows."""
    data = (samples / f"{sample}.step").read_bytes()
    assert before in data
    (tmp_path / "a.step").write_bytes(data.replace(before, after))
    part = v3dcad.part_from(tmp_path / "a.step")
    assert part.findings == ()
    np.testing.assert_array_equal(part.bounds, v3dcad.part_from(samples / f"{sample}.step").bounds)


@pytest.mark.parametrize(
    ("word", "says"),
    [
        (b"ADVANCED_FACE", "only 14 faces without an inside"),
        (b"EDGE_CURVE", "the part is not closed"),
    ],
)
def test_a_hole_in_a_solid_is_refused(
    word: bytes, says: str, samples: Path, tmp_path: Path
) -> None:
    with pytest.raises(v3dcad.KernelError, match=rf"a\.step: .*{says}"):
        v3dcad.part_from(without(word, tmp_path / "a.step", samples))


@pytest.mark.parametrize("unit", ["M", "INCH"])
def test_another_librarys_unit_changes_nothing(unit: str, samples: Path) -> None:
    expected = v3dcad.part_from(samples / "bracket.step").bounds
    before = Interface_Static.CVal_s("xstep.cascade.unit")
    Interface_Static.SetCVal_s("xstep.cascade.unit", unit)
    try:
        found = v3dcad.part_from(samples / "bracket.step").bounds
    finally:
        Interface_Static.SetCVal_s("xstep.cascade.unit", before)
    assert np.array_equal(found, expected)


def written(shape) -> str:
    """All that a shape is: geometry, tolerances, triangles, flags."""
    stream = BytesIO()
    BRepTools.Write_s(shape, stream)
    return stream.getvalue().decode()


@pytest.mark.parametrize(
    "make",
    [
        inverted_face,
        lambda: compound(list(subshapes(shapes.box((0, 0, 0), (1, 2, 3)), FACE))),
        lambda: shapes.box((0, 0, 0), (1, 2, 3)).Reversed(),
        lambda: shapes.cylinder(2.0, 5.0),
    ],
)
def test_the_callers_own_shape_stays_as_it_is(make) -> None:
    shape = make()
    before = written(shape)
    structure = v3dcad.fill(shape, cell_size=1.0, layer_height=0.5)
    structure.faces()  # booleans
    structure.part.mesh()
    assert written(shape) == before
