from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from v3dcad.errors import SettingError
from v3dcad.structure.sites import scatter_sites

SQUARE = np.array([[-20.0, -20.0], [20.0, 20.0]])


@given(
    st.integers(1, 200),
    st.integers(0, 2**63 - 1),
    st.floats(1e-3, 1e3),
    st.floats(1e-2, 1e2),
)
def test_sites_lie_in_the_rectangle_and_differ(
    count: int, seed: int, size: float, ratio: float
) -> None:
    rectangle = np.array([[1.0, -2.0], [1.0 + size, -2.0 + size * ratio]])
    sites = scatter_sites(rectangle, count, seed)
    assert sites.shape == (count, 2)
    assert (sites >= rectangle[0]).all()
    assert (sites <= rectangle[1]).all()
    assert len(np.unique(sites, axis=0)) == count


def test_same_seed_same_sites_other_seed_others() -> None:
    assert np.array_equal(scatter_sites(SQUARE, 40, 0), scatter_sites(SQUARE, 40, 0))
    assert not np.array_equal(scatter_sites(SQUARE, 40, 0), scatter_sites(SQUARE, 40, 1))


def test_fewer_sites_are_the_first_of_more() -> None:
    """Blocks are drawn one after the other, whole ones alike whatever the count."""
    assert np.array_equal(scatter_sites(SQUARE, 16, 5), scatter_sites(SQUARE, 500, 5)[:16])


def test_scatter_is_more_even_than_chance() -> None:
    """Nearest sites keep far more distance than those of a uniform scatter do."""
    even = [pdist(scatter_sites(SQUARE, 100, seed)).min() for seed in range(10)]
    random = np.random.default_rng(0)
    chance = [pdist(random.uniform(-20, 20, (100, 2))).min() for _ in range(10)]
    assert min(even) > 3 * np.mean(chance)


def test_known_sites() -> None:
    """What a seed means is part of the file format: these must never change."""
    first = scatter_sites(SQUARE, 3, 0)
    expected = [
        [14.024969339370728, 5.478466749191284],
        [-16.784013509750366, -8.011523485183716],
        [-1.5631353855133057, 19.888397455215454],
    ]
    assert first.tolist() == expected


def test_a_rectangle_without_room_is_refused() -> None:
    with pytest.raises(SettingError, match="no room"):
        scatter_sites(np.array([[0.0, 0.0], [1.0, 0.0]]), 2_000_000, 0)
