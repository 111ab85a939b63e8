import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import KDTree

from v3dcad.geometry.voronoi.bins import ROOM, bins_of
from v3dcad.geometry.voronoi.neighbours import list_neighbours


def neighbours(places, low, high, count, *, periodic):
    bins = bins_of(places, low, high, periodic=periodic)
    lists, reaches = np.empty((len(places), count), np.int64), np.empty(len(places))
    assert list_neighbours(bins, places, np.arange(len(places)), lists, reaches, ROOM)
    return lists, reaches


@given(st.integers(150, 500), st.integers(0, 10**6), st.booleans())
def test_lists_are_those_of_a_tree(count, seed, periodic):
    """With periods, of sites so many that no list reaches half around the box."""
    rng = np.random.default_rng(seed)
    box = np.array([1.0, 1.3, 0.9])
    places = rng.random((count, 3)) ** (1 if periodic else 3) * box
    tree = KDTree(places, boxsize=box if periodic else None)
    distances, theirs = tree.query(places, k=13)
    ours, reaches = neighbours(places, np.zeros(3), box, 12, periodic=periodic)
    np.testing.assert_array_equal(ours, theirs[:, 1:])
    np.testing.assert_allclose(reaches, distances[:, -1], rtol=1e-12)


def test_equally_near_sites_come_by_number():
    rng = np.random.default_rng(3)
    steps = np.arange(5.0)
    lattice = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    places = rng.permutation(lattice)
    lists, _ = neighbours(places, np.zeros(3), np.full(3, 5.0), 26, periodic=True)
    for site, row in enumerate(lists):
        offsets = np.abs(places[row] - places[site])
        squares = (np.minimum(offsets, 5 - offsets) ** 2).sum(axis=1)
        assert squares.tolist() == [1] * 6 + [2] * 12 + [3] * 8
        for square in (1, 2, 3):
            assert (np.diff(row[squares == square]) > 0).all()


@pytest.mark.parametrize("periodic", [True, False])
def test_a_place_with_too_many_around_is_told(periodic):
    places = np.random.default_rng(0).random((50, 3))
    bins = bins_of(places, np.zeros(3), np.ones(3), periodic=periodic)
    lists, reaches = np.empty((50, 20), np.int64), np.empty(50)
    assert not list_neighbours(bins, places, np.arange(50), lists, reaches, 20)
