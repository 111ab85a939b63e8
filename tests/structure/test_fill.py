import tracemalloc

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from tests import oracle
from v3dcad.errors import GeometryError
from v3dcad.model import OUTSIDE, Section
from v3dcad.settings import FillSettings
from v3dcad.structure.fill import fill_sections
from v3dcad.structure.growth import PACE
from v3dcad.structure.sites import scatter_sites

SQUARE = np.array([[0.0, 0], [10, 0], [10, 10], [0, 10]])
HOLE = np.array([[3.0, 3], [3, 6], [6.5, 6], [6, 3]])
FAR = np.array([[12.0, 2], [14, 2], [14, 9], [12, 9]])
NOTCHED = np.array([[0.0, 0], [10, 0], [10, 10], [5, 2], [0, 10]])
TINY = np.array([[1.0, 1], [1.1, 1], [1, 1.1]])
SECTIONS = {
    "square": (SQUARE,),
    "hole": (SQUARE, HOLE),
    "islands": (SQUARE, HOLE, FAR),
    "notched": (NOTCHED,),
    "in one cell": (TINY,),
    "hole in one cell": (SQUARE, TINY[::-1]),
    "island in hole": (SQUARE, HOLE, HOLE[::-1] * 0.5 + 2.3),
}


def stack(rings, layers=12, height=0.5):
    return [Section(height * k, rings) for k in range(layers)]


@st.composite
def site_sets(draw):
    """Random, on a small grid (cocircular, on the rings' corners and sides), or collinear."""
    kind = draw(st.sampled_from(["random", "grid", "line", "few"]))
    count = draw(st.integers(1, 3) if kind == "few" else st.integers(4, 40))
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    if kind == "grid":
        sites = rng.integers(0, 11, (count, 2)).astype(float)
    elif kind == "line":
        sites = np.column_stack([rng.random(count) * 10, np.full(count, 5.0)])
    else:
        sites = rng.random((count, 2)) * 10
    return np.unique(sites, axis=0)


def laws(layer, tolerance=1e-9):
    """Tiling, sides, equidistance in power: what every layer's diagram must fulfil."""
    diagram, state = layer.diagram, layer.state
    area = oracle.area_of(layer.section)
    size = np.ptp(np.concatenate(layer.section.rings), axis=0).max()
    areas = diagram.areas(len(state.sites))
    assert abs(areas.sum() - area.area) <= tolerance * area.area
    assert areas.min() >= -tolerance * area.area
    found = oracle.cells(state.sites, state.weights, layer.section)
    np.testing.assert_allclose(areas, shapely.area(found), atol=tolerance * size**2, rtol=0)
    i, j = diagram.edge_sites.T
    assert (i < j).all()
    inner = i != OUTSIDE
    ends = diagram.vertices[diagram.edges[inner]]
    power = [
        ((ends - state.sites[k[inner]][:, None]) ** 2).sum(axis=2)
        - state.weights[k[inner]][:, None]
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


@given(site_sets(), st.sampled_from(sorted(SECTIONS)), st.sampled_from([0.0, 0.05, 1.0]))
def test_layers_obey_the_laws(sites, name, offset):
    sections = stack(SECTIONS[name])
    filling = fill_sections(
        sections, sites, FillSettings(max_overhang=90.0, offset=offset, layer_height=0.5)
    )
    for layer in list(filling.layers)[::5]:
        laws(layer)


def test_a_grid_whose_cells_meet_four_at_a_corner_obeys_the_laws():
    """At layer 96 of this grid the oracle's half-planes leave corners an ulp apart."""
    sites = (np.stack(np.meshgrid(*[np.arange(5)] * 2), axis=-1).reshape(-1, 2) - 2.0) * 8
    filling = fill_sections(stack((SQUARE * 4 - 20,), 97, 0.2), sites, FillSettings())
    for layer in filling.layers[0], filling.layers[-1]:
        laws(layer)


@given(site_sets(), st.sampled_from(sorted(SECTIONS)))
def test_tree_is_a_minimum_spanning_tree_of_the_neighbours(sites, name):
    filling = fill_sections(
        stack(SECTIONS[name]), sites, FillSettings(max_overhang=90.0, offset=0.3, layer_height=0.5)
    )
    for layer in filling.layers:
        ends = layer.state.sites[layer.tree]
        theirs = oracle.spanning_tree(layer.state.sites, layer.diagram.neighbours)
        assert len(layer.tree) == len(theirs)
        ours = np.hypot(*(ends[:, 0] - ends[:, 1]).T).sum()
        best = layer.state.sites[theirs]
        assert ours == pytest.approx(np.hypot(*(best[:, 0] - best[:, 1]).T).sum(), rel=1e-12)


def fingerprint(diagram, names=None):
    """The diagram as a set of named inner edges, independent of all numbering."""
    inner = diagram.inner()
    pairs = diagram.edge_sites[inner]
    pairs = pairs if names is None else np.sort(names[pairs], axis=1)
    ends = diagram.vertices[diagram.edges[inner]]
    middle, length = ends.mean(axis=1), diagram.lengths()[inner]
    real = length > 1e-9
    rows = np.column_stack([pairs, np.rint(middle * 1e7), np.rint(length * 1e7)])[real]
    return rows[np.lexsort(rows.T[::-1])]


@given(site_sets(), st.sampled_from(sorted(SECTIONS)), st.integers(0, 10**6))
def test_order_of_the_sites_does_not_matter(sites, name, seed):
    names = np.random.default_rng(seed).permutation(len(sites))
    settings = FillSettings(max_overhang=90.0, offset=0.0, layer_height=0.5)
    one = fill_sections(stack(SECTIONS[name], 1), sites, settings)
    other = fill_sections(stack(SECTIONS[name], 1), sites[names], settings)
    a, b = fingerprint(one.layers[0].diagram), fingerprint(other.layers[0].diagram, names)
    np.testing.assert_array_equal(a, b)


@given(site_sets(), st.sampled_from(["square", "hole", "notched"]))
def test_a_layer_by_itself_is_the_layer_on_the_way_up(sites, name):
    filling = fill_sections(
        stack(SECTIONS[name], 30),
        sites,
        FillSettings(max_overhang=90.0, offset=0.4, layer_height=0.5),
    )
    for layer in list(filling.layers)[::7]:
        alone = filling.layers[layer.index]
        a, b = fingerprint(layer.diagram), fingerprint(alone.diagram)
        assert len(a) == len(b)
        np.testing.assert_allclose(a, b, atol=2)  # 2e-7 mm: the rounding of the fingerprint
        assert alone.area_per_cell == pytest.approx(layer.area_per_cell)


@given(site_sets(), st.sampled_from(["square", "hole"]), st.sampled_from([1e-6, 1e-3, 1e6]))
def test_scale_does_not_matter(sites, name, scale):
    one = fill_sections(
        stack(SECTIONS[name], 4),
        sites,
        FillSettings(max_overhang=90.0, offset=0.4, layer_height=0.5),
    )
    rings = tuple(ring * scale for ring in SECTIONS[name])
    settings = FillSettings(max_overhang=90.0, offset=0.4 * scale**2, layer_height=0.5 * scale)
    other = fill_sections(stack(rings, 4, 0.5 * scale), sites * scale, settings)
    for a, b in zip(one.layers, other.layers, strict=True):
        n = len(a.state.sites)
        np.testing.assert_allclose(
            a.diagram.areas(n), b.diagram.areas(n) / scale**2, atol=1e-4
        )  # grid steps round differently by one


def test_births_start_empty_and_grow_without_a_jump():
    sites = scatter_sites(np.array([[0.0, 0], [10, 10]]), 60, 3)
    settings = FillSettings(offset=0.02, layer_height=0.1)
    filling = fill_sections(stack((SQUARE,), 200, 0.1), sites, settings)
    layers = list(filling.layers)
    births = filling.births
    assert len(births) > 5
    areas = np.zeros((len(layers), 60 + len(births)))
    for layer in layers:
        state = layer.state
        areas[layer.index, : len(state.sites)] = layer.diagram.areas(len(state.sites))
    for layer, site in births:
        assert layers[layer].state.born_at[site] == pytest.approx(layers[layer].z)
        assert len(layers[layer - 1].state.sites) <= site < len(layers[layer].state.sites)
        assert abs(areas[layer, site]) < 1e-9 * 100 / 60
    # They grow as the square of the weight gained: next to nothing at first.
    for layer, site in births[births[:, 0] < 199]:
        assert areas[layer + 1, site] < 0.01 * 100 / 60
        assert np.abs(np.diff(areas[layer:, site])).max() < 0.1 * 100 / 60
    # Cells are convex in space: the dead never return.
    alive = areas > 1e-9
    for site in range(areas.shape[1]):
        was = np.nonzero(alive[:, site])[0]
        assert len(was) == 0 or len(was) == was[-1] - was[0] + 1
    without = fill_sections(
        stack((SQUARE,), 200, 0.1),
        sites,
        FillSettings(max_overhang=90.0, offset=0.02, layer_height=0.1, insertion=False),
    )
    assert not len(without.births)
    assert layers[-1].area_per_cell < list(without.layers)[-1].area_per_cell


@pytest.mark.parametrize("insertion", [True, False])
def test_facets_sliced_are_the_layers_edges(insertion):
    sites = np.random.default_rng(5).random((50, 2)) * 10
    settings = FillSettings(max_overhang=90.0, offset=0.05, layer_height=0.1, insertion=insertion)
    filling = fill_sections(stack((SQUARE,), 60, 0.1), sites, settings)
    walls = filling.walls
    heights = [*(layer.z for layer in list(filling.layers)[1:-1:9]), 0.123, 3.3456789]
    for z in heights:
        which, segments = walls.slice(z)
        diagram = filling.at(z)
        inner = diagram.inner() & (diagram.lengths() > 1e-9)
        assert np.hypot(*(segments[:, 0] - segments[:, 1]).T).sum() == pytest.approx(
            diagram.lengths()[inner].sum(), rel=1e-9
        )
        edges = {
            tuple(pair): ends
            for pair, ends in zip(
                diagram.edge_sites[inner], diagram.vertices[diagram.edges[inner]], strict=True
            )
        }
        for facet, segment in zip(which, segments, strict=True):
            if np.hypot(*(segment[1] - segment[0])) < 1e-8:
                continue
            ends = edges[tuple(walls.sites[facet])]
            apart = min(np.abs(segment - ends).max(), np.abs(segment - ends[::-1]).max())
            assert apart < 1e-8
    growth = filling.history.sites.by_site().growth * 0.5 / PACE
    places = filling.grid.millimetres(filling.history.sites.by_site().places)
    for f in range(0, len(walls.tilts), 7):
        corners = walls.points[walls.starts[f] : walls.starts[f + 1]]
        i, j = walls.sites[f]
        normal = np.array([*(places[j] - places[i]), (growth[j] - growth[i]) / 2])
        flat = (corners - corners[0]) @ (normal / np.linalg.norm(normal))
        assert np.abs(flat).max() < 1e-8
        assert np.tan(np.radians(walls.tilts[f])) == pytest.approx(
            abs(normal[2]) / np.hypot(*normal[:2]), rel=1e-9
        )
    axes = filling.strut_axes
    assert len(axes.sites)
    assert (axes.ends[:, 1, 2] > axes.ends[:, 0, 2]).all()
    assert (axes.ends[:, :, :2] > -1e-9).all()
    assert (axes.ends[:, :, :2] < 10 + 1e-9).all()


def test_layers_can_be_iterated_again_and_do_not_depend_on_chunks(monkeypatch):
    sites = np.random.default_rng(5).random((30, 2)) * 10
    settings = FillSettings(max_overhang=90.0, offset=0.2, layer_height=0.5)
    filling = fill_sections(stack((SQUARE,), 40), sites, settings)
    first = list(filling.layers)
    assert len(filling.layers) == 40
    monkeypatch.setattr("v3dcad.structure.fill.AT_ONCE", 3)
    for a, b in zip(first, filling.layers, strict=True):
        np.testing.assert_array_equal(a.diagram.vertices, b.diagram.vertices)
        np.testing.assert_array_equal(a.diagram.edges, b.diagram.edges)
        np.testing.assert_array_equal(a.tree, b.tree)


def test_how_arrays_lie_in_memory_does_not_matter():
    """`np.array([xs, ys]).T` lies column by column."""
    sites = np.random.default_rng(1).random((9, 2)) * 10
    found = []
    for order in "CF":
        sections = stack((np.array(SQUARE, order=order), np.array(HOLE, order=order)), 3)
        sections.append(Section(2.0, (np.array(SQUARE, order=order),)))
        filling = fill_sections(sections, np.array(sites, order=order), FillSettings())
        found.append([fingerprint(layer.diagram) for layer in filling.layers])
    for rows, columns in zip(*found, strict=True):
        np.testing.assert_array_equal(rows, columns)


def test_duplicates_are_merged_with_a_warning():
    sites = np.array([[1.0, 1], [2, 2], [1, 1], [2, 2], [8, 3]])
    with pytest.warns(UserWarning, match="2 of 5 sites"):
        filling = fill_sections(stack((SQUARE,)), sites, FillSettings())
    assert len(filling.sites) == 3


@pytest.mark.parametrize(("site", "words"), [((np.nan, 1.0), "finite"), ((np.inf, 1.0), "finite")])
def test_faulty_sites_are_named(site, words):
    with pytest.raises(GeometryError, match=words) as caught:
        fill_sections(stack((SQUARE,)), np.array([[1.0, 1], site]), FillSettings())
    assert caught.value.site == 1


@pytest.mark.parametrize(
    "ring",
    [
        np.array([[0.0, 0], [10, 10], [10, 0], [0, 9]]),
        SQUARE[::-1],
        np.array([[np.nan, 0], [10, 0], [10, 10]]),
    ],
)
@pytest.mark.parametrize("method", ["continuous", "thesis"])
def test_faulty_sections_are_named(ring, method):
    sections = stack((SQUARE,), 6)
    sections[4] = Section(2.0, (ring,))
    with pytest.raises(GeometryError, match="layer 4"):
        list(fill_sections(sections, np.ones((1, 2)), FillSettings(method=method)).layers)


def test_settings_that_cannot_be():
    with pytest.raises(GeometryError, match="at least one"):
        fill_sections(stack((SQUARE,)), np.empty((0, 2)), FillSettings())
    with pytest.raises(GeometryError, match="safe range"):
        list(
            fill_sections(
                stack((SQUARE,)),
                np.array([[1.0, 1], [2, 2]]),
                FillSettings(offset=1e6, max_overhang=90.0),
            ).layers
        )


def test_an_empty_section_is_an_empty_layer():
    sections = stack((SQUARE,), 6)
    sections[3] = Section(1.5, ())
    layers = list(fill_sections(sections, np.array([[1.0, 1], [2, 2]]), FillSettings()).layers)
    assert len(layers[3].diagram.edges) == 0
    assert len(layers[4].diagram.edges) > 0


def test_births_on_a_part_that_stands_on_a_point():
    """An empty first layer is no measure: each site's share of the base rectangle is."""
    rings = [SQUARE * share + 5 * (1 - share) for share in np.linspace(0.1, 1, 40)]
    sections = [Section(0.0, ()), *(Section(0.2 * k + 0.2, (r,)) for k, r in enumerate(rings))]
    sites = scatter_sites(np.array([[0.0, 0], [10, 10]]), 40, 1)
    filling = fill_sections(sections, sites, FillSettings())
    layers = list(filling.layers)
    assert layers[0].area_per_cell == 0
    assert len(filling.births) > 5
    share = 100 / 40
    births = np.bincount(filling.births[:, 0], minlength=len(layers))
    assert all(layer.area_per_cell > share * 0.5 for layer in layers if births[layer.index])


@pytest.mark.parametrize("name", sorted(SECTIONS))
def test_layers_are_what_qhull_and_geos_make_of_them(name):
    """The slow side of benchmarks/engine.py does the engine's work."""
    sites = np.random.default_rng(4).uniform(0, 10, (60, 2))
    # Newborns' cells are too small for qhull to see.
    settings = FillSettings(offset=0.3, max_overhang=90.0, layer_height=0.5, insertion=False)
    for layer in list(fill_sections(stack(SECTIONS[name], 12), sites, settings).layers)[::3]:
        pairs, _, tree, count, contours = oracle.layer(
            layer.state.sites, layer.state.weights, layer.section
        )
        assert sorted(map(tuple, pairs)) == sorted(map(tuple, layer.diagram.neighbours))
        assert sorted(map(tuple, tree)) == sorted(map(tuple, layer.tree))
        assert count == len(layer.diagram.sites())
        area = oracle.area_of(layer.section).area
        assert layer.area_per_cell == pytest.approx(area / count)
        outside = ~layer.diagram.inner()
        length = layer.diagram.lengths()[outside].sum()
        assert shapely.length(contours).sum() == pytest.approx(length)


def test_some_layers_at_once() -> None:
    layers = fill_sections(stack((SQUARE,), 7), SQUARE * 0.5 + 2, FillSettings()).layers
    assert [layer.index for layer in layers[1:6:2]] == [1, 3, 5]
    assert [layer.index for layer in layers[::-3]] == [6, 3, 0]
    assert layers[-1].z == layers[6].z == 3.0
    with pytest.raises(IndexError):
        layers[7]


def test_memory_does_not_grow_with_the_number_of_layers() -> None:
    sites = np.random.default_rng(1).random((150, 2)) * 10

    def most_at_once(count: int) -> int:
        """The bytes that going through so many layers takes, at the same growth in all."""
        settings = FillSettings(layer_height=6 / count, offset=3 / count, max_overhang=90.0)
        filling = fill_sections(stack((SQUARE,), count, 6 / count), sites, settings)
        layers = iter(filling.layers)
        next(layers)
        tracemalloc.start()
        try:
            assert sum(1 for _ in layers) == count - 1
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    few, many = most_at_once(600), most_at_once(4800)
    assert 1e6 < few < 3e7
    assert many < 1.3 * few, "eight times as many"
