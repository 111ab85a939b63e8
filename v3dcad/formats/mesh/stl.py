"""STL, binary and ASCII, to a mesh with shared vertices and back."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from v3dcad.errors import FormatError
from v3dcad.formats.mesh.encoding import LOOKED_AT, mark_length
from v3dcad.formats.mesh.stl_ascii import ascii_corners
from v3dcad.model import Floats, Mesh

RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
HEADER_BYTES = 84


def read_stl(path: Path) -> Mesh:
    """The triangles of a binary or ASCII STL, in mm, exactly equal corners made one vertex.

    Raises `FormatError` for a file that is empty, cut off, not STL, or has a coordinate that is
    not a finite number.
    """
    data = path.read_bytes()
    if not data:
        raise FormatError("the file is empty; export it again", path=str(path))
    announced = int.from_bytes(data[HEADER_BYTES - 4 : HEADER_BYTES], "little")
    expected = HEADER_BYTES + announced * RECORD.itemsize
    if len(data) == expected:
        return welded(_binary_corners(data), str(path))
    text = data[mark_length(data[:LOOKED_AT], str(path)) :]
    if len(data) >= HEADER_BYTES and not text.lstrip()[:5].lower() == b"solid":
        raise FormatError(
            f"neither ASCII STL nor a whole binary one: its header states {announced} "
            f"triangles ({expected} bytes), the file has {len(data)} bytes; export it again",
            path=str(path),
        )
    return welded(_ascii_corners(text, str(path)), str(path))


def _binary_corners(data: bytes) -> Floats:
    return np.frombuffer(data, RECORD, offset=HEADER_BYTES)["corners"].astype(np.float64)


def _ascii_corners(data: bytes, path: str) -> Floats:
    text = data.decode("latin-1").replace("\r\n", "\n").replace("\r", "\n")

    def refuse(message: str, at: int) -> FormatError:
        return FormatError(message, path=path, line=text.count("\n", 0, at) + 1)

    return ascii_corners(text, 0, len(text), refuse)


def welded(corners: Floats, path: str, section: str | None = None) -> Mesh:
    """Corners (t, 3, 3), mm, as a mesh: equal points made one, triangles without area left out.

    Vertices and triangles come out in one order, whatever order the triangles had. Raises
    `FormatError` where there are no triangles or a coordinate is not finite.
    """
    if not len(corners):
        raise FormatError("it contains no triangles; export it again", path=path, section=section)
    bad = np.nonzero(~np.isfinite(corners).all(axis=(1, 2)))[0]
    if len(bad):
        raise FormatError(
            f"triangle {bad[0] + 1} has a coordinate that is not a finite number",
            path=path, section=section,
        )  # fmt: skip
    # Adding zero makes −0.0 and 0.0 the same.
    vertices, ids = np.unique(corners.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    triangles = ids.reshape(-1, 3)
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    if not len(triangles):
        raise FormatError("none of its triangles has an area", path=path, section=section)
    turn = (triangles.argmin(axis=1)[:, None] + np.arange(3)) % 3
    triangles = np.take_along_axis(triangles, turn, axis=1)
    return Mesh(vertices, triangles[np.lexsort(triangles.T[::-1])])


def normals(corners: Floats) -> Floats:
    """Unit normals (t, 3) of triangles (t, 3, 3); 0 for one without area."""
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(crossed, axis=1, keepdims=True)
    unit: Floats = np.divide(crossed, length, out=np.zeros_like(crossed), where=length > 0)
    return unit


def binary_stl(mesh: Mesh) -> bytes:
    """A mesh as binary STL: coordinates rounded to float32, without triangles that vanish so."""
    corners = mesh.vertices[mesh.triangles]
    rounded = corners.astype(np.float32)
    corners = corners[(rounded != np.roll(rounded, 1, axis=1)).any(axis=2).all(axis=1)]
    records = np.zeros(len(corners), RECORD)
    records["normal"] = normals(corners)
    records["corners"] = corners
    return b"v3dcad".ljust(80) + len(records).to_bytes(4, "little") + records.tobytes()


def ascii_stl(mesh: Mesh, name: str) -> str:
    """A mesh as ASCII STL, coordinates written so that they read back to the last bit."""
    corners = mesh.vertices[mesh.triangles]
    lines = [f"solid {name}"]
    for normal, triangle in zip(normals(corners).tolist(), corners.tolist(), strict=True):
        lines.append("  facet normal {:.6g} {:.6g} {:.6g}".format(*normal))
        lines.append("    outer loop")
        lines += ["      vertex {!r} {!r} {!r}".format(*corner) for corner in triangle]
        lines += ["    endloop", "  endfacet"]
    lines.append(f"endsolid {name}")
    return "\n".join(lines) + "\n"
