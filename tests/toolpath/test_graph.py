from __future__ import annotations

import numpy as np
import pytest
import shapely
from diagrams import area_of, disc, layer, scattered, square
from hypothesis import given, settings
from hypothesis import strategies as st

from v3dcad.geometry.section_area import section_area
from v3dcad.model import CELLS, PERIMETER, Floats, Section
from v3dcad.toolpath.graph import (
    PathGraph,
    diagram_graph,
    loops_graph,
    with_short_edges_joined,
)
from v3dcad.toolpath.perimeters import inset, loops, with_arcs
from v3dcad.toolpath.trim import trimmed

lean = settings(max_examples=25, deadline=None, derandomize=True)


def lines(graph: PathGraph, feature: int) -> shapely.Geometry:
    chosen = graph.edges[graph.feature == feature]
    return shapely.multilinestrings(shapely.linestrings(graph.vertices[chosen]))


@lean
@given(st.integers(3, 40), st.integers(0, 1000), st.floats(0.05, 3.0), st.booleans())
def test_trimmed_edges_are_the_cell_edges_inside(
    count: int, seed: int, depth: float, with_hole: bool
) -> None:
    check_trimmed(scattered(count, 10, seed), square(10, hole=2.5 if with_hole else 0), depth)


@pytest.mark.parametrize("hole", [0.0, 2.5])
@pytest.mark.parametrize("depth", [0.4, 0.3, 1.0])
def test_cell_edges_through_the_corners_of_the_perimeter(hole: float, depth: float) -> None:
    # The edges run along the diagonals.
    check_trimmed(np.array([[5.0, 0], [0, 5], [-5, 0], [0, -5]]), square(10, hole=hole), depth)


def check_trimmed(sites: Floats, section: Section, depth: float) -> None:
    made = layer(sites, section)
    area = inset(section_area(made.section), depth)
    graph = trimmed(made.diagram, area, loops(area))
    inner = made.diagram.edges[made.diagram.inner()]
    whole = shapely.multilinestrings(shapely.linestrings(made.diagram.vertices[inner]))
    expected = shapely.intersection(whole, area)
    cells = lines(graph, CELLS)
    assert cells.length == pytest.approx(expected.length, rel=1e-9, abs=1e-9)
    assert expected.buffer(1e-6).covers(cells)
    perimeter = lines(graph, PERIMETER)
    assert perimeter.length == pytest.approx(area.boundary.length, rel=1e-9)
    assert area.boundary.buffer(1e-6).covers(perimeter)
    # Where a cell edge ends on the perimeter the two share a vertex.
    on_perimeter = np.unique(graph.edges[graph.feature == PERIMETER])
    degrees = graph.only(graph.feature == CELLS).degrees()
    dead_ends = np.setdiff1d(np.nonzero(degrees == 1)[0], on_perimeter)
    assert len(dead_ends) == 0


def test_region_knows_holes_and_islands_in_them() -> None:
    nested = [square(half).rings[0] for half in (10.0, 6.0, 3.0)]
    area = section_area(Section(0.0, (nested[0], nested[1][::-1], nested[2])))
    assert area.area == pytest.approx(400 - 144 + 36)


def test_short_edges_are_joined_and_counted() -> None:
    made = layer(scattered(300, 10, 3), square(10))
    graph = diagram_graph(made.diagram)
    minimum = 0.3
    short = int(np.count_nonzero(graph.lengths() < minimum))
    joined, count = with_short_edges_joined(graph, minimum)
    assert short > 0
    assert count > 0
    assert joined.lengths().min() >= minimum
    assert len(joined.edges) == len(graph.edges) - count
    before, after = lines(graph, CELLS), lines(joined, CELLS)
    assert after.hausdorff_distance(before) < 2 * minimum
    pairs = np.sort(joined.edges, axis=1)
    assert len(np.unique(pairs, axis=0)) == len(pairs)


def test_joining_short_edges_keeps_the_perimeter() -> None:
    made = layer(scattered(40, 10, 4), square(10))
    joined, _ = with_short_edges_joined(diagram_graph(made.diagram), 0.5)
    outline = joined.vertices[np.unique(joined.edges[joined.feature == PERIMETER])]
    away = shapely.distance(area_of(made.section).boundary, shapely.points(outline))
    assert away.max() < 1e-9
    assert lines(joined, PERIMETER).length == pytest.approx(80, abs=0.5)


def test_a_finely_divided_curve_is_thinned_not_swallowed() -> None:
    circle = disc(10, points=4000)
    joined, _ = with_short_edges_joined(loops_graph(circle.rings, PERIMETER), 0.1)
    assert joined.lengths().min() >= 0.1
    assert joined.lengths().sum() == pytest.approx(2 * np.pi * 10, rel=1e-3)


def test_nothing_is_joined_where_nothing_is_short() -> None:
    graph = diagram_graph(layer(scattered(10, 10, 1), square(10)).diagram)
    joined, count = with_short_edges_joined(graph, 1e-9)
    assert count == 0
    assert joined is graph


def test_arcs_are_found_again_inside_the_contour() -> None:
    made = layer(scattered(20, 14, 6), disc(20))
    area = inset(section_area(made.section), 0.4)
    graph = with_arcs(trimmed(made.diagram, area, loops(area)), made.section, 0.4)
    arc = np.isfinite(graph.centre[:, 0])
    assert np.array_equal(arc, graph.feature == PERIMETER)
    assert graph.lengths()[arc].sum() == pytest.approx(2 * np.pi * 19.6, rel=1e-9)
    assert np.hypot(*graph.vertices[graph.edges[arc]].reshape(-1, 2).T) == pytest.approx(19.6)


def test_an_arc_in_a_hole_runs_outside_its_circle() -> None:
    outside, hole = square(30).rings[0], disc(10).rings[0][::-1]
    run = disc(10).runs[0]._replace(ring=1)
    section = Section(0.0, (outside, hole), (run,))
    area = inset(section_area(section), 0.4)
    graph = with_arcs(loops_graph(loops(area), PERIMETER), section, 0.4)
    arc = np.isfinite(graph.centre[:, 0])
    assert np.count_nonzero(~arc) == 4
    assert graph.lengths()[arc].sum() == pytest.approx(2 * np.pi * 10.4, rel=1e-9)
