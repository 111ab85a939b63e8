"""The thesis's order (§3.5.2): cell after cell along the spanning tree, nearest edge next."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from v3dcad.model import OUTSIDE, Floats, Ints
from v3dcad.toolpath.graph import PathGraph


def tree_walks(graph: PathGraph, here: Floats, tree: Ints) -> Iterator[tuple[Ints, Ints]]:
    """Strokes as vertex ids (k + 1,) and edges (k,), none passed twice.

    The cells follow each other as a walk over `tree` (m, 2) from its lowest site meets them.
    Within a cell the next edge is one at the nozzle, else the nearest not yet passed, to which
    the nozzle travels. Edges of no cell, such as an inset perimeter, come last.
    """
    if not len(graph.edges):
        return
    ends: list[list[int]] = graph.edges.tolist()
    at: dict[int, list[int]] = defaultdict(list)
    for edge, vertices in enumerate(ends):
        for vertex in vertices:
            at[vertex].append(edge)

    passed = np.zeros(len(ends), dtype=bool)
    stroke: list[int] = []
    edges: list[int] = []
    for members in _edges_by_cell(graph, tree):
        left = set(members[~passed[members]].tolist())
        passed[members] = True
        while left:
            edge = next((edge for edge in at[stroke[-1]] if edge in left), -1) if stroke else -1
            if edge < 0:
                edge, start = _nearest(graph, np.array(sorted(left)), here)
                if edges:
                    yield np.array(stroke), np.array(edges)
                stroke, edges = [start], []
            stroke.append(sum(ends[edge]) - stroke[-1])
            edges.append(edge)
            left.remove(edge)
            here = graph.vertices[stroke[-1]]
    if edges:
        yield np.array(stroke), np.array(edges)


def _nearest(graph: PathGraph, edges: Ints, here: Floats) -> tuple[int, int]:
    """The edge with the end nearest to a point, and that end."""
    ends = graph.edges[edges]
    away = graph.vertices[ends] - here
    place = int(np.argmin(np.hypot(away[..., 0], away[..., 1])))
    return int(edges[place // 2]), int(ends.flat[place])


def _edges_by_cell(graph: PathGraph, tree: Ints) -> Iterator[Ints]:
    """The edges of each cell in the tree's order, then those of no cell."""
    edge = np.tile(np.arange(len(graph.edges)), 2)
    site = graph.sites.T.ravel()
    order = np.argsort(site, kind="stable")
    sites, first = np.unique(site[order], return_index=True)
    grouped = np.split(edge[order], first[1:])
    cells = dict(zip(sites.tolist(), grouped, strict=True))
    nobody = cells.pop(OUTSIDE, np.empty(0, dtype=np.int64))
    for cell in _depth_first(tree, list(cells)):
        if cell in cells:
            yield cells[cell]
    yield np.unique(nobody)


def _depth_first(tree: Ints, cells: list[int]) -> Iterator[int]:
    """Sites as a walk over the tree meets them, children by id; the cells it misses after."""
    beside: dict[int, list[int]] = defaultdict(list)
    for a, b in tree.tolist():
        beside[a].append(b)
        beside[b].append(a)
    met: set[int] = set()
    for root in sorted({*beside, *cells}):
        waiting = [root]
        while waiting:
            site = waiting.pop()
            if site not in met:
                met.add(site)
                yield site
                waiting.extend(sorted(set(beside[site]) - met, reverse=True))
