"""The thesis's method from end to end: files, report, command line."""

from __future__ import annotations

import importlib.util
import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from test_cli import mistake, run

import v3dcad
from v3dcad.settings import PrintSettings
from v3dcad.structure.thesis.loop import ThesisLayer

pytestmark = pytest.mark.slow


def test_every_file_can_be_written_of_it(samples: Path, tmp_path: Path) -> None:
    sites = np.random.default_rng(4).uniform(-33.5, 33.5, (50, 2))
    structure = v3dcad.fill(
        samples / "pyramid.stl", method="thesis", sites=sites, layer_height=2.5, offset=10.0
    )
    wide = PrintSettings(nozzle_diameter=2.5, bead_width=2.5, most_flow=1000.0)
    structure.write_gcode(tmp_path / "a.gcode", wide)
    structure.write_picture(tmp_path / "a.png")
    for kind in ("ont", "step", "report"):
        getattr(structure, f"write_{kind}")(tmp_path / f"a.{kind}")
    for kind in ("ont", "gcode", "step", "png", "report"):
        assert (tmp_path / f"a.{kind}").stat().st_size > 1000
    report = json.loads((tmp_path / "a.report").read_text(encoding="utf-8"))
    layers = [layer for layer in structure.layers if isinstance(layer, ThesisLayer)]
    assert report["settings"]["method"] == "thesis"
    births = [(row["layer"], row["site"]) for row in report["births"]]
    assert (
        [site for _, site in births]
        == layers[-1].inserted.tolist()
        == [50 + k for k in range(len(births))]
    )
    assert len(births) > 0
    for layer, site in births:
        assert site in layers[layer].inserted
        assert site not in layers[layer - 1].inserted
    unanswered = [layer.index for layer in layers if layer.unanswered]
    assert report["layers_without_candidate"] == unanswered
    assert len(unanswered) > 0
    for row, layer in zip(report["by_layer"], layers, strict=True):
        assert row["area_per_cell_mm2"] == layer.area_per_cell


def test_what_only_a_foam_has_is_refused(samples: Path) -> None:
    structure = v3dcad.fill(
        samples / "pyramid.stl", method="thesis", layer_height=10, offset=0.5, sites=9
    )
    with pytest.raises(v3dcad.SettingError, match="no walls; take method foam"):
        structure.walls  # noqa: B018
    with pytest.raises(v3dcad.SettingError, match="no strut axes"):
        structure.strut_axes  # noqa: B018
    with pytest.raises(v3dcad.SettingError, match="no diagrams between layers"):
        structure.at(3.3)


def test_interpolation_from_the_command_line(samples: Path, tmp_path: Path) -> None:
    """Two sites: a straight wall between them, on every layer."""
    csv = tmp_path / "sites.csv"
    csv.write_text("-5,0\n5,0\n", encoding="utf-8")
    fill = ("fill", samples / "pyramid.stl", "--method", "thesis", "--interpolate")
    given = ("--sites-file", csv, "--layer-height", 5, "--offset", 0.5)
    done = run(*fill, *given, "--report", tmp_path / "a.json")
    assert done.returncode == 0, done.stderr
    report = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    assert report["layers"] == 10
    assert [row["walls"] for row in report["by_layer"]] == [1] * 10


def test_what_cannot_be_interpolated_is_refused(
    samples: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fill = ("fill", samples / "pyramid.stl", "--method", "thesis", "--interpolate")
    said = mistake(capsys, *fill, "--out", tmp_path / "out", "--layer-height", 0.4)
    assert "leave --interpolate out" in said
    assert not (tmp_path / "out").exists()


def test_a_method_that_does_not_exist(samples: Path, tmp_path: Path) -> None:
    with pytest.raises(v3dcad.SettingError, match="give foam or thesis") as caught:
        v3dcad.fill(samples / "pyramid.stl", method="thesi")
    assert caught.value.name == "method"
    done = run("fill", samples / "pyramid.stl", "--method", "thesi", "--out", tmp_path / "out")
    assert done.returncode == 2
    assert "thesi" in done.stderr
    assert "give foam or thesis" in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--boundary-tolerance", 0], "--boundary-tolerance 0.0: give a number above 0 mm"),
        (["--weight-step", -1], "--weight-step -1.0: give a number of at least 0 mm²"),
    ],
)
def test_its_settings_have_their_ranges(
    words: list[object],
    says: str,
    samples: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    fill = ("fill", samples / "pyramid.stl", "--method", "thesis", "--out", tmp_path / "out")
    assert says in mistake(capsys, *fill, *words)


def test_it_takes_sites_of_a_plane(samples: Path) -> None:
    with pytest.raises(v3dcad.SettingError, match="rows of x, y") as caught:
        v3dcad.fill(samples / "pyramid.stl", method="thesis", sites=[(0, 0, 0), (5, 5, 0)])
    assert caught.value.name == "sites"


def test_as_many_sites_as_are_asked_for(samples: Path) -> None:
    structure = v3dcad.fill(
        samples / "pyramid.stl", method="thesis", layer_height=5, sites=40, offset=0.2
    )
    assert structure.sites.shape == (40, 2)
    assert structure.settings.offset == 0.2


def test_the_published_cases(samples: Path, tmp_path: Path) -> None:
    """Sizes and parameters of Tables 4.1 and 4.2, each part built once; the bunny is optional."""
    spec = importlib.util.spec_from_file_location("recipes", samples / "thesis" / "recipes.py")
    assert spec is not None
    assert spec.loader is not None
    recipes = importlib.util.module_from_spec(spec)
    sys.modules["recipes"] = recipes
    spec.loader.exec_module(recipes)
    sizes = {
        "cone": (40, 40, 30),
        "truncated pyramid": (67, 67, 50),
        "large truncated pyramid": (180, 180, 30),
        "prism": (1000, 1000, 40),
        "cube": (50, 50, 50),
        "fine cube": (50, 50, 50),
    }
    cases = [*recipes.published(), *recipes.cubes()]
    assert [case.name for case in cases] == list(sizes)
    for case in cases:
        bounds = v3dcad.pipeline.part_from(case.source()).bounds
        assert np.ptp(bounds, axis=0) == pytest.approx(sizes[case.name], abs=1e-3)
        assert case.settings.method == "thesis"
    table_41 = [(c.settings.layer_height, c.settings.offset, c.settings.sites) for c in cases[:4]]
    assert table_41 == [(0.2, 0.2, 40), (0.2, 0.5, 10), (0.2, 0.2, 300), (2.0, 0.1, 4000)]
    bunny = recipes.published(tmp_path / "any.stl")[3]
    assert (bunny.name, bunny.source()) == ("bunny", tmp_path / "any.stl")
    assert bunny.settings.layer_height == 0.25
    pyramid = recipes.pyramid_of_50().build()
    top = np.ptp(np.concatenate(pyramid.filling.sections[-1].rings), axis=0)
    height = pyramid.filling.sections[-1].z
    assert top == pytest.approx([67 - 2 * height * math.tan(math.radians(10))] * 2, abs=1e-3)
