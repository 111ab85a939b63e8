from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from diagrams import disc, layer, scattered, square
from hypothesis import given, settings
from hypothesis import strategies as st

from v3dcad.model import CELLS, Floats, Ints
from v3dcad.toolpath.euler import EvenGraph
from v3dcad.toolpath.graph import PathGraph, diagram_graph, loops_graph
from v3dcad.toolpath.route import Walk, closed_strokes, minimum_join
from v3dcad.toolpath.tree_route import tree_walks

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


def check_steps(graph: PathGraph, vertices: Ints, edges: Ints) -> None:
    """Every step is along its edge."""
    ends = np.column_stack([vertices[:-1], vertices[1:]])
    assert np.array_equal(np.sort(ends, axis=1), np.sort(graph.edges[edges], axis=1))


def strokes(graph: PathGraph, here: tuple[float, float] = (0.0, 0.0)) -> list[Walk]:
    """Closed strokes, of which every edge is in one."""
    found = list(closed_strokes(graph, minimum_join(graph), np.array(here)))
    for walk in found:
        check_steps(graph, walk.vertices, walk.edges)
    passed = np.concatenate([np.empty(0, np.int64), *(walk.edges for walk in found)])
    assert np.array_equal(np.unique(passed), np.arange(len(graph.edges)))
    return found


def in_tree_order(
    graph: PathGraph, tree: Ints = NO_TREE, here: tuple[float, float] = (0.0, 0.0)
) -> list[tuple[Ints, Ints]]:
    """The thesis's strokes, which pass every edge once."""
    found = list(tree_walks(graph, np.array(here), tree))
    for vertices, edges in found:
        check_steps(graph, vertices, edges)
    passed = np.concatenate([np.empty(0, np.int64), *(edges for _, edges in found)])
    assert np.array_equal(np.sort(passed), np.arange(len(graph.edges)))
    return found


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
    found = strokes(graph)
    assert all(walk.vertices[0] == walk.vertices[-1] for walk in found)
    pieces = [set(walk.vertices.tolist()) for walk in found]
    assert sum(map(len, pieces)) == len(set().union(*pieces))
    length = sum(graph.lengths()[walk.edges].sum() for walk in found)
    assert length == pytest.approx(graph.lengths().sum() + minimum_join(graph).length)


@lean
@given(graphs())
def test_both_passes_of_an_edge_know_each_other(graph: PathGraph) -> None:
    for walk in strokes(graph):
        assert np.array_equal(walk.other[walk.other], np.arange(len(walk.other)))
        assert np.array_equal(walk.edges[walk.other], walk.edges)
        passes = np.bincount(walk.edges)[walk.edges]
        assert np.array_equal(passes, 1 + (walk.other != np.arange(len(walk.other))))


@lean
@given(graphs())
def test_tree_extrudes_every_edge_once(graph: PathGraph) -> None:
    in_tree_order(graph)


def test_tree_finishes_cell_after_cell_along_the_tree() -> None:
    sites = scattered(30, 10, 2)
    made = layer(sites, square(10))
    graph = diagram_graph(made.diagram)
    found = in_tree_order(graph, made.tree)
    beside = {(a, b) for pair in made.tree.tolist() for a, b in (pair, pair[::-1])}
    last = np.zeros(len(sites), dtype=np.int64)
    for place, edge in enumerate(np.concatenate([edges for _, edges in found]).tolist()):
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


def test_isolated_rings_are_one_closed_stroke_each() -> None:
    corners = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    graph = loops_graph([corners, corners + 5, corners + 20], CELLS)
    closed = [walk.vertices for walk in strokes(graph, (21.0, 20.0))]
    for found in (closed, [one for one, _ in in_tree_order(graph, here=(21.0, 20.0))]):
        assert [vertices[0] for vertices in found] == [9, 6, 2]
        assert all(vertices[0] == vertices[-1] for vertices in found)


def test_weights_of_a_large_part_still_fit() -> None:
    graph = graph_of(np.array([[0, 0], [90_000, 0], [0.5, 0], [0, 3]]), [[0, 1], [0, 2], [0, 3]])
    assert minimum_join(graph).length == pytest.approx(90_003.5)


def test_a_diagram_retraces_about_a_fifth() -> None:
    graph = diagram_graph(layer(scattered(120, 20, 5), disc(20)).diagram)
    assert 0.1 < minimum_join(graph).length / graph.lengths().sum() < 0.3


def test_strokes_are_the_same_every_time() -> None:
    graph = diagram_graph(layer(scattered(60, 10, 7), square(10)).diagram)
    for one, other in zip(strokes(graph), strokes(graph), strict=True):
        assert np.array_equal(one.vertices, other.vertices)
    for once, twice in zip(in_tree_order(graph), in_tree_order(graph), strict=True):
        assert np.array_equal(once[0], twice[0])


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


def test_nothing_is_routed_over_nothing() -> None:
    graph = loops_graph([], CELLS)
    assert strokes(graph) == []
    assert in_tree_order(graph) == []
