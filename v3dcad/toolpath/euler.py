"""Closed walks that pass every edge of an even graph once (Hierholzer 1873)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from v3dcad.geometry.compiled.arrays import (
    BoolArray,
    ConstIntArray,
    ConstIntRows,
    IntArray,
)
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.model import Ints

Passed = NDArray[np.bool_]


class EvenGraph:
    """A graph whose vertices all have even degree, walked piece by piece."""

    def __init__(self, edges: Ints, vertices: int) -> None:
        """`edges` (e, 2) vertex ids below `vertices`; parallel edges are welcome."""
        ends = edges.ravel()
        self.edges = np.array(edges, dtype=np.int64)
        self.incident = np.argsort(ends, kind="stable") // 2
        self.first = np.concatenate([[0], np.cumsum(np.bincount(ends, minlength=vertices))])
        self.cursor = self.first[:-1].copy()
        self.passed: Passed = np.zeros(len(edges), dtype=bool)

    def circuit(self, start: int) -> tuple[Ints, Ints]:
        """The closed walk from `start` over all of its piece: vertex ids (k + 1,), edges (k,).

        Every edge is passed once in the life of the graph, so the walk of a piece already
        walked is empty. Time is linear in the number of edges.
        """
        vertices = np.empty(len(self.edges) + 1, dtype=np.int64)
        passed = np.empty(len(self.edges) + 1, dtype=np.int64)
        count = _circuit(
            self.edges, self.incident, self.first, self.cursor, self.passed, start, vertices, passed
        )
        return vertices[:count].copy(), passed[: count - 1].copy()


@compiled(ENTRY)
def _circuit(
    edges: ConstIntRows,
    incident: ConstIntArray,
    first: ConstIntArray,
    cursor: IntArray,
    passed: BoolArray,
    start: int,
    vertices_out: IntArray,
    edges_out: IntArray,
) -> int:
    # A walk goes on until it is stuck, which in an even graph is where it began; what is taken
    # back from the stack is the circuit, with side trips spliced in where edges were left.
    stack = np.empty(len(edges) + 1, dtype=np.int64)
    taken = np.empty(len(edges) + 1, dtype=np.int64)
    stack[0], taken[0] = start, -1
    top, count = 0, 0
    while top >= 0:
        vertex = stack[top]
        while cursor[vertex] < first[vertex + 1] and passed[incident[cursor[vertex]]]:
            cursor[vertex] += 1
        if cursor[vertex] < first[vertex + 1]:
            edge = incident[cursor[vertex]]
            passed[edge] = True
            top += 1
            stack[top] = edges[edge, 0] + edges[edge, 1] - vertex
            taken[top] = edge
        else:
            vertices_out[count] = vertex
            edges_out[count] = taken[top]
            count += 1
            top -= 1
    return count
