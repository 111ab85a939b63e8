"""What the worker answers is what v3dcad makes."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from worker.worker_process import ROOT, Worker

import v3dcad
from v3dcad.forms import write_part
from v3dcad.kernel.load import load_brep
from v3dcad.kernel.shapes import EDGE, SOLID, bounds, count
from v3dcad.parts import part_from
from v3dcad.pipeline import build
from v3dcad.recipes import known_settings
from v3dcad.settings import ExportSettings, FillSettings, PrintSettings, declared
from v3dcad.structure.placement import on_bed
from v3dcad.worker.kept import Kept

pytestmark = pytest.mark.slow

SETTINGS = {"cell_size": 8.0, "layer_height": 1.0}
THESIS = {"method": "thesis", "sites": 12, "layer_height": 3.0}
WIDE = {"nozzle_diameter": 3.0, "bead_width": 3, "most_flow": 1000.0}
COLUMNS = {"layer_height": 3.0, "stretch": "columns"}


def lines_of(result: dict[str, Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    with np.load(result["lines"]) as found:
        assert found["points"].dtype == np.float32
        assert found["pairs"].dtype == found["layer"].dtype == np.int32
        return found["points"], found["pairs"], found["layer"]


@pytest.mark.parametrize("settings", [SETTINGS, THESIS, COLUMNS])
def test_a_fill_is_that_of_python(worker: Worker, cone: Path, settings: dict[str, Any]) -> None:
    made = worker.get("fill", source=str(cone), settings=settings, shape_up_to=0)
    structure = v3dcad.fill(cone, **settings)
    layers = list(structure.layers)
    assert made["checksum"] == structure.checksum().sha256
    assert made["edges"] == sum(len(layer.diagram.edges) for layer in layers)
    assert made["layers"] == len(layers)
    assert made["shape"] is None
    for name, value in made["settings"].items():
        assert value == getattr(structure.settings, name)
    points, pairs, layer = lines_of(made)
    assert len(pairs) == len(layer) == made["edges"]
    drawn = [points[pairs[layer == one.index]] for one in layers]
    for one, ends in zip(layers, drawn, strict=True):
        flat = one.diagram.vertices[one.diagram.edges]
        at = np.concatenate([flat, np.full((*flat.shape[:2], 1), one.z)], axis=2)
        source = structure.placement.to_source(at.reshape(-1, 3)).reshape(at.shape)
        np.testing.assert_array_equal(ends, source.astype(np.float32))


def test_a_fill_is_that_of_the_command_line(worker: Worker, cone: Path, tmp_path: Path) -> None:
    made = worker.get("fill", source=str(cone), settings=SETTINGS, shape_up_to=100_000)
    told = worker.get("report", source=str(cone), settings=SETTINGS)
    files = {kind: tmp_path / f"a.{kind}" for kind in ("ont", "brep", "report")}
    words = [f"--{kind}={file}" for kind, file in files.items()]
    run = [sys.executable, "-c", "from v3dcad.cli import main; main()", "fill", str(cone), *words]
    done = subprocess.run(
        [*run, "--cell-size=8", "--layer-height=1"],
        cwd=ROOT, capture_output=True, encoding="utf-8", check=True,
    )  # fmt: skip
    assert made["checksum"] in files["ont"].read_text(encoding="utf-8")
    ours, theirs = (load(file) for file in (made["shape"], files["brep"]))
    assert count(ours, EDGE) == count(theirs, EDGE) > 100
    np.testing.assert_allclose(bounds(ours), bounds(theirs), atol=1e-6)
    low, high = part_from(cone).bounds
    assert (bounds(ours)[0] >= low - 1e-6).all()
    assert (bounds(ours)[1] <= high + 1e-6).all()
    summary = json.loads(files["report"].read_text(encoding="utf-8"))
    assert told["layers"] == summary["layers"]
    assert told["cells"] == summary["cells"]
    assert told["wall_length"] == summary["wall_length_mm"]
    assert told["cell_size"] == summary["foam"]["cell_size_made_mm"]
    assert told["certificate"] in done.stdout
    assert f"{told['steepest_wall']:.2f}°" in done.stdout
    assert told["mass"] == v3dcad.fill(cone, **SETTINGS).plastic().mass


def test_what_hangs_is_that_of_python(worker: Worker, cone: Path) -> None:
    fine = {"cell_size": 8.0, "layer_height": 0.4}
    told = worker.get("overhang", source=str(cone), settings=fine, print={"top_layers": 2})
    found = v3dcad.fill(cone, **fine).printed_overhang(PrintSettings(top_layers=2))
    assert told["kinds"] == list(found.kinds)
    assert told["certificate"] == found.line()
    assert told["findings"] == found.findings()
    with np.load(told["arrays"]) as arrays:
        assert set(arrays) == set(found.__dataclass_fields__)
        for name in arrays:
            np.testing.assert_array_equal(arrays[name], getattr(found, name))
    assert found.span.max() > 2
    said, _ = worker.refused("overhang", source=str(cone), settings=fine, print={"fail_over": 0.5})
    assert "more than --fail-over 0.5" in said


def in_order(lines: np.ndarray) -> np.ndarray:
    """Lines (m, 2, 3) sorted: a layer by itself has the same ones in another order."""
    rows = sorted(sorted(map(tuple, ends)) for ends in lines.tolist())
    return np.array(rows)


def load(path: str | Path) -> Any:
    """A BREP file's shape, whatever is in it."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepTools import BRepTools
    from OCP.TopoDS import TopoDS_Shape

    shape = TopoDS_Shape()
    assert BRepTools.Read_s(shape, str(path), BRep_Builder())
    assert not shape.IsNull()
    return shape


@pytest.mark.parametrize("settings", [SETTINGS, {**SETTINGS, "cell_size": 6}, THESIS])
def test_a_preview_is_that_layer_of_the_fill(
    worker: Worker, cone: Path, settings: dict[str, Any]
) -> None:
    structure = v3dcad.fill(cone, **settings)
    layers = list(structure.layers)
    for index in (0, 7, len(layers) - 1):
        shown = worker.get("layer", source=str(cone), settings=settings, target="layer",
                           layer=index)  # fmt: skip
        diagram = layers[index].diagram
        assert shown["layers"] == len(layers)
        assert shown["cells"] == diagram.sites().tolist()
        drawn = np.concatenate([np.load(p["points"])[np.load(p["pairs"])] for p in shown["parts"]])
        inner = diagram.inner()
        flat = diagram.vertices[np.concatenate([diagram.edges[~inner], diagram.edges[inner]])]
        at = np.concatenate([flat, np.full((*flat.shape[:2], 1), layers[index].z)], axis=2)
        source = structure.placement.to_source(at.reshape(-1, 3)).reshape(at.shape)
        np.testing.assert_array_equal(in_order(drawn), in_order(source.astype(np.float32)))
        assert [label[0] for label in shown["labels"]] == list(map(str, shown["cells"]))
        height = layers[index].z + 0.3 * structure.settings.layer_height
        again = worker.get("layer", source=str(cone), settings=settings, target="layer",
                           height=height)  # fmt: skip
        assert again["layer"] == min(index, len(layers) - 1)


@pytest.mark.parametrize("target", ["sizes", "overhang", "toolpath"])
def test_previews_of_values_come_in_steps_of_one_colour(
    worker: Worker, cone: Path, target: str
) -> None:
    structure = v3dcad.fill(cone, **SETTINGS)
    shown = worker.get("layer", source=str(cone), settings=SETTINGS, target=target, layer=7,
                       print={"bead_width": 0.6})  # fmt: skip
    expected = structure.preview(target, 7, printing=PrintSettings(bead_width=0.6))
    assert shown["title"] == expected.title
    assert list(shown["legend"]) == [name for name, *_ in expected.stepped()]
    for part, (_, colour, points, pairs) in zip(shown["parts"], expected.stepped(), strict=True):
        assert part["colour"] == colour
        assert len(np.load(part["points"])) == len(points)
        np.testing.assert_array_equal(
            in_order(np.load(part["points"])[np.load(part["pairs"])]),
            in_order(points[pairs].astype(np.float32)),
        )


def test_a_changed_part_has_another_name_and_other_settings_another_structure(
    worker: Worker, cone: Path, samples: Path
) -> None:
    ask = {"settings": SETTINGS, "shape_up_to": 0}
    first = worker.get("fill", source=str(cone), **ask)
    other = worker.get("fill", source=str(samples / "pyramid.stl"), **ask)
    coarse = worker.get("fill", source=str(cone), settings={"layer_height": 5}, shape_up_to=0)
    again = worker.get("fill", source=str(cone), **ask)
    sums = {one["checksum"] for one in (first, other, coarse)}
    assert len(sums) == 3
    assert again["checksum"] == first["checksum"]


def test_sites_that_are_given(worker: Worker, cone: Path, tmp_path: Path) -> None:
    sites = np.random.default_rng(1).uniform(-15, 15, (30, 2))
    np.save(tmp_path / "s.npy", sites)
    ask = {"source": str(cone), "shape_up_to": 0, "sites": str(tmp_path / "s.npy")}
    for settings in ({"layer_height": 5.0}, {"layer_height": 5.0, "method": "thesis"}):
        made = worker.get("fill", settings=settings, **ask)
        assert made["checksum"] == v3dcad.fill(cone, sites=sites, **settings).checksum().sha256


@pytest.mark.parametrize(
    ("form", "sizes"),
    [("wires", {}), ("faces", {}), ("cells", {}), ("solid", {"thickness": 0.2, "skin": 0.5}),
     ("struts", {"diameter": 1.5})],
)  # fmt: skip
@pytest.mark.filterwarnings("ignore:2 cells are narrower than a thickness of 0.2 mm")
def test_forms_are_those_of_python(
    worker: Worker, cone: Path, form: str, sizes: dict[str, float]
) -> None:
    settings = {"cell_size": 15.0, "layer_height": 5.0}
    made = worker.get("brep", source=str(cone), settings=settings, form=form, **sizes)
    shape, written = getattr(v3dcad.fill(cone, **settings), form)(**sizes), load(made["shape"])
    shapes = shape if isinstance(shape, list) else [shape]
    assert made["edges"] == count(written, EDGE) > 10
    assert made["solids"] == count(written, SOLID) == sum(count(one, SOLID) for one in shapes)
    low, high = bounds(written)
    reach = 1.0 if form == "struts" else 1e-5
    assert (low >= part_from(cone).bounds[0] - reach).all()
    assert (high <= part_from(cone).bounds[1] + reach).all()


@pytest.mark.parametrize(
    ("name", "asks"),
    [
        ("a.step", {}),
        ("a.ont", {}),
        ("a.stl", {"form": "struts", "diameter": 2.0}),
        ("a.brep", {"form": "faces"}),
        ("a.gcode", {"print": WIDE, "profile": "ender3v2"}),
        ("a.svg", {"svg_layer": 2}),
    ],
)
def test_exports_are_the_files_of_python(
    worker: Worker, cone: Path, tmp_path: Path, name: str, asks: dict[str, Any]
) -> None:
    settings = {"cell_size": 15.0, "layer_height": 3.0}
    file, expected = tmp_path / "ü x" / name, tmp_path / "theirs" / name
    said = worker.get("export", source=str(cone), settings=settings, to=str(file), name="A", **asks)
    structure = v3dcad.fill(cone, **settings)
    structure = replace(structure, part=replace(structure.part, name="A"))  # type: ignore[type-var]
    match file.suffix:
        case ".step":
            structure.write_step(expected)
        case ".ont":
            structure.write_ont(expected)
        case ".stl":
            structure.write_stl(expected, "struts", diameter=2.0)
        case ".brep":
            structure.write_brep(expected, "faces")
        case ".svg":
            structure.write_svg(expected, 2)
        case ".gcode":
            from v3dcad.formats.gcode.machine_profile import read_profile

            printing = PrintSettings(**{**read_profile("ender3v2"), **WIDE})
            structure.write_gcode(expected, printing)
            assert any(line.startswith("filament: ") for line in said["lines"])
    assert file.read_bytes() == expected.read_bytes()
    assert said["bytes"] == file.stat().st_size
    assert said["lines"][0] == f"written {file} ({said['bytes']:,} bytes)"
    assert [one.name for one in file.parent.iterdir()] == [name]


@pytest.mark.parametrize("settings", [SETTINGS, THESIS, COLUMNS])
def test_an_ont_file_opened_and_filled_is_what_was_written(
    worker: Worker, cone: Path, tmp_path: Path, settings: dict[str, Any]
) -> None:
    sites = None if "cell_size" in settings else np.random.default_rng(2).uniform(-15, 15, (20, 2))
    structure = v3dcad.fill(cone, **{**settings, **({} if sites is None else {"sites": sites})})
    structure.write_ont(tmp_path / "a.ont")
    opened = worker.get("open_ont", path=str(tmp_path / "a.ont"))
    assert opened["name"] == "a"
    assert opened["checksum"] == structure.checksum().sha256
    assert (opened["sites"] is None) == (sites is None)
    ask = {} if sites is None else {"sites": opened["sites"]}
    made = worker.get("fill", source=opened["boundary"], settings=opened["settings"],
                      shape_up_to=0, **ask)  # fmt: skip
    assert made["checksum"] == opened["checksum"]
    moved = np.array(opened["placement"]["translation"])
    np.testing.assert_allclose(part_from(opened["boundary"]).bounds - moved, load_brep(cone).bounds)


def test_hello_tells_every_setting_as_it_is_declared(worker: Worker) -> None:
    said = worker.get("hello")
    assert said["version"] == v3dcad.version.VERSION  # type: ignore[attr-defined]
    told = {(one["group"], one["name"]): one for one in said["settings"]}
    classes = {"fill": FillSettings, "print": PrintSettings, "export": ExportSettings}
    assert list(told) == [(g, n) for g, cls in classes.items() for n in cls.__dataclass_fields__]
    for (group, name), one in told.items():
        known = declared(classes[group], name)
        assert one["help"] == known.help
        assert one["unit"] == known.unit
        assert one["least"] == (known.least if np.isfinite(known.least) else None)
        assert one["default"] == classes[group].__dataclass_fields__[name].default
        assert one["type"] in ("float", "int", "bool", "str")
        assert one["words"] or type(one["default"]).__name__ == one["type"]


def test_progress_rises_to_the_end(worker: Worker, cone: Path) -> None:
    settings = {"layer_height": 0.05}
    made = worker.get("fill", source=str(cone), settings=settings, shape_up_to=0)
    steps = [one for one in worker.stages if one["stage"] == "filling"]
    done = [one["done"] for one in steps]
    assert done == sorted(done)
    assert (done[0], done[-1]) == (0, made["layers"])
    assert {one["of"] for one in steps} == {made["layers"]}
    assert 10 < len(done) < 100 < made["layers"]


def test_a_kept_structure_is_the_one_that_is_asked_for(worker: Worker, cone: Path) -> None:
    """Sections are kept while only other settings change."""
    part = part_from(cone)
    part = part.placed(on_bed(part.bounds, 0))
    for size in (6.0, 9.0, 6.0):
        for height in (1.0, 2.0, 1.0):
            settings = {"cell_size": size, "layer_height": height}
            made = worker.get("fill", source=str(cone), settings=settings, shape_up_to=0)
            wanted = build(part, FillSettings(**settings)).checksum().sha256
            assert made["checksum"] == wanted, settings


def test_nothing_kept_is_taken_for_what_differs_in_its_sites_alone(cone: Path) -> None:
    kept, settings = Kept(), {"method": "thesis", "layer_height": 3.0}
    one, other = np.random.default_rng(3).uniform(-15, 15, (2, 12, 2))
    for sites in (one, other, one):
        asked = known_settings(settings, sites)
        made = kept.structure(str(cone), asked, sites, PrintSettings(), lambda *_: None).checksum()
        assert made == v3dcad.fill(cone, sites=sites, **settings).checksum()


def test_a_small_part_of_freecad_is_in_no_other_unit(tmp_path: Path) -> None:
    mesh = (np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]]),
            np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))  # fmt: skip
    write_part(part_from(mesh), tmp_path / "a.stl")
    assert "in inches?" in part_from(tmp_path / "a.stl").findings[0]
    settings = FillSettings(cell_size=1.0)
    made = Kept().structure(
        str(tmp_path / "a.stl"), settings, None, PrintSettings(), lambda *_: None
    )
    assert made.findings() == []


def test_words_of_libraries_are_notes(worker: Worker, cone: Path) -> None:
    settings = {"cell_size": 15.0, "layer_height": 5.0}
    made = worker.get("brep", source=str(cone), settings=settings, form="struts", diameter=20.0)
    assert re.search("a diameter of 20 mm", " ".join(made["notes"]))
