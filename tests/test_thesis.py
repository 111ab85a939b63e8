"""The thesis's method from end to end: files, report, command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from test_cli import mistake, run

import v3dcad
from v3dcad.structure.thesis.loop import ThesisLayer


def test_every_file_can_be_written_of_it(samples: Path, tmp_path: Path) -> None:
    sites = np.random.default_rng(4).uniform(-33.5, 33.5, (50, 2))
    structure = v3dcad.fill(
        samples / "pyramid.stl", method="thesis", sites=sites, layer_height=2.5, offset=10.0
    )
    for kind in ("ont", "gcode", "step", "png", "report"):
        getattr(structure, f"write_{kind}")(tmp_path / f"a.{kind}")
        assert (tmp_path / f"a.{kind}").stat().st_size > 1000
    report = json.loads((tmp_path / "a.report").read_text())
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


def test_what_only_the_continuous_method_has_is_refused(samples: Path) -> None:
    structure = v3dcad.fill(
        samples / "pyramid.stl", method="thesis", layer_height=10, offset=0.5, sites=9
    )
    with pytest.raises(v3dcad.SettingError, match="no walls; take the continuous method"):
        structure.walls  # noqa: B018
    with pytest.raises(v3dcad.SettingError, match="no strut axes"):
        structure.strut_axes  # noqa: B018
    with pytest.raises(v3dcad.SettingError, match="no diagrams between layers"):
        structure.at(3.3)


def test_interpolation_from_the_command_line(samples: Path, tmp_path: Path) -> None:
    """Two sites: a straight wall between them, on every layer."""
    csv = tmp_path / "sites.csv"
    csv.write_text("-5,0\n5,0\n")
    fill = ("fill", samples / "pyramid.stl", "--method", "thesis", "--interpolate")
    given = ("--sites-file", csv, "--layer-height", 5, "--offset", 0.5)
    done = run(*fill, *given, "--report", tmp_path / "a.json")
    assert done.returncode == 0, done.stderr
    report = json.loads((tmp_path / "a.json").read_text())
    assert report["layers"] == 10
    assert [row["walls"] for row in report["by_layer"]] == [1] * 10


def test_what_cannot_be_interpolated_is_refused(
    samples: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fill = ("fill", samples / "pyramid.stl", "--method", "thesis", "--interpolate")
    said = mistake(capsys, *fill, "--out", tmp_path / "out", "--layer-height", 5)
    assert "leave --interpolate out" in said
    assert not (tmp_path / "out").exists()


def test_a_method_that_does_not_exist(samples: Path, tmp_path: Path) -> None:
    with pytest.raises(v3dcad.SettingError, match="give continuous or thesis") as caught:
        v3dcad.fill(samples / "pyramid.stl", method="thesi")
    assert caught.value.name == "method"
    done = run("fill", samples / "pyramid.stl", "--method", "thesi", "--out", tmp_path / "out")
    assert done.returncode == 2
    assert "thesi" in done.stderr
    assert "continuous" in done.stderr
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
    said = mistake(capsys, "fill", samples / "pyramid.stl", "--out", tmp_path / "out", *words)
    assert says in said
