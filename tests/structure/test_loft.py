from __future__ import annotations

import numpy as np
import pytest

from v3dcad import FillSettings, GeometryError, Section, fill_sections
from v3dcad.model import Floats, Layer
from v3dcad.structure.loft import LoftedLayers, lofted, matching_vertices
from v3dcad.structure.sites import scatter_sites
from v3dcad.structure.thesis.loop import ThesisFilling

SETTINGS = FillSettings(method="thesis", interpolate=True, layer_height=0.2, offset=0.3, sites=8)
HEIGHTS = np.arange(250) * 0.2


def cube(z: float) -> Section:
    return Section(z, (25 * np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]]),))


def sites_that_keep_their_corners() -> Floats:
    return scatter_sites(np.array([[-25.0, -25], [25, 25]]), 8, 2)


def loft_of(
    sections: list[Section], sites: Floats, heights: Floats, settings: FillSettings
) -> LoftedLayers:
    filling = fill_sections(sections, sites, settings)
    assert isinstance(filling, ThesisFilling)
    return lofted(filling, heights)


def lofted_cube() -> LoftedLayers:
    sections = [cube(0.0), cube(float(HEIGHTS[-1]))]
    return loft_of(sections, sites_that_keep_their_corners(), HEIGHTS, SETTINGS)


def farthest_apart(one: Layer, other: Layer) -> float:
    """Largest distance between matching corners, mm."""
    order = matching_vertices(one.diagram, other.diagram)
    return float(np.hypot(*(one.diagram.vertices - other.diagram.vertices[order]).T).max())


def test_the_cube_of_the_thesis() -> None:
    """Table 4.2, first column: the loft lies within 0.012 mm of the layers computed one by one.

    Those weigh 0, 2, 3, … offsets, so that they jump by one offset more on layer 1 than the
    straight line does: 0.3 mm² / (2 · 13.5 mm), 13.5 mm being the nearest sites' distance.
    """
    regular = fill_sections(
        [cube(float(z)) for z in HEIGHTS], sites_that_keep_their_corners(), SETTINGS
    ).layers
    layers = lofted_cube()
    assert len(layers) == len(regular) == 250
    apart = [farthest_apart(one, other) for one, other in zip(layers, regular, strict=True)]
    assert apart[0] == pytest.approx(0, abs=1e-12)
    assert apart[-1] == pytest.approx(0, abs=1e-9)
    assert 0.010 < max(apart) < 0.012
    assert np.argmax(apart) == 1


def test_lofted_layers_tile() -> None:
    layers = lofted_cube()
    for index in (0, 1, 100, -1):
        layer = layers[index]
        areas = layer.diagram.areas(8)
        assert areas.sum() == pytest.approx(2500)
        assert (areas > 0).all()
        assert layer.area_per_cell == pytest.approx(2500 / 8)
        assert layer.z == HEIGHTS[index]
        assert sum(len(ring) for ring in layer.section.rings) >= 4
        assert np.abs(np.concatenate(layer.section.rings)).max() == pytest.approx(25)
    assert layers[-1].state.weights.max() == pytest.approx(0.3 * 250)
    with pytest.raises(IndexError):
        layers[250]


def test_points_on_a_straight_side_are_no_corners() -> None:
    """A triangulated side adds such points on all layers but the lowest."""
    (ring,) = cube(0.0).rings
    last = Section(9.8, (np.insert(ring, [1, 3], [[0.0, -25], [7.0, 25]], axis=0),))
    sites = np.array([[-9.0, 0], [9, 0]])
    layers = loft_of([cube(0.0), last], sites, np.linspace(0, 9.8, 50), SETTINGS)
    assert len(layers[-1].diagram.vertices) == 6


HOUSE = np.array([[-25.0, -25], [25, -25], [25, 25], [-25, 25], [-30, 0]])


@pytest.mark.parametrize(
    ("sites", "last", "says"),
    [
        ([[0.0, 0], [1, 0], [20, 0]], cube(9.8), "site 0: has no cell on the last layer"),
        (
            [[-9.0, 0], [9, 0]],
            Section(9.8, (HOUSE,)),
            "site 0: has a cell with 4 corners on the first layer and 5 on the last",
        ),
        (
            [[0.0, 0], [20, 0]],
            Section(9.8, (*cube(9.8).rings, np.array([[-3.0, -3], [-3, 3], [3, 3], [3, -3]]))),
            "site 0: has a cell that is not one polygon",
        ),
    ],
)
def test_what_cannot_be_lofted(sites: Floats, last: Section, says: str) -> None:
    settings = FillSettings(method="thesis", interpolate=True, offset=2.0)
    heights = np.linspace(0, 9.8, 50)
    with pytest.raises(GeometryError, match=says) as caught:
        loft_of([cube(0.0), last], np.array(sites), heights, settings)
    assert "leave interpolate out" in str(caught.value)
    assert caught.value.site is not None


def test_cells_whose_neighbours_change_are_refused() -> None:
    """Four quarters of a square; then the same with two of them exchanged."""
    sites = np.array([[-9.0, -9], [9, -9], [9, 9], [-9, 9]])
    section = cube(0.0)
    one = fill_sections([section], sites, FillSettings()).layers[0]
    other = fill_sections([section], sites[[0, 2, 1, 3]], FillSettings()).layers[0]
    with pytest.raises(GeometryError, match="whose neighbours change"):
        matching_vertices(one.diagram, other.diagram)
