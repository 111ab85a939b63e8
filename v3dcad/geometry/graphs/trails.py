"""Chaining the edges of a graph into few trails, each edge in one of them."""

from __future__ import annotations

from v3dcad.model import Ints


def trails(edges: Ints) -> list[list[int]]:
    """The edges (e, 2) of a graph as chains of vertex ids, each edge in exactly one.

    The least number of trails there can be: half the number of vertices of odd degree, and one
    for each piece that has none (Euler; the walk is Hierholzer's without his splicing where a
    trail may as well end). Those that close on themselves begin and end with the same id.
    """
    ways: dict[int, list[tuple[int, int]]] = {}
    for edge, (start, stop) in enumerate(edges.tolist()):
        ways.setdefault(start, []).append((stop, edge))
        ways.setdefault(stop, []).append((start, edge))
    used = bytearray(len(edges))

    def walk(vertex: int) -> list[int]:
        chain = [vertex]
        while True:
            open_ways = ways[chain[-1]]
            while open_ways and used[open_ways[-1][1]]:
                open_ways.pop()
            if not open_ways:
                return chain
            vertex, edge = open_ways.pop()
            used[edge] = True
            chain.append(vertex)

    odd = [vertex for vertex, found in ways.items() if len(found) % 2]
    walked = [walk(vertex) for vertex in odd] + [walk(vertex) for vertex in ways]
    return [chain for chain in walked if len(chain) > 1]
