import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import KDTree

from tests.geometry.voronoi import oracle
from v3dcad.geometry.voronoi.reach import cell_reaches


@given(st.integers(20, 400), st.integers(0, 10**6), st.floats(1, 4))
def test_no_cell_reaches_farther_than_its_bound(count, seed, unevenness):
    rng = np.random.default_rng(seed)
    places = rng.random((count, 3)) ** unevenness
    low, high = np.full(3, 0.2), np.array([0.7, 0.8, 0.6])
    _, reaches = cell_reaches(places, low, high)
    # Random points of the box, and corners of cells, which are the farthest points of all.
    points = low + rng.random((2000, 3)) * (high - low)
    corners = np.concatenate([*oracle.walls(places).values(), points])
    corners = corners[((corners >= low) & (corners <= high)).all(axis=1)]
    distances, nearest = KDTree(places).query(corners, k=4)
    for k in range(4):
        tied = distances[:, k] <= distances[:, 0] * (1 + 1e-9)
        assert (distances[tied, k] <= reaches[nearest[tied, k]]).all()


def test_bounds_of_even_sites_are_near_the_truth():
    steps = np.arange(12.0)
    places = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    places += np.random.default_rng(1).uniform(-0.2, 0.2, places.shape)
    _, reaches = cell_reaches(places, np.full(3, 5.0), np.full(3, 6.0))
    assert reaches.max() < 1.5
    assert reaches.min() == 0
