"""What a fill takes is told before, and refused where there is no room."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from v3dcad.commands import estimate
from v3dcad.commands.estimate import Estimate, estimated, tell
from v3dcad.errors import SettingError
from v3dcad.settings import FillSettings

BOX = np.array([[0.0, 0, 0], [60, 40, 20]])


def test_layers_and_cells_are_those_of_the_box() -> None:
    found = estimated(BOX, FillSettings(layer_height=0.5, cell_size=2.0))
    assert found == Estimate(layers=40, cells=600)
    assert estimated(BOX, FillSettings(method="thesis", sites=7)) == Estimate(100, 7)
    auto = estimated(BOX, FillSettings())
    assert auto is not None
    assert auto.cells == pytest.approx(40)
    assert estimated(BOX, FillSettings(cell_size="4 + x")) is None
    assert estimated(BOX, FillSettings(roof_size=5.0)) is None


@pytest.mark.parametrize("layer_height", [1e-9, 1e-300])
def test_layers_without_number_are_refused(layer_height: float) -> None:
    with pytest.raises(SettingError, match=r"layers, more than 1,000,000; give at least 2e-05"):
        estimated(BOX, FillSettings(layer_height=layer_height))


def test_little_is_not_told_and_much_is(capsys: pytest.CaptureFixture[str]) -> None:
    tell(Estimate(100, 40), None)
    assert capsys.readouterr().err == ""
    tell(Estimate(10_000, 100), Path("/dev/null"))
    said = capsys.readouterr().err
    assert said.startswith("v3dcad: 10,000 layers of up to 100 cells: up to about 12 min, ")
    assert said.endswith(" MB of G-code\n")


def test_what_has_no_room_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    many = Estimate(1_000_000, 20_000)
    monkeypatch.setattr(estimate, "_memory", lambda: 8_000_000_000)
    with pytest.raises(SettingError, match=r"1,003 GB of memory, of which there are 8 GB; take"):
        tell(many, None)
    monkeypatch.setattr(estimate, "_memory", lambda: None)
    monkeypatch.setattr(estimate, "_room", lambda file: 1_000_000)
    with pytest.raises(SettingError, match="but 1 MB are free; make room there, take"):
        tell(many, tmp_path / "a.gcode")


def test_room_is_that_of_the_folder_to_come(tmp_path: Path) -> None:
    room = estimate._room(tmp_path / "to" / "come" / "a.gcode")
    assert room is not None
    assert room > 0
    assert estimate._room(Path("/dev/null")) is None
