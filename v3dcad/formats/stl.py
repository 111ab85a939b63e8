"""STL, binary and ASCII, to a mesh with shared vertices and back."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from v3dcad.errors import FormatError
from v3dcad.model import Floats, Mesh

RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
HEADER = 84

VERTEX = re.compile(rb"^[ \t]*vertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)[ \t\r]*$", re.I | re.M)


def read_stl(path: Path) -> Mesh:
    """The triangles of a binary or ASCII STL, in mm, exactly equal corners made one vertex.

    Raises `FormatError` for a file that is empty, cut off, not STL, or holds a coordinate
    that is not a finite number.
    """
    data = path.read_bytes()
    if not data:
        raise FormatError("the file is empty; export it again", path=str(path))
    if len(data) >= HEADER:
        announced = int.from_bytes(data[80:84], "little")
        expected = HEADER + announced * RECORD.itemsize
        if len(data) == expected:
            return welded(_binary_corners(data), str(path))
        if not data.lstrip()[:5].lower() == b"solid":
            raise FormatError(
                f"neither ASCII STL nor a whole binary one: its header announces {announced} "
                f"triangles ({expected} bytes), the file has {len(data)} bytes; export it again",
                path=str(path),
            )
    return welded(ascii_corners(data, str(path)), str(path))


def _binary_corners(data: bytes) -> Floats:
    return np.frombuffer(data, RECORD, offset=HEADER)["corners"].astype(np.float64)


def ascii_corners(data: bytes, path: str, first_line: int = 1) -> Floats:
    """Corners (t, 3, 3), mm, of ASCII STL text that begins at line `first_line` of its file.

    Raises `FormatError` with the line where a facet is not whole or a number is none.
    """
    if data.lstrip()[:5].lower() != b"solid":
        raise FormatError("not an STL file (no `solid` line); export it again", path=path)
    if not re.search(rb"^[ \t]*endsolid", data, re.I | re.M):
        raise FormatError("cut off: there is no `endsolid` line; export it again", path=path)
    found = list(VERTEX.finditer(data))
    try:
        corners = np.array([match.groups() for match in found], dtype=np.float64)
    except ValueError:
        for match in found:
            _check_numbers(match, data, path, first_line)
        raise
    facets = len(re.findall(rb"^[ \t]*endfacet", data, re.I | re.M))
    vertices = len(re.findall(rb"^[ \t]*vertex", data, re.I | re.M))
    if vertices != len(found) or len(found) != 3 * facets:
        raise FormatError(
            f"{facets} facets have {vertices} vertex lines, {len(found)} of them readable, "
            "three are needed for each; export it again",
            path=path,
        )
    return corners.reshape(-1, 3, 3)


def _check_numbers(match: re.Match[bytes], data: bytes, path: str, first_line: int) -> None:
    for word in match.groups():
        try:
            float(word)
        except ValueError:
            line = first_line + data.count(b"\n", 0, match.start())
            shown = word[:40].decode("ascii", "replace")
            raise FormatError(f"{shown!r} is not a number", path=path, line=line) from None


def welded(corners: Floats, path: str) -> Mesh:
    """Corners (t, 3, 3), mm, as a mesh: equal points made one, triangles without area left out.

    Raises `FormatError` where there are no triangles or a coordinate is not finite.
    """
    if not len(corners):
        raise FormatError("it holds no triangles; export it again", path=path)
    bad = np.nonzero(~np.isfinite(corners).all(axis=(1, 2)))[0]
    if len(bad):
        raise FormatError(
            f"triangle {bad[0] + 1} has a coordinate that is not a finite number", path=path
        )
    # Adding zero makes −0.0 and 0.0 the same.
    vertices, ids = np.unique(corners.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    triangles = ids.reshape(-1, 3)
    a, b, c = triangles.T
    return Mesh(vertices, triangles[(a != b) & (b != c) & (c != a)])


def normals(corners: Floats) -> Floats:
    """Unit normals (t, 3) of triangles (t, 3, 3); 0 for one without area."""
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(crossed, axis=1, keepdims=True)
    unit: Floats = np.divide(crossed, length, out=np.zeros_like(crossed), where=length > 0)
    return unit


def binary_stl(mesh: Mesh) -> bytes:
    """A mesh as binary STL (coordinates rounded to float32, as the format has it)."""
    corners = mesh.vertices[mesh.triangles]
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
