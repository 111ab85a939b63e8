import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree

from v3dcad.structure.foam.darts import CELLS, CROWDING, STEEPEST, radii_for
from v3dcad.structure.foam.size_grid import SLOPE, SizeGrid, limit_slope, sampled


def grid_of(sizes, side=1.0):
    return SizeGrid(np.zeros(3), side, np.ascontiguousarray(sizes, np.float64))


@settings(max_examples=20)
@given(st.integers(0, 10**6))
def test_no_size_is_raised_and_none_is_steeper_than_asked(seed):
    rng = np.random.default_rng(seed)
    asked = rng.uniform(0.5, 4.0, (9, 8, 7))
    grid = grid_of(asked.copy())
    limit_slope(grid, SLOPE)
    assert (grid.sizes <= asked).all()
    for axis in range(3):
        assert np.abs(np.diff(grid.sizes, axis=axis)).max() <= SLOPE * (1 + 1e-5)


def test_a_small_size_spreads_like_a_cone():
    """Against the true envelope: the least, over all nodes, of a size and the slope to there."""
    asked = np.full((25, 25, 25), 5.0)
    asked[12, 12, 12] = 0.5
    grid = grid_of(asked.copy(), 0.5)
    limit_slope(grid, SLOPE)
    places = np.argwhere(asked > 0) * 0.5
    distance = np.linalg.norm(places - 6.0, axis=1).reshape(asked.shape)
    envelope = np.minimum(5.0, 0.5 + SLOPE * distance)
    # The upwind scheme is of first order: around a point it lags by some sides.
    assert (grid.sizes >= envelope - 1e-9).all()
    assert (grid.sizes - envelope).max() < 2 * 0.5 * SLOPE


def test_a_gentle_field_stays_as_it_is():
    found = sampled(lambda at: 2 + 0.1 * at[:, 0], np.zeros(3), np.full(3, 20.0))
    np.testing.assert_array_equal(found.asked, found.made)


def test_the_field_is_not_asked_outside_of_the_box():
    asked = []

    def field(at):
        asked.append(at)
        return 1 + 0.2 * at[:, 2]

    low, high = np.zeros(3), np.array([8.0, 9.0, 10.0])
    grid = sampled(field, low, high).grid
    for at in asked:
        assert (at >= low).all()
        assert (at <= high).all()
    nodes = grid.corner + grid.side * np.argwhere(grid.sizes > 0)
    inside = np.clip(nodes, low, high)
    np.testing.assert_allclose(grid.sizes.ravel(), 1 + 0.2 * inside[:, 2], atol=1e-9)
    assert (nodes.max(axis=0) >= high - 1e-9).all()


@pytest.mark.parametrize("size", [(100, 100, 0.4), (0.5, 80, 80), (1, 1, 300)])
def test_flat_and_slender_boxes_need_no_more_nodes(size):
    found = sampled(lambda at: np.full(len(at), 5.0), np.zeros(3), np.array(size, float))
    assert found.grid.sizes.size < 2_000_000


def test_nearest_of_two_small_sizes_counts():
    places = np.array([[5.0, 5, 5], [15.0, 5, 5]])
    tree = KDTree(places)
    found = sampled(
        lambda at: 1 + np.maximum(tree.query(at)[0] - 1, 0.0),
        np.zeros(3), np.array([20.0, 10, 10]),
    )  # fmt: skip
    assert found.made.max() < 1 + SLOPE * np.sqrt(150)
    assert found.made.min() == pytest.approx(1, abs=0.2)


@settings(max_examples=20)
@given(st.floats(0, SLOPE), st.floats(0, 6.28), st.floats(-1.5, 1.5))
def test_radii_are_larger_by_the_square_of_the_slope(slope, turn, tilt):
    across = np.array([np.cos(turn) * np.cos(tilt), np.sin(turn) * np.cos(tilt), np.sin(tilt)])
    nodes = np.stack(np.meshgrid(*[np.arange(9.0)] * 3, indexing="ij"), axis=-1) / 2
    sizes = 5 + nodes @ across * slope
    radii = radii_for(grid_of(sizes, 0.5)).sizes
    np.testing.assert_allclose(radii, np.sqrt(CELLS) * sizes * (1 + CROWDING * slope**2), rtol=1e-9)


def test_radii_are_nowhere_steeper_than_darts_reckon_with():
    x = np.arange(40.0) / 2
    kinked = np.minimum(1 + SLOPE * np.abs(x - 10), 3)
    sizes = np.broadcast_to(kinked[:, None, None], (40, 5, 5))
    radii = radii_for(grid_of(sizes, 0.5)).sizes
    assert np.abs(np.diff(radii, axis=0)).max() <= STEEPEST * 0.5 * (1 + 1e-5)
    assert (radii >= sizes).all()
