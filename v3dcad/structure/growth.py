"""Which sites grow: every second level of the minimum spanning tree."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree

from v3dcad.model import Floats, Ints


def spanning_tree(sites: Floats, neighbours: Ints) -> Ints:
    """Minimum spanning tree (m, 2), i < j, of the neighbours (k, 2) by distance of their sites.

    Ties go to the pair of smaller ids. A forest where the neighbours are not connected.
    """
    squared = ((sites[neighbours[:, 0]] - sites[neighbours[:, 1]]) ** 2).sum(axis=1)
    order = np.lexsort((neighbours[:, 1], neighbours[:, 0], squared))
    rank = np.empty(len(order))
    rank[order] = np.arange(1, len(order) + 1)
    count = len(sites)
    tree = minimum_spanning_tree(coo_array((rank, neighbours.T), (count, count)).tocsr()).tocoo()
    pairs = np.sort(np.column_stack([tree.row, tree.col]).astype(np.int64), axis=1)
    return np.asarray(pairs[np.lexsort(pairs.T[::-1])])


def growing(count: int, tree: Ints) -> NDArray[np.bool_]:
    """(count,) which sites grow: those on odd levels of the tree, rooted at the smallest site.

    A tree is bipartite, so that of two sites joined by it exactly one grows.
    """
    graph = coo_array((np.ones(len(tree)), tree.T), (count, count)).tocsr()
    pieces = connected_components(graph, directed=False)[1]
    odd = np.zeros(count, dtype=bool)
    for root in np.unique(pieces, return_index=True)[1]:
        order, parents = breadth_first_order(graph, root, directed=False)
        for site in order[1:]:
            odd[site] = not odd[parents[site]]
    return odd
