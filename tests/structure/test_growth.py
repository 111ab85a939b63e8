from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from v3dcad.geometry.graphs.spanning_tree import spanning_tree
from v3dcad.structure.growth import growing, largest_offset


def test_tree_worked_by_hand() -> None:
    """Sites 0 … 3 on a line at 0, 1, 3, 4: the tree is the line; 1 and 3 are odd levels."""
    sites = np.array([[0, 0], [1, 0], [3, 0], [4, 0]])
    every = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])
    tree = spanning_tree(sites, every)
    assert sorted(tree.tolist()) == [[0, 1], [1, 2], [2, 3]]
    assert growing(4, tree).tolist() == [False, True, False, True]


def test_ties_go_to_the_smaller_ids() -> None:
    """Four corners of a square: all sides tie, so 0-1, 0-2 and then 1-3 are taken."""
    sites = np.array([[0, 0], [1, 0], [0, 1], [1, 1]])
    sides = np.array([[2, 3], [1, 3], [0, 2], [0, 1]])
    assert sorted(spanning_tree(sites, sides).tolist()) == [[0, 1], [0, 2], [1, 3]]


def test_every_piece_has_its_own_root() -> None:
    tree = np.array([[1, 4], [2, 3]])
    assert growing(5, tree).tolist() == [False, False, False, True, True]


@given(st.integers(6, 40), st.integers(0, 1000), st.floats(20, 80))
def test_the_largest_offset_is_the_largest(count: int, seed: int, limit: float) -> None:
    """With it no wall leans more than the limit; the wall that limits it leans just so."""
    random = np.random.default_rng(seed)
    sites, grows = random.uniform(-20, 20, (count, 2)), np.arange(count) % 2 == 1
    offset = largest_offset(sites, grows, 0.2, limit)
    i, j = Delaunay(sites).simplices[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).T
    mixed = grows[i] != grows[j]
    apart = np.hypot(*(sites[i] - sites[j])[mixed].T)
    tilts = np.degrees(np.arctan(offset / (2 * apart * 0.2)))
    assert tilts.max() == pytest.approx(limit)


def test_ninety_degrees_or_one_kind_of_site_set_no_limit() -> None:
    sites = np.array([[0.0, 0], [1, 0]])
    assert largest_offset(sites, np.array([True, False]), 0.2, 90) == np.inf
    assert largest_offset(sites, np.array([False, False]), 0.2, 45) == np.inf
