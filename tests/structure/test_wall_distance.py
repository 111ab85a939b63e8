from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from oracle import power_diagram, power_edges

from v3dcad.structure.wall_distance import distance_to_walls


def test_two_cells_worked_by_hand() -> None:
    """Sites at (0, 0) and (4, 0), the second weighs 8: the wall is x = 2 − 8 / 8 = 1."""
    sites, weights = np.array([[0.0, 0], [4, 0]]), np.array([0.0, 8.0])
    segments = np.array([[[-1.0, 0], [4, 0]], [[1, -5], [1, 5]], [[0, 0], [0, 3]]])
    farthest, beyond = distance_to_walls(
        segments, np.zeros(3, int), sites, weights, np.array([[0, 1]]), 1.5
    )
    assert farthest == pytest.approx([3, 0, 1])
    assert beyond == pytest.approx([0.5 + 1.5, 0, 0])


def test_without_walls_everything_is_beyond() -> None:
    farthest, beyond = distance_to_walls(
        np.array([[[0.0, 0], [3, 4]]]), np.zeros(1, int), np.zeros((1, 2)), np.zeros(1),
        np.empty((0, 2), int), 1.0,
    )  # fmt: skip
    assert farthest[0] == np.inf
    assert beyond[0] == 5


@given(st.integers(3, 40), st.integers(0, 10_000), st.floats(0, 60))
def test_against_sampled_distances_of_shapely(count: int, seed: int, spread: float) -> None:
    random = np.random.default_rng(seed)
    sites = random.uniform(-50, 50, (count, 2))
    weights = random.uniform(0, spread, count)
    pairs, edges = power_edges(len(sites), *power_diagram(sites, weights))
    walls = shapely.multilinestrings(list(edges))
    segments = random.uniform(-50, 50, (6, 2, 2))
    hints = random.choice(np.unique(pairs), 6)
    reach = float(random.uniform(0, 10))
    farthest, beyond = distance_to_walls(segments, hints, sites, weights, pairs, reach)
    t = (np.arange(2000) + 0.5)[:, None] / 2000
    for k, (start, stop) in enumerate(segments):
        sampled = shapely.distance(walls, shapely.points(start + t * (stop - start)))
        length = np.hypot(*(stop - start))
        assert farthest[k] >= sampled.max() - 1e-9
        assert farthest[k] <= sampled.max() + length / 2000
        assert beyond[k] == pytest.approx(length * np.mean(sampled > reach), abs=length / 200)
