from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from v3dcad.geometry.print_time import move_seconds
from v3dcad.settings import PrintSettings


def seconds(steps: list[list[float]], speed: float, **given: float) -> float:
    moves = np.array(steps)
    length = np.linalg.norm(moves, axis=1)
    options = PrintSettings(**given)  # type: ignore[arg-type]
    asked = np.full(len(moves), speed)
    accelerations = np.full(len(moves), options.acceleration)
    still = np.zeros(len(moves))
    return float(
        move_seconds(moves, length, still, asked, accelerations, options.corner_speed).sum()
    )


def test_one_move_speeds_up_runs_and_slows_down() -> None:
    # 50 mm/s at 500 mm/s²: 0.1 s and 2.5 mm at either end.
    assert seconds([[100, 0, 0]], 50, acceleration=500) == pytest.approx(0.2 + 95 / 50)


def test_a_short_move_never_reaches_its_speed() -> None:
    assert seconds([[2, 0, 0]], 1000, acceleration=500) == pytest.approx(2 * np.sqrt(2 / 500))


def test_a_straight_way_may_be_divided_at_will() -> None:
    whole = seconds([[100, 0, 0]], 50)
    assert seconds([[7, 0, 0]] + [[1, 0, 0]] * 93, 50) == pytest.approx(whole)


def test_a_right_angle_is_passed_at_the_corner_speed() -> None:
    a, v, corner = 500.0, 50.0, 8.0
    one = (v / a) + (v - corner) / a + (50 - v**2 / (2 * a) - (v**2 - corner**2) / (2 * a)) / v
    found = seconds([[50, 0, 0], [0, 50, 0]], v, acceleration=a, corner_speed=corner)
    assert found == pytest.approx(2 * one)


def test_a_faster_move_speeds_up_after_the_slower_one() -> None:
    moves = np.array([[10.0, 0, 0], [100, 0, 0]])
    found = move_seconds(
        moves, moves[:, 0], np.zeros(2), np.array([10.0, 50]), np.full(2, 500.0), 8.0
    )
    assert found == pytest.approx([10 / 500 + 9.9 / 10, 40 / 500 + 50 / 500 + 95.1 / 50])


def test_each_move_has_its_own_acceleration() -> None:
    # Up to 50 mm/s at 500 mm/s², straight on, and down from it at 1,000 mm/s².
    moves = np.array([[10.0, 0, 0], [10.0, 0, 0]])
    found = move_seconds(
        moves, moves[:, 0], np.zeros(2), np.full(2, 50.0), np.array([500.0, 1000]), 8.0
    )
    assert found == pytest.approx([50 / 500 + 7.5 / 50, 50 / 1000 + 8.75 / 50])


def test_turning_back_stops() -> None:
    assert seconds([[50, 0, 0], [-50, 0, 0]], 50) == pytest.approx(2 * seconds([[50, 0, 0]], 50))


@settings(max_examples=50, deadline=None, derandomize=True)
@given(
    st.lists(st.tuples(*[st.floats(-20, 20)] * 3), min_size=1, max_size=30),
    st.floats(1, 300),
    st.floats(0, 20),
)
def test_between_never_stopping_and_always_stopping(
    steps: list[tuple[float, ...]], speed: float, corner: float
) -> None:
    moves = [list(step) for step in steps]
    found = seconds(moves, speed, corner_speed=corner)
    length = sum(np.linalg.norm(step) for step in moves)
    assert found >= length / speed - 1e-9
    assert found <= sum(seconds([step], speed) for step in moves) + 1e-9
