"""A density or a mass that is asked for is that of the G-code, read without v3dcad's own code."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gcode_reader import read_moves

import v3dcad
from v3dcad.errors import SettingError
from v3dcad.settings import FillSettings, PrintSettings

pytestmark = pytest.mark.slow

BRACKET = Path(__file__).parents[1] / "samples" / "bracket.step"
THIN: dict[str, Any] = {"bottom_layers": 2, "top_layers": 2, "perimeters": 1}


def part(name: str) -> tuple[Any, float]:
    """A part, and its volume by build123d, mm³."""
    from build123d import Box, Cylinder, Rectangle, Sphere, extrude, import_step

    made = {
        "cylinder": lambda: Cylinder(10, 24),
        "pyramid": lambda: extrude(Rectangle(40, 40), 24, taper=10),
        "bracket": lambda: import_step(BRACKET),
        "sphere": lambda: Sphere(12),
        "box": lambda: Box(30, 20, 16),
        "plate": lambda: Box(60, 45, 9),
    }[name]()
    return made, made.volume


def laid(path: Path, settings: PrintSettings) -> float:
    """Mm³ of filament in a G-code file, without prime line, skirt and brim."""
    text = path.read_text(encoding="utf-8")
    moves = read_moves(text)
    kept, of_part, row = np.zeros(len(moves.extruded), np.bool_), False, 0
    for line in text.splitlines():
        if line.startswith(";TYPE:"):
            of_part = line != ";TYPE:SKIRT"
        elif line.split(";")[0].split()[:1] in (["G0"], ["G1"]):
            kept[row], row = of_part, row + 1
    printing = moves.printing() & kept
    return float(moves.extruded[printing].sum()) * math.pi / 4 * settings.filament_diameter**2


@pytest.mark.parametrize(
    ("name", "density", "options"),
    [
        ("cylinder", 0.45, {}),
        ("cylinder", 0.3, THIN),
        ("cylinder", 0.25, {"wall_beads": 1}),
        ("pyramid", 0.3, {}),
        ("pyramid", 0.6, THIN),
        ("bracket", 0.4, {}),
        ("bracket", 0.6, {"open": True, "first_layer_height": 0.3}),
        ("sphere", 0.45, {"first_layer_flow": 120.0}),
        ("box", 0.55, {"bridge_flow": 70.0, "flow": 95.0}),
        ("plate", 0.4, {}),
        ("plate", 0.42, {"top_layers": 2, "bottom_layers": 2, "skin_span": 3.0}),
    ],
)
def test_the_density_is_that_of_the_gcode(
    name: str, density: float, options: dict[str, Any], tmp_path: Path
) -> None:
    source, volume = part(name)
    printing = PrintSettings(brim_width=0.0, **options)
    made = v3dcad.fill(source, density=density, printing=printing)
    made.write_gcode(tmp_path / "a.gcode", printing)
    assert laid(tmp_path / "a.gcode", printing) / volume == pytest.approx(density, rel=0.03)
    assert made.expected is not None
    assert made.expected.density == pytest.approx(density, rel=0.02)


@pytest.mark.parametrize("brim", [0.0, 8.0])
def test_the_mass_is_the_parts_own_by_the_filaments_density(brim: float, tmp_path: Path) -> None:
    source, _ = part("box")
    printing = PrintSettings(filament_density=1.04, brim_width=brim, skirt_loops=3)
    made = v3dcad.fill(source, mass=5.0, printing=printing)
    made.write_gcode(tmp_path / "a.gcode", printing)
    assert laid(tmp_path / "a.gcode", printing) * 1.04e-3 == pytest.approx(5.0, rel=0.03)
    assert made.expected is not None
    assert made.plastic(printing).mass == pytest.approx(made.expected.mass)


def test_the_structure_is_that_of_the_cell_size_that_was_found(tmp_path: Path) -> None:
    source, _ = part("box")
    made = v3dcad.fill(source, density="40%", layer_height=0.4)
    size = made.settings.cell_size
    assert (made.settings.density, made.settings.mass) == ("off", "off")
    again = v3dcad.fill(source, cell_size=size, layer_height=0.4)
    assert made.checksum() == again.checksum()
    assert v3dcad.fill(source, density=0.4, layer_height=0.4).settings == made.settings
    made.write_ont(tmp_path / "a.ont")
    text = (tmp_path / "a.ont").read_text(encoding="utf-8")
    assert "density" not in text
    # The file needs no print settings, whatever they are.
    other = PrintSettings(bead_width=0.6)
    assert v3dcad.fill(tmp_path / "a.ont", printing=other).checksum() == made.checksum()
    heavier = v3dcad.fill(tmp_path / "a.ont", density=0.5)
    assert heavier.settings.cell_size < size
    assert v3dcad.fill(tmp_path / "a.ont", density="off").settings.cell_size == size
    said = text.replace("cell_size =", "density = 0.4\ncell_size =")
    assert said != text
    (tmp_path / "b.ont").write_text(said, encoding="utf-8")
    with pytest.raises(v3dcad.FormatError, match="density stands for a cell size"):
        v3dcad.fill(tmp_path / "b.ont")


def test_graded_sites_get_a_density_of_their_own(tmp_path: Path) -> None:
    source, _ = part("box")
    made = v3dcad.fill(source, cell_size="3 + 0.2 * (z + 8)", layer_height=0.4)
    made.write_ont(tmp_path / "a.ont")
    even = v3dcad.fill(tmp_path / "a.ont", density=0.5)
    assert even.given is None

    from build123d import Box

    box, printing = Box(16, 16, 12), PrintSettings(brim_width=0.0, **THIN)
    under = v3dcad.fill(box, density=0.5, roof_size=4.0, layer_height=0.4, printing=printing)
    assert under.graded is not None
    under.write_gcode(tmp_path / "a.gcode", printing)
    found = laid(tmp_path / "a.gcode", printing) / (16 * 16 * 12)
    assert found == pytest.approx(0.5, rel=0.03)


@pytest.mark.parametrize(
    ("wish", "told"),
    [
        ({"density": 0.05}, r"density 0\.05: cannot be reached; .* skins alone are .*, take less"),
        ({"density": 1.0}, r"density 1: cannot be reached; cells of 30 mm give 0\.\d+, those of"),
        ({"mass": 100.0}, r"mass 100 g: cannot be reached; .* give \d\.\d+ g, those of .* g; "),
    ],
)
def test_what_cannot_be_reached_is_told_with_what_can(wish: dict[str, float], told: str) -> None:
    source, _ = part("box")
    with pytest.raises(SettingError, match=told) as raised:
        v3dcad.fill(source, layer_height=0.4, **wish)
    assert raised.value.name in wish


@pytest.mark.parametrize(
    ("settings", "name", "told"),
    [
        ({"density": 0.2, "cell_size": 5.0}, "density", "density: cell_size says how large cells"),
        ({"density": 0.2, "cell_size": "3 + x"}, "density", "density: cell_size says how large"),
        ({"density": 0.2, "mass": 5.0}, "mass", "mass: density says how large cells are"),
        ({"density": 15}, "density", "density 15: give a number of at most 1, which is 100%"),
        ({"density": 0}, "density", "density 0: give a number above 0"),
        (
            {"density": "150%"},
            "density",
            r"density 1\.5: give a number of at most 1, which is 100%",
        ),
        ({"density": "much"}, "density", "density 'much': give a number or off"),
        ({"density": "x%"}, "density", "density 'x%': give a number or off"),
        ({"mass": "5%"}, "mass", "mass '5%': give a number or off"),
        ({"mass": 5.0, "method": "thesis"}, "mass", "mass is a setting of method foam"),
    ],
)
def test_wishes_that_make_no_sense(settings: dict[str, Any], name: str, told: str) -> None:
    with pytest.raises(SettingError, match=told) as raised:
        FillSettings(**settings)
    assert raised.value.name == name


def test_sites_that_are_given_take_no_density() -> None:
    source, _ = part("box")
    with pytest.raises(SettingError, match=r"density 0\.2: sites are given"):
        v3dcad.fill(source, density=0.2, stretch=2, sites=[(0, 0, 0), (5, 5, 5)])
