"""Stretches on which loops face each other, against all pairs of segments."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from facing_loops import S, loops_of, place
from hypothesis import given, settings
from hypothesis import strategies as st

from v3dcad.geometry.loops.facing import SLACK, facing
from v3dcad.geometry.loops.loops import Loops


@settings(max_examples=15, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.integers(1, 40))
def test_what_faces_is_one_spacing_away_and_nothing_is_missed(seed: int, count: int) -> None:
    loops = loops_of(seed, count)
    found = facing(loops, loops.measured(), S)
    for (one, other), ends, beyond in zip(found.loops, found.along, found.beyond, strict=True):
        assert one < other
        middle = ends.mean()
        apart = place(loops, one, middle).distance(place(loops, other, beyond - middle))
        assert apart == pytest.approx(S, abs=SLACK * S)
    # Parallel walls face each other over all that both have in common.
    shared = np.zeros((len(loops.owner),) * 2)
    np.add.at(shared, tuple(found.loops.T), np.diff(found.along, axis=1)[:, 0])
    lines = [shapely.LinearRing(loops.ring(k)) for k in range(len(loops.owner))]
    for one in range(len(lines)):
        for other in range(one + 1, len(lines)):
            strip = lines[other].buffer(1.001 * S, cap_style="flat", join_style="bevel")
            near = lines[one] & strip
            assert shared[one, other] <= near.length + 4 * S
            if shared[one, other] == 0:
                assert near.length < 4 * S


def test_points_nearer_than_the_shortest_go_and_three_stay() -> None:
    circle = np.exp(2j * np.pi * np.arange(100) / 100)
    rings_ = [r * np.column_stack([circle.real, circle.imag]) for r in (1.0, 0.01)]
    loops = Loops.of(rings_, [5, 7])
    thin = loops.thinned(0.3)
    steps = np.hypot(*(np.roll(thin.ring(0), -1, axis=0) - thin.ring(0)).T)
    assert steps.min() >= 0.3
    assert steps.max() < 0.6
    assert np.array_equal(thin.ring(1), rings_[1])
    assert thin.owner.tolist() == [5, 7]
    assert np.array_equal(loops.thinned(0.0).points, loops.points)
