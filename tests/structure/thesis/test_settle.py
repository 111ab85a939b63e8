from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from one_diagram import power_diagram

from v3dcad.model import Floats, Section
from v3dcad.structure.thesis.cells import corner_count, present
from v3dcad.structure.thesis.settle import least_weight, settle
from v3dcad.structure.thesis.state import GROWS, SHRINKS, State, initial_state

WIDE = Section(0.0, (np.array([[-30.0, -30], [30, -30], [30, 30], [-30, 30]]),))


def around_origin(*others: tuple[float, float], weight: float, corners: int = 0) -> State:
    state = initial_state(np.array(others)).with_site(np.zeros(2), weight, 3)
    return state.with_values(len(others), corners=corners)


def circle(count: int, radius: float) -> list[tuple[float, float]]:
    angles = 2 * np.pi * np.arange(count) / count + 0.3
    return [(radius * float(np.cos(a)), radius * float(np.sin(a))) for a in angles]


def test_the_smallest_weight_by_hand() -> None:
    """Three sites 6 mm around the new one: it vanishes at −6² = −36.

    From 0.2 down in steps of 1, −35.8 is the last that keeps it: a triangle.
    """
    state = around_origin(*circle(3, 6.0), weight=0.2)
    state, diagram = settle(state, WIDE, power_diagram, 1.0)
    assert state.weights[3] == pytest.approx(-35.8)
    assert state.corners[3] == corner_count(diagram, 3) == 3
    assert state.tags[3] == GROWS
    assert present(diagram, 4)[3]


def test_an_older_cell_with_more_corners_loses_weight_by_hand() -> None:
    """Sites at ±10 on both axes and at (8, 8), the new one at the origin with weight w.

    Its edges lie at x, y = ±(100 + w) / 20 and x + y = (128 + w) / 16. The last cuts the corner
    off while (128 + w) / 16 < (100 + w) / 10, that is w > −53.3. From 0 in steps of 20, −60 is
    the first weight at which it has its 4 corners again; it is tagged to shrink.
    """
    others = [(10.0, 0.0), (-10.0, 0.0), (0.0, 10.0), (0.0, -10.0), (8.0, 8.0)]
    state = around_origin(*others, weight=0.0, corners=4)
    assert corner_count(power_diagram(state.sites, state.weights, WIDE), 5) == 5
    state, diagram = settle(state, WIDE, power_diagram, 20.0)
    assert state.weights[5] == -60
    assert state.tags[5] == SHRINKS
    assert corner_count(diagram, 5) == 4


def test_a_cell_that_never_has_few_enough_corners_vanishes() -> None:
    """Six sites 10 mm around: 6 corners down to −100, where it vanishes; steps of 30 end at −120.

    The loop of Algorithm 7 goes on only while the cell exists.
    """
    state = around_origin(*circle(6, 10.0), weight=0.0, corners=5)
    state, diagram = settle(state, WIDE, power_diagram, 30.0)
    assert state.weights[6] == -120
    assert not present(diagram, 7)[6]


def test_cells_that_do_not_exist_or_have_not_more_corners_are_left() -> None:
    for state in (
        around_origin(*circle(3, 6.0), weight=-40.0),
        around_origin(*circle(3, 6.0), weight=0.2, corners=3),
        around_origin(*circle(3, 6.0), weight=0.2, corners=4),
    ):
        after, _ = settle(state, WIDE, power_diagram, 1.0)
        assert after.weights.tolist() == state.weights.tolist()
        assert after.tags.tolist() == state.tags.tolist()


def test_without_a_step_nothing_changes() -> None:
    state = around_origin(*circle(6, 10.0), weight=0.0, corners=5)
    assert settle(state, WIDE, power_diagram, 0.0)[0] is state


@given(st.integers(4, 25), st.integers(0, 10_000), st.floats(0.5, 9))
@settings(max_examples=15)
def test_one_diagram_finds_what_trial_by_trial_finds(count: int, seed: int, step: float) -> None:
    """The thesis's own loop, one diagram for each trial weight, as oracle."""
    random = np.random.default_rng(seed)
    state = initial_state(random.uniform(-30, 30, (count, 2)))
    state = replace(state, weights=random.uniform(0, 20, count))
    place: Floats = random.uniform(-30, 30, 2)
    state = state.with_site(place, 25.0, 1)

    def exists(weight: float) -> bool:
        weights = np.append(state.weights[:-1], weight)
        return bool(present(power_diagram(state.sites, weights, WIDE), count + 1)[count])

    if not exists(25.0):
        return
    weight, k = 25.0, 0
    while exists(25.0 - (k + 1) * step):
        k += 1
        weight = 25.0 - k * step
    assert least_weight(state, WIDE, power_diagram, count, step) == pytest.approx(weight)
