from __future__ import annotations

import math
from pathlib import Path

import pytest

from v3dcad.errors import FormatError
from v3dcad.formats.gcode.reader import MAX_ARC_STEPS, Summary, read_gcode
from v3dcad.geometry.print_time import move_seconds
from v3dcad.settings import PrintSettings


@pytest.fixture
def read(tmp_path: Path):
    def read(text: str, **settings: float) -> Summary:
        file = tmp_path / "a.gcode"
        file.write_bytes(text.encode("latin-1"))
        return read_gcode(file, PrintSettings(**settings))  # type: ignore[arg-type]

    return read


def test_lengths_filament_layers_and_bounds(read) -> None:
    found = read(
        "; sliced elsewhere\nM82\nG28\nG1 Z0.2 F600\nG1 X10 Y10 F3000\nN3 G1 X20 E1 F600*71\n"
        "G1 Y20 E2 (up)\nG92 E0\nG0 X10\nG1 E-3\nG1 Z0.4\nG1 E0\nG1 Y10 E1.5 ;down\n"
    )
    assert found.filament_mm == pytest.approx(3.5)
    assert found.extruded_mm == pytest.approx(30)
    assert found.travelled_mm == pytest.approx(10.2)
    assert found.layers == 2
    assert found.moves == 9
    assert found.least == (10, 10, 0.2)
    assert found.greatest == (20, 20, 0.4)


def test_bounds_include_where_extrusion_begins(read) -> None:
    found = read("G28\nG0 X1 Y9 Z1 F600\nG1 X5 Y5 E1\n")
    assert found.least == (1, 5, 1)
    assert found.greatest == (5, 9, 1)


def test_relative_moves_and_extrusion(read) -> None:
    found = read("G28\nG1 X0 Y0 Z1 F600\nG91\nG1 X5 E1\nG1 X5 E1\nG90\nM83\nG1 X0 E0.5\n")
    assert found.extruded_mm == pytest.approx(20)
    assert found.filament_mm == pytest.approx(2.5)


def test_inches(read) -> None:
    found = read("G20\nM83\nG1 X0 Y0 Z1 F60\nG1 X1 E0.1\n")
    assert found.extruded_mm == pytest.approx(25.4)
    assert found.filament_mm == pytest.approx(2.54)
    assert found.time_s == pytest.approx(1.0, rel=0.1)


@pytest.mark.parametrize(
    ("arc", "turn", "top"),
    [
        ("G3 X-10 Y0 I-10 J0", math.pi, 10.0),
        ("G2 X-10 Y0 I-10 J0", math.pi, 0.0),
        ("G3 X0 Y10 I-10 J0", math.pi / 2, 10.0),
        ("G2 X0 Y10 I-10 J0", 3 * math.pi / 2, 10.0),
        ("G3 X0 Y10 R10", math.pi / 2, 10.0),
        ("G2 X0 Y10 R-10", 3 * math.pi / 2, None),
        ("G3 I-10", 2 * math.pi, 10.0),
        ("G2 I-10", 2 * math.pi, 10.0),
    ],
)
def test_arcs(read, arc: str, turn: float, top: float | None) -> None:
    found = read(f"M83\nG1 X10 Y0 Z1 F600\n{arc} E1\n")
    assert found.extruded_mm == pytest.approx(10 * turn, rel=1e-3)
    assert found.filament_mm == pytest.approx(1)
    if top is not None:
        assert found.greatest[1] == pytest.approx(top, abs=0.02)


def test_the_longest_arc_is_read_in_few_steps(read, monkeypatch: pytest.MonkeyPatch) -> None:
    planned = []

    def counted(steps, *rest):
        planned.append(len(steps))
        return move_seconds(steps, *rest)

    monkeypatch.setattr("v3dcad.formats.gcode.reader.move_seconds", counted)
    found = read("M83\nG1 X1000000 Y0 Z1 F600\nG3 X-1000000 I-1000000 E1\n")
    assert found.extruded_mm == pytest.approx(math.pi * 1e6, rel=1e-4)
    assert sum(planned) <= 1 + MAX_ARC_STEPS


def test_time_knows_accelerations_and_dwells(read) -> None:
    text = "G1 X0 Y0 Z1 F3000\nM204 S{}\nG1 X100\nG4 S2\nG4 P500\n"
    assert read(text.format(500)).time_s == pytest.approx(0.2 + 95 / 50 + 2.5)
    assert read(text.format(1000)).time_s == pytest.approx(0.1 + 97.5 / 50 + 2.5)
    klipper = "G1 X0 Y0 Z1 F3000\nSET_VELOCITY_LIMIT ACCEL=1000\nG1 X100\n"
    assert read(klipper).time_s == pytest.approx(0.1 + 97.5 / 50)


def test_travels_alone_have_no_bounds(read) -> None:
    found = read("G0 X1\nG0 X5\n")
    assert found.least is None
    assert found.layers == 0
    assert found.travelled_mm == 4


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no moves"),
        ("M104 S200\n; nothing\n", "no moves"),
        ("G1 X1\nG1 X1.2.3\n", "line 2: '.3' is not a word of G-code"),
        ("G1 Xone\n", "line 1: 'XONE' is not a word"),
        ("G1 X" + "9" * 400 + "\n", "line 1: a number is too large"),
        ("G1 X1\nG1\0X2\n", "line 2: this is not G-code"),
        ("G1 X1 " + " " * 5000 + "\n", "line 1: this is not G-code"),
    ],
)
def test_what_is_no_gcode(read, text: str, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read(text)
