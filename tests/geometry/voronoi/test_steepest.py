from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.geometry.voronoi import oracle
from v3dcad.errors import GeometryError
from v3dcad.geometry.voronoi.steepest import steepest_wall

STEPS = 1 << 20


@given(st.integers(30, 300), st.integers(0, 10**6), st.floats(0.1, 0.4))
def test_it_is_the_steepest_of_all_walls(count, seed, inset):
    sites = oracle.scattered(count, seed)
    low = np.full(3, round(inset * STEPS))
    high = STEPS - low
    wall = steepest_wall(sites, low, high)
    x, y, z = (sites[wall.sites[1]] - sites[wall.sites[0]]).tolist()
    assert (wall.rise, wall.run) == (z * z, x * x + y * y)
    # No wall of the oracle is steeper; and the one found is a wall, or misses by rounding only.
    assert wall.rise >= oracle.steepest(sites, low, high) * wall.run * (1 - 1e-12)
    corners = oracle.walls(np.concatenate([sites, far_corners()])).get(wall.sites)
    assert corners is not None


def far_corners():
    """Sites far outside, by which all walls near the middle are bounded."""
    ends = np.array([-40, 41]) * STEPS
    return np.stack(np.meshgrid(ends, ends, ends), axis=-1).reshape(-1, 3)


@given(st.integers(2, 200), st.integers(0, 10**6))
def test_the_order_of_sites_does_not_matter(count, seed):
    sites = oracle.scattered(count, seed)
    box = np.zeros(3, np.int64), np.full(3, STEPS)
    order = np.random.default_rng(seed).permutation(len(sites))
    first, second = steepest_wall(sites, *box), steepest_wall(sites[order], *box)
    assert (first.rise, first.run) == (second.rise, second.run)
    assert set(first.sites) == set(order[list(second.sites)].tolist())


@given(st.integers(30, 200), st.integers(0, 10**6))
def test_walls_are_those_in_the_box(count, seed):
    """The boxes of a division have, taken together, the walls of the whole."""
    sites = oracle.scattered(count, seed)
    whole = steepest_wall(sites, np.zeros(3, np.int64), np.full(3, STEPS))
    half = STEPS // 2
    parts = []
    for corner in np.ndindex(2, 2, 2):
        low = np.array(corner) * half
        parts.append(steepest_wall(sites, low, low + half))
    assert max(Fraction(part.rise, max(part.run, 1)) for part in parts) == Fraction(
        whole.rise, max(whole.run, 1)
    )


def test_shifts_and_quarter_turns_change_nothing():
    sites = oracle.scattered(200, 5)
    low, high = np.zeros(3, np.int64), np.full(3, STEPS)
    wall = steepest_wall(sites, low, high)
    turned = np.column_stack([-sites[:, 1], sites[:, 0], sites[:, 2]])
    assert steepest_wall(turned, np.array([-STEPS, 0, 0]), np.array([0, STEPS, STEPS])) == wall
    shift = np.array([1 << 48, -(1 << 47), 12345])
    assert steepest_wall(sites + shift, low + shift, high + shift) == wall


def test_walls_of_lattices():
    steps = np.arange(6)
    lattice = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3) * 1000
    box = np.full(3, 1000), np.full(3, 4000)
    # Floors of a cubic lattice lie flat.
    assert steepest_wall(lattice, *box).tau == np.inf
    assert steepest_wall(lattice, *box).run == 0
    # The rhombic dodecahedra of a face-centred one, cube axes upright, touch those above in a
    # corner: whether they share a wall is a tie, and ties count.
    centred = lattice[(lattice.sum(axis=1) // 1000) % 2 == 0]
    assert steepest_wall(centred, *box).run == 0
    # Slid apart by one step they do not: their walls lean 45°, to one step.
    crushed = centred * np.array([1000, 1000, 1001]) // 1000
    assert 1 <= steepest_wall(crushed, *box).tau < 1.01


def test_tau_is_compared_exactly():
    """Two sites, one wall: 3 up, 4 across."""
    sites = np.array([[0, 0, 0], [4 << 26, 0, 3 << 26]])
    wall = steepest_wall(sites, np.full(3, -1 << 20), np.full(3, 1 << 28))
    assert wall.sites == (0, 1)
    assert wall.tau == 0.75
    assert wall.within(Fraction(9, 16))
    assert not wall.within(Fraction(9, 16) - Fraction(1, 1 << 62))


def test_nothing_leans_where_all_sites_are_level():
    sites = oracle.scattered(50, 1) * np.array([1, 1, 0])
    wall = steepest_wall(sites, np.zeros(3, np.int64), np.full(3, STEPS))
    assert wall.sites == (-1, -1)
    assert wall.within(0)
    assert wall.tau == 0


def test_bad_sites_are_refused():
    box = np.zeros(3, np.int64), np.full(3, STEPS)
    with pytest.raises(GeometryError, match="another site") as caught:
        steepest_wall(np.array([[5, 5, 5], [1, 2, 3], [5, 5, 5]]), *box)
    assert caught.value.site == 2
    with pytest.raises(GeometryError, match="coarser"):
        steepest_wall(np.array([[1 << 51, 0, 0], [0, 0, 0]]), *box)
