"""Layer 0 is an ordinary Voronoi diagram; weights grow from there."""

from __future__ import annotations

import numpy as np
import pytest
from oracle import area_of
from scipy.spatial import Voronoi

from v3dcad import FillSettings, Section, fill_sections

SQUARE = np.array([[-20.0, -20], [20, -20], [20, 20], [-20, 20]])
HOLE = np.array([[-6.0, -5], [-5, 7], [6, 5], [5, -6]])
ISLAND = np.array([[24.0, -3], [30, -3], [30, 3], [24, 3]])
WITH_ALL = (SQUARE, HOLE, ISLAND)


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
    assert layer.diagram.areas(1)[0] == pytest.approx(area_of(layer.section).area)
    assert not layer.diagram.inner().any()
    assert len(layer.diagram.neighbours) == len(layer.tree) == 0
    assert layer.area_per_cell == pytest.approx(area_of(layer.section).area)


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
