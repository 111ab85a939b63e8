from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from diagrams import disc, layer, scattered, square
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from v3dcad.model import CELLS, Floats, Ints
from v3dcad.toolpath.euler import EvenGraph
from v3dcad.toolpath.graph import PathGraph, diagram_graph, loops_graph
from v3dcad.toolpath.route import Walk, minimum_join, walks

lean = settings(max_examples=40, deadline=None, derandomize=True)
NO_TREE = np.empty((0, 2), dtype=np.int64)


def graph_of(vertices: Floats, edges: Ints) -> PathGraph:
    return PathGraph(
        np.asarray(vertices, dtype=np.float64),
        np.asarray(edges, dtype=np.int64),
        np.full(len(edges), CELLS, dtype=np.int8),
        np.full((len(edges), 2), -1),
        np.full((len(edges), 2), np.nan),
    )


@st.composite
def graphs(draw: st.DrawFn, most_odd: int = 12) -> PathGraph:
    """Random graphs with parallel edges, bridges and several pieces."""
    count = draw(st.integers(2, 14))
    pair = st.tuples(st.integers(0, count - 1), st.integers(0, count - 1))
    edges = draw(st.lists(pair.filter(lambda p: p[0] != p[1]), min_size=1, max_size=24))
    place = st.tuples(st.integers(-50, 50), st.integers(-50, 50))
    vertices = draw(st.lists(place, min_size=count, max_size=count, unique=True))
    odd = Counter(vertex for edge in edges for vertex in edge)
    while sum(degree % 2 for degree in odd.values()) > most_odd:
        edges = edges[:-1]
        odd = Counter(vertex for edge in edges for vertex in edge)
    return graph_of(np.array(vertices), np.array(edges))


def brute_force_join(graph: PathGraph) -> float:
    """Least total length of paths that pair the odd vertices: all pairings tried."""
    size = len(graph.vertices)
    apart = np.full((size, size), np.inf)
    np.fill_diagonal(apart, 0)
    for (a, b), length in zip(graph.edges, graph.lengths(), strict=True):
        apart[a, b] = apart[b, a] = min(apart[a, b], length)
    for k in range(size):
        apart = np.minimum(apart, apart[:, k, None] + apart[None, k])

    def least(odd: tuple[int, ...]) -> float:
        if not odd:
            return 0.0
        first, *rest = odd
        return min(
            apart[first, other] + least(tuple(v for v in rest if v != other)) for other in rest
        )

    return least(tuple(np.nonzero(graph.degrees() % 2)[0].tolist()))


def check_walks(graph: PathGraph, found: list[Walk]) -> None:
    """Every step is along its edge, and every edge is extruded once."""
    for walk in found:
        ends = np.column_stack([walk.vertices[:-1], walk.vertices[1:]])
        assert np.array_equal(np.sort(ends, axis=1), np.sort(graph.edges[walk.edges], axis=1))
    extruded = np.concatenate([walk.edges[walk.extrudes] for walk in found])
    assert np.array_equal(np.sort(extruded), np.arange(len(graph.edges)))


@lean
@given(graphs())
def test_retrace_is_the_optimum_of_all_pairings(graph: PathGraph) -> None:
    join = minimum_join(graph)
    assert join.length == pytest.approx(brute_force_join(graph), abs=1e-3)
    odd = np.bincount(graph.edges[join.edges].ravel(), minlength=len(graph.vertices)) % 2
    assert np.array_equal(odd, graph.degrees() % 2)


@lean
@given(graphs())
def test_closed_strokes_one_a_piece(graph: PathGraph) -> None:
    join = minimum_join(graph)
    found = walks(graph, "least-retrace", join, np.zeros(2), NO_TREE)
    check_walks(graph, found)
    assert all(walk.vertices[0] == walk.vertices[-1] for walk in found)
    pieces = [set(walk.vertices.tolist()) for walk in found]
    assert sum(map(len, pieces)) == len(set().union(*pieces))
    retraced = sum(graph.lengths()[walk.edges[~walk.extrudes]].sum() for walk in found)
    assert retraced == pytest.approx(join.length)


@lean
@given(graphs())
def test_an_edge_is_extruded_before_it_is_retraced(graph: PathGraph) -> None:
    for walk in walks(graph, "least-retrace", minimum_join(graph), np.zeros(2), NO_TREE):
        seen: set[int] = set()
        for edge, extrudes in zip(walk.edges.tolist(), walk.extrudes.tolist(), strict=True):
            assert extrudes == (edge not in seen)
            seen.add(edge)


def least_strokes(graph: PathGraph) -> int:
    """The least number of strokes that pass every edge once: half the odd vertices of a piece."""
    degrees = graph.degrees()
    ends = (np.ones(len(graph.edges), bool), tuple(graph.edges.T))
    piece = connected_components(coo_array(ends, (len(degrees),) * 2), directed=False)[1]
    odd = np.bincount(piece, degrees % 2)[np.unique(piece[degrees > 0])]
    return int(np.maximum(odd / 2, 1).sum())


@lean
@given(graphs())
def test_trails_are_as_few_as_can_be(graph: PathGraph) -> None:
    found = walks(graph, "trails", minimum_join(graph), np.zeros(2), NO_TREE)
    check_walks(graph, found)
    assert all(walk.extrudes.all() for walk in found)
    assert len(found) == least_strokes(graph)


@lean
@given(graphs())
def test_tree_extrudes_every_edge_once(graph: PathGraph) -> None:
    check_walks(graph, walks(graph, "tree", minimum_join(graph), np.zeros(2), NO_TREE))


def test_tree_finishes_cell_after_cell_along_the_tree() -> None:
    sites = scattered(30, 10, 2)
    made = layer(sites, square(10))
    graph = diagram_graph(made.diagram)
    found = walks(graph, "tree", minimum_join(graph), np.zeros(2), made.tree)
    check_walks(graph, found)
    beside = {(a, b) for pair in made.tree.tolist() for a, b in (pair, pair[::-1])}
    last = np.zeros(len(sites), dtype=np.int64)
    for place, edge in enumerate(np.concatenate([walk.edges for walk in found]).tolist()):
        for site in graph.sites[edge]:
            if site >= 0:
                last[site] = place
    # The walk over the tree ends each cell no later than those it leads on to.
    assert np.argmin(last) == 0
    order = np.argsort(last)
    met = {int(order[0])}
    for site in order[1:].tolist():
        assert any((site, other) in beside for other in met)
        met.add(site)


@pytest.mark.parametrize("route", ["least-retrace", "trails", "tree"])
def test_isolated_rings_are_one_closed_stroke_each(route: str) -> None:
    corners = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    graph = loops_graph([corners, corners + 5, corners + 20], CELLS)
    found = walks(graph, route, minimum_join(graph), np.array([21.0, 20]), NO_TREE)
    check_walks(graph, found)
    assert [walk.vertices[0] for walk in found] == [9, 6, 2]
    assert all(walk.vertices[0] == walk.vertices[-1] for walk in found)


def test_weights_of_a_large_part_still_fit() -> None:
    graph = graph_of(np.array([[0, 0], [90_000, 0], [0.5, 0], [0, 3]]), [[0, 1], [0, 2], [0, 3]])
    assert minimum_join(graph).length == pytest.approx(90_003.5)


def test_a_diagram_retraces_about_a_fifth() -> None:
    graph = diagram_graph(layer(scattered(120, 20, 5), disc(20)).diagram)
    assert 0.1 < minimum_join(graph).length / graph.lengths().sum() < 0.3


def test_routes_are_the_same_every_time() -> None:
    graph = diagram_graph(layer(scattered(60, 10, 7), square(10)).diagram)
    for route in ("least-retrace", "trails", "tree"):
        once, twice = (
            walks(graph, route, minimum_join(graph), np.zeros(2), NO_TREE) for _ in range(2)
        )
        for one, other in zip(once, twice, strict=True):
            assert np.array_equal(one.vertices, other.vertices)


@lean
@given(graphs(), st.integers(0, 13))
def test_a_circuit_passes_every_edge_once(graph: PathGraph, start: int) -> None:
    doubled = np.concatenate([graph.edges, graph.edges])
    even = EvenGraph(doubled, 14)
    vertices, edges = even.circuit(start)
    assert vertices[0] == vertices[-1] == start
    ends = np.column_stack([vertices[:-1], vertices[1:]])
    assert np.array_equal(np.sort(ends, axis=1), np.sort(doubled[edges], axis=1))
    assert len(np.unique(edges)) == len(edges)
    reached = set(vertices.tolist())
    assert all((set(ends) <= reached) == (e in edges) for e, ends in enumerate(doubled.tolist()))
    assert len(even.circuit(start)[1]) == 0


@pytest.mark.parametrize("route", ["least-retrace", "trails", "tree"])
def test_nothing_is_routed_over_nothing(route: str) -> None:
    graph = loops_graph([], CELLS)
    assert walks(graph, route, minimum_join(graph), np.zeros(2), NO_TREE) == []
