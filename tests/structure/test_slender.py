"""Tall poles, on whose way up weights leave the safe range: epochs follow each other unseen."""

from __future__ import annotations

import numpy as np
import pytest
from v3dcad.geometry.power_diagram.epochs import FIRST

from tests import oracle
from tests.structure.test_births_law import BESIDE, Below
from tests.structure.test_fill import fingerprint, laws
from v3dcad import FillSettings, GeometryError, Section, fill_sections
from v3dcad.geometry.power_diagram.grid import HEAVIEST, STEPS, UTMOST
from v3dcad.geometry.power_diagram.regular_triangulation import triangulation
from v3dcad.geometry.power_diagram.triangle_mesh import SENTINELS
from v3dcad.model import Layer
from v3dcad.structure.checksum import structure_checksum
from v3dcad.structure.fill import Filling
from v3dcad.structure.overhang import overhang
from v3dcad.structure.sites import scatter_sites

pytestmark = pytest.mark.slow

WIDTH = 20.0
SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]) * WIDTH
RANGE = HEAVIEST * (WIDTH / STEPS) ** 2
"""mm²: what a weight of the first epoch is at most"""


def pole(
    aspect: float, count: int = 12, foot: float = 1.0, seed: int = 1, **settings: float
) -> Filling:
    """A pole, or an inverted pyramid whose foot is a share of its top."""
    height = 0.4
    layers = round(aspect * WIDTH / height)
    sections = [
        Section(height * k, ((SQUARE - 10) * (foot + (1 - foot) * k / layers) + 10,))
        for k in range(layers)
    ]
    sites = scatter_sites(np.array([[0.0, 0], [WIDTH, WIDTH]]), count, seed)
    filling = fill_sections(sections, sites, FillSettings(layer_height=height, **settings))
    assert isinstance(filling, Filling)
    return filling


CASES = {
    "slow": {"aspect": 50, "count": 20, "offset": 2.0},
    "steep": {"aspect": 10, "max_overhang": 80.0},
    "many epochs": {"aspect": 25, "max_overhang": 84.0, "count": 20},
    "pyramid": {"aspect": 50, "foot": 0.3, "max_overhang": 75.0, "seed": 5},
}


def test_births_go_on_whatever_newborns_will_weigh_on_top() -> None:
    """None was given once that would have been too heavy by the last layer."""
    filling = pole(100, count=40, offset=1.2)
    layers = list(filling.layers)
    full = layers[0].area_per_cell
    rows = filling.history.sites
    top = layers[-1].z * filling.growth_step / filling.grid.pitch**2
    assert (rows.base + rows.growth * top).max() > 1.5 * HEAVIEST
    late = filling.births[(filling.births[:, 0] > 100) & (filling.births[:, 0] < 500), 0]
    assert len(late) > 40
    for layer in layers[100:500]:
        assert layer.area_per_cell <= full * 1.1
    for index in np.unique(late)[::15]:
        layer, present = layers[index], len(layers[index - 1].state.sites)
        below = Below(filling, layer, present, full)
        newborn = layer.state.sites[present:]
        assert 0 < len(newborn) <= below.wanted
        chosen = np.hypot(*(newborn[:, None] - below.places).transpose(2, 0, 1)).argmin(axis=1)
        off = np.where(below.from_outside, BESIDE, 1e-5)[chosen]
        assert (np.abs(newborn - below.places[chosen]).max(axis=1) < off).all()
        room = below.room(below.sites[below.inside], below.growth[below.inside])
        assert (room[chosen] >= -off).all()


@pytest.mark.parametrize("name", sorted(CASES))
def test_layers_of_every_epoch_obey_the_laws(name: str) -> None:
    filling = pole(**CASES[name])
    layers = list(filling.layers)
    starts = [epoch.start for epoch in filling.history.epochs]
    assert len(starts) > 1
    assert layers[-1].state.weights.max() > RANGE
    for layer in [*layers[:: len(layers) // 6], layers[-1]]:
        laws(layer)
        same(layer, filling.layers[layer.index])
        same(layer, filling.slice(layer.section, layer.index))


def same(layer: Layer, other: Layer) -> None:
    """The same to the last bit of every vertex."""
    np.testing.assert_array_equal(layer.state.weights, other.state.weights)
    ours, theirs = (each.diagram.vertices for each in (layer, other))
    np.testing.assert_array_equal(ours[np.lexsort(ours.T)], theirs[np.lexsort(theirs.T)])
    np.testing.assert_array_equal(fingerprint(layer.diagram), fingerprint(other.diagram))
    assert layer.area_per_cell == other.area_per_cell


@pytest.mark.parametrize("name", sorted(CASES))
def test_what_climbs_is_what_is_built_from_scratch(name: str) -> None:
    """The triangulation at the top is the one of its weights, and of those left uncounted."""
    filling = pole(**CASES[name])
    for _ in filling.layers:
        pass
    course = filling._passed
    assert course is not None
    mesh, sites, epoch = course.mesh, course.sites(), course.epochs[-1]
    time = int(course.times[-1])
    rows = slice(SENTINELS, int(mesh.counts.points))
    base, growth = epoch.counts(sites.base, sites.growth, sites.born)
    np.testing.assert_array_equal(mesh.points[rows, 2], base + growth * (time - epoch.start))
    # All sites of the recorded weights, the heaviest 0: who has none of the frame is the same.
    weights = sites.base + sites.growth * time
    whole = triangulation(sites.places, weights - weights.max())
    top = filling.layers[-1]
    lives = np.isin(np.arange(len(sites.born)), top.diagram.sites())[sites.site_of]
    for each in (mesh, whole):
        assert (each.triangle_of[rows][lives] >= 0).all()
    gone = (growth == 0) & (base == -HEAVIEST)
    if len(course.epochs) > 2:
        assert gone.any()
    assert (mesh.triangle_of[rows][gone] < 0).all()


@pytest.mark.parametrize("name", sorted(CASES))
def test_facets_sliced_are_the_edges_of_all_epochs(name: str) -> None:
    filling = pole(**CASES[name])
    layers, walls = list(filling.layers), filling.walls
    rate = filling.growth_step / filling.grid.pitch**2
    seams = [epoch.start / rate for epoch in filling.history.epochs[1:]]
    heights = [seam + step for seam in seams[:4] for step in (-0.01, 0.01)]
    for z in [*heights, *(layer.z + 0.123 for layer in layers[5 : -1 : len(layers) // 9])]:
        if not 0 < z < layers[-1].z:
            continue
        which, segments = walls.slice(z)
        diagram = filling.at(z)
        inner = diagram.inner() & (diagram.lengths() > 1e-7)
        edges = {
            tuple(pair): ends
            for pair, ends in zip(
                diagram.edge_sites[inner], diagram.vertices[diagram.edges[inner]], strict=True
            )
        }
        long = np.hypot(*(segments[:, 0] - segments[:, 1]).T) > 1e-7
        found = {tuple(pair) for pair in walls.sites[which[long]]}
        assert found == set(edges)
        for facet, segment in zip(which[long], segments[long], strict=True):
            ends = edges[tuple(walls.sites[facet])]
            apart = min(np.abs(segment - ends).max(), np.abs(segment - ends[::-1]).max())
            assert apart < 1e-9


def test_struts_go_on_through_epochs() -> None:
    """Where an epoch begins nothing ends: no strut inside the rectangle has an end there."""
    filling = pole(50, 30, max_overhang=80.0, insertion=False)
    rate = filling.growth_step / filling.grid.pitch**2
    seams = np.array([epoch.start / rate for epoch in filling.history.epochs[1:]])
    assert len(seams)
    axes = filling.strut_axes
    assert ((axes.ends[:, 0, 2] < seams[0]) & (axes.ends[:, 1, 2] > seams[0])).any()
    inside = ((axes.ends[:, :, :2] > 1e-6) & (axes.ends[:, :, :2] < WIDTH - 1e-6)).all(axis=2)
    apart = np.abs(axes.ends[:, :, 2, None] - seams).min(axis=2)
    assert apart[inside].min() > 1e-9


@pytest.mark.parametrize("name", ["slow", "pyramid"])
def test_the_certificate_holds_at_the_top(name: str) -> None:
    filling = pole(**CASES[name])
    layers = list(filling.layers)[-40:]
    limit = filling.settings.max_overhang
    found = overhang(layers, 0.8)
    assert found.wall_tilt.max() <= limit + 1e-6
    shift = 0.4 * np.tan(np.radians(limit))
    assert found.distance.max() <= shift * 1.01 + 1e-6
    for layer in layers[::13]:
        pairs = oracle.power_diagram(layer.state.sites, lightened(layer))[0]
        born = layer.diagram.areas(len(layer.state.sites)) > 1e-9  # and not only just
        shown = layer.diagram.neighbours[born[layer.diagram.neighbours].all(axis=1)]
        assert {tuple(pair) for pair in shown.tolist()} <= {
            tuple(sorted(row[[k, (k + 1) % 3]].tolist())) for row in pairs for k in range(3)
        }


def lightened(layer: Layer) -> np.ndarray:
    """The weights, less the heaviest, and none so light that qhull would lose its digits."""
    weights = layer.state.weights - layer.state.weights.max()
    return np.maximum(weights, -4 * WIDTH**2)


def test_the_check_sum_is_the_same_each_time() -> None:
    filling = pole(**CASES["steep"])
    first = structure_checksum(filling.layers, filling.grid)
    again = structure_checksum(pole(**CASES["steep"]).layers, filling.grid)
    assert first.differences(again) == []
    alone = (filling.layers[index] for index in range(len(filling.layers)))
    assert first.differences(structure_checksum(alone, filling.grid)) == []


def test_a_gap_between_sections_may_be_many_epochs_high() -> None:
    sites = scatter_sites(np.array([[0.0, 0], [WIDTH, WIDTH]]), 20, 3)
    settings = FillSettings(layer_height=0.4, offset=2.0, max_overhang=90.0)
    heights = [*np.arange(0, 30, 0.4), 20_000.0, 20_000.4]
    filling = fill_sections([Section(z, (SQUARE,)) for z in heights], sites, settings)
    layers = list(filling.layers)
    assert layers[-1].state.weights.max() > 4 * RANGE
    for layer in layers[-2:]:
        laws(layer, 1e-8)
        same(layer, filling.layers[layer.index])


def test_a_first_section_far_above_the_bed() -> None:
    sites = scatter_sites(np.array([[0.0, 0], [WIDTH, WIDTH]]), 20, 3)
    settings = FillSettings(layer_height=0.4, offset=2.0, max_overhang=90.0)
    sections = [Section(5000 + 0.4 * k, (SQUARE,)) for k in range(20)]
    filling = fill_sections(sections, sites, settings)
    for layer in list(filling.layers)[::6]:
        laws(layer)
        same(layer, filling.layers[layer.index])
    assert filling.walls.points[:, 2].min() == pytest.approx(5000)


def test_facets_go_on_above_the_last_layer() -> None:
    filling = pole(**CASES["steep"])
    last = list(filling.layers)[-1].z
    facets = filling.facets(last + 25)
    assert facets.points[:, 2].max() == pytest.approx(last + 25)
    assert {tuple(pair) for pair in filling.walls.sites.tolist()} <= {
        tuple(pair) for pair in facets.sites.tolist()
    }


def test_points_are_found_in_their_cells_near_the_top() -> None:
    filling = pole(**CASES["many epochs"])
    top = list(filling.layers)[-1]
    rng = np.random.default_rng(4)
    points = np.column_stack([rng.uniform(0, WIDTH, (200, 2)), np.full(200, top.z)])
    weights = lightened(top)
    power = ((points[:, None, :2] - top.state.sites) ** 2).sum(axis=2) - weights
    np.testing.assert_array_equal(filling.sites_at(points), power.argmin(axis=1))


def test_what_64_bits_do_not_hold_is_refused() -> None:
    utmost = UTMOST * (WIDTH / STEPS) ** 2
    safe = utmost / 99
    settings = {"layer_height": 0.4, "max_overhang": 90.0}
    sections = [Section(0.4 * k, (SQUARE,)) for k in range(100)]
    sites = scatter_sites(np.array([[0.0, 0], [WIDTH, WIDTH]]), 12, 1)
    with pytest.raises(GeometryError, match="safe range"):
        fill_sections(sections, sites, FillSettings(offset=safe * 1.001, **settings))
    filling = fill_sections(sections, sites, FillSettings(offset=safe * 0.999, **settings))
    top = list(filling.layers)[-1]
    assert abs(top.state.weights).max() <= utmost
    same(top, filling.layers[-1])


def test_within_the_safe_range_there_is_one_epoch() -> None:
    filling = pole(2, count=40)
    assert filling.history.epochs == (FIRST,)


@pytest.mark.parametrize("seed", [101, 1721])
def test_struts_that_last_no_height_are_none(seed: int) -> None:
    """Moments that differ may be the same height: such a strut would have no place in a chain."""
    square = np.array([[-20.0, -20], [20, -20], [20, 20], [-20, 20]])
    sections = [Section(0.0, (0.3 * square,)), *(Section(3e3 * k, (square,)) for k in range(1, 5))]
    sites = np.random.default_rng(seed).uniform(-20, 20, (30, 2))
    filling = fill_sections(sections, sites, FillSettings(max_overhang=80.0))
    spans = filling.history.tracks.spans
    assert (spans[:, 0] < spans[:, 1]).all()
    walls = filling.walls
    for z in 1000.0, 5000.0, 11000.0:
        _, segments = walls.slice(z)
        diagram = filling.at(z)
        assert np.hypot(*(segments[:, 0] - segments[:, 1]).T).sum() == pytest.approx(
            diagram.lengths()[diagram.inner()].sum(), rel=1e-9
        )
