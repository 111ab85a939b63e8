"""Walls of one bead: one closed stroke over each connected piece of a graph.

A stroke that passes every edge once needs even vertices. Where three edges meet, some have to
be passed twice: the least length that makes all vertices even is a minimum T-join of the odd
ones (Edmonds & Johnson 1973), a minimum-weight perfect matching, which PyMatching finds.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import scipy.sparse
from scipy.sparse.csgraph import connected_components

from v3dcad.model import Floats, Ints
from v3dcad.toolpath.euler import EvenGraph
from v3dcad.toolpath.graph import PathGraph

UNIT = 1e-5
"""mm of an edge's weight in the matching, whose integers end at `MOST_WEIGHT`."""
MOST_WEIGHT = 2**24 - 1


class Walk(NamedTuple):
    """One stroke: the vertices (k + 1,) it passes, its edges (k,), and of each step (k,) the other

    one along the same edge, or itself.
    """

    vertices: Ints
    edges: Ints
    other: Ints


class Join(NamedTuple):
    """A minimum T-join of a graph's odd vertices: its edges and its length in mm."""

    edges: Ints
    length: float


def closed_strokes(graph: PathGraph, join: Join, here: Floats) -> Iterator[Walk]:
    """One stroke for each piece, over all of its edges and those of the join once more.

    The first begins near `here` (2,), mm; each goes on to the nearest piece that is left.
    """
    copied = np.concatenate([np.arange(len(graph.edges)), join.edges])
    even = EvenGraph(graph.edges[copied], len(graph.vertices))
    for vertices, steps in _pieces(graph, even, here):
        edges = copied[steps]
        order = np.argsort(edges, kind="stable")
        twice = np.nonzero(np.diff(edges[order]) == 0)[0]
        other = np.arange(len(edges))
        other[order[twice]], other[order[twice + 1]] = order[twice + 1], order[twice]
        yield Walk(vertices, edges, other)


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
    # Without weights of 0 the join has no circle: no edge is passed for nothing.
    weights = np.maximum(np.rint(lengths / unit), 1)
    # Imported here: it loads NetworkX and matplotlib, and only walls of one bead need it.
    from pymatching import Matching

    matching = Matching.from_check_matrix(ends, weights=weights, merge_strategy="smallest-weight")
    edges = np.nonzero(matching.decode(odd))[0]
    return Join(edges, float(lengths[edges].sum()))


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
