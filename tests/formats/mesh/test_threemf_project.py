"""Projects for slicers: read back, and sliced by PrusaSlicer where it is installed."""

from __future__ import annotations

import re
import shutil
import subprocess
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import lib3mf
import pytest
import trimesh

import v3dcad
from v3dcad.errors import SettingError
from v3dcad.formats.mesh.threemf_reader import read_threemf
from v3dcad.pipeline import Structure
from v3dcad.settings import PrintSettings

pytestmark = pytest.mark.filterwarnings("ignore:.* cells are narrower than a thickness")

SIZE = (24.0, 20.0, 6.0)
WALLS = 0.8
"""mm: two beads of 0.45 as they lie side by side."""


@pytest.fixture(scope="module")
def structure() -> Structure:
    box = trimesh.creation.box(SIZE)
    return v3dcad.fill((box.vertices, box.faces), cell_size=6.0)


def test_the_part_comes_back_without_its_foam(structure: Structure, tmp_path: Path) -> None:
    file = tmp_path / "box.3mf"
    structure.write_3mf(file, "project", thickness=WALLS)
    mesh, told = read_threemf(file)
    assert trimesh.Trimesh(mesh.vertices, mesh.triangles).volume == pytest.approx(24 * 20 * 6)
    assert told == ["left out 1 modifier"]
    # In the middle of the bed of 220 × 220 mm, on it.
    assert mesh.vertices.min(axis=0) == pytest.approx([98, 100, 0])


def volumes(file: Path) -> dict[int, float]:
    """Volumes of the meshes in a file by their numbers, mm³, as lib3mf reads them."""
    model = lib3mf.get_wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromFile(str(file))
    found, meshes = {}, model.GetMeshObjects()
    while meshes.MoveNext():
        mesh = meshes.GetCurrentMeshObject()
        corners = [tuple(vertex.Coordinates) for vertex in mesh.GetVertices()]
        faces = [tuple(triangle.Indices) for triangle in mesh.GetTriangleIndices()]
        solid = trimesh.Trimesh(corners, faces, process=False)
        found[mesh.GetUniqueResourceID()] = float(solid.volume)
    return found


def test_both_models_hold_part_and_foam(structure: Structure, tmp_path: Path) -> None:
    """As PrusaSlicer has them, in one mesh, and as OrcaSlicer has them, each in one of its own."""
    file, other = tmp_path / "box.3mf", tmp_path / "parts.3mf"
    structure.write_3mf(file, "project", thickness=WALLS)
    with zipfile.ZipFile(file) as both, zipfile.ZipFile(other, "w") as parts:
        for name in ("[Content_Types].xml", "_rels/.rels"):
            parts.writestr(name, both.read(name))
        parts.writestr("3D/3dmodel.model", both.read("OrcaSlicer/3dmodel.xml"))
    part, foam = volumes(other).values()
    assert part == pytest.approx(24 * 20 * 6)
    assert 0 < foam < part
    assert sum(volumes(file).values()) == pytest.approx(part + foam)


def relations(package: zipfile.ZipFile) -> list[tuple[str, str]]:
    """Types and targets of the package's relations, in their order."""
    rows = ElementTree.fromstring(package.read("_rels/.rels"))
    return [(row.attrib["Type"], row.attrib["Target"]) for row in rows]


def test_prusaslicer_of_any_version_comes_across_one_model(
    structure: Structure, tmp_path: Path
) -> None:
    """Up to 2.7.1 it reads each `.model` in the folder 3D, from 2.7.2 on each `.model` there is;
    from 2.8 on it takes for the root what a relation of the standard's own type names.
    """
    file = tmp_path / "box.3mf"
    structure.write_3mf(file, "project", thickness=WALLS)
    with zipfile.ZipFile(file) as package:
        names, named = package.namelist(), relations(package)
    assert [name for name in names if name.lower().endswith(".model")] == ["3D/3dmodel.model"]
    standard = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    assert [target for kind, target in named if kind == standard] == ["/3D/3dmodel.model"]


def test_orcaslicer_is_told_of_the_parts_that_its_model_has(
    structure: Structure, tmp_path: Path
) -> None:
    """By its source (bbs_3mf.cpp) it takes the first relation whose type begins and ends as
    these, finds parts by number, and keeps what it is told of a file that PrusaSlicer did not
    write; it asks the model in the folder 3D who did.
    """
    file = tmp_path / "box.3mf"
    structure.write_3mf(file, "project", thickness=WALLS)
    begins, ends = "http://schemas.microsoft.com/3dmanufacturing/", "3dmodel"
    with zipfile.ZipFile(file) as package:
        read = [
            target
            for kind, target in relations(package)
            if kind.startswith(begins) and kind.endswith(ends)
        ]
        folder, _, root = read[0].removeprefix("/").rpartition("/")
        assert f"{folder}/_rels/{root}.rels" not in package.namelist()
        model = ElementTree.fromstring(package.read(f"{folder}/{root}"))
        told = ElementTree.fromstring(package.read("Metadata/model_settings.config"))
        assert b"PrusaSlicer" not in package.read("3D/3dmodel.model")
    core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    (whole,) = told
    (item,) = model.iter(f"{core}item")
    components = [row.attrib["objectid"] for row in model.iter(f"{core}component")]
    parts = {part.attrib["id"]: part for part in whole.iter("part")}
    assert item.attrib["objectid"] == whole.attrib["id"]
    assert list(parts) == components
    assert [part.attrib["subtype"] for part in parts.values()] == ["normal_part", "modifier_part"]
    printing = PrintSettings()
    below, above = printing.solid_layers()
    assert settings(whole) == {
        "name": structure.part.name,
        "layer_height": f"{structure.settings.layer_height:g}",
        "wall_loops": str(printing.perimeters),
        "bottom_shell_layers": str(below),
        "top_shell_layers": str(above),
        "sparse_infill_density": "0%",
        "wall_generator": "arachne",
    }
    assert settings(parts[components[1]]) == {
        "name": "foam",
        "sparse_infill_density": "100%",
        "sparse_infill_pattern": "concentric",
        "sparse_infill_line_width": f"{printing.bead_width:g}",
        "internal_solid_infill_pattern": "concentric",
        "internal_solid_infill_line_width": f"{printing.bead_width:g}",
        "minimum_sparse_infill_area": "0",
    }


def settings(told: ElementTree.Element) -> dict[str, str]:
    """What an object or a part is told itself, by names that OrcaSlicer's PrintConfig.cpp has."""
    return {row.attrib["key"]: row.attrib["value"] for row in told.findall("metadata")}


def test_the_same_structure_gives_the_same_bytes(structure: Structure, tmp_path: Path) -> None:
    files = [tmp_path / "one.3mf", tmp_path / "two.3mf"]
    for file in files:
        structure.write_3mf(file, "project", thickness=WALLS)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_sizes_of_another_form_are_refused(structure: Structure, tmp_path: Path) -> None:
    with pytest.raises(SettingError, match="project has no diameter"):
        structure.write_3mf(tmp_path / "box.3mf", "project", diameter=1)


def sliced(
    file: Path, infill_width: float = PrintSettings().bead_width
) -> tuple[float, dict[str, float]]:
    """What PrusaSlicer makes of a file: filament, and by feature (each mm of filament)."""
    slicer = shutil.which("prusa-slicer")
    if slicer is None:
        pytest.skip("prusa-slicer is not installed")
    gcode = file.with_suffix(".gcode")
    printing = PrintSettings()
    widths = ("", "perimeter-", "external-perimeter-", "solid-infill-", "top-infill-")
    subprocess.run(
        [
            slicer, "--export-gcode", "--loglevel=0", f"--output={gcode}", "--skirts=0",
            f"--first-layer-height={printing.first_layer_height}", "--nozzle-diameter=0.4",
            "--retract-length=0", "--use-relative-e-distances",
            "--bed-shape=0x0,220x0,220x220,0x220",
            "--layer-gcode=G92 E0", "--first-layer-extrusion-width=0.45",
            *(f"--{name}extrusion-width={printing.bead_width}" for name in widths),
            f"--infill-extrusion-width={infill_width}", file,
        ],
        check=True, capture_output=True,
    )  # fmt: skip
    found: dict[str, float] = {}
    feature = ""
    for line in gcode.read_text().splitlines():
        if line.startswith(";TYPE:"):
            feature = line[6:]
        elif extruded := re.match(r"G1 X.* E([\d.]+)", line):
            found[feature] = found.get(feature, 0.0) + float(extruded[1])
    return sum(found.values()), found


@pytest.mark.slow
def test_prusaslicer_prints_as_much_as_we_do(structure: Structure, tmp_path: Path) -> None:
    project = tmp_path / "box.3mf"
    structure.write_3mf(project, "project", thickness=WALLS)
    printing = PrintSettings(skirt_loops=0, brim_width=0.0, prime_line=0.0)
    ours = structure.write_gcode(tmp_path / "ours.gcode", printing).totals.filament_mm
    theirs, features = sliced(project)
    assert theirs == pytest.approx(ours, rel=0.05)
    assert features["Internal infill"] > 0.1 * theirs


@pytest.mark.slow
def test_one_bead_a_wall_is_half_of_two(structure: Structure, tmp_path: Path) -> None:
    taken = []
    for walls in (0.45, WALLS):
        project = tmp_path / f"{walls}.3mf"
        structure.write_3mf(project, "project", thickness=walls)
        taken.append(sliced(project)[1]["Internal infill"])
    assert taken[0] / taken[1] == pytest.approx(0.45 / WALLS, rel=0.15)


@pytest.mark.slow
def test_walls_of_one_bead_are_printed_whatever_infill_the_profile_has(
    structure: Structure, tmp_path: Path
) -> None:
    """A wider infill left out a part of them: 0.6 mm wide, two thirds."""
    project = tmp_path / "box.3mf"
    structure.write_3mf(project, "project", thickness=0.45)
    narrow, wide = (sliced(project, width)[1]["Internal infill"] for width in (0.45, 0.6))
    assert wide == pytest.approx(narrow, rel=0.01)
