"""Spanning trees against Prim's algorithm over all pairs, and where edges tie."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Delaunay
from scipy.spatial.distance import pdist, squareform

from v3dcad.geometry.graphs.spanning_tree import spanning_tree
from v3dcad.geometry.graphs.trails import trails


def test_ties_go_by_the_lower_number_then_by_the_higher() -> None:
    places = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    pairs = np.array([[2, 3], [0, 3], [1, 2], [0, 1]])
    np.testing.assert_array_equal(spanning_tree(places, pairs), [[0, 1], [0, 3], [1, 2]])


@given(st.integers(2, 6), st.integers(0, 10_000))
def test_the_order_of_the_pairs_does_not_matter(side: int, seed: int) -> None:
    """On a grid all sides of squares tie."""
    places = np.stack(np.meshgrid(*[np.arange(side)] * 2), axis=-1).reshape(-1, 2)
    apart = squareform(pdist(places))
    pairs = np.argwhere(np.triu((apart > 0) & (apart < 1.5)))
    shuffled = np.random.default_rng(seed).permutation(pairs)
    np.testing.assert_array_equal(spanning_tree(places, shuffled), spanning_tree(places, pairs))


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


@given(st.integers(1, 12), st.integers(0, 30), st.integers(0, 10_000))
def test_trails_pass_every_edge_once_and_are_as_few_as_can_be(
    vertices: int, count: int, seed: int
) -> None:
    edges = np.random.default_rng(seed).integers(0, vertices, (count, 2))
    edges = edges[edges[:, 0] != edges[:, 1]]
    chains = trails(edges)
    passed = [tuple(sorted(step)) for chain in chains for step in zip(chain, chain[1:])]  # noqa: B905, RUF007
    assert sorted(passed) == sorted(map(tuple, np.sort(edges, axis=1).tolist()))
    degree = np.bincount(edges.ravel(), minlength=vertices)
    piece = np.arange(vertices)
    for _ in range(vertices):
        for a, b in edges.tolist():
            piece[a] = piece[b] = min(piece[a], piece[b])
    odd = np.bincount(piece, degree % 2, vertices)
    there = np.bincount(piece, degree, vertices) > 0
    assert len(chains) == np.maximum(odd[there] / 2, 1).sum()
