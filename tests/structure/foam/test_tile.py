from fractions import Fraction
from math import sqrt, tan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Voronoi

from v3dcad.errors import SettingError
from v3dcad.geometry.power_diagram.grid import STEPS
from v3dcad.geometry.voronoi.cells import voronoi_cells
from v3dcad.geometry.voronoi.measures import extents
from v3dcad.geometry.voronoi.periodic import with_copies
from v3dcad.geometry.voronoi.reach import cell_reaches
from v3dcad.geometry.voronoi.steepest import steepest_wall
from v3dcad.structure.foam import make_tile
from v3dcad.structure.foam.tile import MARGIN_CELLS, SIZE, TAU_SQUARED, pattern, stretch_for, tiles

SEEDS = st.integers(0, 2**63 - 1)


def test_the_shipped_tiles_are_whole_certified_and_even():
    assert tiles()
    for tile in tiles():
        assert (tile.sites >= 0).all()
        assert (tile.sites < np.array(SIZE)).all()
        assert len(np.unique(tile.sites, axis=0)) == len(tile.sites) > 2000
        assert make_tile.certified(tile.sites).within(TAU_SQUARED)
        quality = make_tile.judged(tile.sites / make_tile.RADIUS, np.array(SIZE) / make_tile.RADIUS)
        assert quality.cells_per_section == pytest.approx(tile.cells_per_section, rel=1e-9)
        assert quality.cells_per_section > 1000
        assert quality.fewest > 0.97
        assert quality.most < 1.03
        assert quality.spread <= 0.72
        assert quality.largest <= 3.5
        assert quality.height <= 1.35


@pytest.mark.parametrize("angle", [30.0, 45.0, 60.0])
@pytest.mark.parametrize("random_seed", range(5))
def test_no_wall_of_a_part_leans_over_the_angle(angle, random_seed):
    """Parts of 10,000 cells: the walls' angles in mm, and the certificate in steps."""
    stretch = stretch_for(angle)
    size = np.array([27.0, 27.0, 27.0 * stretch])
    foam = pattern(1.0, random_seed, 31.0)
    high = np.ceil(size / foam.pitch / [1, 1, stretch]).astype(np.int64)
    sites = foam.sites_in(np.zeros(3, np.int64), high)[0]
    inside = ((sites >= 0) & (sites <= high)).all(axis=1)
    assert inside.sum() >= 10_000
    wall = steepest_wall(sites, np.zeros(3, np.int64), high)
    assert wall.within(TAU_SQUARED)
    x, y, z = (sites[wall.sites[1]] - sites[wall.sites[0]]) * foam.pitch * [1, 1, stretch]
    # The wall's normal is (Δx, Δy, Δz / s²).
    assert abs(z) / stretch**2 <= np.hypot(x, y) * tan(np.radians(angle))


def test_qhull_finds_no_steeper_wall():
    foam = pattern(1.0, 0, 14.0)
    high = np.full(3, round(10 / foam.pitch))
    sites = foam.sites_in(np.zeros(3, np.int64), high)[0]
    diagram = Voronoi(sites.astype(np.float64))
    worst = 0.0
    for (i, j), ends in zip(diagram.ridge_points, diagram.ridge_vertices, strict=True):
        corners = diagram.vertices[ends]
        if -1 not in ends and ((corners > 0) & (corners < high)).all(axis=1).any():
            x, y, z = sites[j] - sites[i]
            worst = max(worst, abs(z) / np.hypot(x, y))
    assert worst**2 <= TAU_SQUARED
    assert steepest_wall(sites, np.zeros(3, np.int64), high).tau == pytest.approx(worst)


def test_the_margin_holds_all_sites_that_matter():
    """Proven: no point of space is farther from its nearest site than the margin."""
    for tile in tiles():
        around = with_copies(tile.sites.astype(np.float64), np.array(SIZE, np.float64), 3e4)
        _, bounds = cell_reaches(around, np.zeros(3), np.array(SIZE, np.float64))
        cell = SIZE[0] / sqrt(tile.cells_per_section)
        assert bounds.max() < MARGIN_CELLS * cell


def box(draw_low, draw_size):
    low = np.array(draw_low)
    return low, low + np.array(draw_size)


@settings(max_examples=30)
@given(
    SEEDS,
    st.floats(0.5, 5),
    st.tuples(*[st.integers(-(1 << 24), 1 << 24)] * 3),
    st.tuples(*[st.integers(0, 1 << 22)] * 3),
    st.tuples(*[st.integers(0, 1 << 21)] * 3),
)
def test_sites_do_not_depend_on_the_box_that_they_are_asked_for(seed, cell, low, size, inset):
    foam = pattern(cell, seed, 30.0)
    low, high = box(low, size)
    whole = foam.sites_in(low, high)[0]
    inner_low = low + np.minimum(inset, size)
    inner_high = np.maximum(inner_low, high - np.array(inset))
    part = foam.sites_in(inner_low, inner_high)[0]
    reach = inner_low - foam.margin, inner_high + foam.margin
    expected = whole[((whole >= reach[0]) & (whole <= reach[1])).all(axis=1)]
    # The same sites, in the same order.
    np.testing.assert_array_equal(part, expected)
    assert len(whole) == foam.count_in(low, high)
    assert len(np.unique(whole, axis=0)) == len(whole)
    assert (whole % foam.multiple == 0).all()


def test_sites_on_the_edge_of_what_is_in_reach_are_in():
    foam = pattern(1.0, 0, 10.0)
    site = foam.sites[0] * foam.multiple
    for way in np.concatenate([np.eye(3, dtype=np.int64), -np.eye(3, dtype=np.int64)]):
        edge = site + way * foam.margin
        assert (foam.sites_in(edge, edge)[0] == site).all(axis=1).any()
        assert not (foam.sites_in(edge + way, edge + way)[0] == site).all(axis=1).any()


@settings(max_examples=20)
@given(SEEDS, st.floats(0.2, 20), st.floats(1, 400))
def test_the_grid_spans_the_frame_and_the_tile_is_whole_on_it(seed, cell, frame):
    foam = pattern(cell, seed, frame)
    assert foam.pitch * STEPS >= frame * (1 - 1e-12)
    assert foam.pitch * STEPS <= frame * (1 + 1 / foam.multiple) * (1 + 1e-12)
    step = foam.pitch * foam.multiple * SIZE[0]
    assert step**2 / cell**2 == pytest.approx(tiles()[0].cells_per_section)
    assert foam.margin * foam.pitch == pytest.approx(2 * cell, rel=1e-4)


@given(SEEDS)
def test_seeds_only_shift_and_turn(seed):
    """All pairs of sites stay as far apart, in height and across."""
    foam, tile = pattern(1.0, seed, 10.0), tiles()[0]
    count = len(tile.sites)
    if len(foam.sites) == count:
        rng = np.random.default_rng(seed % 1000)
        i, j = rng.integers(0, count, (2, 500))
        ours, theirs = foam.sites[i] - foam.sites[j], tile.sites[i] - tile.sites[j]
        assert ((ours[:, 2] - theirs[:, 2]) % SIZE[2] == 0).all()

        def squared(offsets):
            offsets = offsets[:, :2] % SIZE[0]
            return (np.minimum(offsets, SIZE[0] - offsets) ** 2).sum(axis=1)

        np.testing.assert_array_equal(squared(ours), squared(theirs))


def test_seeds_give_different_sites():
    low, high = np.zeros(3, np.int64), np.full(3, 1 << 22)
    found = {pattern(1.0, seed, 10.0).sites_in(low, high)[0].tobytes() for seed in range(20)}
    assert len(found) == 20


def test_cell_size_is_that_of_sections():
    """1 / s² cells a mm² on average over all heights: cells' heights sum up to it."""
    cell, foam = 0.7, pattern(0.7, 3, 40.0)
    side = SIZE[0] * foam.multiple
    high = np.array([side, side, SIZE[2] * foam.multiple])
    sites = foam.sites_in(np.zeros(3, np.int64), high)[0].astype(np.float64)
    wanted = np.flatnonzero(((sites >= 0) & (sites < high)).all(axis=1))
    low, top = extents(voronoi_cells(sites, wanted))
    cells = (top - low)[:, 2].sum() / high[2]
    assert cells / (side * foam.pitch) ** 2 == pytest.approx(1 / cell**2, rel=1e-6)


@pytest.mark.parametrize(("angle", "tau"), [(30, 1), (45, 1), (60, 1), (20, 1), (80, 1)])
def test_the_stretch_keeps_tau(angle, tau):
    stretch = stretch_for(angle)
    assert stretch >= 1
    assert stretch * tan(np.radians(angle)) >= tau * sqrt(TAU_SQUARED) * (1 - 1e-12)
    assert stretch == 1 or stretch * tan(np.radians(angle)) == pytest.approx(sqrt(TAU_SQUARED))
    assert Fraction(1) <= TAU_SQUARED <= 2


def test_cells_that_the_grid_does_not_resolve_are_refused():
    with pytest.raises(SettingError, match=r"0\.0001: .* are the least") as caught:
        pattern(1e-4, 0, 1000.0)
    assert caught.value.name == "cell_size"
    least = float(str(caught.value).rsplit("; ", 1)[1].split()[0])
    assert pattern(least * 1.01, 0, 1000.0).multiple >= 1
    with pytest.raises(SettingError):
        pattern(least * 0.99, 0, 1000.0)


@pytest.mark.long
def test_the_program_makes_the_shipped_file(tmp_path, monkeypatch):
    made = tmp_path / "tiles.npz"
    monkeypatch.setattr("sys.argv", ["make_tile", str(made)])
    make_tile.main()
    shipped = make_tile.Path(make_tile.__file__).parent / make_tile.TILES
    assert made.read_bytes() == shipped.read_bytes()


def test_cells_lie_within_the_reaches_that_are_shipped():
    for tile in tiles():
        around = with_copies(
            tile.sites.astype(np.float64), np.array(SIZE, np.float64), 3 * make_tile.RADIUS
        )
        low, high = extents(voronoi_cells(around, np.arange(len(tile.sites))))
        below, above = tile.sites[:, 2] - low[:, 2], high[:, 2] - tile.sites[:, 2]
        true = np.column_stack([below, above])
        assert (tile.reaches >= true).all()
        assert (tile.reaches <= true + 2).all()
