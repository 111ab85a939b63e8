"""Layers as B-rep wires: contours closed, walls edge by edge, sharing their vertices."""

from __future__ import annotations

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.gp import gp_Pnt
from OCP.TopoDS import TopoDS_Compound, TopoDS_Edge, TopoDS_Vertex, TopoDS_Wire

from v3dcad.kernel.shapes import compound
from v3dcad.model import Diagram, Floats, Layer, Placement

TOLERANCE = 1e-7
"""OCCT's confusion; an edge shorter than this cannot be made, its ends are one vertex."""


def layer_wires(layer: Layer, placement: Placement) -> TopoDS_Compound:
    """One compound of a layer's wires, where the source lies.

    Every contour is one closed wire, every wall one wire of one edge; all share vertices.
    """
    diagram = layer.diagram
    flat = np.column_stack([diagram.vertices, np.full(len(diagram.vertices), layer.z)])
    corners = _Corners(placement.to_source(flat))
    wires = [corners.wire(chain) for chain in _contours(diagram)]
    wires += [corners.wire(edge) for edge in diagram.edges[diagram.inner()].tolist()]
    return compound(wire for wire in wires if wire is not None)


def _contours(diagram: Diagram) -> list[list[int]]:
    """The boundary edges chained into closed lists of vertex ids, the first id repeated last.

    Where contours touch in a vertex, each way through it is taken once.
    """
    ways: dict[int, list[int]] = {}
    for start, stop in diagram.edges[~diagram.inner()].tolist():
        ways.setdefault(start, []).append(stop)
    chains = []
    for start in list(ways):
        while ways[start]:
            chain = [start, ways[start].pop()]
            while chain[-1] != start:
                chain.append(ways[chain[-1]].pop())
            chains.append(chain)
    return chains


class _Corners:
    """Vertices made once each, and wires along them."""

    def __init__(self, points: Floats) -> None:
        self.points = points
        self.made: dict[int, TopoDS_Vertex] = {}
        self.builder = BRep_Builder()

    def wire(self, chain: list[int]) -> TopoDS_Wire | None:
        """A wire along vertex ids; None where all its edges are shorter than the tolerance."""
        wire = TopoDS_Wire()
        self.builder.MakeWire(wire)
        edges = 0
        start = chain[0]
        for k, stop in enumerate(chain[1:], start=2):
            short = np.linalg.norm(self.points[stop] - self.points[start]) <= TOLERANCE
            if short and k < len(chain):
                continue
            if not short:
                self.builder.Add(wire, self._edge(start, stop))
                edges += 1
            start = stop
        wire.Closed(chain[0] == chain[-1])
        return wire if edges else None

    def _edge(self, start: int, stop: int) -> TopoDS_Edge:
        return BRepBuilderAPI_MakeEdge(self._vertex(start), self._vertex(stop)).Edge()

    def _vertex(self, index: int) -> TopoDS_Vertex:
        vertex = self.made.get(index)
        if vertex is None:
            vertex = self.made[index] = TopoDS_Vertex()
            x, y, z = self.points[index].tolist()
            self.builder.MakeVertex(vertex, gp_Pnt(x, y, z), TOLERANCE)
        return vertex
