"""Foams whose cells differ in size: walls, sizes, distances, and what is told."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import RegularGridInterpolator
from scipy.spatial import KDTree

from tests.geometry.voronoi import oracle
from v3dcad.errors import SettingError
from v3dcad.settings import FillSettings
from v3dcad.structure.foam.darts import graded_disk, shares_of
from v3dcad.structure.foam.explicit import explicit_sites
from v3dcad.structure.foam.graded import (
    LEAST_TAU,
    TAU,
    graded_sites,
    graded_stretch,
)
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


def test_a_constant_field_has_as_many_cells_as_a_uniform_foam():
    made = graded_sites(lambda at: np.full(len(at), 1.6), LOW, HIGH, settings_of())
    for density in densities(made.sites, made.stretch, 1):
        assert density[0] * 1.6**2 == pytest.approx(1, abs=0.06)
    assert made.asked == made.made == pytest.approx((1.6, 1.6))
    assert made.finer == 0


def test_a_mirrored_field_makes_as_many_sites():
    counts = [
        len(graded_sites(field, LOW, HIGH, settings_of(max_overhang=90.0)).sites)
        for field in (lambda at: 1.5 + 0.1 * at[:, 0], lambda at: 1.5 + 0.1 * (16 - at[:, 0]))
    ]
    assert counts[0] == pytest.approx(counts[1], rel=0.04)


def test_the_same_sites_twice_and_others_for_another_seed():
    def field(at):
        return 2 + 0.1 * at[:, 2]

    first, again = (graded_sites(field, LOW, HIGH, settings_of()).sites for _ in range(2))
    assert first.tobytes() == again.tobytes()
    other = graded_sites(field, LOW, HIGH, settings_of(random_seed=1)).sites
    assert first.tobytes() != other.tobytes()


def test_darts_keep_the_mean_of_their_radii():
    found = sampled(lambda at: 0.5 + 0.2 * at[:, 0], np.zeros(3), np.full(3, 5.0), 2.0)
    inside = np.array([[0.0] * 3, [5.0] * 3])
    shares = shares_of(found.grid, inside, 2.0)
    places, radii = graded_disk(found.grid, shares, inside, 2.0, 0)
    assert len(places) > 100
    grid = found.grid
    axes = [
        low + grid.side * np.arange(count)
        for low, count in zip(grid.corner, grid.sizes.shape, strict=True)
    ]
    np.testing.assert_allclose(radii, RegularGridInterpolator(axes, grid.sizes)(places))
    beyond = np.maximum(np.maximum(-places, places - 5.0), 0).max(axis=1)
    assert (beyond <= 2.0 * radii + 1e-9).all()
    pairs = KDTree(places).query_pairs(1.6, output_type="ndarray")
    apart = np.linalg.norm(places[pairs[:, 0]] - places[pairs[:, 1]], axis=1)
    assert (apart >= radii[pairs].mean(axis=1) * (1 - 1e-12)).all()


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
