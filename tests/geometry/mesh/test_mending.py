"""Corners that lie beside each other, triangles back to back, edges of three: against trimesh."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from tests.geometry.mesh.test_check import CUBE, flipped, soup, volume
from tests.geometry.mesh.test_section import as_mesh, box, together
from v3dcad.errors import GeometryError
from v3dcad.geometry.mesh.check import checked_mesh
from v3dcad.model import Floats, Mesh

BALL = as_mesh(trimesh.creation.icosphere(subdivisions=2, radius=15))


def single(points: Floats) -> Floats:
    return points.astype(np.float32).astype(np.float64)


@given(st.integers(0, 10**6), st.sampled_from([0.0, 300.0]))
def test_corners_off_by_rounding_or_noise_are_joined(seed: int, far: float) -> None:
    random = np.random.default_rng(seed)
    corners = soup(BALL)
    points = single(corners.vertices + far)
    up = random.random(points.shape) < 0.3
    bits = np.where(up, np.nextafter(points.astype(np.float32), np.float32(1e9)), points)
    noise = single(corners.vertices + far + random.normal(0, 1e-6 + far / 1e7, points.shape))
    for moved in (bits.astype(np.float64), noise):
        mesh, findings = checked_mesh(Mesh(moved, corners.triangles))
        assert len(findings) == 1
        assert findings[0].startswith("joined ")
        assert volume(mesh) == pytest.approx(volume(BALL), rel=1e-5)
        joined = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=True)
        assert joined.is_watertight


def test_what_is_open_by_more_stays_open() -> None:
    apart = soup(CUBE)
    moved = apart.vertices.copy()
    moved[0] += 1e-4
    with pytest.raises(GeometryError, match="open"):
        checked_mesh(Mesh(moved, apart.triangles))


def test_a_face_that_two_bodies_share_goes() -> None:
    beside = Mesh(CUBE.vertices * [-1, 1, 1] + [4, 0, 0], CUBE.triangles[:, ::-1])
    mesh, findings = checked_mesh(together(CUBE, beside))
    assert findings == []
    assert len(mesh.triangles) == 20
    assert volume(mesh) == pytest.approx(16)
    assert trimesh.Trimesh(mesh.vertices, mesh.triangles).is_watertight


def test_a_mesh_of_which_both_sides_are_there_is_one() -> None:
    mesh, findings = checked_mesh(together(CUBE, flipped(CUBE)))
    assert findings == ["dropped 12 repeated triangles"]
    assert volume(mesh) == pytest.approx(8)


def test_fins_are_dropped_when_asked() -> None:
    far = np.vstack([CUBE.vertices, [[5, 5, 5]]])
    fin = Mesh(far, np.vstack([CUBE.triangles, [[0, 1, 8]]]))
    with pytest.raises(GeometryError, match=r"not closed: 2 boundary edges and 1 non-manifold"):
        checked_mesh(fin)
    mesh, findings = checked_mesh(fin, repair=True)
    assert findings == ["dropped 1 triangles at edges that an odd number of them share"]
    assert volume(mesh) == pytest.approx(8)


@given(st.integers(0, 10**6))
def test_repair_ends_in_a_solid_or_in_words(seed: int) -> None:
    random = np.random.default_rng(seed)
    triangles = [BALL, CUBE][seed % 2].triangles.copy()
    vertices = [BALL, CUBE][seed % 2].vertices
    some = random.integers(0, len(triangles), 1 + len(triangles) // 20)
    wild = random.integers(0, len(vertices), (seed % 3, 3))
    triangles[some] = triangles[some][:, ::-1]
    triangles = np.vstack([np.delete(triangles, some[:3], 0), triangles[some], wild])
    try:
        mesh, _ = checked_mesh(Mesh(vertices, triangles), repair=True)
    except GeometryError as error:
        mesh, said = None, error.message
    if mesh is None:
        assert "--repair" not in said
        assert "repair it" not in said
    else:
        assert volume(mesh) > 0
        ends = mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        assert np.array_equal(
            *(np.sort(way @ [len(mesh.vertices), 1]) for way in (ends, ends[:, ::-1]))
        )


def test_a_sheet_encloses_nothing() -> None:
    plane = box((0, 0, 0), (2, 2, 2))
    top = np.all(plane.vertices[plane.triangles][:, :, 2] == 2, axis=1)
    with pytest.raises(GeometryError, match="encloses nothing"):
        checked_mesh(Mesh(plane.vertices, plane.triangles[top]), repair=True)
