"""The certificate against points sampled on the walls."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from v3dcad import FillSettings, Section, fill_sections
from v3dcad.geometry.section_area import section_area
from v3dcad.model import Floats, Layer
from v3dcad.structure.overhang import SLACK, overhang

pytestmark = pytest.mark.slow

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
    st.floats(0.0, 8),
    st.floats(0.9, 1.1),
    st.sampled_from([(20, 0), (3, 20), (0.5, 0), (0.5, 20), (0.5, 200)]),
)
def test_no_wall_is_farther_than_the_certificate_says(
    count: int, seed: int, rise: float, scale: float, place: tuple[float, float]
) -> None:
    """Sites all over the section or all in its middle, layers from the base or high above it."""
    reach, base = place
    flat = np.random.default_rng(seed).uniform(-reach, reach, (count, 2)) + np.array([8.0, 0.0])
    high = base + np.random.default_rng(seed + 1).uniform(-rise, rise, count)
    sites = np.column_stack([flat, high])
    sections = [Section(base + 0.2 * k, (SQUARE * scale**k, HOLE * scale**k)) for k in range(5)]
    layers = list(
        fill_sections(sections, sites, FillSettings(stretch=1.0, max_overhang=90.0)).layers
    )
    certificate = overhang(layers, 0.8)
    for k, (below, layer) in enumerate(pairwise(layers), start=1):
        found = sampled(layer, below)
        assert found.max(initial=0) <= certificate.distance[k] + 1e-9
        # Samples lie up to 0.3 mm apart, and distance changes by no more than the way.
        assert certificate.distance[k] <= 1.02 * found.max(initial=0) + 0.15


def test_tilt_worked_by_hand() -> None:
    """Two sites 4 mm apart, one 2 mm higher, heights doubled: the wall moves 1 / 8 of a height."""
    sites = np.array([[-2.0, 0, 0], [2, 0, 2]])
    sections = [Section(0.2 * k, (SQUARE,)) for k in range(3)]
    layers = list(fill_sections(sections, sites, FillSettings(stretch=2.0)).layers)
    certificate = overhang(layers, 0.8)
    assert certificate.wall_tilt == pytest.approx(np.degrees(np.arctan(1 / 8)), rel=1e-5)
    assert certificate.distance[1:] == pytest.approx(0.2 / 8, rel=0.011)
    assert certificate.distance[0] == 0
    assert not certificate.unsupported.any()
    assert not certificate.strut_tilt.any()


def test_walls_farther_than_half_a_bead_are_measured() -> None:
    """The wall of two sites jumps 2.5 mm a layer; 40 mm of it are unsupported, 0.4 at each end
    being near a contour."""
    sites = np.array([[-2.0, 0, -24.8], [2, 0, 25.2]])
    sections = [Section(0.2 * k, (SQUARE,)) for k in range(3)]
    layers = list(
        fill_sections(sections, sites, FillSettings(stretch=1.0, max_overhang=90.0)).layers
    )
    certificate = overhang(layers, 0.8)
    assert certificate.distance[1:] == pytest.approx(2.5, rel=0.011)
    assert certificate.unsupported[1:] == pytest.approx(40 - 0.8)


def test_walls_beyond_the_section_below_are_told_apart() -> None:
    sites = np.array([[-2.0, 0], [2, 0]])
    sections = [Section(0.0, (SQUARE,)), Section(0.2, (SQUARE * 1.5,))]
    layers = list(fill_sections(sections, sites, FillSettings()).layers)
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


def test_struts_lean_as_their_axes_do() -> None:
    """Per layer, the largest tilt is that of the axes in space that pass it."""
    sites = np.random.default_rng(5).uniform([-20, -20, -10], [20, 20, 10], (60, 3))
    sections = [Section(0.2 * k, (SQUARE,)) for k in range(20)]
    filling = fill_sections(sections, sites, FillSettings(stretch=1.5, max_overhang=90.0))
    certificate = overhang(filling.layers, 0.8)
    axes = filling.strut_axes
    (low, high), tilts = axes.ends[:, :, 2].T, axes.tilts()
    for layer in list(filling.layers)[1:-1]:
        passing = (low < layer.z) & (high > layer.z)
        assert certificate.strut_tilt[layer.index] == pytest.approx(tilts[passing].max(), abs=0.01)


@pytest.mark.parametrize(("limit", "seed"), [(20.0, 0), (45.0, 1), (60.0, 2)])
def test_every_wall_of_a_foam_rests_on_the_layer_below(limit: float, seed: int) -> None:
    """Within the layer's height times tan θ, where cells open and close too."""
    height = 0.25
    sections = [Section(height * k, (SQUARE,)) for k in range(40)]
    settings = FillSettings(
        cell_size=6.0, max_overhang=limit, random_seed=seed, layer_height=height
    )
    layers = list(fill_sections(sections, None, settings).layers)
    farthest = height * np.tan(np.radians(limit))
    certificate = overhang(layers, 0.8)
    assert certificate.wall_tilt.max() <= limit + 1e-9
    assert certificate.wall_tilt.max() > limit - 15
    assert certificate.distance.max() <= farthest * (1 + SLACK) + 1e-6
    for k, (below, layer) in enumerate(pairwise(layers), start=1):
        found = sampled(layer, below).max(initial=0)
        assert found <= farthest + 1e-6
        assert found <= certificate.distance[k] + 1e-9
    present = [len(np.setdiff1d(b.diagram.sites(), a.diagram.sites())) for a, b in pairwise(layers)]
    assert sum(present) > 10, "cells open"
