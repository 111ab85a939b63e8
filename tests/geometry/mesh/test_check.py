"""What is mended in a mesh, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.geometry.mesh.test_section import as_mesh, box, together
from v3dcad.errors import GeometryError
from v3dcad.geometry.mesh.check import checked_mesh
from v3dcad.geometry.mesh.holes import patch
from v3dcad.geometry.mesh.section import section_mesh
from v3dcad.model import Mesh


def volume(mesh: Mesh) -> float:
    corners = mesh.vertices[mesh.triangles]
    return float(np.linalg.det(corners).sum() / 6)


def flipped(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices, mesh.triangles[:, ::-1])


def soup(mesh: Mesh) -> Mesh:
    """Every triangle with vertices of its own, as in an STL."""
    return Mesh(
        mesh.vertices[mesh.triangles].reshape(-1, 3),
        np.arange(3 * len(mesh.triangles)).reshape(-1, 3),
    )


CUBE = box((0, 0, 0), (2, 2, 2))


def test_a_sound_mesh_is_left_alone_and_a_soup_is_welded():
    assert checked_mesh(CUBE)[1] == []
    mesh, findings = checked_mesh(soup(CUBE))
    assert findings == []
    assert len(mesh.vertices) == 8
    assert volume(mesh) == pytest.approx(8)


def test_an_inverted_body_is_turned():
    mesh, findings = checked_mesh(flipped(CUBE))
    assert findings == ["turned 1 inverted bodies inside out"]
    assert volume(mesh) == pytest.approx(8)


def test_single_triangles_are_turned():
    triangles = CUBE.triangles.copy()
    triangles[[2, 7]] = triangles[[2, 7], ::-1]
    mesh, findings = checked_mesh(Mesh(CUBE.vertices, triangles))
    assert findings == ["turned 2 triangles that wound against the neighbours"]
    assert volume(mesh) == pytest.approx(8)


def test_a_cavity_stays_a_cavity_even_when_all_is_inverted():
    hollow = together(box((-1, -1, -1), (3, 3, 3)), flipped(CUBE))
    assert checked_mesh(hollow)[1] == []
    mesh, findings = checked_mesh(flipped(hollow))
    assert findings == ["turned 2 inverted bodies inside out"]
    assert volume(mesh) == pytest.approx(64 - 8)


@given(st.integers(0, 10**6))
@settings(max_examples=10, deadline=None, derandomize=True)
def test_overlapping_bodies_are_united_and_apart_ones_kept(seed: int):
    shift = np.random.default_rng(seed).uniform(0.1, 3, 3)
    pair = together(CUBE, Mesh(CUBE.vertices + shift, CUBE.triangles))
    mesh, findings = checked_mesh(pair)
    shared = float(np.prod(np.maximum(2 - shift, 0)))
    assert volume(mesh) == pytest.approx(16 - shared)
    assert len(findings) == (shared > 1e-8)
    (section,) = section_mesh(mesh, np.array([(2 + shift[2]) / 2 if shift[2] < 2 else 1.0]))
    assert len(section.rings) >= 1


def test_overlap_with_a_hollow_body_keeps_the_cavity():
    hollow = together(box((-1, -1, -1), (3, 3, 3)), flipped(CUBE))
    mesh, findings = checked_mesh(together(hollow, box((2.5, 0, 0), (5, 1, 1))))
    assert volume(mesh) == pytest.approx(64 - 8 + 2)
    assert len(findings) == 1


def test_a_cavity_belongs_to_the_smallest_body_around_it():
    """A hollow body inside the cavity of another, neither touched."""
    shells = [box((-r, -r, -r), (r, r, r)) for r in (4.0, 3.0, 2.0, 1.0)]
    nested = together(shells[0], flipped(shells[1]), shells[2], flipped(shells[3]))
    found, findings = checked_mesh(nested)
    assert findings == []
    assert volume(found) == pytest.approx(8**3 - 6**3 + 4**3 - 2**3)


def test_a_body_inside_another_is_swallowed():
    mesh, findings = checked_mesh(together(box((-1, -1, -1), (3, 3, 3)), CUBE))
    assert volume(mesh) == pytest.approx(64)
    assert findings == ["bodies 1 and 2 overlap by 8 mm³: they are filled as one"]


def test_holes_are_refused_with_counts_or_patched_and_said():
    ball = as_mesh(trimesh.creation.icosphere(3))
    keep = ball.vertices[ball.triangles].mean(axis=1)[:, 2] < 0.7
    cup = Mesh(ball.vertices, ball.triangles[keep])
    with pytest.raises(
        GeometryError, match=r"open: \d+ boundary edges and 0 non-manifold .*repair"
    ):
        checked_mesh(cup)
    mesh, (finding,) = checked_mesh(cup, repair=True)
    assert finding.startswith("closed 1 hole with 1.")
    below = as_mesh(
        trimesh.boolean.difference(
            [
                trimesh.creation.icosphere(3),
                trimesh.creation.box(bounds=[(-2, -2, 0.7), (2, 2, 2)]),
            ]
        )
    )
    assert volume(mesh) == pytest.approx(volume(below), rel=0.03)


def test_a_patch_of_a_plane_rim_has_its_area_even_where_it_is_not_convex():
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    radius = np.where(np.arange(40) % 2, 1.0, 0.4)
    star = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle])
    triangles = patch(star, np.arange(40))
    corners = star[triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] / 2
    x, y = star[:, 0], star[:, 1]
    assert cross.min() > 0
    assert cross.sum() == pytest.approx(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)


def test_what_is_refused():
    with pytest.raises(GeometryError, match="no triangle"):
        checked_mesh(Mesh(np.zeros((3, 3)), np.empty((0, 3), np.int64)))
    lost = CUBE.vertices.copy()
    lost[3, 1] = np.nan
    with pytest.raises(GeometryError, match=r"1 vertex with .* vertex 3"):
        checked_mesh(Mesh(lost, CUBE.triangles))
    with pytest.raises(GeometryError, match="beyond"):
        checked_mesh(Mesh(CUBE.vertices, CUBE.triangles + 1))
    fin = np.vstack([CUBE.triangles, [[0, 1, 7]]])
    if len({tuple(sorted(t)) for t in fin.tolist()}) == len(fin):
        with pytest.raises(GeometryError, match="non-manifold"):
            checked_mesh(Mesh(CUBE.vertices, fin))


def test_a_one_sided_surface_is_refused():
    count = 12
    angle = np.arange(count) * 2 * np.pi / count
    centre = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle]) * 5
    arm = np.column_stack(
        [np.cos(angle / 2) * np.cos(angle), np.cos(angle / 2) * np.sin(angle), np.sin(angle / 2)]
    )
    vertices = np.vstack([centre + arm, centre - arm])
    quads = [(i, i + 1, i + count, i + count + 1) for i in range(count - 1)]
    quads.append((count - 1, count, 2 * count - 1, 0))
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (b, d, c))])
    with pytest.raises(GeometryError, match="one-sided"):
        checked_mesh(Mesh(vertices, triangles), repair=True)
