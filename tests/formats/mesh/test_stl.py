from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from v3dcad.errors import FormatError
from v3dcad.formats.mesh.stl import ascii_stl, binary_stl, normals, read_stl, welded
from v3dcad.model import Mesh

TETRAHEDRON = Mesh(
    np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1 / 3]]),
    np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
)


def written(tmp_path: Path, content: bytes) -> Path:
    path = tmp_path / "part.stl"
    path.write_bytes(content)
    return path


def corners(mesh: Mesh) -> list[list[list[float]]]:
    """Every triangle's corners, the least first."""
    rows = mesh.vertices[mesh.triangles].tolist()
    return sorted(row[least:] + row[:least] for row in rows for least in [row.index(min(row))])


def test_ascii_keeps_every_bit(tmp_path: Path) -> None:
    path = written(tmp_path, ascii_stl(TETRAHEDRON, "a part").encode())
    again = read_stl(path)
    assert corners(again) == corners(TETRAHEDRON)
    assert len(again.vertices) == 4


def test_binary_keeps_float32(tmp_path: Path) -> None:
    again = read_stl(written(tmp_path, binary_stl(TETRAHEDRON)))
    rounded = Mesh(TETRAHEDRON.vertices.astype(np.float32).astype(float), TETRAHEDRON.triangles)
    assert corners(again) == corners(rounded)


@pytest.mark.parametrize("write", [binary_stl, lambda mesh: ascii_stl(mesh, "x").encode()])
def test_trimesh_reads_what_we_write(tmp_path: Path, write) -> None:  # type: ignore[no-untyped-def]
    loaded = trimesh.load(written(tmp_path, write(TETRAHEDRON)))
    assert loaded.is_watertight
    assert loaded.volume == pytest.approx(1 / 18)


def test_we_read_what_trimesh_writes(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=2)
    for content in (ball.export(file_type="stl"), ball.export(file_type="stl_ascii").encode()):
        mesh = read_stl(written(tmp_path, content))
        assert len(mesh.triangles) == 320
        assert len(mesh.vertices) == 162


def test_binary_whose_header_says_solid(tmp_path: Path) -> None:
    content = b"solid".ljust(80) + binary_stl(TETRAHEDRON)[80:]
    assert len(read_stl(written(tmp_path, content)).triangles) == 4


def test_triangles_without_area_are_left_out(tmp_path: Path) -> None:
    flat = Mesh(TETRAHEDRON.vertices, np.vstack([TETRAHEDRON.triangles, [[0, 0, 1]]]))
    assert len(read_stl(written(tmp_path, binary_stl(flat))).triangles) == 4


@pytest.mark.parametrize("zero", [0.0, -0.0])
def test_there_is_one_zero(zero: float) -> None:
    corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 0], [1, 0, 0], [1, 1, 0]]])
    corners[0][corners[0] == 0] = zero
    corners[1][corners[1] == 0] = -zero
    mesh = welded(corners, "a")
    assert len(mesh.vertices) == 4
    assert not np.signbit(mesh.vertices).any()


def test_crlf_capitals_and_exponents(tmp_path: Path) -> None:
    text = ascii_stl(TETRAHEDRON, "X").replace("vertex 1.0", "VERTEX +1.0E+00")
    text = text.replace("endsolid", "ENDSOLID").replace("solid X", "SOLID X", 1)
    again = read_stl(written(tmp_path, text.replace("\n", "\r\n").encode()))
    assert corners(again) == corners(TETRAHEDRON)


def test_several_solids_comments_and_hexadecimal_numbers(tmp_path: Path) -> None:
    first = GOOD.replace("outer loop", "outer loop // three corners", 1)
    first = first.replace("vertex 1.0 0.0 0.0", "vertex 0x1p0 .0 0.e-5", 1)
    again = read_stl(written(tmp_path, f"{first}\n// and again\n{GOOD}".encode()))
    assert corners(again) == sorted(2 * corners(TETRAHEDRON))


def test_normals_point_out_and_are_zero_without_area() -> None:
    triangles = np.array([[[0.0, 0, 0], [2, 0, 0], [0, 2, 0]], [[0, 0, 0], [1, 1, 1], [2, 2, 2]]])
    assert normals(triangles).tolist() == [[0, 0, 1], [0, 0, 0]]


GOOD = ascii_stl(TETRAHEDRON, "x")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "empty"),
        (b"hello, world", "line 1: 'hello, world' is not the `solid` line"),
        (b"\x00" * 200, "neither ASCII"),
        (b"header".ljust(80) + b"\xff\xff\xff\x7f" + b"\x00" * 16, "states 2147483647"),
        (binary_stl(TETRAHEDRON)[:-7], "states 4"),
        (GOOD.replace("endsolid x", "").encode(), "cut off"),
        (
            GOOD.replace("vertex 1.0 0.0 0.0", "vertex 1.0 zero 0.0", 1).encode(),
            "line 6: 'vertex 1.0 zero 0.0' is not",
        ),
        (
            GOOD.replace("      vertex 1.0 0.0 0.0\n", "", 1).encode(),
            "line 6: 'endloop' is not `vertex x y z`",
        ),
        (
            GOOD.replace("vertex 1.0 0.0 0.0", "vertex 1.0 0.0", 1).encode(),
            "line 6: 'vertex 1.0 0.0' is not",
        ),
        (GOOD.replace("vertex 1.0 0.0 0.0", "vertex nan 0.0 0.0", 1).encode(), "line 6.*nan"),
        (GOOD.replace("vertex 1.0 0.0 0.0", "vertex 1e999 0.0 0.0", 1).encode(), "not finite"),
        (binary_stl(TETRAHEDRON)[:-6] + b"\0\0\xc0\x7f\0\0", "triangle 4 .* not a finite"),
        (b"solid x\nendsolid x\n", "no triangles"),
        (GOOD.encode() + b"1 2 3\n", "line 31: '1 2 3' comes after the end of the solid"),
    ],
)
def test_damaged_files_are_refused(tmp_path: Path, content: bytes, says: str) -> None:
    with pytest.raises(FormatError, match=says) as caught:
        read_stl(written(tmp_path, content))
    assert "part.stl" in str(caught.value)
