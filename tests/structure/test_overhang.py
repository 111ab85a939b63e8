"""The certificate against points sampled on the walls."""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from v3dcad import FillSettings, Section, fill_sections
from v3dcad.errors import GeometryError, SettingError
from v3dcad.geometry.section_area import section_area
from v3dcad.model import Floats, Layer
from v3dcad.structure.growth import largest_offset
from v3dcad.structure.overhang import overhang

SQUARE = np.array([[-20.0, -20], [20, -20], [20, 20], [-20, 20]])
HOLE = np.array([[-6.0, -5], [-5, 7], [6, 5], [5, -6]])


def sampled(layer: Layer, below: Layer) -> Floats:
    """Distances of points on a layer's walls, over the section below, to what lies below."""
    diagram = below.diagram
    lines = shapely.multilinestrings(list(diagram.vertices[diagram.edges]))
    shapely.prepare(lines)
    start, stop = np.moveaxis(layer.diagram.vertices[layer.diagram.edges], 1, 0)
    t = np.linspace(0, 1, 201)[:, None, None]
    points = ((1 - t) * start + t * stop)[:, layer.diagram.inner()].reshape(-1, 2)
    area = section_area(below.section)
    shapely.prepare(area)
    return shapely.distance(lines, shapely.points(points))[shapely.contains_xy(area, points)]


@settings(max_examples=20)
@given(
    st.integers(2, 40),
    st.integers(0, 1000),
    st.floats(0.05, 2),
    st.floats(0.9, 1.1),
    st.sampled_from([(20, 0), (3, 20), (0.5, 0), (0.5, 20), (0.5, 200)]),
)
def test_no_wall_is_farther_than_the_certificate_says(
    count: int, seed: int, offset: float, scale: float, place: tuple[float, float]
) -> None:
    """Sites all over the section or all in its middle, layers from the base or high above it."""
    reach, base = place
    sites = np.random.default_rng(seed).uniform(-reach, reach, (count, 2)) + np.array([8.0, 0.0])
    sections = [Section(base + 0.2 * k, (SQUARE * scale**k, HOLE * scale**k)) for k in range(5)]
    layers = list(
        fill_sections(sections, sites, FillSettings(offset=offset, max_overhang=90.0)).layers
    )
    certificate = overhang(layers, 0.8)
    for k, (below, layer) in enumerate(pairwise(layers), start=1):
        found = sampled(layer, below)
        assert found.max(initial=0) <= certificate.distance[k] + 1e-9
        # Samples lie up to 0.3 mm apart, and distance changes by no more than the way.
        assert certificate.distance[k] <= 1.02 * found.max(initial=0) + 0.15


def test_tilt_worked_by_hand() -> None:
    """Two sites 4 mm apart, one gains 0.2 mm² in 0.2 mm: the wall moves 1 / 8 of a height."""
    sites = np.array([[-2.0, 0], [2, 0]])
    sections = [Section(0.2 * k, (SQUARE,)) for k in range(3)]
    layers = list(fill_sections(sections, sites, FillSettings(offset=0.2)).layers)
    certificate = overhang(layers, 0.8)
    assert certificate.wall_tilt == pytest.approx(np.degrees(np.arctan(1 / 8)))
    assert certificate.distance[1:] == pytest.approx(0.2 / 8, rel=0.011)
    assert certificate.distance[0] == 0
    assert not certificate.unsupported.any()
    assert not certificate.strut_tilt.any()


def test_walls_farther_than_half_a_bead_are_measured() -> None:
    """The wall of two sites jumps 2.5 mm a layer; 40 mm of it are unsupported, 0.4 at each end
    being near a contour."""
    sites = np.array([[-2.0, 0], [2, 0]])
    sections = [Section(0.2 * k, (SQUARE,)) for k in range(3)]
    layers = list(
        fill_sections(sections, sites, FillSettings(offset=20.0, max_overhang=90.0)).layers
    )
    certificate = overhang(layers, 0.8)
    assert certificate.distance[1:] == pytest.approx(2.5, rel=0.011)
    assert certificate.unsupported[1:] == pytest.approx(40 - 0.8)


def test_walls_beyond_the_section_below_are_told_apart() -> None:
    sites = np.array([[-2.0, 0], [2, 0]])
    sections = [Section(0.0, (SQUARE,)), Section(0.2, (SQUARE * 1.5,))]
    layers = list(fill_sections(sections, sites, FillSettings(offset=0.0)).layers)
    certificate = overhang(layers, 0.8)
    assert certificate.outside.tolist() == pytest.approx([0, 20])
    assert certificate.distance[1] == 0
    assert certificate.unsupported[1] == 0


def test_over_nothing_all_walls_are_outside() -> None:
    sites = np.random.default_rng(0).uniform(-20, 20, (40, 2))
    sections = [Section(0.0, (SQUARE,)), Section(0.2, ()), Section(0.4, (SQUARE,))]
    layers = fill_sections(sections, sites, FillSettings()).layers
    certificate = overhang(layers, 0.8)
    diagram = layers[2].diagram
    walls = diagram.lengths()[diagram.inner()].sum()
    assert walls > 400
    assert certificate.outside.tolist() == pytest.approx([0, 0, walls])
    assert not certificate.distance.any()
    assert not certificate.unsupported.any()


@given(st.integers(6, 40), st.integers(0, 1000), st.floats(20, 80))
def test_the_largest_offset_is_the_largest(count: int, seed: int, limit: float) -> None:
    """With it no wall leans more than the limit; the wall that limits it leans just so."""
    sites = np.random.default_rng(seed).uniform(-20, 20, (count, 2))
    sections = [Section(0.2 * k, (SQUARE * 40,)) for k in range(4)]
    filling = fill_sections(sections, sites, FillSettings(max_overhang=limit))
    tilts = overhang(filling.layers, 0.8).wall_tilt
    with pytest.raises(SettingError, match="largest safe value"):
        fill_sections(
            sections,
            sites,
            FillSettings(max_overhang=limit, offset=1.001 * float(filling.settings.offset)),
        )
    assert tilts[0] == pytest.approx(limit)
    assert (tilts <= limit + 1e-9).all()


def prism(width: float, height: float, layer_height: float) -> list[Section]:
    count = round(height / layer_height)
    return [Section(layer_height * k, (SQUARE * width / 40,)) for k in range(count)]


@pytest.mark.parametrize("count", [2, 8, 40])
@pytest.mark.parametrize(
    ("width", "height"), [(10, 150), (5, 500), (40, 12), (1e-4, 1e-4), (1e-4, 5e-3)]
)
@pytest.mark.parametrize("limit", [1.0, 45.0, 89.9, 90.0])
def test_auto_fits_every_part(count: int, width: float, height: float, limit: float) -> None:
    """It keeps the limit, and is the largest that does unless 64 bits do not hold the weights."""
    sites = np.random.default_rng(count).uniform(-0.5, 0.5, (count, 2)) * width
    sections = prism(width, height, min(0.2, height / 8))
    layer_height = sections[1].z
    filling = fill_sections(
        sections, sites, FillSettings(max_overhang=limit, layer_height=layer_height)
    )
    first, last = filling.layers[0], filling.layers[-1]
    # The limit's wall is there at the base if anywhere; what a newborn leans is for other tests.
    leans = float(overhang([first], 0.8).wall_tilt[0])
    assert leans <= (limit if limit < 90 else 45) + 1e-9
    heaviest = 2**61 * (width / 2**24) ** 2
    assert abs(last.state.weights).max() <= heaviest
    offset = float(filling.settings.offset)
    largest = largest_offset(
        filling.sites, first.state.growth > 0, layer_height, limit if limit < 90 else 45
    )
    half = heaviest / 2 / (len(sections) - 1)
    assert offset == pytest.approx(min(largest, half), rel=1e-6)


@pytest.mark.parametrize(("width", "height"), [(40.0, 12.0), (1e-4, 1e-4), (10.0, 150.0)])
@pytest.mark.parametrize("limit", [45.0, 90.0])
def test_the_value_that_a_refusal_names_is_accepted(
    width: float, height: float, limit: float
) -> None:
    sites = np.random.default_rng(1).uniform(-0.5, 0.5, (9, 2)) * width
    sections = prism(width, height, height / 60)
    given_settings = {"max_overhang": limit, "layer_height": height / 60}
    with pytest.raises((SettingError, GeometryError)) as caught:
        fill_sections(sections, sites, FillSettings(offset=1e6, **given_settings))
    (named,) = re.findall(r"(?:value is|at most) ([0-9.e+-]*[0-9])", str(caught.value))
    assert float(named) > 0
    fill_sections(sections, sites, FillSettings(offset=float(named), **given_settings))
    with pytest.raises((SettingError, GeometryError)):
        fill_sections(sections, sites, FillSettings(offset=1.0001 * float(named), **given_settings))


def test_ninety_degrees_or_one_kind_of_site_set_no_limit() -> None:
    sites = np.array([[0.0, 0], [1, 0]])
    assert largest_offset(sites, np.array([True, False]), 0.2, 90) == np.inf
    assert largest_offset(sites, np.array([False, False]), 0.2, 45) == np.inf


def test_struts_lean_as_their_axes_do() -> None:
    """Per layer, the largest tilt is that of the axes (from the kinetic log) that pass it."""
    sites = np.random.default_rng(5).uniform(-20, 20, (30, 2))
    sections = [Section(0.2 * k, (SQUARE * 1.2,)) for k in range(20)]
    filling = fill_sections(sections, sites, FillSettings(offset=0.3, max_overhang=90.0))
    certificate = overhang(filling.layers, 0.8)
    axes = filling.strut_axes
    (low, high), tilts = axes.ends[:, :, 2].T, axes.tilts()
    for layer in filling.layers:
        passing = (low < layer.z - 1e-9) & (high > layer.z + 1e-9)
        if layer.index in (0, len(sections) - 1) or not passing.any():
            continue
        assert certificate.strut_tilt[layer.index] == pytest.approx(tilts[passing].max(), abs=1e-3)
