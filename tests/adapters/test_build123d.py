"""`VoronoiFill` as build123d's own objects behave."""

from __future__ import annotations

import subprocess
import sys

import pytest
from build123d import Box, BuildPart, Color, Locations, Mode, Pos

from v3dcad.adapters.build123d import VoronoiFill
from v3dcad.errors import SettingError

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore:.* cells are wide. they close up"),
]

SETTINGS = {"cell_size": 8.0, "layer_height": 1.0}


def test_lies_where_its_source_lies_and_keeps_label_and_colour() -> None:
    block = Pos(10, 20, 30) * Box(30, 30, 20)
    block.label, block.color = "block", Color("red")
    filled = VoronoiFill(block, "solid", thickness=1, **SETTINGS)
    assert filled.label == "block"
    assert tuple(filled.color) == tuple(block.color)
    assert tuple(filled.bounding_box().min) == pytest.approx((-5, 5, 20), abs=1e-6)
    assert tuple(filled.bounding_box().max) == pytest.approx((25, 35, 40), abs=1e-6)
    cells = VoronoiFill(block, "cells", **SETTINGS)
    assert len(cells.solids()) == len(cells.structure.cells())
    assert cells.volume == pytest.approx(block.volume, rel=1e-8)
    rest = block - cells
    assert rest.volume == pytest.approx(0, abs=1e-4)


def test_a_builder_is_filled() -> None:
    with BuildPart() as built:
        Box(20, 20, 10)
        VoronoiFill(thickness=0.8, **SETTINGS)
    alone = VoronoiFill(Box(20, 20, 10), thickness=0.8, **SETTINGS)
    assert built.part.volume == pytest.approx(alone.volume, rel=1e-9)


def test_locations_and_mode_are_respected() -> None:
    cube = Box(20, 20, 20)
    with BuildPart() as block:
        Box(100, 100, 21)
        with Locations((-30, 0, 0), (30, 0, 0)):
            VoronoiFill(cube, "cells", mode=Mode.SUBTRACT, **SETTINGS)
    assert block.part.volume == pytest.approx(100 * 100 * 21 - 2 * 20**3, rel=1e-9)
    with BuildPart() as untouched:
        Box(10, 10, 10)
        VoronoiFill(cube, "cells", mode=Mode.PRIVATE, **SETTINGS)
    assert untouched.part.volume == pytest.approx(1000)


def test_mistakes_are_named() -> None:
    with pytest.raises(SettingError, match="needs a part"):
        VoronoiFill()
    with pytest.raises(SettingError, match="solid needs a thickness"):
        VoronoiFill(Box(9, 9, 9))
    with pytest.raises(SettingError, match="form 'foam'"):
        VoronoiFill(Box(9, 9, 9), "foam")


@pytest.mark.parametrize(
    ("library", "line"),
    [("build123d", "pip install 'v3dcad[build123d]'"), ("cadquery", "'v3dcad[cadquery]'")],
)
def test_a_missing_library_is_named_with_the_pip_line(library: str, line: str) -> None:
    code = (
        f"import sys; sys.modules[{library!r}] = None\n"
        f"try:\n    import v3dcad.adapters.{library}\n"
        "except ImportError as error: print(error)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, encoding="utf-8", check=True
    )
    assert line in done.stdout
