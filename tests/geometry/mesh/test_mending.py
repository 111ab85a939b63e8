"""Corners that lie beside each other, doubled triangles, fins, holes: against trimesh."""

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
from v3dcad.geometry.mesh.holes import MAX_RIM_EDGES, patch, rims_of
from v3dcad.geometry.mesh.section import mesh_edges
from v3dcad.geometry.mesh_overlap import overlap_volume
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


def test_both_sides_of_one_body_among_others_are_a_body_and_of_a_sheet_nothing() -> None:
    far = box((9, 0, 0), (11, 2, 2))
    mesh, findings = checked_mesh(together(CUBE, far, flipped(far)))
    assert findings == ["dropped 12 repeated triangles"]
    assert volume(mesh) == pytest.approx(16)
    sheet = Mesh(far.vertices, far.triangles[:3])
    mesh, findings = checked_mesh(together(CUBE, sheet, flipped(sheet)))
    assert findings == []
    assert volume(mesh) == pytest.approx(8)
    with pytest.raises(GeometryError, match="encloses nothing"):
        checked_mesh(together(sheet, flipped(sheet)))


def test_fins_are_dropped_when_asked() -> None:
    far = np.vstack([CUBE.vertices, [[5, 5, 5]]])
    fin = Mesh(far, np.vstack([CUBE.triangles, [[0, 1, 8]]]))
    with pytest.raises(GeometryError, match=r"not closed: 2 boundary edges and 1 non-manifold"):
        checked_mesh(fin)
    mesh, findings = checked_mesh(fin, repair=True)
    assert findings == ["dropped fins and inner walls: 1 sheet of 1 triangle"]
    assert volume(mesh) == pytest.approx(8)


def test_a_wall_inside_goes() -> None:
    """Two bodies side by side, the face between them there once; a ball with a floor."""
    beside = Mesh(CUBE.vertices * [-1, 1, 1] + [4, 0, 0], CUBE.triangles[:, ::-1])
    between = np.all(beside.vertices[beside.triangles][:, :, 0] == 2, axis=1)
    joined = together(CUBE, Mesh(beside.vertices, beside.triangles[~between]))
    with pytest.raises(GeometryError, match="4 non-manifold"):
        checked_mesh(joined)
    mesh, findings = checked_mesh(joined, repair=True)
    assert findings == ["dropped fins and inner walls: 1 sheet of 2 triangles"]
    assert volume(mesh) == pytest.approx(16)
    assert trimesh.Trimesh(mesh.vertices, mesh.triangles).is_watertight
    ball = as_mesh(trimesh.creation.uv_sphere(radius=5, count=[9, 12]))
    levels = ball.vertices[:, 2].round(6)
    middle = np.flatnonzero(levels == np.unique(levels)[4])
    ring = middle[np.argsort(np.arctan2(*ball.vertices[middle, :2].T))]
    floor = np.column_stack([np.full(len(ring) - 2, ring[0]), ring[1:-1], ring[2:]])
    mesh, findings = checked_mesh(
        Mesh(ball.vertices, np.vstack([ball.triangles, floor])), repair=True
    )
    assert findings == [f"dropped fins and inner walls: 1 sheet of {len(floor)} triangles"]
    assert volume(mesh) == pytest.approx(volume(ball))


@pytest.mark.parametrize("noise", [1e-5, 1e-4, 2e-3])
def test_more_noise_is_welded_when_asked(noise: float) -> None:
    corners = soup(BALL)
    moved = corners.vertices + np.random.default_rng(1).normal(0, noise, corners.vertices.shape)
    rough = Mesh(moved, corners.triangles)
    if noise > 1e-5:
        with pytest.raises(GeometryError, match="is open"):
            checked_mesh(rough)
    mesh, findings = checked_mesh(rough, repair=True)
    assert len(findings) == 1
    assert findings[0].startswith(f"joined {len(moved) - len(BALL.vertices)} corners")
    assert volume(mesh) == pytest.approx(volume(BALL), rel=1e-3)


@given(st.integers(0, 10**6))
def test_patches_close_whatever_triangles_there_are(seed: int) -> None:
    """Every edge is passed as often one way as the other; no rim passes a node twice."""
    random = np.random.default_rng(seed)
    triangles = random.integers(0, 12, (int(random.integers(1, 40)), 3))
    triangles = triangles[np.all(triangles != np.roll(triangles, 1, axis=1), axis=1)]
    rims = rims_of(triangles)
    assert all(len(np.unique(rim)) == len(rim) >= 3 for rim in rims)
    points = random.normal(0, 1, (12, 3))
    mesh_edges(np.vstack([triangles, *(patch(points, rim) for rim in rims)]))


def test_long_rims_are_patched_in_parts() -> None:
    pipe = trimesh.creation.cylinder(20, 30, sections=3 * MAX_RIM_EDGES)
    wall = as_mesh(pipe).triangles[np.abs(pipe.face_normals[:, 2]) < 0.5]
    mesh, findings = checked_mesh(Mesh(as_mesh(pipe).vertices, wall), repair=True)
    assert len(findings) == 1
    assert findings[0].startswith("closed 2 holes with 2513 mm²")
    assert volume(mesh) == pytest.approx(pipe.volume, rel=1e-9)


@given(st.integers(0, 10**6))
def test_repair_ends_in_a_solid(seed: int) -> None:
    """About as large as it was before the damage."""
    random = np.random.default_rng(seed)
    whole = [BALL, CUBE][seed % 2]
    triangles = whole.triangles.copy()
    some = random.integers(0, len(triangles), 1 + len(triangles) // 20)
    wild = random.integers(0, len(whole.vertices), (seed % 3, 3))
    triangles[some] = triangles[some][:, ::-1]
    triangles = np.vstack([np.delete(triangles, some[:3], 0), triangles[some], wild])
    mesh, _ = checked_mesh(Mesh(whole.vertices, triangles), repair=True)
    mesh_edges(mesh.triangles)
    assert volume(mesh) - overlap_volume(mesh) == pytest.approx(volume(whole), rel=0.4)


def test_a_sheet_encloses_nothing() -> None:
    plane = box((0, 0, 0), (2, 2, 2))
    top = np.all(plane.vertices[plane.triangles][:, :, 2] == 2, axis=1)
    with pytest.raises(GeometryError, match="encloses nothing"):
        checked_mesh(Mesh(plane.vertices, plane.triangles[top]), repair=True)
