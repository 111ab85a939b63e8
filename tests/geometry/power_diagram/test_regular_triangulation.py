import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from v3dcad.errors import GeometryError
from v3dcad.geometry.power_diagram.ending import Ending
from v3dcad.geometry.power_diagram.grid import STEPS, Grid, curve_order
from v3dcad.geometry.power_diagram.kinetic_triangulation import advance, motion_of
from v3dcad.geometry.power_diagram.predicates import NUMBER, WEIGHT
from v3dcad.geometry.power_diagram.regular_triangulation import neighbour_pairs, triangulation
from v3dcad.geometry.power_diagram.triangle_mesh import ABSENT, SENTINELS

pytestmark = pytest.mark.filterwarnings("error")


def triangles(mesh):
    """The triangles (t, 3), smallest point first, sorted."""
    corners = mesh.triangles[: mesh.counts.triangles, :3]
    corners = corners[corners[:, 0] != ABSENT]
    turn = (np.argmin(corners, axis=1)[:, None] + np.arange(3)) % 3
    corners = np.take_along_axis(corners, turn, axis=1)
    return corners[np.lexsort(corners.T)]


@st.composite
def weighted(draw):
    """Distinct grid points, many of them cocircular or collinear, and weights."""
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    count = draw(st.integers(1, 60))
    coarse = draw(st.sampled_from([1, STEPS // 8, STEPS // 4]))
    sites = rng.integers(0, STEPS // coarse + 1, (count, 2)) * coarse
    if draw(st.booleans()):
        sites[:, 1] = sites[0, 1]
    sites = np.unique(sites, axis=0)
    heaviest = draw(st.sampled_from([0, 1, 2**40, 2**47]))
    return rng.permutation(sites), rng.integers(-heaviest, heaviest + 1, len(sites))


@given(weighted())
def test_every_orthocircle_is_empty(given_sites):
    sites, weights = given_sites
    mesh = triangulation(sites, weights)
    # Independently: no site is below the plane of any triangle, in Python's exact integers.
    lifted = [
        (int(x), int(y), int(x) ** 2 + int(y) ** 2 - int(w))
        for x, y, w, _ in mesh.points[: SENTINELS + len(sites)]
    ]
    for a, b, c in triangles(mesh):
        (ax, ay, _), (bx, by, _), (cx, cy, _) = (lifted[p] for p in (a, b, c))
        assert (bx - ax) * (cy - ay) > (by - ay) * (cx - ax)
        for d in range(SENTINELS, len(lifted)):
            rows = [[lifted[p][k] - lifted[d][k] for k in range(3)] for p in (a, b, c)]
            (p, q, r), (s, t, u), (v, w, x) = rows
            assert p * (t * x - u * w) - q * (s * x - u * v) + r * (s * w - t * v) <= 0


@given(st.integers(3, 60), st.integers(44, 51), st.integers(0, 10**6))
def test_neighbours_are_the_sides_of_the_triangles(count, bits, seed):
    """And of no triangle that was there before the heaviest site, which comes last, hid others."""
    rng = np.random.default_rng(seed)
    sites = rng.integers(0, STEPS + 1, (count, 2))
    weights = np.sort(rng.integers(0, 2**bits, count))
    mesh = triangulation(sites, weights)
    sides = triangles(mesh)[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2) - SENTINELS
    expected = {tuple(sorted(side)) for side in sides.tolist() if min(side) >= 0}
    found = neighbour_pairs(mesh, np.arange(len(sites))).tolist()
    assert len(found) == len(expected)
    assert set(map(tuple, found)) == expected


def numbered(mesh):
    """The triangles by the points' numbers, whatever their rows."""
    corners = mesh.points[triangles(mesh), NUMBER]
    turn = (np.argmin(corners, axis=1)[:, None] + np.arange(3)) % 3
    return set(map(tuple, np.take_along_axis(corners, turn, axis=1).tolist()))


@given(weighted(), st.integers(0, 10**6))
def test_the_order_of_insertion_does_not_show(given_sites, seed):
    """Nor does it where sites lie one above the other."""
    sites, weights = given_sites
    rng = np.random.default_rng(seed)
    twins = rng.integers(0, len(sites), len(sites) // 2)
    sites = np.concatenate([sites, sites[twins]])
    weights = np.concatenate([weights, weights[twins] + rng.integers(-1, 2, len(twins))])
    numbers = rng.permutation(len(sites))
    expected = numbered(triangulation(sites, weights, numbers))
    for _ in range(3):
        order = rng.permutation(len(sites))
        found = triangulation(sites[order], weights[order], numbers[order])
        assert numbered(found) == expected
        where = found.triangle_of[SENTINELS:]
        hidden = set(found.hidden[: found.counts.hidden].tolist())
        assert hidden == set((SENTINELS + np.flatnonzero(where == ABSENT)).tolist())


def test_of_twins_the_heavier_has_the_cell_or_else_the_first():
    place = np.array([[5, 5], [5, 5], [9, 2]]) * (STEPS // 16)
    for weights, winner in (([0, 0, 0], 7), ([0, 1, 0], 8), ([1, 0, 0], 7)):
        for order in ([0, 1, 2], [1, 0, 2], [2, 1, 0]):
            numbers = np.array([7, 8, 9])[order]
            mesh = triangulation(place[order], np.array(weights)[order], numbers)
            shown = numbers[mesh.triangle_of[SENTINELS:] != ABSENT]
            assert set(shown.tolist()) == {winner, 9}


def advanced(mesh, motion, time):
    """The triangulation and its motion at a later time, as the sweep has them."""
    if advance(mesh, motion, time) == Ending.DONE:
        return mesh, motion
    sites, growth = mesh.points[SENTINELS:, :2], motion.growth
    weights = (motion.base + growth * time)[SENTINELS:]
    mesh = triangulation(sites, weights, mesh.points[SENTINELS:, NUMBER])
    return mesh, motion_of(mesh, growth, time, motion.state.last)


@given(weighted(), st.integers(0, 10**6))
def test_flips_up_to_a_time_give_the_triangulation_of_that_time(given_sites, seed):
    sites, _ = given_sites
    rng = np.random.default_rng(seed)
    growth = np.zeros(SENTINELS + len(sites), np.int64)
    growth[SENTINELS:] = rng.integers(0, 3, len(sites))
    last = 2**44
    mesh = triangulation(sites, np.zeros(len(sites), np.int64))
    motion = motion_of(mesh, growth, 0, last)
    for time in np.sort(rng.integers(1, last, 10)):
        mesh, motion = advanced(mesh, motion, time)
        again = triangulation(sites, growth[SENTINELS:] * time)
        np.testing.assert_array_equal(triangles(mesh), triangles(again))


@pytest.mark.parametrize("fastest", [1, 2**20])
@pytest.mark.parametrize("seed", range(30))
def test_an_edge_that_fails_at_a_whole_time_is_flipped_then(seed, fastest):
    """All sites, none among the others, are orthogonal to one circle at that time: every flip is
    for the exact test. Floats tell its moment too late, or, of slow sites, many units too early.
    """
    rng = np.random.default_rng(seed)
    way = np.exp(2j * np.pi * (np.arange(8) + rng.uniform(0, 0.5, 8)) / 8)
    sites = np.rint(np.column_stack([way.real, way.imag]) * 0.4 * STEPS + STEPS / 2).astype(int)
    growth = np.zeros(SENTINELS + len(sites), np.int64)
    growth[SENTINELS:] = rng.integers(-fastest, fastest + 1, len(sites))
    time = int(rng.integers(2**22, 2**23))
    centre = rng.integers(STEPS // 4, 3 * STEPS // 4, 2)
    weights = ((sites - centre) ** 2).sum(axis=1) - STEPS**2
    mesh = triangulation(sites, weights - growth[SENTINELS:] * time)
    assert mesh.counts.hidden == 0
    motion = motion_of(mesh, growth, 0, time)
    for now in (time // 2, time - 3, time - 2, time - 1, time):
        mesh, motion = advanced(mesh, motion, now)
        again = triangulation(sites, weights - growth[SENTINELS:] * (time - now))
        np.testing.assert_array_equal(triangles(mesh), triangles(again))
    np.testing.assert_array_equal(mesh.points[SENTINELS:, WEIGHT], weights)


def test_same_as_the_lower_hull_of_the_lifted_sites():
    rng = np.random.default_rng(4)
    sites = rng.integers(0, STEPS + 1, (2000, 2))
    sites = sites[curve_order(sites)]
    weights = rng.integers(0, 2**40, len(sites))
    mesh = triangulation(sites, weights)
    ours = triangles(mesh)
    ours = ours[(ours >= SENTINELS).all(axis=1)] - SENTINELS
    unit = sites / STEPS - 0.5
    hull = ConvexHull(np.column_stack([unit, (unit**2).sum(axis=1) - weights / STEPS**2]))
    theirs = {tuple(sorted(face)) for face in hull.simplices[hull.equations[:, 2] < 0]}
    mine = {tuple(sorted(face)) for face in ours}
    assert mine <= theirs
    # Beyond ours, qhull has flat triangles along the hull: sentinels see those edges too.
    assert len(theirs - mine) < 30


def test_grid_refuses_what_it_cannot_hold():
    grid = Grid(np.zeros(2), 10.0)
    for value, words in ((np.nan, "finite"), (11.0, "range")):
        with pytest.raises(GeometryError, match=words) as caught:
            grid.snap(np.array([[1.0, 1], [2, value]]))
        assert caught.value.site == 1
    for value, words in ((np.inf, "finite"), (1e4, "safe range")):
        with pytest.raises(GeometryError, match=words) as caught:
            grid.snap_weights(np.array([0.0, 0, value]))
        assert caught.value.site == 2
    points = np.random.default_rng(0).random((100, 2)) * 10
    snapped = grid.snap(points)
    assert np.abs(grid.millimetres(snapped) - points).max() <= grid.pitch * 0.51
    np.testing.assert_array_equal(grid.snap(grid.millimetres(snapped)), snapped)
