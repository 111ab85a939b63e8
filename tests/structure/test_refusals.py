"""What a foam cannot be made of, in words that say where and what to do."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tests.structure.test_fill import SQUARE, foam, stack
from v3dcad import FillSettings, GeometryError, Section, SettingError, fill_sections
from v3dcad.model import Floats
from v3dcad.structure.foam import uniform

PART = stack((SQUARE,), 12)


@pytest.mark.parametrize("stretch", ["auto", "columns"])
def test_cells_larger_than_the_part(stretch: str) -> None:
    with pytest.raises(SettingError, match=r"cell_size 16\.1: larger than the part") as caught:
        fill_sections(PART, None, FillSettings(cell_size=16.1, stretch=stretch))
    assert caught.value.name == "cell_size"
    fill_sections(PART, None, FillSettings(cell_size=15.9, stretch=stretch))


@pytest.mark.parametrize("limit", [10.0, 30.0, 45.0, 80.0, 90.0])
@pytest.mark.parametrize("size", [(1.0, 1, 2.4), (0.1, 0.1, 50), (300, 200, 0.2), (3, 4, 5)])
def test_an_automatic_size_always_fits(size: tuple[float, float, float], limit: float) -> None:
    sections = [Section(z, (SQUARE / 16 * size[:2],)) for z in np.linspace(0, size[2], 3)[:2]]
    filling = fill_sections(sections, None, FillSettings(max_overhang=limit))
    assert len(filling.layers[1].diagram.sites()) > 0


def test_cells_that_the_grid_does_not_resolve() -> None:
    long = [Section(0.2 * k, (SQUARE * [100, 1],)) for k in range(3)]
    with pytest.raises(SettingError, match=r"cell_size 0\.05: the grid") as caught:
        fill_sections(long, None, FillSettings(cell_size=0.05))
    least = float(re.findall(r"cells; ([0-9.]+) mm are the least", str(caught.value))[0])
    with pytest.raises(SettingError, match="grid"):
        fill_sections(long, None, FillSettings(cell_size=least * 0.95))
    fill_sections(long, None, FillSettings(cell_size=least * 1.05))


@pytest.mark.parametrize("stretch", ["auto", "columns"])
def test_more_cells_than_memory_holds(stretch: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(uniform, "MOST", 100)
    with pytest.raises(SettingError, match=r"[0-9,]+ cells are more than memory holds \(100\)"):
        fill_sections(PART, None, FillSettings(cell_size=1.0, stretch=stretch))


def test_a_stretch_below_what_the_overhang_needs() -> None:
    with pytest.raises(SettingError, match="walls would lean more than 30°") as caught:
        fill_sections(PART, None, FillSettings(stretch=1.5, max_overhang=30.0))
    assert caught.value.name == "stretch"
    least = float(re.findall(r"at least ([0-9.]+)", str(caught.value))[0])
    with pytest.raises(SettingError):
        fill_sections(PART, None, FillSettings(stretch=least * 0.99, max_overhang=30.0))
    fill_sections(PART, None, FillSettings(stretch=least * 1.01, max_overhang=30.0))


@pytest.mark.parametrize(
    "settings", [{"sites": 50}, {"offset": 1.0}, {"interpolate": True}, {"weight_step": 0.1}]
)
def test_settings_of_the_thesis(settings: dict[str, float]) -> None:
    with pytest.raises(SettingError, match="a setting of method thesis"):
        FillSettings(**settings)


@pytest.mark.parametrize("settings", [{"cell_size": 5.0}, {"stretch": 2.0}])
def test_settings_of_the_foam(settings: dict[str, float]) -> None:
    with pytest.raises(SettingError, match="a setting of method foam"):
        FillSettings(method="thesis", **settings)


STEEP = np.array([[4.0, 4, 0], [12, 12, 0], [6, 4, 4]])
"""Sites 0 and 2 are 4.47 mm apart, and 4 of these upward."""


def test_given_sites_whose_wall_leans_too_much() -> None:
    with pytest.raises(
        SettingError, match=r"the wall between sites 0 and 2 leans 63.43°"
    ) as caught:
        foam(PART, STEEP, max_overhang=63.43)
    assert caught.value.name == "max_overhang"
    foam(PART, STEEP, max_overhang=63.44)
    foam(PART, STEEP, max_overhang=26.57, stretch=2.0)


def test_one_site_above_another_has_a_flat_wall() -> None:
    twins = np.array([[4.0, 4, 0], [4, 4, 4]])
    with pytest.raises(SettingError, match=r"sites 0 and 1 leans 90°"):
        foam(PART, twins, max_overhang=80.0)
    layers = foam(PART, twins).layers
    assert [layer.diagram.sites().tolist() for layer in layers] == [[0]] * 5 + [[1]] * 7


def test_a_wall_outside_the_part_may_lean() -> None:
    above = np.array([[4.0, 4, 0], [12, 12, 0], [8, 8, 90]])
    foam(PART, above, max_overhang=10.0)


def test_sites_in_space_need_a_stretch() -> None:
    with pytest.raises(SettingError, match="stretch auto: sites in space need a number"):
        foam(PART, STEEP, stretch="auto")


@pytest.mark.parametrize("shape", [(4, 1), (4, 4), (4,), (2, 2, 3)])
def test_sites_of_another_shape(shape: tuple[int, ...]) -> None:
    with pytest.raises(SettingError, match="give rows of x, y, z, or of x, y for columns"):
        foam(PART, np.ones(shape))


@pytest.mark.parametrize("columns", [2, 3])
def test_no_sites(columns: int) -> None:
    with pytest.raises(GeometryError, match="give at least one"):
        foam(PART, np.empty((0, columns)))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_sites_that_are_no_numbers_are_named(value: float, axis: int) -> None:
    sites = np.ones((3, 3)) * [[1], [2], [3]]
    sites[1, axis] = value
    with pytest.raises(GeometryError, match="finite") as caught:
        foam(PART, sites)
    assert caught.value.site == 1


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_far_site_is_named_and_a_nearer_one_is_not(axis: int) -> None:
    sites = np.ones((2, 3))
    sites[1, axis] = 1e6
    with pytest.raises(GeometryError, match=r"site 1: .* mm is more than 1600 mm outside the part"):
        foam(PART, sites)
    sites[1, axis] = -1000
    foam(PART, sites)


def test_sites_that_lie_on_others_are_merged_with_a_warning() -> None:
    sites = np.array([[1.0, 1, 0], [2, 2, 0], [1, 1, 0], [2, 2, 1e-9], [8, 3, 0]])
    with pytest.warns(UserWarning, match="2 of 5 sites lie on others"):
        filling = foam(PART, sites)
    assert len(filling.sites) == 3
    with pytest.warns(UserWarning, match="2 of 5 sites lie on others"):
        filling = foam(PART, sites[:, :2])
    assert filling.settings.stretch == "columns"


CROSSED = np.array([[0.0, 0], [10, 10], [10, 0], [0, 9]])


@pytest.mark.parametrize("ring", [CROSSED, SQUARE[::-1], SQUARE * [[np.nan], [1], [1], [1]]])
@pytest.mark.parametrize("method", ["foam", "thesis"])
def test_faulty_sections_are_named(ring: Floats, method: str) -> None:
    sections = stack((SQUARE,), 6)
    sections[4] = Section(2.0, (ring,))
    with pytest.raises(GeometryError, match="layer 4"):
        list(fill_sections(sections, None, FillSettings(method=method)).layers)


def test_sections_that_cannot_be() -> None:
    for sections, words in [
        ([Section(-1.0, (SQUARE,))], "layer 0: it lies below z = 0"),
        ([Section(0.0, (SQUARE[:2],))], "layer 0: one of its rings has fewer than three"),
        ([Section(0.0, (np.empty((0, 2)),))], "layer 0: one of its rings has fewer than three"),
        ([PART[0], PART[0]], "layer 1: it does not lie above the layer before"),
        ([PART[0], Section(np.nan, (SQUARE,))], "layer 1: its height is not a finite number"),
        ([], "no section has a ring"),
        ([Section(0.0, ()), Section(1.0, ())], "no section has a ring"),
    ]:
        with pytest.raises(GeometryError, match=words):
            fill_sections(sections, None, FillSettings())
    with pytest.raises(GeometryError, match="base rectangle are not finite"):
        fill_sections(PART, None, FillSettings(), np.array([[0.0, 0], [np.nan, 1]]))


def test_what_cannot_be_asked_for() -> None:
    filling = foam(PART, STEEP)
    for z in (-0.01, 6.01, 1e9, -1e9, 1e300):
        with pytest.raises(GeometryError, match=r"outside the foam: give a height from 0 to 6 mm"):
            filling.at(z)
    for z in (np.nan, np.inf):
        with pytest.raises(GeometryError, match="not a finite number"):
            filling.at(z)
    for ring, words in [
        (np.empty((0, 2)), "fewer than three"),
        (SQUARE[:2], "fewer than three"),
        (SQUARE * np.nan, "finite"),
    ]:
        with pytest.raises(GeometryError, match=words):
            filling.at(0.3, Section(0.3, (SQUARE, ring)))
    for point in ((0, 0, np.nan), (np.inf, 0, 0)):
        with pytest.raises(GeometryError, match="finite"):
            filling.sites_at(np.array([(0.0, 0, 0.2), point]))
    assert filling.at(6.0).areas(3).sum() == pytest.approx(256)
