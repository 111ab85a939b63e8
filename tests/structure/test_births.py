"""Births where holes tie: what climbs from layer to layer stays what each layer is by itself."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from v3dcad import FillSettings, GeometryError, Section, fill_sections
from v3dcad.model import Floats

BLOCK = np.array([[-20.0, -20], [20, -20], [20, 20], [-20, 20]])


def block(layers: int) -> list[Section]:
    return [Section(0.2 * layer, (BLOCK,)) for layer in range(layers)]


def lattice(count: int, pitch: float, skew: float) -> Floats:
    """Rows of sites, every second one moved: all holes of a row are as large."""
    row, column = np.divmod(np.arange(count * count), count)
    middle = (count - 1) / 2
    shifted = column - middle + skew * (row % 2)
    return np.column_stack([shifted, 0.875 * (row - middle)]) * pitch


def scatter(seed: int) -> Floats:
    rng = np.random.default_rng(seed)
    return rng.uniform(-20, 20, (int(rng.integers(20, 80)), 2))


CASES = [
    (lattice(10, 4.0, 0.5), 3.2),
    (lattice(7, 5.5, 0.5), 0.7),
    (lattice(6, 6.0, 0.0), 4.0),
    (scatter(71), 17.78729178849272),
    (scatter(90), 5.652906300209881),
]


@pytest.mark.parametrize(("sites", "offset"), CASES)
def test_layers_with_births_are_what_they_are_by_themselves(sites: Floats, offset: float) -> None:
    settings = FillSettings(offset=offset, max_overhang=90.0)
    filling = fill_sections(block(60), sites, settings)
    layers = list(filling.layers)
    assert len(filling.births) > 5
    for layer in layers:
        count = len(layer.state.sites)
        alone = filling.at(layer.z, layer.section).areas(count)
        np.testing.assert_allclose(layer.diagram.areas(count), alone, atol=1e-6)


@pytest.mark.parametrize(("sites", "offset"), CASES)
def test_no_newborn_lies_where_a_dead_site_lay(sites: Floats, offset: float) -> None:
    filling = fill_sections(block(60), sites, FillSettings(offset=offset, max_overhang=90.0))
    places = list(filling.layers)[-1].state.sites
    assert len(np.unique(places, axis=0)) == len(places)


@given(st.integers(0, 10**6))
def test_scattered_births_are_what_they_are_by_themselves(seed: int) -> None:
    filling = fill_sections(block(20), scatter(seed), FillSettings(offset=8.0, max_overhang=90.0))
    top = list(filling.layers)[-1]
    count = len(top.state.sites)
    alone = filling.at(top.z, top.section).areas(count)
    np.testing.assert_allclose(top.diagram.areas(count), alone, atol=1e-6)


def test_weights_beyond_the_safe_range_are_refused_at_any_height() -> None:
    sites = scatter(1)
    with pytest.raises(GeometryError, match="safe range"):
        fill_sections(block(3), sites, FillSettings(offset=1e15, max_overhang=90.0))
    filling = fill_sections(block(3), sites, FillSettings())
    for height in (1e9, -1e9):
        with pytest.raises(GeometryError, match="safe range"):
            filling.at(height)
    for height in (np.nan, np.inf):
        with pytest.raises(GeometryError, match="not a finite number"):
            filling.at(height)


def test_a_far_site_is_named_and_a_nearer_one_is_not() -> None:
    with pytest.raises(GeometryError, match=r"site 1: \(1e\+06, 0\) mm is more than 4000 mm"):
        fill_sections(block(2), np.array([[0.0, 0], [1e6, 0]]), FillSettings())
    fill_sections(block(2), np.array([[0.0, 0], [1000, 0]]), FillSettings())


def test_sections_below_the_bed_and_rings_without_area_are_refused() -> None:
    with pytest.raises(GeometryError, match="layer 0: it lies below z = 0"):
        fill_sections([Section(-1.0, (BLOCK,))], scatter(1), FillSettings())
    with pytest.raises(GeometryError, match="layer 0: one of its rings has fewer than three"):
        fill_sections([Section(0.0, (BLOCK[:2],))], scatter(1), FillSettings())
    with pytest.raises(GeometryError, match="layer 0: one of its rings has fewer than three"):
        fill_sections([Section(0.0, (np.empty((0, 2)),))], scatter(1), FillSettings())


def test_what_cannot_be_asked_for_is_refused() -> None:
    filling = fill_sections(block(3), scatter(8), FillSettings())
    for ring, words in [
        (np.empty((0, 2)), "fewer than three"),
        (BLOCK[:2], "fewer than three"),
        (BLOCK * np.nan, "finite"),
        (BLOCK * np.inf, "finite"),
    ]:
        with pytest.raises(GeometryError, match=words):
            filling.at(0.3, Section(0.3, (BLOCK, ring)))
    box = np.array([[-20.0, -20], [20, 20]])
    with pytest.raises(GeometryError, match="layer 1: its rings are not finite"):
        fill_sections([*block(1), Section(1.0, (BLOCK * np.nan,))], scatter(8), FillSettings(), box)
    with pytest.raises(GeometryError, match="base rectangle are not finite"):
        fill_sections(block(3), scatter(8), FillSettings(), box * np.nan)
    for point, words in [
        ((0, 0, np.nan), "finite"),
        ((np.inf, 0, 0), "finite"),
        ((0, 0, 1e12), "safe range"),
    ]:
        with pytest.raises(GeometryError, match=words):
            filling.sites_at(np.array([(0.0, 0, 0.2), point]))


def test_births_take_no_more_room_than_there_are_holes_for_them() -> None:
    """A part that stands on a blade asks for more cells at once than can be born."""
    sites = np.random.default_rng(5).uniform(-20, 20, (2000, 2))
    sections = [Section(0.0, (BLOCK * [1, 1 / 1600],)), Section(0.4, (BLOCK,))]
    tracemalloc.start()
    try:
        foot, above = fill_sections(sections, sites, FillSettings()).layers
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert 1600 / foot.area_per_cell > 100_000
    assert 2100 < len(above.state.sites) < 6000  # a triangulation has less than two holes a site
    assert peak < 1 << 26, "beside the 31 MiB that are let go of at once"


@pytest.mark.parametrize("tip", [1e-7, 1e-3, 0.1])
def test_a_part_on_a_tip_grows_as_one_on_a_point_does(tip: float) -> None:
    """Where the foot is smaller than a cell its cells are no measure, as where there are none."""
    above = [Section(0.4 * k, (BLOCK * min(1.0, 0.2 * k),)) for k in range(1, 9)]
    point = fill_sections([Section(0.0, ()), *above], scatter(60), FillSettings())
    found = fill_sections([Section(0.0, (BLOCK * tip,)), *above], scatter(60), FillSettings())
    assert len(found.births) == len(point.births) > 0
    np.testing.assert_array_equal(found.births, point.births)
