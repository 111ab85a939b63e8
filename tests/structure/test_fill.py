"""Laws of a filled stack of sections, on made-up sections."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Voronoi

from v3dcad import FillSettings, Section, fill_sections
from v3dcad.errors import GeometryError
from v3dcad.model import Diagram, Floats

SQUARE = np.array([[-20.0, -20], [20, -20], [20, 20], [-20, 20]])
HOLE = np.array([[-6.0, -5], [-5, 7], [6, 5], [5, -6]])
ISLAND = np.array([[24.0, -3], [30, -3], [30, 3], [24, 3]])
WITH_ALL = (SQUARE, HOLE, ISLAND)


def area_of(section: Section) -> float:
    """By the shoelace formula, ring by ring."""
    total = 0.0
    for ring in section.rings:
        x, y = ring.T
        total += (x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    return total


def check_laws(diagram: Diagram, section: Section, sites: Floats, weights: Floats) -> None:
    areas = diagram.areas(len(sites))
    assert areas.sum() == pytest.approx(area_of(section), rel=1e-9)
    assert (areas > -1e-9 * area_of(section)).all()
    ends = np.sort(diagram.edges, axis=1)
    assert len(np.unique(ends, axis=0)) == len(ends), "an edge stands there twice"
    assert (diagram.edge_sites[:, 0] < diagram.edge_sites[:, 1]).all()
    inner = diagram.inner()
    for points in np.moveaxis(diagram.vertices[diagram.edges[inner]], 1, 0):
        power = ((points[:, None] - sites[None]) ** 2).sum(axis=2) - weights
        first, second = diagram.edge_sites[inner].T
        rows = np.arange(len(points))
        scale = np.abs(power).max(initial=1.0)
        assert np.abs(power[rows, first] - power[rows, second]).max(initial=0.0) <= 1e-9 * scale
        assert (power[rows, first] - power.min(axis=1)).max(initial=0.0) <= 1e-9 * scale
    rings = shapely.boundary(
        shapely.build_area(
            shapely.multilinestrings(
                [shapely.linestrings(np.vstack([ring, ring[:1]])) for ring in section.rings]
            )
        )
    )
    contour = diagram.lengths()[~inner].sum()
    assert contour == pytest.approx(rings.length, rel=1e-9)


@given(st.integers(1, 60), st.integers(0, 10_000), st.floats(0, 3))
def test_cells_tile_every_layer(count: int, seed: int, offset: float) -> None:
    sites = np.random.default_rng(seed).uniform(-20, 20, (count, 2))
    sections = [Section(0.2 * k, WITH_ALL) for k in (0, 1, 40)]
    for layer in fill_sections(sections, sites, FillSettings(offset=offset)).layers:
        check_laws(layer.diagram, layer.section, layer.state.sites, layer.state.weights)


def test_equal_weights_give_voronoi() -> None:
    """Inner vertices of layer 0 are scipy's Voronoi vertices that lie in the section."""
    sites = np.random.default_rng(3).uniform(-20, 20, (80, 2))
    layer = fill_sections([Section(0.0, (SQUARE,))], sites, FillSettings()).layers[0]
    voronoi = Voronoi(layer.state.sites).vertices
    expected = voronoi[(np.abs(voronoi) < 20).all(axis=1)]
    degree = np.bincount(layer.diagram.edges.ravel())
    on_contour = np.zeros(len(degree), dtype=bool)
    on_contour[layer.diagram.edges[~layer.diagram.inner()]] = True
    found = layer.diagram.vertices[~on_contour]
    assert len(found) == len(expected)
    order, wanted = np.lexsort(found.T), np.lexsort(expected.T)
    assert found[order] == pytest.approx(expected[wanted], abs=1e-9)


def test_one_site_owns_the_whole_section() -> None:
    layer = fill_sections([Section(0.0, WITH_ALL)], np.array([[1.0, 2.0]]), FillSettings()).layers[
        0
    ]
    assert layer.diagram.areas(1)[0] == pytest.approx(area_of(layer.section))
    assert not layer.diagram.inner().any()
    assert len(layer.diagram.neighbours) == len(layer.tree) == 0
    assert layer.area_per_cell == pytest.approx(area_of(layer.section))


def test_weights_are_zero_at_the_base_and_grow_with_height() -> None:
    sites = np.random.default_rng(1).uniform(-20, 20, (30, 2))
    sections = [Section(0.2 * k, (SQUARE,)) for k in range(4)]
    settings = FillSettings(offset=0.3, layer_height=0.2, insertion=False)
    layers = fill_sections(sections, sites, settings).layers
    assert not layers[0].state.weights.any()
    for layer in layers:
        expected = np.where(layer.state.growth > 0, 0.3 * layer.index, 0.0)
        assert layer.state.weights == pytest.approx(expected)


def test_of_two_sites_joined_by_the_tree_one_grows() -> None:
    sites = np.random.default_rng(2).uniform(-20, 20, (50, 2))
    layer = fill_sections([Section(0.0, (SQUARE,))], sites, FillSettings()).layers[0]
    assert len(layer.tree) == 49
    grows = layer.state.growth > 0
    assert (grows[layer.tree[:, 0]] != grows[layer.tree[:, 1]]).all()
    assert not grows[0], "the root stays"


def test_layers_can_be_gone_through_again() -> None:
    sites = np.random.default_rng(2).uniform(-20, 20, (9, 2))
    layers = fill_sections(
        [Section(0.2 * k, (SQUARE,)) for k in range(3)], sites, FillSettings()
    ).layers
    assert len(layers) == 3
    first, again = list(layers), list(layers)
    for one, other in zip(first, again, strict=True):
        assert np.array_equal(one.diagram.vertices, other.diagram.vertices)
        assert np.array_equal(one.diagram.edge_sites, other.diagram.edge_sites)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_site_that_is_no_number_is_named(bad: float) -> None:
    sites = np.array([[0.0, 0.0], [1.0, bad]])
    with pytest.raises(GeometryError, match="site 1") as caught:
        fill_sections([Section(0.0, (SQUARE,))], sites, FillSettings())
    assert caught.value.site == 1
