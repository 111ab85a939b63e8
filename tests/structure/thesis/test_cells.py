from __future__ import annotations

import numpy as np
import pytest
from one_diagram import power_diagram

from v3dcad.model import OUTSIDE, Section
from v3dcad.structure.thesis.cells import area, corner_count, is_convex, rings
from v3dcad.structure.thesis.proximity import cells_on_boundary, near_boundary
from v3dcad.structure.thesis.tree import walked

SQUARE = np.array([[0.0, 0], [10, 0], [10, 10], [0, 10]])
HOLE = np.array([[4.0, 4], [4, 6], [6, 6], [6, 4]])


def test_near_is_closer_than_the_tolerance_to_any_ring() -> None:
    """Beside the left side by 0.005 and 0.02, beside the hole's by 0.009, on a corner, inside."""
    points = np.array([[0.005, 5.0], [0.02, 5.0], [3.991, 5.0], [10.0, 10.0], [2.0, 2.0]])
    section = Section(0.0, (SQUARE, HOLE))
    assert near_boundary(points, section, 0.01).tolist() == [True, False, True, True, False]
    assert near_boundary(points, section, 0.03).tolist() == [True, True, True, True, False]
    assert not near_boundary(points, Section(0.0, ()), 9.0).any()


def test_of_nine_cells_in_a_square_the_middle_one_is_off_the_boundary() -> None:
    """Sites on a 3 × 3 grid; site 9 is hidden by its weight and counts as on the boundary."""
    grid = np.array([[x, y] for y in (2.0, 5, 8) for x in (2.0, 5, 8)])
    sites = np.vstack([grid, [[5.0, 5.5]]])
    weights = np.append(np.zeros(9), -9.0)
    section = Section(0.0, (SQUARE,))
    touching = cells_on_boundary(power_diagram(sites, weights, section), section, 10, 0.01)
    assert touching.tolist() == [True] * 4 + [False] + [True] * 5


def test_rings_of_two_cells_by_hand() -> None:
    """The square cut at x = 5: two rectangles of 4 corners and area 50."""
    diagram = power_diagram(np.array([[2.0, 5], [8, 5]]), np.zeros(2), Section(0.0, (SQUARE,)))
    for site, middle in ((0, 2.5), (1, 7.5)):
        (ring,) = rings(diagram, site)
        polygon = diagram.vertices[ring]
        assert len(ring) == corner_count(diagram, site) == 4
        assert area(polygon) == pytest.approx(50)
        assert polygon.mean(axis=0) == pytest.approx([middle, 5])
        assert is_convex(polygon)
    assert rings(diagram, 7) == []


def test_a_cell_around_a_hole_has_two_rings_and_the_section_its_own() -> None:
    diagram = power_diagram(np.array([[1.0, 1]]), np.zeros(1), Section(0.0, (SQUARE, HOLE)))
    for site in (0, OUTSIDE):
        areas = sorted(area(diagram.vertices[ring]) for ring in rings(diagram, site))
        assert areas == pytest.approx([-4, 100])


def test_convex_by_hand() -> None:
    """A square; the square with a side's middle drawn in by 1; with it drawn in by 1e-9."""
    assert is_convex(SQUARE)
    for depth, convex in ((1.0, False), (1e-9, True)):
        assert is_convex(np.insert(SQUARE, 1, [5.0, depth], axis=0)) is convex


def test_the_tree_is_walked_as_prim_walks_it() -> None:
    """From 0 at the origin: 2 at 1 mm is nearer than 1 at 3 mm; from 2 to 3 it is 1.5 mm; 1 last.

    4 and 5 are a piece of their own.
    """
    sites = np.array([[0.0, 0], [-3, 0], [1, 0], [2.5, 0], [50, 0], [51, 0]])
    tree = np.array([[0, 1], [0, 2], [2, 3], [4, 5]])
    assert walked(np.arange(6), tree, sites).tolist() == [0, 2, 3, 1, 4, 5]


def test_only_cells_that_are_there_are_walked() -> None:
    order = walked(np.array([1, 3]), np.array([[1, 3]]), np.zeros((4, 2)))
    assert order.tolist() == [1, 3]
