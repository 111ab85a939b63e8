from __future__ import annotations

import numpy as np
import pytest
from one_diagram import power_diagram

from v3dcad.model import Floats, Section
from v3dcad.structure.thesis.cells import area, is_convex, rings
from v3dcad.structure.thesis.inset import drawn_in, inset, kept_steps, most_steps, moved
from v3dcad.structure.thesis.state import State, initial_state


def square(side: float) -> Floats:
    return side * np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])


def test_a_square_is_drawn_in_down_to_2_mm2() -> None:
    """10 mm wide: 42 steps leave 1.6² = 2.56 mm², 43 would leave 1.4² = 1.96 mm²."""
    assert most_steps(square(10.0)) == 42
    left = drawn_in(square(10.0), 42)
    assert left == pytest.approx(square(1.6) + 4.2, abs=1e-6)
    assert drawn_in(square(10.0), 43) is None


def test_a_short_edge_ends_the_inset() -> None:
    """10 mm wide, a corner cut off by 1 mm along both sides, so by an edge of √2 mm.

    Both its ends turn by 45°, so it loses 2 · tan 22.5° = 0.828 mm for each mm: gone after
    1.707 mm. 17 steps keep the five corners.
    """
    cut = np.array([[0.0, 0], [10, 0], [10, 9], [9, 10], [0, 10]])
    assert most_steps(cut) == 17
    left = drawn_in(cut, 17)
    assert left is not None
    assert len(left) == 5
    assert np.hypot(*(left[3] - left[2])) == pytest.approx(2**0.5 - 1.7 * 0.82843, abs=1e-4)


def test_a_cell_smaller_than_2_mm2_stays_as_it_is() -> None:
    assert most_steps(square(1.4)) == 0


def test_later_layers_take_back_what_no_longer_fits() -> None:
    """2 mm wide: 5 steps would leave 1 mm², 3 leave 1.96 mm², 2 leave 2.56 mm²."""
    assert kept_steps(square(2.0), 5) == 2
    assert kept_steps(square(10.0), 5) == 5
    assert kept_steps(square(1.0), 5) == 0


def test_corners_on_the_boundary_stay() -> None:
    """4 mm wide, drawn in by 0.5 mm, its lower side on the boundary."""
    fixed = np.array([True, True, False, False])
    expected = [[0, 0], [4, 0], [3.5, 3.5], [0.5, 3.5]]
    assert moved(square(4.0), 5, fixed) == pytest.approx(np.array(expected), abs=1e-6)


def test_a_corner_that_the_hull_leaves_out_is_put_on_it() -> None:
    """The lowest corner would go from y = −0.5 to above 0, where the two fixed ones lie."""
    kite = np.array([[0.0, 0], [10, -0.5], [20, 0], [10, 10]])
    cell = moved(kite, 10, np.array([True, False, True, False]))
    assert cell[:3] == pytest.approx(np.array([[0.0, 0], [10, 0], [20, 0]]), abs=1e-6)
    assert 8 < cell[3, 1] < 10
    assert is_convex(cell)


SECTION = Section(0.0, (20 * (square(1.0) - 0.5),))
"""20 mm wide, the origin in its middle."""

CROSS = np.array([[7.0, 0], [0, 7], [-7, 0], [0, -7]])


def with_middle(place: tuple[float, float]) -> State:
    return initial_state(CROSS).with_site(np.array(place), 0.0, 1)


def test_the_cells_around_follow() -> None:
    """The middle cell, 7 mm wide, is drawn in by 27 steps to 1.6 mm (28 would leave 1.96 mm²).

    Its corners go to ±0.8 mm; those of the section do not move.
    """
    state = with_middle((0.0, 0.0))
    diagram = power_diagram(state.sites, state.weights, SECTION)
    state, after = inset(state, diagram, SECTION, 0.01)
    assert state.inset_steps.tolist() == [-1, -1, -1, -1, 27]
    middle = after.vertices[rings(after, 4)[0]]
    assert np.abs(middle) == pytest.approx(np.full((4, 2), 0.8), abs=1e-6)
    assert after.areas(5) == pytest.approx([*[(400 - 2.56) / 4] * 4, 2.56], abs=1e-4)
    still = np.abs(diagram.vertices).max(axis=1) > 9.9
    assert np.array_equal(after.vertices[still], diagram.vertices[still])
    assert np.array_equal(after.edges, diagram.edges)
    again, later = inset(state, diagram, SECTION, 0.01)
    assert again.inset_steps[4] == 27
    assert np.array_equal(later.vertices, after.vertices)


def test_a_cell_on_the_boundary_keeps_it() -> None:
    """Shifted to the right side, the middle cell has two corners on the boundary: they stay."""
    state = initial_state(CROSS[1:]).with_site(np.array([6.0, 0.0]), 0.0, 1)
    diagram = power_diagram(state.sites, state.weights, SECTION)
    before = diagram.vertices[rings(diagram, 3)[0]]
    assert np.count_nonzero(before[:, 0] > 9.99) == 2
    state, after = inset(state, diagram, SECTION, 0.01)
    cell = after.vertices[rings(after, 3)[0]]
    assert state.inset_steps[3] > 0
    assert np.array_equal(cell[before[:, 0] > 9.99], before[before[:, 0] > 9.99])
    assert area(cell) < area(before)
    assert is_convex(cell)
    assert after.areas(4).sum() == pytest.approx(400)


def test_a_cell_that_is_not_convex_is_left() -> None:
    """A notch of the section reaches into the middle cell."""
    notch = np.array([[-10.0, -10], [10, -10], [10, -1], [1, 0], [10, 1], [10, 10], [-10, 10]])
    section = Section(0.0, (notch,))
    state = with_middle((0.0, 0.0))
    diagram = power_diagram(state.sites, state.weights, section)
    state, after = inset(state, diagram, section, 0.01)
    assert state.inset_steps[4] == -1
    assert np.array_equal(after.vertices, diagram.vertices)
