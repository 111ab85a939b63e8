"""The spanning tree as the thesis walks it: CVT's order of cells."""

from __future__ import annotations

from heapq import heappop, heappush

import numpy as np

from v3dcad.model import Floats, Ints


def walked(cells: Ints, tree: Ints, sites: Floats) -> Ints:
    """The cells (c,) in the order in which Prim's algorithm reaches them along a tree (m, 2).

    It starts from the cell with the smallest id, again in every piece of a forest, and goes on
    along the shortest edge between reached and unreached cells, ties to smaller ids.
    """
    around: dict[int, list[tuple[float, int]]] = {cell: [] for cell in cells.tolist()}
    lengths = np.hypot(*(sites[tree[:, 0]] - sites[tree[:, 1]]).T)
    for (a, b), length in zip(tree.tolist(), lengths.tolist(), strict=True):
        around[a].append((length, b))
        around[b].append((length, a))
    order: dict[int, None] = {}
    for root in sorted(around):
        reach = [] if root in order else [(0.0, root)]
        while reach:
            cell = heappop(reach)[1]
            if cell not in order:
                order[cell] = None
                for edge in around[cell]:
                    heappush(reach, edge)
    return np.array(list(order), dtype=np.int64)
