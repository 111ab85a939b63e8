"""Laws of a foam's layers, whatever its sites are: many that tie, few, stacked, far apart."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from tests import oracle
from v3dcad.model import OUTSIDE, Section
from v3dcad.settings import FillSettings
from v3dcad.structure.fill import fill_sections
from v3dcad.structure.foam import explicit

pytestmark = pytest.mark.slow

SIDE = 16.0
"""mm; a power of two, so that simple numbers lie on the engine's grid."""

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]) * SIDE
HOLE = np.array([[5.0, 5], [5, 9], [10, 9], [9, 5]])
FAR = np.array([[19.0, 3], [22, 3], [22, 14], [19, 14]])
NOTCHED = np.array([[0.0, 0], [16, 0], [16, 16], [8, 3], [0, 16]])
TINY = np.array([[1.5, 1.5], [1.6, 1.5], [1.5, 1.6]])
SECTIONS = {
    "square": (SQUARE,),
    "hole": (SQUARE, HOLE),
    "islands": (SQUARE, HOLE, FAR),
    "notched": (NOTCHED,),
    "in one cell": (TINY,),
    "hole in one cell": (SQUARE, TINY[::-1]),
    "island in hole": (SQUARE, HOLE, HOLE[::-1] * 0.5 + 3.6),
}
BOX = np.array([[0.0, 0], [SIDE, SIDE]])


def stack(rings, layers=12, height=0.5):
    return [Section(height * k, rings) for k in range(layers)]


def foam(sections, sites, box=None, **settings):
    """A filling with given sites, whose walls may lean as they like."""
    chosen = {"max_overhang": 90.0, "stretch": 1.0, "layer_height": 0.5, **settings}
    return fill_sections(sections, sites, FillSettings(**chosen), box)


@st.composite
def site_sets(draw):
    """Random ones; on a small grid (one above the other, on one sphere, on the rings' corners);
    on a line; in a plane; few.
    """
    kind = draw(st.sampled_from(["random", "grid", "line", "plane", "few"]))
    count = draw(st.integers(1, 3) if kind == "few" else st.integers(4, 40))
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    sites = rng.uniform([0, 0, -3], [SIDE, SIDE, 9], (count, 3))
    if kind == "grid":
        sites = rng.integers([0, 0, -1], [9, 9, 4], (count, 3)) * 2.0
    elif kind == "line":
        sites[:, 1:] = 8.0, 2.0
    elif kind == "plane":
        sites[:, 2] = 3.0
    return rng.permutation(np.unique(sites, axis=0))


def laws(layer, tolerance=1e-9):
    """Tiling, sides, equidistance in power: what every layer's diagram must fulfil."""
    diagram, state = layer.diagram, layer.state
    area = oracle.area_of(layer.section)
    size = np.ptp(np.concatenate(layer.section.rings), axis=0).max()
    areas = diagram.areas(len(state.sites))
    assert abs(areas.sum() - area.area) <= tolerance * area.area
    assert areas.min() >= -tolerance * area.area
    present, flat = state.present(), state.sites[:, :2]
    assert np.isin(diagram.sites(), present).all()
    found = oracle.cells(state.sites[present], state.weights[present], layer.section)
    np.testing.assert_allclose(
        areas[present], shapely.area(found), atol=tolerance * size**2, rtol=0
    )
    i, j = diagram.edge_sites.T
    assert (i < j).all()
    inner = i != OUTSIDE
    ends = diagram.vertices[diagram.edges[inner]]
    power = [
        ((ends - flat[k[inner]][:, None]) ** 2).sum(axis=2) - state.weights[k[inner]][:, None]
        for k in (i, j)
    ]
    np.testing.assert_allclose(power[0], power[1], atol=tolerance * size**2, rtol=0)
    boundary = shapely.boundary(area)
    lying = shapely.distance(boundary, shapely.points(diagram.vertices[diagram.edges[~inner]]))
    assert lying.max() <= tolerance * size
    length = diagram.lengths()[~inner].sum()
    assert abs(length - boundary.length) <= tolerance * boundary.length
    np.testing.assert_allclose(ring_areas(diagram, len(areas)), areas, atol=tolerance * size**2)
    assert len(np.unique(diagram.edges.ravel())) == len(diagram.vertices)


def ring_areas(diagram, count):
    """(count,) area of each site's cell by its rings, holes less."""
    areas = np.zeros(count)
    for site, rings in diagram.cells().items():
        for ring in rings:
            x, y = (ring - ring[0]).T
            areas[site] += (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2
    return areas


def edges(diagram):
    """The edges by their sites and ends (e, 6), however vertices and edges are numbered."""
    rows = np.column_stack([diagram.edge_sites, diagram.vertices[diagram.edges].reshape(-1, 4)])
    return rows[np.lexsort(rows.T[::-1])]


def pairs(rows):
    return set(map(tuple, np.sort(rows, axis=1).tolist()))


def same(layer, other):
    """The same layer, to the last bit."""
    np.testing.assert_array_equal(edges(layer.diagram), edges(other.diagram))
    assert pairs(layer.diagram.neighbours) == pairs(other.diagram.neighbours)
    assert pairs(layer.tree) == pairs(other.tree)
    assert layer.area_per_cell == other.area_per_cell
    np.testing.assert_array_equal(layer.state.weights, other.state.weights)


def same_but_for_rounding(one, other, names=None):
    """The same inner edges, but for those without length; `names` are the other's sites'."""
    found = []
    for diagram, named in ((one, None), (other, names)):
        inner = diagram.inner() & (diagram.lengths() > 1e-7)
        between = diagram.edge_sites[inner]
        between = between if named is None else np.sort(named[between], axis=1)
        middle = diagram.vertices[diagram.edges[inner]].mean(axis=1)
        rows = np.column_stack([between, middle, diagram.lengths()[inner]])
        found.append(rows[np.lexsort([*np.rint(middle * 1e4).T, between[:, 1], between[:, 0]])])
    np.testing.assert_allclose(*found, atol=1e-8)


@pytest.fixture(params=[1000, 0], ids=["always there", "by reach"])
def few(request, monkeypatch):
    """Sites that are always in the mesh, or only while their cells may be."""
    monkeypatch.setattr(explicit, "FEW", request.param)


WHERE = st.sampled_from(sorted(SECTIONS))
FEW = st.sampled_from([0, 1000])


def with_few(few, *given, **settings):
    """`foam` where at most so many sites are always in the mesh."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(explicit, "FEW", few)
        return foam(*given, **settings)


@given(site_sets(), WHERE, st.sampled_from([1.0, 2.0, 7.3]), FEW)
def test_layers_obey_the_laws(sites, name, stretch, few):
    for layer in list(with_few(few, stack(SECTIONS[name]), sites, stretch=stretch).layers)[::5]:
        laws(layer)


@given(site_sets(), WHERE)
def test_tree_is_a_minimum_spanning_tree_of_the_neighbours(sites, name):
    for layer in foam(stack(SECTIONS[name]), sites).layers:
        flat = layer.state.sites[:, :2]
        ends = flat[layer.tree]
        theirs = oracle.spanning_tree(flat, layer.diagram.neighbours)
        assert len(layer.tree) == len(theirs)
        ours = np.hypot(*(ends[:, 0] - ends[:, 1]).T).sum()
        best = flat[theirs]
        assert ours == pytest.approx(np.hypot(*(best[:, 0] - best[:, 1]).T).sum(), rel=1e-12)


@given(site_sets(), WHERE, st.integers(0, 10**6))
def test_order_of_the_sites_does_not_matter(sites, name, seed):
    """On no layer does a cell of the grid open, or lie on a wall: whose that is, the order says."""
    names = np.random.default_rng(seed).permutation(len(sites))
    sections = [Section(0.13 + 0.47 * k, SECTIONS[name]) for k in range(12)]
    one, other = foam(sections, sites), foam(sections, sites[names])
    for layer, permuted in zip(list(one.layers)[::4], list(other.layers)[::4], strict=True):
        same_but_for_rounding(layer.diagram, permuted.diagram, names)
        assert layer.area_per_cell == pytest.approx(permuted.area_per_cell)


@given(site_sets(), WHERE, FEW)
def test_a_layer_by_itself_is_the_layer_on_the_way_up(sites, name, few):
    filling = with_few(few, stack(SECTIONS[name], 30), sites)
    for layer in list(filling.layers)[::4]:
        same(layer, filling.layers[layer.index])


@given(site_sets(), WHERE)
def test_which_sites_are_in_the_mesh_does_not_show(sites, name):
    """Those whose cells cannot be near are as good as there."""
    always, by_reach = (with_few(few, stack(SECTIONS[name], 30), sites) for few in (1000, 0))
    for layer, other in zip(always.layers, by_reach.layers, strict=True):
        np.testing.assert_array_equal(*(edges(each.diagram)[:, :2] for each in (layer, other)))
        same_but_for_rounding(layer.diagram, other.diagram)


@pytest.mark.parametrize("seed", range(3))
def test_many_sites_come_and_go(seed):
    """Some enter before their cells open, and are hidden by others that enter after them."""
    low, high = np.array([-3.0, -3, -3]), np.array([SIDE + 3, SIDE + 3, 63])
    sites = np.random.default_rng(seed).uniform(low, high, (1500, 3))
    filling = foam(stack((SQUARE,), 120), sites)
    assert filling._block < 60 / filling.foam.step
    for layer in filling.layers:
        if layer.index % 3 == 1:
            same(layer, filling.layers[layer.index])
        if layer.index % 50 == 13:
            laws(layer)


@given(site_sets(), st.sampled_from(["square", "hole"]), st.sampled_from([1e-6, 1e-3, 1e6]))
def test_scale_does_not_matter(sites, name, scale):
    one = foam(stack(SECTIONS[name], 4), sites)
    rings = tuple(ring * scale for ring in SECTIONS[name])
    other = foam(stack(rings, 4, 0.5 * scale), sites * scale, layer_height=0.5 * scale)
    for a, b in zip(one.layers, other.layers, strict=True):
        count = len(a.state.sites)
        np.testing.assert_allclose(
            a.diagram.areas(count), b.diagram.areas(count) / scale**2, atol=1e-4
        )  # grid steps round differently by one


@given(site_sets(), st.floats(0, 5.5), st.integers(0, 10**6))
def test_points_of_a_cell_are_found_in_it(sites, z, seed):
    """`sites_at` asks for the nearest site in the stretched space: so do the layers."""
    filling = foam(stack((SQUARE,)), sites, stretch=1.5)
    cells = filling.at(z).cells()
    points = np.random.default_rng(seed).uniform(0, SIDE, (20, 2))
    found = filling.sites_at(np.column_stack([points, np.full(20, z)]))
    for point, site in zip(points, found.tolist(), strict=True):
        away = [
            shapely.distance(shapely.Polygon(ring), shapely.Point(point)) for ring in cells[site]
        ]
        assert min(away) < 1e-6


def test_layers_can_be_iterated_again_and_do_not_depend_on_chunks(few, monkeypatch):
    sites = np.random.default_rng(5).uniform([0, 0, -3], [SIDE, SIDE, 23], (60, 3))
    filling = foam(stack((SQUARE,), 40), sites)
    first = list(filling.layers)
    assert len(filling.layers) == 40
    monkeypatch.setattr("v3dcad.structure.fill.AT_ONCE", 3)
    for a, b in zip(first, filling.layers, strict=True):
        np.testing.assert_array_equal(a.diagram.vertices, b.diagram.vertices)
        np.testing.assert_array_equal(a.diagram.edges, b.diagram.edges)
        np.testing.assert_array_equal(a.tree, b.tree)


def test_how_arrays_lie_in_memory_does_not_matter():
    """`np.array([xs, ys]).T` lies column by column."""
    sites = np.random.default_rng(1).random((9, 3)) * 10
    found = []
    for order in "CF":
        sections = stack((np.array(SQUARE, order=order), np.array(HOLE, order=order)), 3)
        sections.append(Section(2.0, (np.array(SQUARE, order=order),)))
        filling = foam(sections, np.array(sites, order=order))
        found.append([edges(layer.diagram) for layer in filling.layers])
    for rows, columns in zip(*found, strict=True):
        np.testing.assert_array_equal(rows, columns)


def test_an_empty_section_is_an_empty_layer():
    sections = stack((SQUARE,), 6)
    sections[3] = Section(1.5, ())
    layers = list(foam(sections, np.array([[1.0, 1, 0], [2, 2, 1]])).layers)
    assert len(layers[3].diagram.edges) == 0
    assert len(layers[4].diagram.edges) > 0
    assert layers[3].area_per_cell == 0


def test_an_island_may_be_in_one_cell_and_then_in_another():
    """No edge is crossed on either layer, and columns do not move."""
    sites = np.array([[4.0, 4], [12, 4], [4, 12], [12, 12]])
    sections = [Section(0.5 * k, (TINY + site,)) for k, site in enumerate(sites - 2)]
    layers = list(foam(sections, sites).layers)
    assert [layer.diagram.sites().tolist() for layer in layers] == [[0], [1], [2], [3]]


@pytest.mark.parametrize("name", sorted(SECTIONS))
def test_layers_are_what_qhull_and_geos_make_of_them(name):
    """The slow side of benchmarks/engine.py does the engine's work."""
    sites = np.random.default_rng(4).uniform(0, [SIDE, SIDE, 6], (60, 3))
    for layer in list(foam(stack(SECTIONS[name], 12), sites).layers)[::3]:
        between, _, tree, count, contours = oracle.layer(
            layer.state.sites, layer.state.weights, layer.section
        )
        assert pairs(between) == pairs(layer.diagram.neighbours)
        assert pairs(tree) == pairs(layer.tree)
        assert count == len(layer.diagram.sites())
        area = oracle.area_of(layer.section).area
        assert layer.area_per_cell == pytest.approx(area / count)
        outside = ~layer.diagram.inner()
        length = layer.diagram.lengths()[outside].sum()
        assert shapely.length(contours).sum() == pytest.approx(length)


def test_some_layers_at_once() -> None:
    layers = foam(stack((SQUARE,), 7), SQUARE * 0.5 + 2).layers
    assert [layer.index for layer in layers[1:6:2]] == [1, 3, 5]
    assert [layer.index for layer in layers[::-3]] == [6, 3, 0]
    assert layers[-1].z == layers[6].z == 3.0
    with pytest.raises(IndexError):
        layers[7]


def most_at_once(layers: int, height: float, size: float) -> int:
    """The bytes that going through layers up to a height takes, beside those of the first."""
    sections = [Section(k * height / layers, (SQUARE,)) for k in range(layers)]
    chosen = FillSettings(layer_height=height / layers, cell_size=size)
    filling = fill_sections(sections, None, chosen)
    way_up = iter(filling.layers)
    next(way_up)
    tracemalloc.start()
    try:
        assert sum(1 for _ in way_up) == layers - 1
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_memory_does_not_grow_with_the_number_of_layers() -> None:
    few, many = most_at_once(600, 8.0, 1.3), most_at_once(4800, 8.0, 1.3)
    assert 1e6 < few < 3e7
    assert many < 1.3 * few, "eight times as many"


def test_nor_does_it_with_the_height() -> None:
    """But for some bytes a site in the lists of all."""
    low, tall = most_at_once(300, 30.0, 1.3), most_at_once(2400, 240.0, 1.3)
    assert tall < 1.3 * low + 200 * 8 * 240 * SIDE**2 / 1.3**3
