from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from parts import read_stl

from v3dcad.formats.mesh.stl import welded
from v3dcad.formats.ont import mesh_codec as mesh_code
from v3dcad.formats.ont.armor import checked, packed, unpacked
from v3dcad.formats.ont.mesh_codec import DOUBLE, HEADER, SINGLE, mesh_bytes, mesh_in
from v3dcad.model import Floats, Mesh

NOWHERE = np.zeros(3)


def assert_comes_back(mesh: Mesh, origin: Floats = NOWHERE) -> bytes:
    """The same triangles, bit for bit, whatever their order; and the same bytes again."""
    mesh = welded(mesh.vertices[mesh.triangles], "it")
    data = mesh_bytes(mesh, origin)
    read = mesh_in(data)
    again = welded(read.vertices[read.triangles], "it")
    assert again.vertices.tobytes() == mesh.vertices.tobytes()
    assert np.array_equal(again.triangles, mesh.triangles)
    assert mesh_bytes(again, origin) == data
    return data


@given(
    st.lists(st.tuples(*[st.integers(0, 6)] * 3), min_size=1, max_size=60),
    st.lists(st.tuples(*[st.floats(-1e300, 1e300)] * 3), min_size=7, max_size=7, unique=True),
)
def test_any_triangles_come_back(
    triangles: list[tuple[int, int, int]], places: list[tuple[float, float, float]]
) -> None:
    """Not only surfaces: sides shared by one, two or many triangles, in any direction."""
    whole = [corners for corners in triangles if len(set(corners)) == 3]
    vertices = np.unique(np.array(places) + 0.0, axis=0)
    if whole and len(vertices) == 7:
        assert_comes_back(Mesh(vertices, np.array(whole)))


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize(
    "solid",
    [
        trimesh.creation.icosphere(subdivisions=3),
        trimesh.creation.torus(2.0, 0.5),
        trimesh.creation.annulus(1.0, 2.0, 3.0),
    ],
    ids=["ball", "torus", "tube"],
)
def test_surfaces_with_and_without_holes_come_back(solid: trimesh.Trimesh, scale: float) -> None:
    assert_comes_back(Mesh(np.asarray(solid.vertices) * scale, np.asarray(solid.faces)))
    opened = Mesh(np.asarray(solid.vertices) * scale, np.asarray(solid.faces)[::3])
    assert_comes_back(opened)


def test_the_fewest_bits_are_found() -> None:
    """Decimals as whole numbers, float32 as such, also when they were moved since."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    triangles = np.asarray(ball.faces)
    shift = np.array([0.1, -1 / 3, 12.5])
    single = np.asarray(ball.vertices).astype(np.float32).astype(np.float64)
    tenths = np.rint(np.asarray(ball.vertices) * 1000) / 1000
    assert assert_comes_back(Mesh(tenths, triangles))[0] == 3
    assert assert_comes_back(Mesh(tenths + shift, triangles), shift)[0] == 3
    assert assert_comes_back(Mesh(single, triangles))[0] == SINGLE
    assert assert_comes_back(Mesh(single + shift, triangles), shift)[0] == SINGLE
    assert assert_comes_back(Mesh(single, triangles), shift)[0] == SINGLE
    assert assert_comes_back(Mesh(single + shift, triangles))[0] == DOUBLE


def test_the_bunny_takes_less_than_five_bytes_a_triangle() -> None:
    mesh = read_stl("bunny.stl")
    data = assert_comes_back(mesh)
    assert sum(map(len, packed(data))) / 1.25 < 5 * len(mesh.triangles)


def test_more_triangles_than_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mesh_code, "MAX_TRIANGLES", 79)
    ball = trimesh.creation.icosphere(subdivisions=1)
    data = mesh_bytes(Mesh(np.asarray(ball.vertices), np.asarray(ball.faces)), NOWHERE)
    with pytest.raises(ValueError, match="more than 79 triangles"):
        mesh_in(data)


TRIANGLE = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
GOOD = mesh_bytes(TRIANGLE, NOWHERE)
SYMBOLS = HEADER.size


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "header is cut off"),
        (GOOD[:-1], "states 115 bytes and has 114"),
        (bytes([12]) + GOOD[1:], "unknown form"),
        (GOOD[:13] + np.array([np.nan]).tobytes() + GOOD[21:], "unknown form"),
        (GOOD[:SYMBOLS] + b"\4" + GOOD[SYMBOLS + 1 :], "refers to a vertex that does not exist"),
        (GOOD[:SYMBOLS] + b"\2" + GOOD[SYMBOLS + 1 :], "refers to a vertex that does not exist"),
        (GOOD[: SYMBOLS + 3] + b"\1" + GOOD[SYMBOLS + 4 :], "states 3 vertices"),
        (HEADER.pack(0, 0, 0, 1, 0, 0, 0) + bytes(4), "has more old corners than its walk uses"),
        (bytes([SINGLE]) + GOOD[1:-72] + b"\xff" * 72, "not finite"),
    ],
)
def test_damaged_bytes_are_refused(data: bytes, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        mesh_in(data)


@given(st.binary(max_size=3000))
def test_packed_bytes_come_back(data: bytes) -> None:
    lines = packed(data)
    assert unpacked("".join(line[1:] for line in lines), len(data), checked(data)) == data
    assert all(len(line) <= 101 and line[0] == ":" for line in lines)
