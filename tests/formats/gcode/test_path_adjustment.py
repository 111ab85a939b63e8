from __future__ import annotations

import pytest

from v3dcad.errors import SettingError
from v3dcad.formats.gcode.path_adjustment import Adjusted, adjust

FIGURE_3_26 = """\
G92 E0
G1 X160.97 Y188.337 E0.10286 F600
G1 X160.97 Y188.337 Z0.25 F3000
G92 E0
G1 X149.119 Y183.762 E1.22219 F600
G1 X149.119 Y183.762 Z0.25 F3000
G92 E0
G1 X149.119 Y183.762 Z3.25 E0.28863 F600 ;target line
G1 X160.97 Y188.337 E1.51082
G1 X160.97 Y188.337 Z0.25 E1.79946
G1 X160.97 Y188.337 Z0.25 F3000
G92 E0"""

# By hand: lines 3 and 6 go where the nozzle is and do not extrude; line 8 rises from 0.25 to
# 3.25, so line 7 gets its E and lines 8, 9, 10 go; line 11 comes after a line without X and Y.
BY_HAND = """\
G92 E0
G1 X160.97 Y188.337 E0.10286 F600
G92 E0
G1 X149.119 Y183.762 E1.22219 F600
G92 E-1
G1 X160.97 Y188.337 Z0.25 F3000
G92 E0"""


def adjusted(text: str, retraction: float = 1.0) -> str:
    return "\n".join(adjust(text.splitlines(), retraction))


def test_the_segment_of_figure_3_26() -> None:
    counted = Adjusted()
    found = list(adjust(FIGURE_3_26.splitlines(), 1.0, counted))
    assert "\n".join(found) == BY_HAND
    assert (counted.hops, counted.retractions, counted.still) == (1, 1, 2)


def test_the_form_of_figure_3_28() -> None:
    # Its lines: extrude, G92 E-1, travel with Z and F, G92 E0, extrude.
    kinds = [
        ("E" if " E" in line and line.startswith("G1") else line.split(" F")[0].split(" X")[0])
        for line in BY_HAND.splitlines()[3:]
    ]
    assert kinds == ["E", "G92 E-1", "G1", "G92 E0"]


def test_an_adjusted_file_stays_as_it_is() -> None:
    assert adjusted(BY_HAND) == BY_HAND


@pytest.mark.parametrize(("retraction", "word"), [(2.5, "G92 E-2.5"), (0.0, "G92 E0")])
def test_the_retraction_asked_for(retraction: float, word: str) -> None:
    assert word in adjusted(FIGURE_3_26, retraction).splitlines()[4:5]


def test_a_rise_of_one_layer_or_one_mm_stays() -> None:
    text = "G1 X1 Y1 Z0.2 F600\nG1 X2 Y1 E1\nG1 X2 Y2 Z1.2 F600\nG1 X3 Y2 E2"
    assert adjusted(text) == text


def test_a_hop_after_a_line_without_extrusion_sets_none() -> None:
    counted = Adjusted()
    text = "G1 X1 Y1 Z0.2 F600\nG1 X5 Y1 Z3.2\na\nb\nG1 X9 Y9 E1"
    found = list(adjust(text.splitlines(), 1.0, counted))
    assert found == ["G1 X1 Y1 Z0.2 F600", "G1 X9 Y9 E1"]
    assert (counted.hops, counted.retractions) == (1, 0)


def test_other_commands_and_comments_pass() -> None:
    text = "M104 S200\nG10\n;Z9\nG1 F600\nG28 Z\nG11 Z5\nG1 X1 ; E5 Z9\nG1 Y2 E1"
    assert adjusted(text) == text


def test_a_hop_of_the_last_lines() -> None:
    assert adjusted("G1 Z0.2\nG92 E0\nG1 Z5") == "G1 Z0.2\nG92 E-1"


def test_nothing_in_nothing_out() -> None:
    assert adjusted("") == ""


@pytest.mark.parametrize("retraction", [-1.0, 51.0, float("nan")])
def test_retraction_in_range(retraction: float) -> None:
    with pytest.raises(SettingError, match="retraction"):
        adjusted("G28", retraction)
