"""What a mesh encloses more than once, against manifold3d's unions and exact areas."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
import trimesh
from manifold3d import Manifold, Mesh64, OpType

import v3dcad
from tests.geometry.mesh.test_section import as_mesh, together
from tests.parts import ring_area
from v3dcad.geometry.mesh_overlap import overlap_volume
from v3dcad.model import Floats, Ints, Mesh

AROUND, ALONG = 16, 60


def rings() -> Floats:
    """(60, 16, 3) circles along an eight."""
    t = np.linspace(0, 2 * np.pi, ALONG, endpoint=False)
    path = np.c_[30 * np.sin(t), 15 * np.sin(2 * t), 0 * t]
    way = np.roll(path, -1, 0) - np.roll(path, 1, 0)
    aside = np.c_[-way[:, 1], way[:, 0], 0 * t] / np.linalg.norm(way, axis=1)[:, None]
    w = 2 * np.pi * np.arange(AROUND) / AROUND
    up = np.array([0.0, 0.0, 1.0])
    circle = np.cos(w)[:, None] * aside[:, None] + np.sin(w)[:, None] * up
    return np.asarray(path[:, None] + 5 * circle)


def tube(first: int, last: int) -> Ints:
    """Triangles between circles, from the first to the last."""
    rows = []
    for i in range(first, last):
        for j in range(AROUND):
            k = (j + 1) % AROUND
            p, q = i * AROUND, (i + 1) % ALONG * AROUND
            rows += [(p + j, q + k, q + j), (p + j, p + k, q + k)]
    return np.array(rows)


def eight() -> Mesh:
    return Mesh(rings().reshape(-1, 3), tube(0, ALONG))


def piece(first: int, last: int) -> Manifold:
    """A piece of the eight with plane ends."""
    fan = [(0, j + 1, j) for j in range(1, AROUND - 1)]
    ends = np.concatenate(
        [np.array(fan)[:, ::-1] + first * AROUND, np.array(fan) + last % ALONG * AROUND]
    )
    triangles = np.concatenate([tube(first, last), ends])
    body = trimesh.Trimesh(rings().reshape(-1, 3), triangles, process=True)
    body.fix_normals()
    assert body.is_watertight
    return Manifold(Mesh64(np.array(body.vertices), body.faces.astype(np.uint64)))


def volume(mesh: Mesh) -> float:
    return float(np.linalg.det(mesh.vertices[mesh.triangles]).sum() / 6)


def test_a_tube_through_itself_is_the_union_of_its_pieces() -> None:
    mesh = eight()
    quarters = [piece(first, first + 15) for first in range(0, ALONG, 15)]
    whole = Manifold.batch_boolean(quarters, OpType.Add).volume()
    outward = mesh if volume(mesh) > 0 else Mesh(mesh.vertices, mesh.triangles[:, ::-1])
    found = overlap_volume(outward)
    assert volume(outward) - found == pytest.approx(whole, rel=1e-5)
    assert found > 0.03 * whole
    part = v3dcad.part_from((mesh.vertices, mesh.triangles))
    assert part.contents()["volume"] == f"{volume(outward) - found:.6g} mm³"
    assert [finding for finding in part.findings if f"{found:.4g} mm³" in finding]
    structure = v3dcad.fill(part, layer_height=0.5, cell_size=5)
    filled = sum(
        layer.diagram.areas(len(layer.state.sites)).sum() * 0.5 for layer in structure.layers
    )
    assert filled == pytest.approx(whole, rel=0.02)


def test_a_star_wound_twice_is_filled_once() -> None:
    angle = 4 * np.pi * np.arange(5) / 5
    star = 10 * np.column_stack([np.cos(angle), np.sin(angle)])
    low, high = np.column_stack([star, np.zeros(5)]), np.column_stack([star, np.full(5, 4.0)])
    vertices = np.vstack([low, high, [[0, 0, 0], [0, 0, 4]]])
    rows = []
    for j in range(5):
        k = (j + 1) % 5
        rows += [(j, k, 5 + k), (j, 5 + k, 5 + j), (10, k, j), (11, 5 + j, 5 + k)]
    mesh = Mesh(vertices, np.array(rows))
    pentagon = 5 / 2 * (10 * np.cos(2 * np.pi / 5) / np.cos(np.pi / 5)) ** 2 * np.sin(2 * np.pi / 5)
    assert overlap_volume(mesh) == pytest.approx(4 * pentagon)
    part = v3dcad.part_from((vertices, np.array(rows)))
    outline = shapely.make_valid(shapely.Polygon(star)).area + pentagon  # which GEOS leaves open
    (section,) = part.sections(np.array([1.0]))
    (ring,) = section.rings
    assert ring_area(ring) == pytest.approx(outline)


def test_sound_meshes_share_nothing() -> None:
    ball = as_mesh(trimesh.creation.icosphere(2))
    assert overlap_volume(ball) == 0.0
    hollow = together(ball, Mesh(ball.vertices / 2, ball.triangles[:, ::-1]))
    assert overlap_volume(hollow) == 0.0


def test_an_overlap_of_rounding_is_none() -> None:
    box = trimesh.creation.box([4, 4, 4])
    for shift, shared in ((4 - 1e-3, 16e-3), (4 - 1e-10, 0.0)):
        beside = Mesh(np.add(box.vertices, [shift, 0, 0]), np.array(box.faces))
        found = overlap_volume(together(as_mesh(box), beside))
        assert found == pytest.approx(shared, rel=1e-6)
