"""The cells of a cut diagram as rings, made on demand: the layer loop needs only its edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from v3dcad.model import OUTSIDE, Diagram, Floats, Ints, Value


@dataclass(frozen=True, eq=False, slots=True)
class Cells(Value):
    """Rings around cells: outer ones counter-clockwise, holes clockwise.

    A cell has 0, 1 or several rings: pieces and holes follow each other in `rings`.
    """

    vertices: Ints
    """(r,) vertex ids of the diagram, ring after ring, open"""
    rings: Ints
    """(k + 1,) where each ring begins in `vertices`"""
    sites: Ints
    """(k,) whose ring it is, ascending"""

    def ring(self, index: int, diagram: Diagram) -> Floats:
        """The corners (m, 2), mm, of one ring."""
        return diagram.vertices[self.vertices[self.rings[index] : self.rings[index + 1]]]


def cells(diagram: Diagram) -> Cells:
    """The rings of all cells of a diagram that have a part inside the section.

    Every edge is walked once on each side that has a cell. Where a cell touches itself in a
    vertex, its ring passes there more than once or is two rings, which have the same area.
    """
    edges, sites = diagram.edges, diagram.edge_sites
    inner = sites[:, 0] != OUTSIDE
    begin = np.concatenate([edges[:, 0], edges[inner, 1]])
    end = np.concatenate([edges[:, 1], edges[inner, 0]])
    owner = np.concatenate([sites[:, 1], sites[inner, 0]])
    order = np.lexsort((begin, owner))
    begin, end, owner = begin[order], end[order], owner[order]
    # At each vertex a cell has as many edges that begin there as end: pair them.
    by_end = np.lexsort((end, owner))
    successor = np.empty(len(begin), np.int64)
    successor[by_end] = np.arange(len(begin))
    ring_of = np.full(len(begin), -1)
    walked: list[int] = []
    starts = [0]
    following = successor.tolist()
    visited = ring_of.tolist()
    for first in range(len(following)):
        if visited[first] >= 0:
            continue
        edge = first
        while visited[edge] < 0:
            visited[edge] = len(starts)
            walked.append(edge)
            edge = following[edge]
        starts.append(len(walked))
    rows = np.array(walked, np.int64)
    return Cells(begin[rows], np.array(starts), owner[rows[np.array(starts[:-1], np.int64)]])
