"""Foams whose cells differ in size: walls, sizes, distances, and what is told."""

import hashlib

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import RegularGridInterpolator
from scipy.spatial import KDTree

import v3dcad
from tests.geometry.voronoi import oracle
from v3dcad.errors import SettingError
from v3dcad.settings import FillSettings
from v3dcad.structure.foam.choice import LEAST_TAU, TAU, graded_stretch
from v3dcad.structure.foam.darts import graded_disk, targets_of
from v3dcad.structure.foam.explicit import explicit_sites
from v3dcad.structure.foam.graded import graded_sites
from v3dcad.structure.foam.size_grid import sampled
from v3dcad.structure.foam.space import space_of

pytestmark = pytest.mark.slow

LOW, HIGH = np.zeros(3), np.array([16.0, 14.0, 15.0])


def settings_of(**chosen):
    return FillSettings(cell_size="x", **chosen)


def tilt(graded):
    """The largest tilt of a wall, degrees, by scipy's diagram of the sites in stretched space."""
    squeezed = np.array([1, 1, 1 / graded.stretch])
    worst = oracle.steepest(graded.sites * squeezed, LOW * squeezed, HIGH * squeezed)
    return np.degrees(np.arctan(np.sqrt(worst) / graded.stretch))


@settings(max_examples=6, deadline=None)
@given(
    st.integers(0, 10**6),
    st.tuples(*[st.floats(-0.25, 0.25)] * 3),
    st.sampled_from([(45.0, "auto"), (45.0, LEAST_TAU), (30.0, "auto"), (60.0, 1.0)]),
)
def test_no_wall_leans_more_than_allowed(seed, gradient, allowed):
    angle, stretch = allowed
    middle = (LOW + HIGH) / 2

    def field(at):
        return np.clip(3 + (at - middle) @ np.array(gradient), 1.5, 6)

    chosen = settings_of(max_overhang=angle, stretch=stretch, random_seed=seed)
    made = graded_sites(field, LOW, HIGH, chosen)
    assert tilt(made) <= angle + 1e-6


@settings(max_examples=5, deadline=None)
@given(st.integers(0, 1 << 20), st.floats(0.0, 6.28), st.sampled_from([LEAST_TAU, TAU, 2.5]))
def test_no_wall_leans_more_where_sizes_come_and_go(seed, turn, stretch):
    def field(at):
        return 2.6 + 0.9 * np.sin(at @ np.array([np.cos(turn), np.sin(turn), 0.4]) * 0.25)

    chosen = settings_of(random_seed=seed, stretch=stretch)
    assert tilt(graded_sites(field, LOW, HIGH, chosen)) <= 45 + 1e-6


def densities(sites, stretch, bins):
    """Cells a mm² of a horizontal section in bins along z and x: half as many as corners."""
    foam = explicit_sites(sites, stretch, LOW, HIGH)
    ends = space_of(foam, np.array([LOW, HIGH])).strut_axes().ends
    rise, middle = np.ptp(ends[:, :, 2], axis=1), ends.mean(axis=1)
    return [
        np.histogram(middle[:, axis], bins, (LOW[axis], HIGH[axis]), weights=rise)[0]
        / (2 * np.prod(HIGH) / bins)
        for axis in (0, 2)
    ]


@pytest.mark.parametrize("axis", [0, 2])
def test_cells_are_as_large_as_asked(axis):
    """Local sizes within 10 %: cells a mm² along the direction in which the size changes."""

    def field(at):
        return np.clip(1.2 + 0.15 * at[:, axis], 0, 3.2)

    made = graded_sites(field, LOW, HIGH, settings_of(random_seed=3))
    found = densities(made.sites, made.stretch, 4)[0 if axis == 0 else 1]
    edges = np.linspace(0, HIGH[axis], 401)
    places = np.zeros((400, 3))
    places[:, axis] = (edges[1:] + edges[:-1]) / 2
    wanted = (1 / field(places) ** 2).reshape(4, 100).mean(axis=1)
    np.testing.assert_allclose(np.sqrt(wanted / found), 1, atol=0.1)


def random_field(seed):
    """Six waves in random directions, as long as the box or longer: about 2.2 mm."""
    rng = np.random.default_rng(seed)
    ways = rng.normal(size=(6, 3))
    ways *= rng.uniform(0.1, 0.35, (6, 1)) / np.linalg.norm(ways, axis=1, keepdims=True)
    phases = rng.uniform(0, 2 * np.pi, 6)
    return lambda at: 2.2 * np.exp(0.12 * np.sin(at @ ways.T + phases).sum(axis=1))


def as_can_be_met(field, stretch):
    """The field lowered until it is nowhere too steep."""
    squeezed = np.array([1, 1, 1 / stretch])
    grid = sampled(lambda at: field(at / squeezed), LOW, HIGH * squeezed).grid
    axes = [
        low + grid.side * np.arange(count)
        for low, count in zip(grid.corner, grid.sizes.shape, strict=True)
    ]
    sizes = RegularGridInterpolator(axes, grid.sizes)
    return lambda at: sizes(at * squeezed)


@settings(max_examples=6)
@given(st.integers(0, 10**6))
def test_smooth_fields_get_their_sizes_and_no_steep_wall(seed):
    field = random_field(seed)
    made = graded_sites(field, LOW, HIGH, settings_of(random_seed=seed))
    assert tilt(made) <= 45 + 1e-6
    # Cells a mm² in each eighth of the box.
    ends = space_of(explicit_sites(made.sites, made.stretch, LOW, HIGH), np.array([LOW, HIGH]))
    ends = ends.strut_axes().ends
    halves = [np.linspace(low, high, 3) for low, high in zip(LOW, HIGH, strict=True)]
    rise = np.ptp(ends[:, :, 2], axis=1)
    found = np.histogramdd(ends.mean(axis=1), halves, weights=rise)[0] / (2 * np.prod(HIGH) / 8)
    share = (np.arange(40) + 0.5) / 40
    places = np.stack(np.meshgrid(*(share[:, None] * HIGH).T, indexing="ij"), axis=-1)
    wanted = as_can_be_met(field, made.stretch)(places.reshape(-1, 3)) ** -2.0
    wanted = wanted.reshape(2, 20, 2, 20, 2, 20).mean(axis=(1, 3, 5))
    assert np.sqrt(np.mean((np.sqrt(wanted / found) - 1) ** 2)) < 0.1


CUBE = trimesh.creation.box((24.0, 24.0, 30.0))


def statistics(**chosen):
    """Of cells that no contour cuts: mean size, mm, its spread, and their neighbours."""
    filled = v3dcad.fill((CUBE.vertices, CUBE.faces), layer_height=2.0, **chosen)
    areas, neighbours = [], []
    for layer in filled.layers:
        pairs, cells = layer.diagram.edge_sites, len(layer.state.sites)
        whole = layer.diagram.areas(cells) > 0
        whole[pairs[pairs[:, 0] < 0, 1]] = False
        areas.append(layer.diagram.areas(cells)[whole])
        neighbours.append(np.bincount(pairs[pairs >= 0], minlength=cells)[whole])
    sizes = np.sqrt(np.concatenate(areas))
    assert len(sizes) > 1000
    return sizes.mean(), sizes.std(), np.concatenate(neighbours).mean()


def test_a_constant_field_has_the_statistics_of_a_uniform_foam():
    uniform = statistics(cell_size=2.0, stretch=TAU)
    graded = statistics(cell_size=lambda x, y, z: np.full(len(x), 2.0))
    assert graded[0] == pytest.approx(uniform[0], rel=0.03)
    assert graded[1] == pytest.approx(uniform[1], rel=0.1)
    assert graded[2] == pytest.approx(uniform[2], rel=0.02)


def test_a_constant_field_is_made_as_it_is_asked():
    made = graded_sites(lambda at: np.full(len(at), 1.6), LOW, HIGH, settings_of())
    for density in densities(made.sites, made.stretch, 1):
        assert density[0] * 1.6**2 == pytest.approx(1, abs=0.06)
    assert made.asked == made.made == pytest.approx((1.6, 1.6))
    assert made.finer == 0


@pytest.mark.parametrize("axis", [0, 2])
def test_a_mirrored_field_has_the_same_statistics(axis):
    def field(*at):
        return 2.2 + 0.08 * at[axis]

    def mirrored(*at):
        return 2.2 - 0.08 * at[axis]

    one, other = (statistics(cell_size=size) for size in (field, mirrored))
    assert one[0] == pytest.approx(other[0], rel=0.04)
    assert one[1] == pytest.approx(other[1], rel=0.1)
    assert one[2] == pytest.approx(other[2], rel=0.02)


def test_the_same_sites_everywhere_and_others_for_another_seed():
    def field(at):
        return 2 + 0.1 * at[:, 2]

    first, again = (graded_sites(field, LOW, HIGH, settings_of()).sites for _ in range(2))
    assert first.tobytes() == again.tobytes()
    # So on Python 3.11, 3.12 and 3.13, with numpy 2.4 and 2.5.
    digest = "84b9c47310b766947dd2c422d2928430a4fafd5969ac249fb8cc7cd9b9c997ee"
    assert hashlib.sha256(first.tobytes()).hexdigest() == digest
    other = graded_sites(field, LOW, HIGH, settings_of(random_seed=1)).sites
    assert first.tobytes() != other.tobytes()


def test_darts_keep_the_mean_of_their_radii():
    found = sampled(lambda at: 0.5 + 0.2 * at[:, 0], np.zeros(3), np.full(3, 5.0))
    inside = np.array([[0.0] * 3, [5.0] * 3])
    wanted = np.array([[2.5, 2.5, 2.5], [2.5, 2.5, 2.8], [9.0, 2.5, 2.5]])
    targets = targets_of(found.grid, inside, 2.0)
    places, radii, kept = graded_disk(found.grid, targets, 0, wanted, 1.1)
    assert len(places) > 100
    # What is wanted comes first, but not straight over another, nor far outside.
    assert kept == 1
    assert places[0].tolist() == wanted[0].tolist()
    grid = found.grid
    axes = [
        low + grid.side * np.arange(count)
        for low, count in zip(grid.corner, grid.sizes.shape, strict=True)
    ]
    sizes = RegularGridInterpolator(axes, grid.sizes)
    np.testing.assert_allclose(radii, sizes(np.clip(places, 0, [axis[-1] for axis in axes])))
    beyond = np.maximum(np.maximum(-places, places - 5.0), 0).max(axis=1)
    assert (beyond <= 2.0 * radii + 1e-9).all()
    pairs = KDTree(places).query_pairs(1.6, output_type="ndarray")
    apart = np.linalg.norm(places[pairs[:, 0]] - places[pairs[:, 1]], axis=1)
    assert (apart >= radii[pairs].mean(axis=1) * (1 - 1e-12)).all()


def hexagons(apart):
    """Sites in a plane in the middle of the box and around it."""
    i, j = np.meshgrid(np.arange(-2, 9), np.arange(-2, 9))
    places = np.stack([i + j % 2 / 2, j * np.sqrt(3) / 2], axis=-1).reshape(-1, 2) * apart
    return np.column_stack([places, np.full(len(places), HIGH[2] / 2)])


@pytest.mark.parametrize("seed", [0, 1])
def test_sites_stay_where_they_are_wanted(seed):
    wanted = hexagons(3.0)
    made = graded_sites(
        lambda at: np.full(len(at), 3.0),
        LOW,
        HIGH,
        settings_of(random_seed=seed),
        wanted=lambda: wanted,
    )
    assert tilt(made) <= 45 + 1e-6
    inside = wanted[((wanted > LOW) & (wanted < HIGH)).all(axis=1)]
    assert KDTree(made.sites).query(inside)[0].max() < 1e-9


def test_sites_do_not_stay_where_walls_would_lean():
    """Two patterns over each other, as near as may be: some must give way, and it ends."""
    wanted = np.concatenate([hexagons(3.0), hexagons(3.0) + np.array([0.3, 0.2, 6.5])])
    made = graded_sites(
        lambda at: np.full(len(at), 3.0), LOW, HIGH, settings_of(), wanted=lambda: wanted
    )
    assert tilt(made) <= 45 + 1e-6


def test_steep_fields_are_made_smaller_and_told():
    def field(at):
        return np.where(at[:, 0] < 6, 1.8, 6.0)

    box = np.zeros(3), np.array([12.0, 12, 16])
    made = graded_sites(field, *box, settings_of())
    assert made.asked == pytest.approx((1.8, 6.0))
    assert made.made[0] == pytest.approx(1.8)
    assert made.made[1] < 1.8 + 0.3 * 6.5
    assert made.finest < 0.4
    assert 0.4 < made.finer < 0.6
    with pytest.raises(SettingError, match="strict: the cell size changes too steeply"):
        graded_sites(field, *box, settings_of(strict=True))


def test_the_usual_stretch():
    assert graded_stretch(settings_of()) == TAU == 1.67
    for angle in (60, 70, 90):
        assert graded_stretch(settings_of(max_overhang=angle)) == 1


@pytest.mark.parametrize(
    ("chosen", "told"),
    [
        ({"stretch": "columns"}, "stretch columns: cells of many sizes need a number, or auto"),
        ({"stretch": 1.2}, r"stretch 1\.2: with cells of many sizes, walls .* at least 1\.41"),
    ],
)
def test_a_stretch_that_does_not_do_is_refused(chosen, told):
    with pytest.raises(SettingError, match=told):
        graded_stretch(settings_of(**chosen))


@pytest.mark.parametrize(
    ("size", "told"),
    [
        (0.001, r"cells, more than 10,000,000; sizes .* times as large"),
        (50.0, "larger than the part"),
    ],
)
def test_sizes_that_do_not_fit_are_refused(size, told):
    with pytest.raises(SettingError, match=told):
        graded_sites(lambda at: np.full(len(at), size), LOW, HIGH, settings_of())


def test_progress_is_heard():
    heard = []
    field = lambda at: np.full(len(at), 3.0)  # noqa: E731
    graded_sites(field, LOW, HIGH, settings_of(), lambda *step: heard.append(step))
    steps = dict.fromkeys(step for step, _, _ in heard)
    assert list(steps) == [
        "sampling cell sizes", "scattering cells", "straightening walls", "certifying walls",
    ]  # fmt: skip
    assert all(0 <= done <= of for _, done, of in heard)
