"""Columns are an ordinary Voronoi diagram; what sites of a foam weigh."""

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
    """Inner vertices are scipy's Voronoi vertices that lie in the section."""
    sites = np.random.default_rng(3).uniform(-20, 20, (80, 2))
    layer = fill_sections([Section(0.0, (SQUARE,))], sites, FillSettings()).layers[0]
    voronoi = Voronoi(layer.state.sites[:, :2]).vertices
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


def test_weights_are_squared_distances_in_height() -> None:
    """So that a site's power is its squared distance in the stretched space."""
    sites = np.random.default_rng(1).uniform([-20, -20, -5], [20, 20, 5], (30, 3))
    sections = [Section(0.2 * k, (SQUARE,)) for k in range(9)]
    settings = FillSettings(stretch=1.6, max_overhang=90.0, layer_height=0.2)
    layers = list(fill_sections(sections, sites, settings).layers)
    for layer in layers:
        expected = -(((layer.z - layer.state.sites[:, 2]) / 1.6) ** 2)
        assert layer.state.weights == pytest.approx(expected, abs=1e-4)
    # Growth is the weights' but for what is common to all.
    grown = layers[5].state.weights - layers[4].state.weights
    growth = layers[4].state.growth * 0.2
    assert grown - grown[0] == pytest.approx(growth - growth[0], abs=1e-4)
