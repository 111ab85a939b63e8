"""Laws of the thesis's layers: tiling, convexity, what insertion does to area per cell."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely

from v3dcad import FillSettings, Section, fill_sections
from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.model import Diagram, Floats
from v3dcad.structure.sweep.one_layer import diagrams_on
from v3dcad.structure.thesis.cells import area, corner_count, is_convex, rings
from v3dcad.structure.thesis.loop import ThesisFilling, ThesisLayer


def square(side: float, z: float) -> Section:
    return Section(z, (side / 2 * np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]]),))


def pyramid(layers: int) -> list[Section]:
    """The thesis's truncated pyramid: 67 mm at the base, 10° draft, layers of 0.2 mm."""
    return [square(67 - 0.4 * k * math.tan(math.radians(10)), 0.2 * k) for k in range(layers)]


def prism(layers: int) -> list[Section]:
    return [square(40, 0.2 * k) for k in range(layers)]


def scattered(count: int, side: float, seed: int) -> Floats:
    """Plainly random sites: unlike the even scatter's, some of their cells vanish early."""
    return np.random.default_rng(seed).uniform(-side / 2, side / 2, (count, 2))


def layers_of(
    sections: list[Section], sites: Floats, *, offset: float, weight_step: float = 0.0
) -> list[ThesisLayer]:
    settings = FillSettings(method="thesis", offset=offset, weight_step=weight_step)
    filling = fill_sections(sections, sites, settings)
    assert isinstance(filling, ThesisFilling)
    return list(filling.layers)


@pytest.fixture(scope="module")
def jumping() -> list[ThesisLayer]:
    """A prism with many insertions, their weights lowered in steps so wide that cells jump."""
    return layers_of(prism(40), scattered(60, 40, 1), offset=1.0, weight_step=10.0)


def test_weights_by_the_pseudocode() -> None:
    """Growing sites gain the offset on layer 0, after its diagram, and on entering each layer."""
    layers = layers_of(prism(4), scattered(30, 40, 2), offset=0.5)
    grows = layers[0].state.growth > 0
    assert not layers[0].state.weights.any()
    for layer in layers[1:]:
        expected = np.where(grows, 0.5 * (layer.index + 1), 0.0)
        assert layer.state.weights == pytest.approx(expected)
    assert 0 < grows.sum() < 30
    assert layers[0].state.growth[grows] == pytest.approx(0.5 / 0.2)
    assert not grows[0], "the root stays"


def test_one_insertion_brings_area_per_cell_back() -> None:
    """Fig. 3.13: above the first layer's while cells vanish, below it once sites are inserted.

    On this pyramid of 50 sites with the thesis's settings one cell vanishes in layer 3.
    """
    layers = layers_of(pyramid(20), scattered(50, 67, 6), offset=0.1)
    first = layers[0].area_per_cell
    assert first == pytest.approx(67**2 / 50)
    above = [layer.index for layer in layers if layer.area_per_cell > first]
    assert above == [3]
    assert [len(layer.inserted) for layer in layers] == [0] * 4 + [1] * 16
    below = [layer.area_per_cell for layer in layers[4:]]
    assert all(one > next_one for one, next_one in pairwise(below))


def test_an_insertion_follows_every_layer_above_the_first_and_no_other() -> None:
    layers = layers_of(pyramid(60), scattered(50, 67, 4), offset=0.5)
    first = layers[0].area_per_cell
    for below, layer in pairwise(layers):
        called_for = below.area_per_cell > first * (1 + 1e-9)
        answered = len(layer.inserted) - len(below.inserted)
        assert answered + layer.unanswered == called_for
    last_above = max(layer.index for layer in layers if layer.area_per_cell > first)
    assert len(layers[-1].inserted) >= 3
    assert last_above < 40, "area per cell falls back and stays there"


def test_where_a_site_is_inserted(jumping: list[ThesisLayer]) -> None:
    """At the corner of three cells of the layer below, off the boundary; the target frozen."""
    inserted = 0
    for below, layer in pairwise(jumping):
        born = np.setdiff1d(layer.inserted, below.inserted)
        if not len(born):
            continue
        (site,) = born
        inserted += 1
        diagram = below.diagram_before_inset
        place = layer.state.sites[site, :2]
        vertex = np.nonzero((diagram.vertices == place).all(axis=1))[0]
        around = np.unique(diagram.edge_sites[(diagram.edges == vertex).any(axis=1)])
        assert len(around) == 3
        tags = np.sign(below.state.growth[around])
        assert tags.tolist().count(1) == 1
        target = around[tags == 1][0]
        assert not np.isin(around, below.inserted).any()
        for cell in around:
            corners = diagram.vertices[np.concatenate(rings(diagram, int(cell)))]
            assert np.abs(corners).max() < 20 - 0.01
        assert layer.state.growth[target] == 0
        assert layer.state.weights[target] == pytest.approx((layer.index - 1) * 1.0)
    assert inserted > 10


def test_cells_tile_and_are_convex_before_the_inset(jumping: list[ThesisLayer]) -> None:
    for layer in jumping:
        diagram = layer.diagram_before_inset
        assert diagram.areas(len(layer.state.sites)).sum() == pytest.approx(1600)
        for site in layer.cell_order.tolist():
            (ring,) = rings(diagram, site)
            assert is_convex(diagram.vertices[ring])


def test_inset_cells_keep_their_corners_and_2_mm2(jumping: list[ThesisLayer]) -> None:
    seen = 0
    for layer in jumping:
        before, after = layer.diagram_before_inset, layer.diagram
        for site in layer.inserted[layer.inset_distance[layer.inserted] > 0].tolist():
            if not rings(before, site):
                continue
            seen += 1
            (ring,) = rings(after, site)
            assert corner_count(after, site) == corner_count(before, site)
            assert area(after.vertices[ring]) >= 2 - 1e-6
            assert area(after.vertices[ring]) < area(before.vertices[ring])
            assert is_convex(after.vertices[ring])
    assert seen > 15


def test_cells_still_tile_after_the_inset(jumping: list[ThesisLayer]) -> None:
    for layer in jumping:
        polygons = [shapely.polygons(ring) for (ring,) in layer.diagram.cells().values()]
        assert shapely.is_valid(polygons).all()
        assert shapely.area(polygons).sum() == pytest.approx(1600)
        assert shapely.union_all(polygons).area == pytest.approx(1600)


def test_inserted_cells_keep_the_number_of_corners_that_they_were_born_with() -> None:
    """Algorithm 7; a tagged one only shrinks from then on.

    Sites are settled one after the other: one beside another inserted cell may be changed by it
    afterwards, so those are left out.
    """
    crowded: set[int] = set()
    layers = layers_of(prism(30), scattered(60, 40, 1), offset=1.0)
    born: dict[int, int] = {}
    tagged: set[int] = set()
    for layer in layers:
        inserted = np.isin(layer.neighbours, layer.inserted).all(axis=1)
        for site in layer.inserted.tolist():
            corners = corner_count(layer.diagram_before_inset, site)
            if site in layer.neighbours[inserted]:
                crowded.add(site)
            if site not in crowded:
                assert corners <= born.setdefault(site, corners)
            if site in tagged:
                assert layer.state.growth[site] < 0
            elif layer.state.growth[site] < 0:
                tagged.add(site)
    assert len(born) > 5
    assert tagged


def test_a_layer_where_no_cell_qualifies_gets_no_site() -> None:
    """Of nine cells on a 3 × 3 grid only the middle one lies off the boundary."""
    grid = 13.0 * np.array([[x, y] for y in (-1, 0, 1.02) for x in (-1, 0.03, 1)])
    layers = layers_of(prism(30), grid, offset=10.0)
    first = layers[0].area_per_cell
    assert layers[-1].area_per_cell > first
    assert all(len(layer.inserted) == 0 for layer in layers)
    for below, layer in pairwise(layers):
        assert layer.unanswered == (below.area_per_cell > first * (1 + 1e-9))


def test_insertion_can_be_turned_off() -> None:
    settings = FillSettings(method="thesis", offset=1.0, insertion=False)
    for layer in fill_sections(prism(12), scattered(60, 40, 1), settings).layers:
        assert len(layer.state.sites) == 60
        assert isinstance(layer, ThesisLayer)
        assert not layer.unanswered


def test_equal_areas_call_for_no_site() -> None:
    """On a prism without growth area per cell stays, up to rounding."""
    layers = layers_of(prism(10), scattered(60, 40, 1), offset=0.0)
    assert not any(layer.unanswered or len(layer.inserted) for layer in layers)


def test_a_first_layer_without_area_counts_for_nothing() -> None:
    sections = [Section(0.0, ()), *(square(40, 0.2 * k) for k in range(1, 9))]
    layers = layers_of(sections, scattered(60, 40, 1), offset=1.0)
    assert layers[0].area_per_cell == 0
    assert len(layers[0].cell_order) == 0
    assert layers[1].area_per_cell == pytest.approx(1600 / 60)
    assert not len(layers[2].inserted)
    assert len(layers[-1].inserted) > 0


def test_order_of_cells_and_neighbours(jumping: list[ThesisLayer]) -> None:
    for layer in jumping[::10]:
        assert sorted(layer.cell_order.tolist()) == layer.diagram_before_inset.sites().tolist()
        assert layer.cell_order[0] == layer.cell_order.min()
        assert layer.neighbours is layer.diagram_before_inset.neighbours
        assert len(layer.tree) == len(layer.cell_order) - 1


def same(one: ThesisLayer, other: ThesisLayer) -> bool:
    return np.array_equal(one.diagram.vertices, other.diagram.vertices) and np.array_equal(
        one.state.weights, other.state.weights
    )


def test_layers_can_be_gone_through_again_and_asked_for_singly() -> None:
    settings = FillSettings(method="thesis", offset=1.0)
    layers = fill_sections(prism(12), scattered(60, 40, 1), settings).layers
    first = list(layers)
    assert len(layers) == len(first) == 12
    assert all(same(one, other) for one, other in zip(first, layers, strict=True))
    for index in (3, 7, 7, 2, -1):
        layer = layers[index]
        assert isinstance(layer, ThesisLayer)
        assert same(layer, first[index])
    with pytest.raises(IndexError):
        layers[12]


def test_any_engine_will_do() -> None:
    """The diagrams come from the function given, and from nowhere else."""
    seen: list[int] = []
    grid = Grid(np.array([-32.0, -32.0]), 64.0)
    exact = diagrams_on(grid)

    def engine(sites: Floats, weights: Floats, section: Section) -> Diagram:
        seen.append(len(sites))
        return exact(sites, weights, section)

    settings = FillSettings(method="thesis", offset=1.0)
    places = grid.snap(scattered(60, 40, 1))
    own = list(ThesisFilling(prism(8), places, grid, settings, engine).layers)
    usual = ThesisFilling(prism(8), places, grid, settings).layers
    assert all(same(one, other) for one, other in zip(own, usual, strict=True))
    assert max(seen) == 60 + len(own[-1].inserted)
    assert len(seen) > len(own)


def test_offset_auto_is_a_number() -> None:
    """The largest offset with which no wall leans more than 45°: 2 · distance · layer height."""
    sites = np.array([[-5.0, 0], [5, 0], [-5, 12], [5, 12]])
    filling = fill_sections(prism(2), sites, FillSettings(method="thesis"))
    assert filling.settings.offset == pytest.approx(2 * 10 * 0.2, rel=1e-6)
