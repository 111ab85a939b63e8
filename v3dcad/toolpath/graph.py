"""The graph a layer is printed from: cell edges and perimeters once each, junctions by id."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from v3dcad.geometry import arcs
from v3dcad.model import CELLS, OUTSIDE, PERIMETER, Bytes, Diagram, Floats, Ints, Value


@dataclass(frozen=True, eq=False, slots=True)
class PathGraph(Value):
    """What is to be extruded, each edge once, as a graph drawn in the plane."""

    vertices: Floats
    """(v, 2) mm"""
    edges: Ints
    """(e, 2) vertex ids"""
    feature: Bytes
    """(e,) CELLS, PERIMETER, …"""
    sites: Ints
    """(e, 2) the two sites beside a cell edge; `OUTSIDE` where there is none"""
    centre: Floats
    """(e, 2) mm, centre of an edge that is an arc; NaN where it is straight"""

    def lengths(self) -> Floats:
        """(e,) mm, measured along the arc where an edge is one."""
        start, stop = np.moveaxis(self.vertices[self.edges], 1, 0)
        return arcs.lengths(start, stop, self.centre)

    def only(self, chosen: NDArray[np.bool_]) -> PathGraph:
        """The same graph with the chosen (e,) edges alone; vertices keep their ids."""
        return PathGraph(
            self.vertices,
            self.edges[chosen],
            self.feature[chosen],
            self.sites[chosen],
            self.centre[chosen],
        )

    def degrees(self) -> Ints:
        """(v,) number of edge ends at each vertex."""
        return np.bincount(self.edges.ravel(), minlength=len(self.vertices))


def diagram_graph(diagram: Diagram) -> PathGraph:
    """A whole diagram: its cell edges, and its boundary as the perimeter."""
    inner = diagram.inner()
    return PathGraph(
        diagram.vertices,
        diagram.edges,
        np.where(inner, CELLS, PERIMETER).astype(np.int8),
        diagram.edge_sites,
        np.full(diagram.edges.shape, np.nan),
    )


def loops_graph(loops: Sequence[Floats], feature: int) -> PathGraph:
    """Closed lines, each by its points (k, 2), that do not meet."""
    vertices = np.concatenate([np.empty((0, 2)), *loops])
    sizes = np.array([len(loop) for loop in loops], dtype=np.int64)
    first = np.repeat(np.cumsum(sizes) - sizes, sizes)
    here = np.arange(len(vertices))
    following = first + (here - first + 1) % np.repeat(sizes, sizes)
    edges = np.column_stack([here, following])
    return PathGraph(
        vertices,
        edges,
        np.full(len(edges), feature, dtype=np.int8),
        np.full(edges.shape, OUTSIDE),
        np.full(edges.shape, np.nan),
    )


def with_short_edges_joined(graph: PathGraph, minimum: float) -> tuple[PathGraph, int]:
    """The graph without edges shorter than `minimum` (mm), and how many there were.

    The ends of a short edge become one vertex: the perimeter's, where one is on it, so that
    the print keeps its outline, else the one with the lower id. Vertices move by at most
    `minimum` a round; a curve of many short edges is thinned, not swallowed. Of two straight
    edges that come to lie between the same vertices one stays.
    """
    joined = 0
    while True:
        lengths = graph.lengths()
        short = np.nonzero((lengths < minimum) | (lengths == 0))[0]
        if not len(short):
            return graph, joined
        shrunk = _contracted(graph, short[np.argsort(lengths[short], kind="stable")], minimum)
        joined += len(graph.edges) - len(shrunk.edges)
        graph = shrunk


def _contracted(graph: PathGraph, short: Ints, minimum: float) -> PathGraph:
    on_perimeter = np.zeros(len(graph.vertices), dtype=bool)
    on_perimeter[graph.edges[graph.feature == PERIMETER]] = True
    heir = np.arange(len(graph.vertices))
    spread: dict[int, list[int]] = {}
    for start, stop in graph.edges[short].tolist():
        kept, lost = sorted(
            (int(heir[start]), int(heir[stop])), key=lambda v: (not on_perimeter[v], v)
        )
        together = spread.get(kept, [kept]) + spread.get(lost, [lost])
        extent = np.ptp(graph.vertices[together], axis=0)
        if kept == lost or (len(together) > 2 and np.hypot(*extent) > minimum):
            continue
        heir[together] = kept
        spread[kept] = together
    edges = heir[graph.edges]
    straight = np.isnan(graph.centre[:, 0])
    # Perimeters come first, so that of two edges that coincide theirs is kept.
    order = np.argsort(graph.feature != PERIMETER, kind="stable")
    alike = np.column_stack([np.sort(edges, axis=1), np.where(straight, -1, np.arange(len(edges)))])
    _, first = np.unique(alike[order], axis=0, return_index=True)
    chosen = np.zeros(len(edges), dtype=bool)
    chosen[order[first]] = True
    chosen &= edges[:, 0] != edges[:, 1]
    return PathGraph(
        graph.vertices,
        edges[chosen],
        graph.feature[chosen],
        graph.sites[chosen],
        graph.centre[chosen],
    )
