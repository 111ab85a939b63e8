"""Our STEP as FreeCAD reads it: the same layers, chains, lengths, boxes and volumes."""

from __future__ import annotations

import json
import os
import subprocess
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from build123d import Axis, Box, Cylinder, Pos, fillet
from hosts import freecad_or_skip
from occt import area_of, box_of, edges_of, length_of, volume_of

import v3dcad
from v3dcad import Structure
from v3dcad.kernel.wires import layer_wires

pytestmark = pytest.mark.slow

READER = Path(__file__).parent / "freecad_reader.py"

Read = Callable[..., list[dict[str, Any]]]


@pytest.fixture(scope="module")
def structure() -> Structure:
    body = Box(30, 24, 12) - Cylinder(5, 12)
    part = Pos(7, -3, 20) * fillet(body.edges().filter_by(Axis.Z), 3)
    return v3dcad.fill(part.wrapped, cell_size=8.0, layer_height=1.0)


@pytest.fixture
def read(structure: Structure, tmp_path: Path) -> Read:
    """Writes a form and gives what FreeCAD finds in it, object by object."""
    command = freecad_or_skip()

    def write_and_read(form: str, **sizes: Any) -> list[dict[str, Any]]:
        step, report = tmp_path / "a.step", tmp_path / "report.json"
        structure.write_step(step, form, **sizes)
        paths = {"STEP_FILE": str(step), "REPORT_FILE": str(report)}
        done = subprocess.run(
            [command, str(READER)],
            env={**os.environ, **paths, "QT_QPA_PLATFORM": "offscreen"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            encoding="utf-8",
            errors="replace",
            timeout=120,
            check=False,
        )
        assert report.exists(), done.stdout
        objects = json.loads(report.read_text(encoding="utf-8"))["objects"]
        assert all(found["valid"] for found in objects)
        return list(objects)

    return write_and_read


def around(objects: list[dict[str, Any]]) -> Any:
    """(2, 3) the box around all objects, mm."""
    low, high = (np.array([found[end] for found in objects]) for end in ("low", "high"))
    return pytest.approx(np.array([low.min(axis=0), high.max(axis=0)]), abs=1e-5)


def test_layers_chains_lengths_and_boxes(structure: Structure, read: Read) -> None:
    found = read("wires")
    layers = structure.layers
    assert [each["label"] for each in found] == [f"layer {k.index} z {k.z:g}" for k in layers]
    for each, layer in zip(found, layers, strict=True):
        wires = layer_wires(structure.part.exact(layer), structure.placement)
        assert each["edges"] < len(edges_of(wires)), "straight runs are chained"
        assert each["length"] == pytest.approx(length_of(wires), rel=1e-7)
        assert each["low"][2] == pytest.approx(layer.z + 14, abs=1e-6)
    total = sum(each["length"] for each in found)
    assert total == pytest.approx(length_of(structure.wires()), rel=1e-7)
    assert box_of(structure.wires()) == around(found)


def test_cells_by_name_volume_and_box(structure: Structure, read: Read) -> None:
    found = read("cells")
    cells, labels = [], []
    for site, pieces in structure.cells_by_site().items():
        count = len(pieces)
        cells += pieces
        labels += [
            f"cell {site}" if count == 1 else f"cell {site}, piece {piece} of {count}"
            for piece in range(1, count + 1)
        ]
    assert len(cells) > len(structure.cells_by_site()), "the hole cuts some in pieces"
    assert [each["label"] for each in found] == labels
    assert [each["solids"] for each in found] == [1] * len(cells)
    for each, cell in zip(found, cells, strict=True):
        # FreeCAD integrates by OCCT's fixed rule.
        assert each["volume"] == pytest.approx(volume_of(cell), rel=1e-5)
        assert np.array([each["low"], each["high"]]) == pytest.approx(box_of(cell), abs=1e-5)


def test_faces_thick_walls_and_struts(structure: Structure, read: Read) -> None:
    (walls,) = read("faces")
    assert walls["area"] == pytest.approx(area_of(structure.faces()), rel=1e-5)
    assert box_of(structure.faces()) == around([walls])
    for form, size in (("solid", {"thickness": 1.0}), ("struts", {"diameter": 1.5})):
        with warnings.catch_warnings(action="ignore"):  # some cells are narrower than walls
            made = getattr(structure, form)(**size)
            found = read(form, **size)
        volume = sum(each["volume"] for each in found)
        assert volume == pytest.approx(volume_of(made), rel=1e-5)
        assert box_of(made) == around(found)
