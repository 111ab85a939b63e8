from __future__ import annotations

import io
from pathlib import Path

import pytest
from diagrams import stack
from simulated_printer import Printer

from v3dcad.errors import FormatError
from v3dcad.formats.gcode.machine_profile import profile_names, profile_text, read_profile
from v3dcad.formats.gcode.writer import write_gcode
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.trace import trace


def test_profiles_that_come_along() -> None:
    assert profile_names() == [
        "bambu-p1",
        "ender3v2",
        "generic-klipper",
        "generic-marlin",
        "prusa-mk3s",
        "prusa-mk4",
        "thesis",
        "voron",
    ]
    machines = {PrintSettings(**read_profile(name)).machine for name in profile_names()}
    assert len(machines) == len(profile_names())


@pytest.mark.parametrize("name", profile_names())
def test_profiles_write_files_that_a_printer_can_obey(name: str) -> None:
    settings = PrintSettings(**read_profile(name))
    stream = io.StringIO()
    write_gcode(stream, trace(stack(3), settings), settings)
    text = stream.getvalue()
    assert f"; printer = {settings.machine}\n" in text
    printed = Printer().run(text).printing()
    assert {m.layer for m in printed} == {0, 1, 2}
    for axis, size in enumerate(settings.bed_size()):
        assert all(0 < m.stop[axis] < size for m in printed)
    assert settings.bead_width == (0.8 if name == "thesis" else 0.45)


def test_the_default_is_a_stock_machine() -> None:
    assert PrintSettings(**read_profile("ender3v2")) == PrintSettings()


def test_the_thesis_printer_has_its_table() -> None:
    # Table 3.2; the layer height is the structure's.
    table = {
        "first_layer_height": 0.2,
        "bead_width": 0.8,
        "print_speed": 10,
        "travel_speed": 50,
        "retraction": 0,
        "filament_diameter": 1.75,
        "flow": 100,
    }
    found = PrintSettings(**read_profile("thesis"))
    assert {name: getattr(found, name) for name in table} == table


def test_the_users_own_file(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(
        'bead_width = 1\nseam = "rear"\narcs = true\nperimeters = 2\n', encoding="utf-8"
    )
    assert read_profile(str(file)) == {
        "bead_width": 1.0,
        "seam": "rear",
        "arcs": True,
        "perimeters": 2,
    }


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"bead_width = \nflow = 1", r"not valid TOML: .*line 1"),
        (b"bead_with = 1", "bead_with is not a setting; did you mean bead_width?"),
        (b"zzz = 1", "zzz is not a setting; see"),
        (b"[printing]\nbed = 1", "printing is not a setting"),
        (b'bead_width = "wide"', "bead_width = 'wide': give a number"),
        (b"arcs = 1", "arcs = 1: give true or false"),
        (b"perimeters = 1.5", "perimeters = 1.5: give a whole number"),
        (b"perimeters = true", "perimeters = True: give a whole number"),
        (b"flow = -5", r"flow: flow -5.*at least 1 %"),
        (b"flow = inf", "give a finite number"),
        (b'seam = "spiral"', "seam: seam spiral: give"),
        (b'bed = "wide"', "write two lengths"),
        (b"flow = 1\n# \xff", "line 2: not UTF-8"),
        (b"#" * 1_000_001, "larger than 1 MB"),
    ],
)
def test_bad_content(tmp_path: Path, content: bytes, message: str) -> None:
    file = tmp_path / "mine.toml"
    file.write_bytes(content)
    with pytest.raises(FormatError, match=message) as caught:
        read_profile(str(file))
    assert caught.value.path == str(file)


def test_no_such_profile() -> None:
    with pytest.raises(FormatError, match=r"ender4: cannot be read .*or one of bambu-p1, ender3v2"):
        read_profile("ender4")


def test_a_profile_reads_back(tmp_path: Path) -> None:
    values = {
        "bead_width": 0.6,
        "perimeters": 3,
        "arcs": False,
        "seam": "rear",
        "bed": "100x100",
        "start_gcode": 'M117 "quoted" \\ back\n"""\nG28\n',
    }
    file = tmp_path / "mine.toml"
    file.write_text(profile_text(values, "mine"), encoding="utf-8")
    assert read_profile(str(file)) == values
