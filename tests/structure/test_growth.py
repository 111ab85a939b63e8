from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Delaunay
from scipy.spatial.distance import pdist, squareform

from v3dcad.geometry.graphs.spanning_tree import spanning_tree
from v3dcad.structure.growth import growing


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


@given(st.integers(4, 60), st.integers(0, 10_000))
def test_delaunay_edges_hold_the_tree_of_all_pairs(count: int, seed: int) -> None:
    """The Euclidean minimum spanning tree, found by Prim over all pairs, has the same length."""
    sites = np.random.default_rng(seed).integers(0, 1 << 24, (count, 2))
    sides = Delaunay(sites).simplices[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    tree = spanning_tree(sites, np.unique(np.sort(sides, axis=1), axis=0).astype(np.int64))
    distances = squareform(pdist(sites))
    reach, total, left = distances[0].copy(), 0.0, set(range(1, count))
    while left:
        nearest = min(left, key=lambda site: reach[site])
        total += reach[nearest]
        left.remove(nearest)
        reach = np.minimum(reach, distances[nearest])
    assert len(tree) == count - 1
    assert np.isclose(distances[tree[:, 0], tree[:, 1]].sum(), total, rtol=1e-12)
