"""The spanning tree as the thesis walks it: the list SL of pairs, and CVT's order of cells."""

from __future__ import annotations

from heapq import heappop, heappush

import numpy as np

from v3dcad.model import Floats, Ints
from v3dcad.structure.thesis.state import GROWS, STAYS


def walked(cells: Ints, tree: Ints, sites: Floats) -> tuple[Ints, Ints]:
    """The cells (c,) in the order in which Prim's algorithm reaches them along a tree (m, 2).

    It starts from the cell with the smallest id, again in every piece of a forest, and goes on
    along the shortest edge between reached and unreached cells, ties to smaller ids. The second
    array (m, 2) is SL: for each cell but the roots, (the cell that it was reached from, itself).
    """
    around: dict[int, list[tuple[float, int]]] = {cell: [] for cell in cells.tolist()}
    lengths = np.hypot(*(sites[tree[:, 0]] - sites[tree[:, 1]]).T)
    for (a, b), length in zip(tree.tolist(), lengths.tolist(), strict=True):
        around[a].append((length, b))
        around[b].append((length, a))
    order: dict[int, int] = {}
    for root in sorted(around):
        reach = [] if root in order else [(0.0, root, root)]
        while reach:
            _, cell, parent = heappop(reach)
            if cell not in order:
                order[cell] = parent
                for length, other in around[cell]:
                    if other not in order:
                        heappush(reach, (length, other, cell))
    pairs = [(parent, cell) for cell, parent in order.items() if parent != cell]
    return np.array(list(order), dtype=np.int64), np.array(pairs, np.int64).reshape(-1, 2)


def tagged(count: int, pairs: Ints) -> Ints:
    """(count,) the tags OL: GROWS where the pair's first site does not (Algorithm 1, 36 to 43)."""
    tags = np.full(count, STAYS)
    for parent, child in pairs.tolist():
        if tags[parent] == STAYS:
            tags[child] = GROWS
    return tags
