"""Sections whose rings touch, and walls that lie on a contour."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from tests import oracle
from tests.geometry.clipping.test_ring_validity import fault
from tests.regions import region
from tests.structure.test_fill import foam, laws, ring_areas
from v3dcad.model import Section

pytestmark = pytest.mark.slow

SQUARE = np.array([[0.0, 0], [5, 0], [5, 5], [0, 5]])


def test_a_vertex_where_two_squares_touch():
    section = Section(0.0, (SQUARE, SQUARE + 5))
    sites = np.array([[7.0, 4], [6, 3], [4, 7]])
    laws(foam([section], sites).layers[0])


def at_heights(sites, rise, random):
    """The sites at one height, or at several that differ by a rise."""
    return np.column_stack([sites, rise * random.integers(0, 4, len(sites))])


@st.composite
def touching(draw):
    """A region that touches itself in points, and sites of whose diagram much lies on its rings."""
    random = np.random.default_rng(draw(st.integers(0, 10**6)))
    rings = region(random, 4)
    sites = random.integers(0, 17, (draw(st.integers(1, 30)), 2)) / 4
    if draw(st.booleans()):
        rings = [np.repeat(ring, random.integers(1, 3, len(ring)), axis=0) for ring in rings]
    angle = draw(st.sampled_from([0.0, 0.3]))
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return [ring @ turn for ring in rings], np.unique(sites, axis=0) @ turn


@given(touching(), st.sampled_from([0.0, 0.01, 0.25]))
def test_sections_that_touch_themselves_obey_the_laws(given_section, rise):
    rings, sites = given_section
    sections = [Section(0.5 * k, tuple(rings)) for k in range(8)]
    sites = at_heights(sites, rise, np.random.default_rng(len(sites)))
    for layer in list(foam(sections, sites).layers)[::3]:
        laws(layer)


@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.01]))
def test_cells_behind_a_contour_are_not_counted(seed, rise):
    """Nor do they have edges. The sites lie on the engine's grid: many walls are on a contour."""
    random = np.random.default_rng(seed)
    rings = region(random, 4, apart=True)
    sites = random.permutation(np.argwhere(np.ones((5, 5))) - 0.5)[: random.integers(1, 25)]
    sites = np.vstack([sites, [[-2, -2], [6, 6]]])
    sections = [Section(0.5 * k, tuple(rings)) for k in range(4)]
    for layer in foam(sections, at_heights(sites, rise, random)).layers:
        state, area = layer.state, oracle.area_of(layer.section)
        np.testing.assert_array_equal(state.sites[:, :2], sites)
        parts = shapely.area(oracle.cells(state.sites, state.weights, layer.section))
        filled = np.nonzero(parts > 1e-11)[0]
        np.testing.assert_array_equal(layer.diagram.sites(), filled)
        assert layer.area_per_cell == pytest.approx(area.area / len(filled))
        assert oracle.layer(state.sites, state.weights, layer.section)[3] == len(filled)


@given(st.integers(0, 10**6))
def test_spikes_of_no_area_change_no_cell(seed):
    """They run through the diagram's vertices, and backwards around them but for rounding."""
    random = np.random.default_rng(seed)
    rings = region(random, 4)
    spiky = []
    for ring in rings:
        spike = [ring[1], ring[1] + random.integers(-1, 2, 2)]
        spiky.append(np.insert(ring, [1, 1], spike, axis=0))
    sites = np.vstack([np.argwhere(np.ones((4, 4))) + 0.5, [[-2, -2], [6, 6]]])
    sections = [Section(0.0, tuple(rings)), Section(1.0, tuple(spiky))]
    if fault(spiky) is not None:  # a spike that crosses
        return
    layers = list(foam(sections, sites).layers)
    smooth, diagram = (layer.diagram for layer in layers)
    areas = smooth.areas(len(sites))
    np.testing.assert_allclose(diagram.areas(len(sites)), areas, atol=1e-8)
    np.testing.assert_allclose(ring_areas(diagram, len(sites)), areas, atol=1e-8)
