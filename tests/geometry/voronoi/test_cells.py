from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.geometry.voronoi import oracle
from v3dcad.errors import GeometryError
from v3dcad.geometry.voronoi.cells import voronoi_cells
from v3dcad.geometry.voronoi.measures import extents, section_areas, volumes_and_centroids
from v3dcad.geometry.voronoi.wall import OPEN, polygon_room, wall_in_space


def inner(places, low=0.3, high=0.7):
    return np.flatnonzero(((places > low) & (places < high)).all(axis=1))


@st.composite
def sites(draw):
    """Random sites, even ones, and such that are far denser on one side."""
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    return rng.random((draw(st.integers(200, 600)), 3)) ** draw(st.sampled_from([1.0, 1.7]))


@given(sites())
def test_walls_neighbours_and_volumes_are_those_of_qhull(places):
    wanted = inner(places)
    cells = voronoi_cells(places, wanted)
    theirs = oracle.walls(places)
    beside = {pair for pair in theirs if set(pair) & set(wanted.tolist())}
    assert set(map(tuple, cells.walls.tolist())) == beside
    assert (np.diff(cells.walls, axis=1) > 0).all()
    np.testing.assert_allclose(
        volumes_and_centroids(cells, places)[0], oracle.volumes(places, wanted), rtol=1e-9
    )
    for wall, pair in enumerate(map(tuple, cells.walls.tolist())):
        start, end = cells.wall_joints.starts[wall : wall + 2]
        ours = cells.joints[cells.wall_joints.items[start:end]]
        assert len(ours) == len(theirs[pair])
        gaps = np.linalg.norm(ours[:, None] - theirs[pair], axis=2)
        assert gaps.min(axis=0).max() < 1e-9


@given(sites())
def test_joints_struts_and_walls_are_equally_far_from_their_sites(places):
    cells = voronoi_cells(places, inner(places))
    for owners, around in (
        (cells.joints, cells.joint_sites),
        (cells.joints[cells.struts].mean(axis=1), cells.strut_sites),
    ):
        assert set(np.diff(around.starts).tolist()) <= {3, 4}
        distances = np.linalg.norm(owners[around.rows()] - places[around.items], axis=1)
        low = np.minimum.reduceat(distances, around.starts[:-1])
        high = np.maximum.reduceat(distances, around.starts[:-1])
        np.testing.assert_allclose(low, high, rtol=1e-9)
    assert (np.diff(cells.joint_sites.starts) == 4).all()
    assert (np.diff(cells.strut_sites.starts) == 3).all()


@given(sites())
def test_cells_are_closed_polyhedra(places):
    """Every strut of a cell lies between two of its walls, which pass it in opposite ways."""
    wanted = inner(places)
    cells = voronoi_cells(places, wanted)
    items, starts = cells.wall_joints.items, cells.wall_joints.starts
    following = cells.following()
    for cell, site in enumerate(wanted.tolist()):
        first, last = cells.cell_walls.starts[cell : cell + 2]
        directed, struts = [], []
        for wall in cells.cell_walls.items[first:last]:
            assert site in cells.walls[wall]
            rows = np.arange(starts[wall], starts[wall + 1])
            struts.extend(cells.wall_struts[rows].tolist())
            ways = np.column_stack([items[rows], following[rows]])
            directed.extend(map(tuple, ways if cells.walls[wall, 0] == site else ways[:, ::-1]))
        assert len(set(directed)) == len(directed)
        assert {(b, a) for a, b in directed} == set(directed)
        joints = {joint for way in directed for joint in way}
        assert len(joints) - len(set(struts)) + (last - first) == 2
        assert len(struts) == 2 * len(set(struts))


@given(sites(), st.floats(0.35, 0.65))
def test_sections_add_up_to_volumes_and_lie_between_the_ends(places, height):
    cells = voronoi_cells(places, inner(places))
    low, high = extents(cells)
    areas = section_areas(cells, height)
    assert ((areas > 0) == ((low[:, 2] < height) & (height < high[:, 2]))).all()
    # Simpson's rule is exact between joints, where areas are quadratic: one cell's volume so.
    cell = int(areas.argmax())
    volume = volumes_and_centroids(cells, places)[0][cell]
    items = cells.wall_joints
    own = np.isin(items.rows(), cells.cell_walls.items[slice(*cells.cell_walls.starts[cell:][:2])])
    ends = np.unique(cells.joints[items.items[own], 2])
    total = 0.0
    for a, b in pairwise(ends):
        inset = (b - a) * 1e-9
        heights = (a + inset, (a + b) / 2, b - inset)
        start, middle, end = (section_areas(cells, z)[cell] for z in heights)
        total += (b - a) * (start + 4 * middle + end) / 6
    np.testing.assert_allclose(total, volume, rtol=1e-6)


def test_cells_are_the_same_however_many_are_wanted():
    places = np.random.default_rng(4).random((400, 3))
    wanted = inner(places)
    all_at_once = voronoi_cells(places, wanted)
    volumes, centroids = volumes_and_centroids(all_at_once, places)
    for row, site in enumerate(wanted[:10]):
        one = voronoi_cells(places, np.array([site]))
        volume, centroid = volumes_and_centroids(one, places)
        np.testing.assert_allclose(volume, volumes[row], rtol=1e-12)
        np.testing.assert_allclose(centroid[0], centroids[row], rtol=1e-9)


def test_a_cubic_lattice_has_cubes():
    """Eight cells meet in each joint and four along each strut; no wall is a line or a point."""
    steps = np.arange(7.0)
    places = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    wanted = inner(places, 1.5, 4.5)
    cells = voronoi_cells(places, wanted)
    assert len(cells.walls) == 3 * 9 * 4
    assert len(cells.joints) == 4**3
    assert len(cells.struts) == 3 * 16 * 3
    assert (np.diff(cells.wall_joints.starts) == 4).all()
    assert (np.diff(cells.cell_walls.starts) == 6).all()
    np.testing.assert_allclose(volumes_and_centroids(cells, places)[0], 1.0)
    within = ((cells.joints > 2) & (cells.joints < 4)).all(axis=1)
    assert (np.diff(cells.joint_sites.starts)[within] == 8).all()


def test_cells_without_end_and_twins_are_refused():
    places = np.random.default_rng(0).random((100, 3))
    outermost = int(places[:, 0].argmax())
    with pytest.raises(GeometryError, match="no end") as caught:
        voronoi_cells(places, np.array([outermost]))
    assert caught.value.site == outermost
    twins = np.concatenate([places, places[[inner(places)[0]]]])
    with pytest.raises(GeometryError, match="another site"):
        voronoi_cells(twins, inner(places)[:1])


def test_one_wall():
    """The wall to the right of a cell of a cubic lattice, seen from the right."""
    ways = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    points, beyond = np.empty((8, 3)), np.empty(8, np.int64)
    assert wall_in_space(ways, 0, 2.0, polygon_room(), points, beyond) == 4
    assert (points[:4, 0] == 0.5).all()
    assert sorted(beyond[:4].tolist()) == [2, 3, 4, 5]
    assert np.cross(points[1] - points[0], points[2] - points[1])[0] == 1.0
    # Without the others it ends where what is looked at ends; and it has no part in a far site.
    assert wall_in_space(ways[:1], 0, 2.0, polygon_room(), points, beyond) == 4
    assert (beyond[:4] == OPEN).all()
    far = np.concatenate([ways, [[3.0, 0, 0]]])
    assert wall_in_space(far, 6, 2.0, polygon_room(), points, beyond) == 0
