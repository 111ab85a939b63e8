"""Layers are slices of a Voronoi diagram in space: scipy's, and the one of sites lifted (qhull)."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from tests import oracle
from tests.structure.test_fill import foam, laws, same
from v3dcad import FillSettings, Section, fill_sections
from v3dcad.model import Diagram, Floats, Ints
from v3dcad.structure.fill import Filling

pytestmark = pytest.mark.slow


def rectangle(width: float, depth: float) -> Floats:
    return np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]) * [width, depth]


def pole(
    width: float, depth: float, height: float, layers: int = 20, **settings: float | str
) -> Filling:
    """A box of so many layers, whose settings are those of its foam."""
    ring = rectangle(width, depth)
    sections = [Section(z, (ring,)) for z in np.linspace(0, height, layers)]
    chosen = FillSettings(layer_height=height / (layers - 1), **settings)
    filling = fill_sections(sections, None, chosen)
    assert isinstance(filling, Filling)
    return filling


def snapped(filling: Filling, z: float) -> float:
    """The height, mm, that a layer at z stands for."""
    return float(filling.foam.times(np.array([z]))[0]) * filling.foam.step / 2


def agree(
    diagram: Diagram,
    pairs: Ints,
    edges: Floats,
    area: shapely.Geometry,
    tolerance: float = 1e-9,
) -> None:
    """A diagram inside a convex area has these edges, and no other that is longer than nothing."""
    shapely.prepare(area)
    pairs, lines = oracle.cut_edges(area, pairs, edges)
    expected = {}
    for pair, line in zip(pairs.tolist(), lines, strict=True):
        if shapely.length(line) > 10 * tolerance:
            expected[tuple(pair)] = shapely.get_coordinates(line)
    inner = diagram.inner() & (diagram.lengths() > 10 * tolerance)
    ends = diagram.vertices[diagram.edges[inner]]
    found = dict(zip(map(tuple, diagram.edge_sites[inner].tolist()), ends, strict=True))
    assert set(found) == set(expected)
    for pair, here in found.items():
        there = expected[pair]
        assert min(np.abs(here - there).max(), np.abs(here - there[::-1]).max()) < tolerance


CASES = {
    "45": pole(20, 16, 70, cell_size=4),
    "30": pole(20, 16, 110, cell_size=4, max_overhang=30.0, random_seed=1),
    "60": pole(20, 16, 70, cell_size=4, max_overhang=60.0, random_seed=2),
    "stretched": pole(12, 12, 400, cell_size=5, stretch=6.0),
}
HEIGHTS = (0.0, 3.3, 7.7777, 31.0, 69.9)


@pytest.mark.parametrize("name", CASES)
def test_a_layer_is_a_slice_of_scipys_diagram(name: str) -> None:
    filling = CASES[name]
    area = shapely.Polygon(filling.box)
    for z in HEIGHTS:
        cut = oracle.slice_in_space(filling.sites, filling.foam.stretch, snapped(filling, z))
        agree(filling.at(z), *cut, area)


@pytest.mark.parametrize("name", CASES)
def test_a_layer_is_the_hull_of_its_lifted_sites(name: str) -> None:
    filling = CASES[name]
    area = shapely.Polygon(filling.box)
    for z in HEIGHTS:
        layer = filling.slice(Section(z, (filling.box,)), 0)
        sites, weights = layer.state.sites[:, :2], layer.state.weights
        whole = oracle.power_edges(len(sites), *oracle.power_diagram(sites, weights))
        agree(layer.diagram, *whole, area)
        i, j = layer.diagram.neighbours.T
        assert np.isin([i, j], layer.state.present()).all()


def test_slices_of_given_sites() -> None:
    sites = np.random.default_rng(3).uniform([-6, -6, -9], [26, 26, 30], (400, 3))
    ring = rectangle(20, 20)
    filling = foam([Section(0.5 * k, (ring,)) for k in range(40)], sites, stretch=1.7)
    for z in (0.1, 4.44, 17.3):
        cut = oracle.slice_in_space(filling.sites, 1.7, snapped(filling, z))
        agree(filling.at(z), *cut, shapely.Polygon(ring))


def test_sites_below_the_bed_and_far_above() -> None:
    """Their cells are cut by the part: weights are negative, and large."""
    sites = np.random.default_rng(3).uniform([0, 0, -40], [20, 20, -5], (40, 3))
    sites[::4, 2] += 90
    ring = rectangle(20, 20)
    filling = foam([Section(0.5 * k, (ring,)) for k in range(60)], sites)
    assert (filling.foam.places[:, 2] < 0).any()
    for layer in list(filling.layers)[::13]:
        laws(layer)
        same(layer, filling.layers[layer.index])


@pytest.mark.parametrize("name", CASES)
def test_nothing_happens_where_blocks_meet(name: str) -> None:
    """Between two layers half a grid step apart, of which another block is above."""
    filling = CASES[name]
    half, block = filling.foam.step / 2, filling._block
    times = [
        time
        for border in range(block, int(filling.layers[-1].z / half), block)
        for time in (border - 1, border)
    ]
    assert len(times) >= 2
    sections = [Section(time * half, (filling.box,)) for time in times]
    layers = list(Filling(sections, filling.foam, filling.settings, filling.box[[0, 2]], 99).layers)
    for below, above in zip(layers[::2], layers[1::2], strict=True):
        assert set(map(tuple, below.diagram.neighbours.tolist())) == set(
            map(tuple, above.diagram.neighbours.tolist())
        )
        count = len(filling.sites)
        apart = below.diagram.areas(count) - above.diagram.areas(count)
        assert np.abs(apart).max() < 1e-4
        laws(above)
        for layer in (below, above):
            same(layer, filling.slice(layer.section, layer.index))


@pytest.mark.parametrize("limit", [30.0, 60.0])
@pytest.mark.parametrize("size", [(16.0, 16.0, 1000.0), (1000.0, 16.0, 16.0)])
def test_long_parts(size: tuple[float, float, float], limit: float) -> None:
    """The laws at the far end, where places and heights take most bits."""
    filling = pole(*size, layers=1000, cell_size=5, max_overhang=limit)
    layers = list(filling.layers)
    end = rectangle(16, 16) + np.array([size[0] - 16, 0])
    for index in (0, 499, 998, 999):
        layer = layers[index]
        same(layer, filling.layers[index])
        present = layer.state.present()
        present = present[filling.sites[present, 0] > size[0] - 32]
        sites = filling.sites[present, :2] - end[0]
        whole = oracle.power_diagram(sites, layer.state.weights[present])
        pairs, edges = oracle.power_edges(len(present), *whole)
        diagram = filling.at(layer.z, Section(layer.z, (end,)))
        agree(diagram, present[pairs], edges + end[0], shapely.Polygon(end), 1e-8)


def test_a_wire_so_tall_that_squares_of_its_heights_leave_64_bits() -> None:
    ring = rectangle(1, 1)
    sections = [Section(z, (ring,)) for z in (0.0, 0.1, 999.9, 1000.0)]
    filling = fill_sections(sections, None, FillSettings(cell_size=0.3))
    assert isinstance(filling, Filling)
    assert filling.foam.places[:, 2].max() ** 2.0 > 2**63
    for layer in filling.layers:
        laws(layer)
        same(layer, filling.layers[layer.index])
