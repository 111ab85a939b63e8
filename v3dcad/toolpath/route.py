"""Walls of one bead: the order in which a graph's edges are extruded, with few interruptions.

A stroke that passes every edge once needs even vertices. Where three edges meet, some have to
be passed twice: the least length that makes all vertices even is a minimum T-join of the odd
ones (Edmonds & Johnson 1973), a minimum-weight perfect matching, which PyMatching finds.
`least-retrace` passes the join again without extruding; `trails` jumps between the vertices it
pairs; `tree` is the thesis's order (`tree_route.py`).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from v3dcad.model import Floats, Ints
from v3dcad.toolpath.euler import EvenGraph
from v3dcad.toolpath.graph import PathGraph
from v3dcad.toolpath.tree_route import tree_walks

UNIT = 1e-5
"""mm of an edge's weight in the matching, whose integers end at `MOST_WEIGHT`."""
MOST_WEIGHT = 2**24 - 1


class Walk(NamedTuple):
    """One stroke: the vertices (k + 1,) it passes, its edges (k,), and which it extrudes (k,)."""

    vertices: Ints
    edges: Ints
    extrudes: NDArray[np.bool_]


class Join(NamedTuple):
    """A minimum T-join of a graph's odd vertices: its edges and its length in mm."""

    edges: Ints
    length: float


def walks(graph: PathGraph, route: str, join: Join, here: Floats, tree: Ints) -> list[Walk]:
    """Strokes that extrude every edge of the graph once, from near `here` (2,) mm on.

    `route` is "least-retrace", "trails" or "tree"; `tree` (m, 2) is the layer's spanning tree
    of sites. Pieces follow each other by the nearest start.
    """
    if route == "tree":
        return [
            Walk(vertices, edges, np.ones(len(edges), dtype=bool))
            for vertices, edges in tree_walks(graph, here, tree)
        ]
    if route == "trails":
        return list(_trails(graph, join, here))
    return list(_closed_strokes(graph, join, here))


def minimum_join(graph: PathGraph) -> Join:
    """The edges of least length which, passed once more, make every vertex even.

    Of parallel edges the shortest counts. Lengths are rounded to `UNIT`, or so that the
    longest fits PyMatching's integers.
    """
    odd = (graph.degrees() % 2).astype(np.uint8)
    if not odd.any():
        return Join(np.empty(0, np.int64), 0.0)
    lengths = graph.lengths()
    unit = max(UNIT, float(lengths.max()) / MOST_WEIGHT)
    size = len(graph.edges)
    ends = scipy.sparse.csc_matrix(
        (np.ones(2 * size, np.uint8), graph.edges.ravel(), np.arange(0, 2 * size + 1, 2)),
        shape=(len(graph.vertices), size),
    )
    # Without weights of 0 the join has no circle, on which `_pairs` relies.
    weights = np.maximum(np.rint(lengths / unit), 1)
    # Imported here: it loads NetworkX and matplotlib, and only this route needs it.
    from pymatching import Matching

    matching = Matching.from_check_matrix(ends, weights=weights, merge_strategy="smallest-weight")
    edges = np.nonzero(matching.decode(odd))[0]
    return Join(edges, float(lengths[edges].sum()))


def _pairs(graph: PathGraph, join: Join) -> Ints:
    """(m, 2) the odd vertices at the ends of the paths that the join consists of.

    The join is a forest whose leaves are odd. An odd vertex goes from a leaf on to the next
    vertex until it meets another: no edge is used by two pairs.
    """
    ends = graph.edges[join.edges].tolist()
    beside: dict[int, set[int]] = defaultdict(set)
    for start, stop in ends:
        beside[start].add(stop)
        beside[stop].add(start)
    carried = {vertex: vertex for vertex, others in beside.items() if len(others) % 2}
    leaves = sorted(vertex for vertex, others in beside.items() if len(others) == 1)
    pairs = []
    for leaf in leaves:
        vertex = leaf
        while len(beside[vertex]) == 1:
            following = beside[vertex].pop()
            beside[following].remove(vertex)
            arriving = carried.pop(vertex)
            if following in carried:
                pairs.append((arriving, carried.pop(following)))
            else:
                carried[following] = arriving
            vertex = following
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)


def _closed_strokes(graph: PathGraph, join: Join, here: Floats) -> Iterator[Walk]:
    """One closed stroke a piece; of the two passes of an edge of the join the first extrudes."""
    copied = np.concatenate([np.arange(len(graph.edges)), join.edges])
    even = EvenGraph(graph.edges[copied], len(graph.vertices))
    for vertices, steps in _pieces(graph, even, here):
        edges = copied[steps]
        _, first = np.unique(edges, return_index=True)
        extrudes = np.zeros(len(edges), dtype=bool)
        extrudes[first] = True
        yield Walk(vertices, edges, extrudes)


def _trails(graph: PathGraph, join: Join, here: Floats) -> Iterator[Walk]:
    """Half as many strokes a piece as it has odd vertices, or one: jumps pair the odd ones.

    A piece's circuit over edges and jumps is opened at the jump whose place gains most: its
    own length, less the way from where the nozzle is.
    """
    size = len(graph.edges)
    even = EvenGraph(np.concatenate([graph.edges, _pairs(graph, join)]), len(graph.vertices))
    for vertices, steps in _pieces(graph, even, here):
        jumps = np.nonzero(steps >= size)[0]
        if not len(jumps):
            yield Walk(vertices, steps, np.ones(len(steps), dtype=bool))
            here = graph.vertices[vertices[-1]]
            continue
        ends = graph.vertices[vertices]
        gained = np.hypot(*(ends[jumps + 1] - ends[jumps]).T)
        gained -= np.hypot(*(ends[jumps + 1] - here).T)
        opened = int(jumps[np.argmax(gained)]) + 1
        steps = np.roll(steps, -opened)
        around = np.roll(vertices[:-1], -opened)
        cuts = np.nonzero(steps >= size)[0]
        for start, stop in zip(np.concatenate([[0], cuts[:-1] + 1]), cuts, strict=True):
            if stop > start:
                yield Walk(
                    around[start : stop + 1], steps[start:stop], np.ones(stop - start, dtype=bool)
                )
        here = graph.vertices[around[cuts[-1]]]


def _pieces(graph: PathGraph, even: EvenGraph, here: Floats) -> Iterator[tuple[Ints, Ints]]:
    """The circuit of each connected piece, always going on to the nearest one left."""
    ends = np.unique(even.edges)
    if not len(ends):
        return
    size = len(graph.vertices)
    linked = scipy.sparse.coo_matrix(
        (np.ones(len(even.edges), dtype=bool), tuple(even.edges.T)), shape=(size, size)
    )
    piece = connected_components(linked, directed=False)[1][ends]
    left = np.ones(len(ends), dtype=bool)
    while left.any():
        open_ends = ends[left]
        start = int(open_ends[np.argmin(np.hypot(*(graph.vertices[open_ends] - here).T))])
        left &= piece != piece[np.searchsorted(ends, start)]
        vertices, steps = even.circuit(start)
        here = graph.vertices[vertices[-1]]
        yield vertices, steps
