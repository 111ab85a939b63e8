import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree

from v3dcad.structure.foam.darts import poisson_disk


@settings(max_examples=10)
@given(st.integers(0, 2**63), st.floats(0.5, 2))
def test_no_two_are_near_and_hardly_any_room_is_left(random_seed, radius):
    box = np.array([5.0, 6.0, 4.0]) * radius
    places = poisson_disk(box, radius, random_seed)
    assert (places >= 0).all()
    assert (places < box).all()
    tree = KDTree(places, boxsize=box)
    assert tree.query(places, k=2)[0][:, 1].min() >= radius
    points = np.random.default_rng(0).random((20_000, 3)) * box
    assert (tree.query(points)[0] > radius).mean() < 1e-3
    assert 0.6 < len(places) * radius**3 / box.prod() < 0.8


def test_a_seed_means_these_sites():
    places = poisson_disk(np.full(3, 5.0), 1.0, 1)
    np.testing.assert_array_equal(places, poisson_disk(np.full(3, 5.0), 1.0, 1))
    assert len(poisson_disk(np.full(3, 5.0), 1.0, 2)) > 0
    assert not np.array_equal(places[:5], poisson_disk(np.full(3, 5.0), 1.0, 2)[:5])
