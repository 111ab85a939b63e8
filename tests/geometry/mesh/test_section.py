"""Laws of the triangle slicer."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.parts import read_stl, ring_area
from v3dcad.errors import GeometryError
from v3dcad.geometry.mesh import section as mesh_section
from v3dcad.geometry.mesh.section import mesh_edges, section_mesh
from v3dcad.model import Mesh


def as_mesh(solid: trimesh.Trimesh) -> Mesh:
    return Mesh(np.array(solid.vertices, np.float64), np.array(solid.faces, np.int64))


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> Mesh:
    solid = trimesh.creation.box(bounds=[low, high])
    return as_mesh(solid)


def together(*meshes: Mesh) -> Mesh:
    shifts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Mesh(
        np.vstack([mesh.vertices for mesh in meshes]),
        np.vstack([mesh.triangles + shift for mesh, shift in zip(meshes, shifts, strict=False)]),
    )


def areas(mesh: Mesh, heights: list[float]) -> list[list[float]]:
    return [
        sorted(ring_area(ring) for ring in section.rings)
        for section in section_mesh(mesh, np.array(heights))
    ]


def test_a_box_from_its_base_to_its_top():
    # The base is the limit from above, all others from below: the top still has its area.
    cut = areas(box((0, 0, 0), (2, 3, 1)), [-0.1, 0.0, 0.5, 1.0, 1.1])
    assert cut == [[], [6.0], [6.0], [6.0], []]


def test_a_plane_next_to_the_base_is_at_the_base():
    sections = section_mesh(box((0, 0, 0), (2, 3, 1)), np.array([-5e-7, 0.0]))
    assert [section.z for section in sections] == [-5e-7, 0.0]
    assert [[ring_area(ring) for ring in section.rings] for section in sections] == [[6.0], [6.0]]
    assert areas(box((0, 0, 0), (2, 3, 1)), [-2e-6]) == [[]]


def test_a_step_plane_is_the_limit_from_below():
    solid = trimesh.boolean.union(
        [
            trimesh.creation.box(bounds=[(0, 0, 0), (4, 4, 1)]),
            trimesh.creation.box(bounds=[(1, 1, 0.5), (3, 3, 2)]),
        ]
    )
    assert areas(as_mesh(solid), [1.0, 1.0 + 5e-10, 1.0 + 2e-9, 2.0]) == [
        [16.0],
        [16.0],
        [pytest.approx(4.0)],
        [4.0],
    ]


def test_a_hole_is_clockwise_and_the_box_counter_clockwise():
    inner = box((1, 1, -1), (2, 2, 5))
    solid = trimesh.boolean.difference(
        [
            trimesh.Trimesh(*_arrays(box((0, 0, 0), (3, 3, 3)))),
            trimesh.Trimesh(*_arrays(inner)),
        ]
    )
    assert areas(as_mesh(solid), [1.5]) == [[pytest.approx(-1.0), pytest.approx(9.0)]]


def _arrays(mesh: Mesh):
    return mesh.vertices.copy(), mesh.triangles.copy()


def test_an_apex_and_a_ridge_in_the_plane_leave_no_ring():
    octahedron = Mesh(
        np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float),
        np.array(
            [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]]
        ),
    )
    assert areas(octahedron, [-1.0, 0.0, 1.0]) == [[], [2.0], []]
    roof = Mesh(
        np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 1, 1], [2, 1, 1]], float),
        np.array(
            [[0, 2, 1], [0, 3, 2], [0, 1, 5], [0, 5, 4], [2, 3, 4], [2, 4, 5], [0, 4, 3], [1, 2, 5]]
        ),
    )
    assert areas(roof, [0.0, 0.5, 1.0]) == [[4.0], [2.0], []]


def test_boxes_that_touch_along_an_edge_close():
    pair = together(box((0, 0, 0), (1, 1, 1)), box((1, 1, 0), (2, 2, 1)))
    nodes, inverse = np.unique(pair.vertices, axis=0, return_inverse=True)
    welded = Mesh(nodes, inverse[pair.triangles].reshape(-1, 3))
    (section,) = section_mesh(welded, np.array([0.5]))
    assert sum(map(ring_area, section.rings)) == pytest.approx(2.0)


def test_no_plane_and_no_triangle():
    assert section_mesh(box((0, 0, 0), (1, 1, 1)), np.empty(0)) == []
    empty = Mesh(np.empty((0, 3)), np.empty((0, 3), np.int64))
    assert areas(empty, [0.0, 1.0]) == [[], []]


def test_batches_change_nothing(monkeypatch: pytest.MonkeyPatch):
    ball = as_mesh(trimesh.creation.icosphere(3))
    heights = np.linspace(-1, 1, 21)
    whole = section_mesh(ball, heights)
    monkeypatch.setattr(mesh_section, "CROSSINGS_PER_BATCH", 100)
    for one, other in zip(whole, section_mesh(ball, heights), strict=True):
        assert one.z == other.z
        assert all(map(np.array_equal, one.rings, other.rings))


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=25, deadline=None, derandomize=True)
def test_area_between_nodes_integrates_to_the_volume(seed: int):
    # Between two node heights the area is a polynomial of degree 2: Simpson's rule is exact.
    points = np.random.default_rng(seed).normal(size=(12, 3))
    hull = as_mesh(trimesh.convex.convex_hull(points))
    volume = trimesh.Trimesh(*_arrays(hull)).volume
    z = np.unique(hull.vertices[:, 2])
    low, high = z[:-1], z[1:]
    step = 1e-7 * (high - low)
    heights = np.column_stack([low + step, (low + high) / 2, high - step]).ravel()
    area = np.array([sum(map(ring_area, s.rings)) for s in section_mesh(hull, heights)])
    simpson = (area.reshape(-1, 3) @ [1, 4, 1]) * (high - low) / 6
    assert simpson.sum() == pytest.approx(volume, rel=1e-6)


def test_the_bunny_against_rational_arithmetic():
    mesh = read_stl("bunny.stl")
    edges = mesh_edges(mesh.triangles)
    z = mesh.vertices[:, 2]
    heights = np.linspace(z.min(), z.max(), 9)[1:-1]
    (_, crossings), *rest = mesh_section.cross_planes(mesh, edges, heights)
    assert not rest
    plane = np.repeat(crossings.planes, np.diff(crossings.starts))
    assert len(plane) > 500
    worst = Fraction(0)
    for point, edge, height in zip(crossings.points, crossings.edges, heights[plane], strict=True):
        low, high = (
            [Fraction(float(x)) for x in mesh.vertices[node]] for node in edges.nodes[edge]
        )
        share = (Fraction(float(height)) - low[2]) / (high[2] - low[2])
        assert 0 <= share <= 1
        for axis in range(2):
            true = low[axis] + share * (high[axis] - low[axis])
            worst = max(worst, abs(Fraction(float(point[axis])) - true))
    assert worst < 1e-13


def test_an_open_mesh_and_falling_heights_are_refused():
    cube = box((0, 0, 0), (1, 1, 1))
    with pytest.raises(GeometryError, match="open"):
        section_mesh(Mesh(cube.vertices, cube.triangles[1:]), np.array([0.5]))
    turned = cube.triangles.copy()
    turned[0] = turned[0, ::-1]
    with pytest.raises(GeometryError, match="wind alike"):
        section_mesh(Mesh(cube.vertices, turned), np.array([0.5]))
    with pytest.raises(GeometryError, match="ascending"):
        section_mesh(cube, np.array([0.6, 0.5]))
