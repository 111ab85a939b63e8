"""`VoronoiFill` as build123d's own objects behave."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
import trimesh
from build123d import (
    Box,
    BuildPart,
    BuildSketch,
    Color,
    Compound,
    Location,
    Locations,
    Mode,
    Part,
    Plane,
    Pos,
    Rectangle,
    Shell,
    Solid,
    export_step,
    extrude,
    import_step,
)
from OCP.TopoDS import TopoDS_Shape

import v3dcad
from v3dcad.adapters.build123d import VoronoiFill
from v3dcad.errors import SettingError, V3dcadError

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore:.* narrower than a .*, and filled solid"),
]

SETTINGS = {"cell_size": 8.0, "layer_height": 1.0}


def test_lies_where_its_source_lies_and_keeps_label_and_colour() -> None:
    block = Pos(10, 20, 30) * Box(30, 30, 20)
    block.label, block.color = "block", Color("red")
    filled = VoronoiFill(block, "solid", thickness=1, **SETTINGS)
    assert filled.label == "block"
    assert tuple(filled.color) == tuple(block.color)
    assert tuple(filled.bounding_box().min) == pytest.approx((-5, 5, 20), abs=1e-6)
    assert tuple(filled.bounding_box().max) == pytest.approx((25, 35, 40), abs=1e-6)
    cells = VoronoiFill(block, "cells", **SETTINGS)
    assert len(cells.solids()) == len(cells.structure.cells())
    assert cells.volume == pytest.approx(block.volume, rel=1e-8)
    rest = block - cells
    assert rest.volume == pytest.approx(0, abs=1e-4)


def test_a_builder_is_filled() -> None:
    with BuildPart() as built:
        Box(20, 20, 10)
        VoronoiFill(thickness=0.8, **SETTINGS)
    alone = VoronoiFill(Box(20, 20, 10), thickness=0.8, **SETTINGS)
    assert built.part.volume == pytest.approx(alone.volume, rel=1e-9)


def test_locations_and_mode_are_respected() -> None:
    cube = Box(20, 20, 20)
    with BuildPart() as block:
        Box(100, 100, 21)
        with Locations((-30, 0, 0), (30, 0, 0)):
            VoronoiFill(cube, "cells", mode=Mode.SUBTRACT, **SETTINGS)
    assert block.part.volume == pytest.approx(100 * 100 * 21 - 2 * 20**3, rel=1e-9)
    with BuildPart() as untouched:
        Box(10, 10, 10)
        VoronoiFill(cube, "cells", mode=Mode.PRIVATE, **SETTINGS)
    assert untouched.part.volume == pytest.approx(1000)


def test_an_operation_ignores_locations_and_works_on_what_is_built() -> None:
    alone = VoronoiFill(Box(10, 10, 6), thickness=0.5, skin=1, **SETTINGS)
    with BuildPart() as block, Locations((20, 0, 0)):
        Box(10, 10, 6)
        VoronoiFill(thickness=0.5, skin=1, **SETTINGS)
    assert tuple(block.part.bounding_box().min) == pytest.approx((15, -5, -3), abs=1e-6)
    assert block.part.volume == pytest.approx(alone.volume, rel=1e-6)
    with BuildPart(Plane.XZ.offset(7)) as turned:
        Box(10, 10, 6)
        VoronoiFill(thickness=0.5, skin=1, **SETTINGS)
    assert tuple(turned.part.bounding_box().min) == pytest.approx((-5, -10, -5), abs=1e-6)


def test_what_is_no_solid_cannot_replace_what_is_built() -> None:
    with BuildPart() as block:
        Box(10, 10, 6)
        for form in ("faces", "wires"):
            with pytest.raises(SettingError, match=f"form '{form}': a builder's part is made of"):
                VoronoiFill(form=form, **SETTINGS)
        walls = VoronoiFill(form="faces", mode=Mode.PRIVATE, **SETTINGS)
    assert len(walls.faces()) > 1
    assert block.part.volume == pytest.approx(600)


def box() -> Box:
    return Box(10, 10, 10)


def built() -> BuildPart:
    with BuildPart() as block:
        Box(10, 10, 10)
    return block


def extruded() -> Part:
    with BuildSketch() as outline:
        Rectangle(10, 10)
    return extrude(outline.sketch, 10)


@pytest.mark.parametrize(
    "source",
    [
        box,
        built,
        extruded,
        lambda: box().solids(),
        lambda: box().shells()[0],
        lambda: box().faces(),
        lambda: [box().wrapped],
        lambda: Compound([Box(10, 10, 5), Pos(0, 0, 5) * Box(10, 10, 5)]),
        lambda: (Box(10, 10, 5), Pos(0, 0, 5) * Box(10, 10, 5)),
        lambda: trimesh.creation.box((10, 10, 10)),
        lambda: trimesh.Scene([trimesh.creation.box((10, 10, 10))]),
    ],
)
def test_whatever_holds_a_solid_is_a_part(source) -> None:
    assert v3dcad.part_from(source()).contents()["volume"] == "1000 mm³"


@pytest.mark.parametrize(
    ("source", "says"),
    [
        (BuildPart, "BuildPart has built nothing yet"),
        (Part, "this Part holds no shape"),
        (lambda: Rectangle(1, 2), "no solid, only 1 face without an inside"),
        (lambda: Shell(box().faces()[:5]), "only 5 faces without an inside"),
        (lambda: [box(), 3], "int cannot be filled: give a path, a solid, a list of solids"),
        (lambda: Location((1, 2, 3)), "Location cannot be filled"),
        (lambda: trimesh.PointCloud([(1, 2, 3)]), "PointCloud cannot be filled"),
        (list, "no solid"),
    ],
)
def test_whatever_holds_none_is_told(source, says: str) -> None:
    with pytest.raises(V3dcadError, match=says):
        v3dcad.part_from(source())


def test_shapes_come_back_as_the_sources_library_has_them(tmp_path: Path) -> None:
    part = Box(20, 20, 10)
    structure = v3dcad.fill(part, **SETTINGS)
    walls = structure.solid(1.0)
    rest = part - walls
    assert rest.volume == pytest.approx(4000 - walls.volume, rel=1e-6)
    struts = structure.struts(1.0, fuse=True)
    assert (part - struts).volume == pytest.approx(4000 - (part & struts).volume, rel=1e-6)
    assert export_step(walls, tmp_path / "a.step")
    assert import_step(tmp_path / "a.step").volume == pytest.approx(walls.volume, rel=1e-6)
    assert all(isinstance(cell, Solid) for cell in structure.cells())
    assert all(isinstance(form, Compound) for form in (structure.wires(), structure.faces()))
    bare = v3dcad.fill(part.wrapped, **SETTINGS)
    assert isinstance(bare.solid(1.0), TopoDS_Shape)
    structure.write_step(tmp_path / "a.step", "cells")
    bare.write_step(tmp_path / "b.step", "cells")
    assert (tmp_path / "a.step").read_bytes() == (tmp_path / "b.step").read_bytes()


def test_mistakes_are_named() -> None:
    with pytest.raises(SettingError, match="needs a part"):
        VoronoiFill()
    with pytest.raises(SettingError, match="solid needs a thickness"):
        VoronoiFill(Box(9, 9, 9))
    with pytest.raises(SettingError, match="form 'foam'"):
        VoronoiFill(Box(9, 9, 9), "foam")


@pytest.mark.parametrize(
    ("library", "line"),
    [("build123d", "pip install 'v3dcad[build123d]'"), ("cadquery", "'v3dcad[cadquery]'")],
)
def test_a_missing_library_is_named_with_the_pip_line(library: str, line: str) -> None:
    code = (
        f"import sys; sys.modules[{library!r}] = None\n"
        f"try:\n    import v3dcad.adapters.{library}\n"
        "except ImportError as error: print(error)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, encoding="utf-8", check=True
    )
    assert line in done.stdout
