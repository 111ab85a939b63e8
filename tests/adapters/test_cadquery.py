"""`Workplane.voronoiFill` on the stack, in assemblies, on solids from sketches."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hosts import cadquery_or_skip
from PIL import Image

cadquery = cadquery_or_skip()

import v3dcad.adapters.cadquery  # noqa: E402

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore:.* narrower than a .*, and filled solid"),
]

SETTINGS = {"cell_size": 8.0, "layer_height": 1.0}


def test_every_solid_on_the_stack_is_filled_where_it_lies() -> None:
    two = cadquery.Workplane().rarray(40, 1, 2, 1).box(20, 20, 20, combine=False)
    filled = two.voronoiFill(thickness=1, **SETTINGS)
    assert [value.BoundingBox().center.x for value in filled.vals()] == pytest.approx([-20, 20])
    assert all(0 < value.Volume() < 8000 for value in filled.vals())


def test_cells_of_a_sketched_solid_in_an_assembly() -> None:
    sketch = cadquery.Sketch().rect(30, 20).vertices().fillet(3)
    solid = cadquery.Workplane().placeSketch(sketch).extrude(15)
    cells = solid.voronoiFill("cells", **SETTINGS)
    assert cells.size() == len(v3dcad.fill(solid, **SETTINGS).cells()) > 9
    whole = solid.val().Volume()
    assert sum(cell.Volume() for cell in cells.vals()) == pytest.approx(whole, rel=1e-8)
    assembly = cadquery.Assembly().add(cells, name="cells")
    assert assembly.toCompound().Volume() == pytest.approx(whole, rel=1e-8)


def test_what_was_selected_stands_for_the_solid_that_it_is_of() -> None:
    block = cadquery.Workplane().box(20, 20, 10)
    for selected in (block.faces(">Z").workplane(), block.edges("|Z"), block.faces(">Z")):
        cells = selected.voronoiFill("cells", **SETTINGS)
        assert sum(cell.Volume() for cell in cells.vals()) == pytest.approx(4000, rel=1e-8)
        assert v3dcad.part_from(selected).contents()["volume"] == "4000 mm³"
    with pytest.raises(v3dcad.GeometryError, match="Sketch holds no shape"):
        v3dcad.part_from(cadquery.Sketch().rect(1, 2))
    with pytest.raises(v3dcad.GeometryError, match="Workplane holds nothing to fill"):
        cadquery.Workplane().voronoiFill("cells", **SETTINGS)
    with pytest.raises(v3dcad.KernelError, match="no solid"):
        v3dcad.part_from(cadquery.Workplane())


def test_shapes_come_back_as_cadquerys_own() -> None:
    block = cadquery.Workplane().box(20, 20, 10)
    structure = v3dcad.fill(block, **SETTINGS)
    assert all(isinstance(cell, cadquery.Solid) for cell in structure.cells())
    rest = block.cut(cadquery.Workplane(structure.solid(1.0)))
    filled = structure.solid(1.0).Volume()
    assert rest.val().Volume() == pytest.approx(4000 - filled, rel=1e-6)
    assembly = cadquery.Assembly().add(block).add(block, loc=cadquery.Location((40, 0, 0)))
    for two in (assembly, [block, block.translate((40, 0, 0))]):
        assert v3dcad.part_from(two).contents()["volume"] == "8000 mm³"
        assert v3dcad.part_from(two).library == "cadquery"


def test_cadquery_vis_shows_a_filled_workplane(tmp_path: Path) -> None:
    """On a screen in memory; the picture is kept where `V3DCAD_PICTURES` says."""
    if shutil.which("xvfb-run") is None:
        pytest.skip("Xvfb is not installed: apt-get install xvfb")
    folder = Path(os.environ.get("V3DCAD_PICTURES", tmp_path))
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "cadquery-vis.png"
    code = (
        "import sys, cadquery, cadquery.vis, v3dcad.adapters.cadquery\n"
        "box = cadquery.Workplane().box(30, 30, 20)\n"
        "walls = box.voronoiFill('faces', cell_size=10.0, layer_height=2.0)\n"
        "cadquery.vis.show(walls, interact=False, screenshot=sys.argv[1], width=400, height=300,\n"
        "                  gradient=False, trihedron=False)\n"
    )
    command = ["xvfb-run", "-a", sys.executable, "-c", code, str(file)]
    done = subprocess.run(command, capture_output=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    with Image.open(file) as picture:
        pixels = np.asarray(picture.convert("RGB")).reshape(-1, 3)
    colours, counts = np.unique(pixels, axis=0, return_counts=True)
    assert len(colours) > 10, "walls are lit from several sides"
    assert 0.1 < 1 - counts.max() / len(pixels) < 0.9
