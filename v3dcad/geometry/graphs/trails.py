"""Chaining the edges of a graph into few trails, each edge in one of them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from v3dcad.model import Ints


def trails(edges: Ints) -> list[list[int]]:
    """The edges (e, 2) of a graph as chains of vertex ids, each edge in exactly one.

    The least number of trails there can be (Euler): half the number of vertices of odd degree, and
    one for each piece that has none. Those that close on themselves begin and end with the same id.

    Further edges that join the odd vertices in pairs make every piece a circuit (Hierholzer,
    "Ueber die Möglichkeit, einen Linienzug ohne Wiederholung und ohne Unterbrechung zu umfahren",
    Math. Annalen 1873), which is cut where they are.
    """
    vertices, degree = np.unique(edges, return_counts=True)
    joins = vertices[degree % 2 == 1].reshape(-1, 2)
    ways: dict[int, list[tuple[int, int]]] = {}
    for edge, (start, stop) in enumerate(np.concatenate([edges, joins]).tolist()):
        ways.setdefault(start, []).append((stop, edge))
        ways.setdefault(stop, []).append((start, edge))
    used = bytearray(len(edges) + len(joins))
    found = []
    for vertex in ways:
        found += _cut(_circuit(vertex, ways, used), len(edges))
    return found


def _circuit(
    vertex: int, ways: dict[int, list[tuple[int, int]]], used: bytearray
) -> list[tuple[int, int]]:
    """All unused edges of a piece in one circuit: each vertex, and the edge to the next one."""
    passed, circuit = [(vertex, -1)], []
    while passed:
        open_ways = ways[passed[-1][0]]
        while open_ways and used[open_ways[-1][1]]:
            open_ways.pop()
        if open_ways:
            passed.append(open_ways.pop())
            used[passed[-1][1]] = True
        else:
            circuit.append(passed.pop())
    return circuit


def _cut(circuit: list[tuple[int, int]], count: int) -> list[list[int]]:
    """The parts of a circuit between edges that are none of the first `count`."""
    cuts = [place for place, (_, edge) in enumerate(circuit) if edge >= count]
    vertices = [vertex for vertex, _ in circuit]
    if cuts:  # from one cut all the way round to it
        turn = cuts[0] + 1
        vertices = vertices[turn:] + vertices[1:turn]
        cuts = [place - turn for place in cuts[1:]]
    ends = [0, *(place + 1 for place in cuts), len(vertices)]
    parts = [vertices[start:stop] for start, stop in pairwise(ends)]
    return [part for part in parts if len(part) > 1]
