"""Projects for slicers: read back, and sliced by PrusaSlicer where it is installed."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
import trimesh

import v3dcad
from v3dcad.errors import SettingError
from v3dcad.formats.mesh.threemf_reader import read_threemf
from v3dcad.pipeline import Structure
from v3dcad.settings import PrintSettings

pytestmark = pytest.mark.filterwarnings("ignore:thickness .* they close up")

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


def test_the_same_structure_gives_the_same_bytes(structure: Structure, tmp_path: Path) -> None:
    files = [tmp_path / "one.3mf", tmp_path / "two.3mf"]
    for file in files:
        structure.write_3mf(file, "project", thickness=WALLS)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_sizes_of_another_form_are_refused(structure: Structure, tmp_path: Path) -> None:
    with pytest.raises(SettingError, match="project has no diameter"):
        structure.write_3mf(tmp_path / "box.3mf", "project", diameter=1)


def sliced(file: Path) -> tuple[float, dict[str, float]]:
    """What PrusaSlicer makes of a file: filament, and by feature (each mm of filament)."""
    slicer = shutil.which("prusa-slicer")
    if slicer is None:
        pytest.skip("prusa-slicer is not installed")
    gcode = file.with_suffix(".gcode")
    printing = PrintSettings()
    widths = ("", "perimeter-", "external-perimeter-", "infill-", "solid-infill-", "top-infill-")
    subprocess.run(
        [
            slicer, "--export-gcode", "--loglevel=0", f"--output={gcode}", "--skirts=0",
            f"--first-layer-height={printing.first_layer_height}", "--nozzle-diameter=0.4",
            "--retract-length=0", "--use-relative-e-distances",
            "--bed-shape=0x0,220x0,220x220,0x220",
            "--layer-gcode=G92 E0", "--first-layer-extrusion-width=0.45",
            *(f"--{name}extrusion-width={printing.bead_width}" for name in widths), file,
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
