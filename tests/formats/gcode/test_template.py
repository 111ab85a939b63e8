from __future__ import annotations

from pathlib import Path

import pytest

from v3dcad.errors import FormatError
from v3dcad.formats.gcode.blocks import Totals, filled
from v3dcad.formats.gcode.machine_profile import read_profile
from v3dcad.formats.gcode.template import Template, read_template, template_profile
from v3dcad.settings import PrintSettings

HEADER = "G28 ; home\nM109 S200\n"
FOOTER = "M104 S0\nM84\n"
PRINT = "G1 X1 Y1 F600\nG1 X2 Y1 E1\nG1 E0.5\nG1 X3 Y3 E2\n"


@pytest.fixture
def read(tmp_path: Path):
    def read(content: str | bytes) -> Template:
        file = tmp_path / "example.gcode"
        file.write_bytes(content.encode() if isinstance(content, str) else content)
        return read_template(file)

    return read


@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_between_the_markers(read, line_end: str) -> None:
    text = f"{HEADER}START here\n{PRINT}END\n{PRINT}END of it\n{FOOTER}"
    found = read(text.replace("\n", line_end))
    assert (found.prepended, found.appended) == (HEADER, FOOTER)
    assert found.marked
    assert "START (line 3)" in found.finding()


def test_first_start_and_last_end(read) -> None:
    found = read(f"{HEADER}START\nSTART\n{PRINT}END\nEND\n")
    assert (found.prepended, found.appended) == (HEADER, "")


def test_without_markers_the_extrusions_are_found_and_said(read) -> None:
    found = read(HEADER + PRINT + FOOTER)
    assert found.prepended == HEADER + "G1 X1 Y1 F600\n"
    assert found.appended == FOOTER
    assert (found.first_line, found.last_line) == (4, 6)
    assert "no START and END markers" in found.finding()
    assert "first extrusion (line 4)" in found.finding()


def test_a_move_that_repeats_its_e_extrudes_nothing(read) -> None:
    found = read("G92 E0\nG1 X1 Y1 E0\nG1 X2 E1\nG1 X3 E1\nM84\n")
    assert found.prepended == "G92 E0\nG1 X1 Y1 E0\n"
    assert found.appended == "G1 X3 E1\nM84\n"


def test_relative_extrusion_and_retractions_at_the_end(read) -> None:
    found = read("M83\nG1 E5\nG1 X1 E0.1\nG1 X2 E0.1\nG1 X0 E-2\nG1 E-1\nM84\n")
    assert found.prepended == "M83\nG1 E5\n"
    assert found.appended == "G1 X0 E-2\nG1 E-1\nM84\n"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("G28\nSTART\nG1 X1 E1\n", r"line 2: a line END is missing"),
        ("G28\nG1 X1 E1\nEND\n", r"line 3: a line START is missing"),
        ("END\nG28\nSTART\n", r"line 1: END comes before START \(line 3\)"),
        ("G28\nM84\n", "neither START and END markers nor a move that extrudes"),
        ("", "neither START"),
        ("G28\n; größer\n".encode(), "line 2: this is not plain ASCII"),
        (b"G28\nM84\n\0\0", "line 3: this is not plain ASCII"),
    ],
)
def test_files_that_are_no_example(read, content: str | bytes, message: str) -> None:
    with pytest.raises(FormatError, match=message):
        read(content)


def test_stored_as_a_profile(read, tmp_path: Path) -> None:
    found = read('M117 {"a"}\nSTART\nEND\nM84 \\\n')
    file = tmp_path / "mine.toml"
    file.write_text(template_profile(found, "example.gcode"), encoding="utf-8")
    options = PrintSettings(**read_profile(str(file)))
    assert filled(options.start_gcode, "start_gcode", options, Totals()) == 'M117 {"a"}\n'
    assert filled(options.end_gcode, "end_gcode", options, Totals()) == "M84 \\\n"
