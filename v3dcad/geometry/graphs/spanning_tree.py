"""The minimum spanning tree of sites: by exact lengths, ties by the sites' numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import minimum_spanning_tree

from v3dcad.model import Ints


def spanning_tree(places: Ints, pairs: Ints) -> Ints:
    """The minimum spanning forest (k, 2) of pairs (m, 2), i < j, of places (n, 2) on the grid.

    By length, ties by the places' numbers, so that there is only one; shortest first.
    """
    if not len(pairs):
        return np.empty((0, 2), np.int64)
    across = places[pairs[:, 0]] - places[pairs[:, 1]]
    order = np.lexsort((pairs[:, 1], pairs[:, 0], (across * across).sum(axis=1)))
    rank = np.empty(len(pairs))
    rank[order] = np.arange(1.0, len(pairs) + 1)
    graph: Any = csr_array((rank, pairs.T), (len(places), len(places)))
    kept = minimum_spanning_tree(graph).data.astype(np.int64) - 1
    return np.asarray(pairs[order[np.sort(kept)]])


def spanning_tree_of(places: Ints, pairs: Ints) -> Ints:
    """The same where few of the places have a pair."""
    there, rows = np.unique(pairs, return_inverse=True)
    return np.asarray(there[spanning_tree(places[there], rows.reshape(-1, 2))])
