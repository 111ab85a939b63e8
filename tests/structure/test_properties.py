from __future__ import annotations

import numpy as np
import pytest
import shapely

from v3dcad import FillSettings, Section, SettingError, fill_sections
from v3dcad.geometry.section_area import section_area
from v3dcad.structure.properties import properties

SQUARE = np.array([[0.0, 0], [20, 0], [20, 10], [0, 10]])
HOLE = np.array([[3.0, 3], [3, 6], [7, 6], [7, 3]])


def stack(rings, sites, layers=5):  # type: ignore[no-untyped-def]
    """Layers of columns."""
    sections = [Section(0.5 * k, rings) for k in range(layers)]
    return fill_sections(sections, np.array(sites), FillSettings(layer_height=0.5)).layers


def test_a_box_of_two_cells_in_closed_form() -> None:
    """20 × 10 box, wall in the middle, beads 1 wide: two voids of 8.5 × 8."""
    found = properties(stack((SQUARE,), [[5.0, 5], [15, 5]]), 0.5, 1.0, 1.25)
    void = 8.5 * 8
    area = 200 - 2 * void
    assert found.volume == pytest.approx(area * 2.5)
    assert found.mass == pytest.approx(area * 2.5 * 1.25e-3)
    assert found.relative_density == pytest.approx(area / 200)
    assert found.centre == pytest.approx([10, 5, 1.25])
    # Ixx of a box minus that of two smaller ones, about the common centre.
    grams = 1.25e-3 * 2.5

    def box(width: float, depth: float, away: float) -> np.ndarray:
        mass = grams * width * depth
        across = (depth**2 + 2.5**2) / 12
        along = (width**2 + 2.5**2) / 12 + away**2
        flat = (width**2 + depth**2) / 12 + away**2
        return mass * np.diag([across, along, flat])

    expected = box(20, 10, 0) - 2 * box(8.5, 8, 4.75)
    assert found.inertia == pytest.approx(expected, abs=1e-9)


SCATTERED = np.random.default_rng(4).uniform(0, [20, 10], (12, 2))
UNIT = np.array([[0.0, 0], [5, 0], [5, 5], [0, 5]])
STEPS = np.array([[8.0, 0], [8, 3], [9, 3], [9, 5], [5, 5], [5, 4], [4, 4], [4, 2], [5, 2], [5, 0]])
ASIDE = np.array([[0.0, 6], [0, 5], [4, 5], [4, 6]])
GRID = np.stack(np.meshgrid([2.5, 7.5], [2.5, 7.5]), axis=-1).reshape(-1, 2)


@pytest.mark.parametrize(
    ("rings", "sites", "width"),
    [
        pytest.param((SQUARE, HOLE), SCATTERED, 0.6, id="hole"),
        pytest.param((SQUARE, HOLE), SCATTERED, 3.0, id="wide beads"),
        pytest.param((UNIT, UNIT + 5), GRID, 0.2, id="contours that touch"),
        pytest.param((STEPS, ASIDE), [[6.0, 1], [10, 8], [4, 1]], 0.2, id="wall along a contour"),
        pytest.param((UNIT, UNIT + np.array([5.5, 2.0])), GRID, 0.2, id="grid along contours"),
    ],
)
def test_beads_are_counted_once_where_they_meet(rings, sites, width) -> None:  # type: ignore[no-untyped-def]
    """Against the union of all beads, as GEOS buffers it with round ends."""
    layers = stack(rings, sites, layers=1)
    found = properties(layers, 0.5, width, 1.0)
    diagram = layers[0].diagram
    area = section_area(layers[0].section)
    inner = diagram.vertices[diagram.edges[diagram.inner()]]
    walls = shapely.multilinestrings(shapely.linestrings(inner))
    union = shapely.unary_union(
        [
            shapely.buffer(walls, width / 2, quad_segs=64),
            shapely.buffer(area.boundary, width, quad_segs=64),
        ]
    )
    material = shapely.intersection(union, area)
    assert found.volume == pytest.approx(material.area * 0.5, rel=1e-5)
    assert found.centre[:2] == pytest.approx(
        shapely.get_coordinates(material.centroid)[0], rel=1e-5
    )


def test_wide_beads_fill_the_part() -> None:
    found = properties(stack((SQUARE,), [[5.0, 5], [15, 5]]), 0.5, 50.0, 1.0)
    assert found.relative_density == 1
    assert found.volume == pytest.approx(200 * 2.5)


@pytest.mark.parametrize("name", ["bead_width", "density"])
def test_nothing_wide_or_heavy_is_refused(name: str) -> None:
    with pytest.raises(SettingError, match=name):
        properties([], 0.5, **{"bead_width": 1.0, "density": 1.0, name: 0.0})
