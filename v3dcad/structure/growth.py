"""Which sites grow: every second level of the spanning tree of layer 0."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from v3dcad.model import Ints


def growing(count: int, tree: Ints) -> NDArray[np.bool_]:
    """(count,) which sites grow: those on odd levels of the tree (m, 2), rooted at site 0.

    Pieces of a forest are rooted at their smallest site. A tree is bipartite, so that of two
    sites joined by it exactly one grows.
    """
    ends = np.concatenate([tree, tree[:, ::-1]])
    ends = ends[np.argsort(ends[:, 0], kind="stable")]
    first = np.searchsorted(ends[:, 0], np.arange(count + 1))
    level = np.full(count, -1)
    for root in range(count):
        if level[root] >= 0:
            continue
        level[root] = 0
        front = np.array([root])
        while len(front):
            rows = np.concatenate([np.arange(first[site], first[site + 1]) for site in front])
            reached = ends[rows]
            reached = reached[level[reached[:, 1]] < 0]
            level[reached[:, 1]] = level[reached[:, 0]] + 1
            front = reached[:, 1]
    return np.asarray(level % 2 == 1)
