"""Cells of a diagram as polygons, against half-planes cut by shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from one_diagram import power_diagram

from tests import oracle
from tests.structure.test_fill import SECTIONS
from v3dcad.model import Floats, Section


def polygon(rings: list[Floats]) -> shapely.Geometry:
    """The area on the left of rings: of outer ones, less that of holes."""
    polygons = shapely.polygons([shapely.linearrings(ring) for ring in rings])
    outer = shapely.is_ccw(shapely.get_exterior_ring(polygons))
    return shapely.union_all(polygons[outer]).difference(shapely.union_all(polygons[~outer]))


@pytest.mark.parametrize("name", SECTIONS)
@pytest.mark.parametrize("heavy", [0.0, 2.0])
def test_cells_tile_the_section(name: str, heavy: float) -> None:
    """Each is what half-planes leave of the section; together they are all of it, once.

    Where weights are large, some sites have no cell.
    """
    random = np.random.default_rng(5)
    section = Section(0.0, SECTIONS[name])
    sites = random.integers(0, 14 << 10, (30, 2)) / (1 << 10)  # on the engine's grid
    weights = heavy * random.integers(0, 1 << 10, 30) / (1 << 10)
    diagram = power_diagram(sites, weights, section)
    cells = diagram.cells()
    expected = oracle.cells(sites, weights, section)
    assert list(cells) == diagram.sites().tolist()
    assert list(cells) == np.nonzero(shapely.area(expected) > 1e-9)[0].tolist()
    polygons = [polygon(rings) for rings in cells.values()]
    for site, found in zip(cells, polygons, strict=True):
        assert shapely.symmetric_difference(found, expected[site]).area < 1e-9
    area = oracle.area_of(section).area
    assert sum(found.area for found in polygons) == pytest.approx(area)
    assert shapely.union_all(polygons).area == pytest.approx(area)


def test_every_edge_is_walked_once_on_each_side_that_has_a_cell() -> None:
    """By hand: a square in two, one of the halves with a hole."""
    square = np.array([[0.0, 0], [10, 0], [10, 10], [0, 10]])
    hole = np.array([[6.0, 4], [6, 6], [8, 6], [8, 4]])
    section = Section(0.0, (square, hole))
    diagram = power_diagram(np.array([[2.0, 5], [8, 5]]), np.zeros(2), section)
    (left,), right = diagram.cells().values()
    assert sorted(left.tolist()) == [[0, 0], [0, 10], [5, 0], [5, 10]]
    assert sorted(map(len, right)) == [4, 4]
    walked = sum(len(ring) for ring in (left, *right))
    assert walked == len(diagram.edges) + diagram.inner().sum()


def test_a_diagram_without_edges_has_no_cells() -> None:
    diagram = power_diagram(np.array([[2.0, 5]]), np.zeros(1), Section(0.0, ()))
    assert diagram.cells() == {}
