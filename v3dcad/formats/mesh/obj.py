"""Reading Wavefront OBJ: the polygons of all its groups, as triangles."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from v3dcad.errors import FormatError
from v3dcad.formats.mesh.encoding import LOOKED_AT, mark_length
from v3dcad.geometry.mesh.holes import patch
from v3dcad.model import Floats, Mesh
from v3dcad.words import counted

FREE_FORM = {b"curv", b"curv2", b"surf"}
"""Keywords of curved surfaces, which are not read."""

MAX_CORNERS = 500
"""Corners of a face: triangulating takes time with their cube, here a tenth of a second."""


def read_obj(path: Path) -> tuple[Mesh, list[str]]:
    """The faces of an OBJ file as triangles, mm, and what was left out.

    Polygons are cut into triangles of least area, so that they need not be convex. Raises
    `FormatError` with the line of a word that is not a finite number or of a reference to a vertex
    that does not exist, for text in UTF-16, and where there are no faces.
    """
    vertices: list[tuple[float, ...]] = []
    polygons: list[tuple[int, list[int]]] = []
    free_form = 0
    with path.open("rb") as lines:
        lines.seek(mark_length(lines.read(LOOKED_AT), str(path)))
        for number, line in enumerate(_joined(lines), start=1):
            words = line.split(b"#", 1)[0].split()
            if not words:
                continue
            if words[0] == b"v":
                vertices.append(_vertex(words, number, str(path)))
            elif words[0] == b"f":
                corners = _corners(words[1:], len(vertices), number, str(path))
                polygons.append((number, corners))
            elif words[0] in FREE_FORM:
                free_form += 1
    if not polygons:
        raise FormatError("it contains no faces; export it again as polygons", path=str(path))
    for number, corners in polygons:
        if max(corners) >= len(vertices):
            message = f"a face refers to vertex {max(corners) + 1} of {len(vertices)}"
            raise FormatError(message, path=str(path), line=number)
    points = np.array(vertices)
    triangles = [row for _, corners in polygons for row in _cut(points, corners)]
    left_out = [f"left out {counted(free_form, 'free-form element')}"] if free_form else []
    return Mesh(points, np.array(triangles, np.int64)), left_out


def _joined(lines: Iterable[bytes]) -> Iterator[bytes]:
    """Lines; one that ends in a backslash is joined to the next, and empty in its own place."""
    held = b""
    for line in lines:
        text = held + line.rstrip(b"\r\n")
        held = text[:-1] + b" " if text.endswith(b"\\") else b""
        yield b"" if held else text


def _vertex(words: list[bytes], number: int, path: str) -> tuple[float, ...]:
    try:
        point = tuple(float(word) for word in words[1:4])
    except ValueError:
        point = ()
    if len(point) < 3:
        raise FormatError("a vertex needs three numbers", path=path, line=number)
    if not np.isfinite(point).all():
        raise FormatError("a coordinate is not a finite number", path=path, line=number)
    return point


def _corners(words: list[bytes], known: int, number: int, path: str) -> list[int]:
    """Vertex ids of a face, from 0; in the file from 1, or from −1 backwards."""
    try:
        given = [int(word.split(b"/", 1)[0]) for word in words]
    except ValueError:
        raise FormatError(
            "a face is written as v, v/vt, v//vn or v/vt/vn", path=path, line=number
        ) from None
    corners = [place - 1 if place > 0 else known + place for place in given]
    if not 3 <= len(corners) <= MAX_CORNERS:
        message = f"a face of {counted(len(corners), 'corner')}; 3 to {MAX_CORNERS} are read"
        raise FormatError(message, path=path, line=number)
    if 0 in given or min(corners) < 0:
        message = f"a face refers to vertex {min(given)}, with {counted(known, 'vertex')} before it"
        raise FormatError(message, path=path, line=number)
    return corners


def _cut(points: Floats, corners: list[int]) -> list[list[int]]:
    """One polygon as triangles."""
    if len(corners) == 3:
        return [corners]
    rows: list[list[int]] = patch(points, np.array(corners, np.int64)).tolist()
    return rows
