"""What is read from files: values at points (CSV, VTU, VTK), and triangles (STL)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from v3dcad.errors import FormatError
from v3dcad.model import Floats, Mesh

CSV, VTK = (".csv", ".txt", ".tsv"), (".vtu", ".vtk")

MOST = 5_000_000
"""Rows of a table."""


def read_table(path: Path, column: str | None = None) -> tuple[Floats, Floats]:
    """Points (n, 3), mm, and their values (n,).

    A CSV file has rows of x, y, z and a value; a heading may name them. Of a VTK file the column is
    the name of an array at the points; it need not be given where there is one alone. Raises
    `FormatError`, with the line where there is one.
    """
    ending = path.suffix.lower()
    if ending in CSV:
        points, values = _read_csv(path, column)
    elif ending in VTK:
        points, arrays = read_vtk(path)
        values = _array_of(arrays, column, path)
    else:
        known = ", ".join((*CSV, *VTK))
        raise FormatError(f"not a table that can be read; give {known}", path=str(path))
    refuse_unusable(points, values, path, "points")
    return points, values


def refuse_unusable(points: Floats, values: Floats, path: Path, what: str) -> None:
    """Raise `FormatError` where there are no points (n, 3) with values (n,), called `what`, or any
    that are not finite.
    """
    if not len(points):
        raise FormatError(f"contains no {what}", path=str(path))
    if not (np.isfinite(points).all() and np.isfinite(values).all()):
        raise FormatError("contains values that are not finite", path=str(path))


def _read_csv(path: Path, column: str | None) -> tuple[Floats, Floats]:
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise FormatError("cannot be read as text", path=str(path)) from error
    except OSError as error:
        raise FormatError(f"cannot be read ({error.strerror})", path=str(path)) from error
    rows: list[list[float]] = []
    places: list[int] | None = None
    for number, line in enumerate(lines, start=1):
        text = line.split("#", 1)[0].strip()
        if not text:
            continue
        cells = [cell.strip() for cell in text.replace(";", ",").replace("\t", ",").split(",")]
        if places is None:
            places = _places(cells, column, str(path), number)
            if places is not None and not _is_number(cells[0]):
                continue
        if places is None or max(places) >= len(cells):
            raise FormatError("needs x, y, z and a value", path=str(path), line=number)
        try:
            rows.append([float(cells[place]) for place in places])
        except ValueError as error:
            raise FormatError("is not four numbers", path=str(path), line=number) from error
        if len(rows) > MOST:
            raise FormatError(f"over {MOST:,} rows", path=str(path), line=number)
    table = np.array(rows).reshape(-1, 4)
    return table[:, :3], table[:, 3]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _places(cells: list[str], column: str | None, path: str, line: int) -> list[int] | None:
    """In which columns x, y, z and the value are."""
    if _is_number(cells[0]):
        if column is not None:
            raise FormatError(f"has no heading that names {column!r}", path=path, line=line)
        return [0, 1, 2, 3]
    heading = [cell.split("[")[0].split("(")[0].strip().lower() for cell in cells]
    for cell in cells:
        unit = cell.lower().rpartition("[")[2].strip(" ])") if "[" in cell else ""
        if cell.strip().lower()[:1] in ("x", "y", "z") and unit in ("m", "cm", "in", "inch", "um"):
            raise FormatError(f"coordinates in {unit}; they have to be in mm", path=path, line=line)
    missing = [name for name in "xyz" if name not in heading]
    if missing:
        raise FormatError(f"has no column {missing[0]!r}", path=path, line=line)
    others = [place for place, name in enumerate(heading) if name not in "xyz"]
    if column is not None:
        others = [place for place in others if heading[place] == column.lower()]
    if len(others) != 1:
        names = ", ".join(name for name in heading if name not in "xyz") or "none"
        raise FormatError(f"name one column of values; there are: {names}", path=path, line=line)
    return [*(heading.index(name) for name in "xyz"), others[0]]


def read_vtk(path: Path) -> tuple[Floats, dict[str, Floats]]:
    """The points (n, 3) of a VTK file and the arrays at them, by name."""
    mesh = _read_mesh(path, "a VTK file")
    points = np.asarray(mesh.points, np.float64)
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise FormatError("its points have neither two nor three coordinates", path=str(path))
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    arrays = {name: np.asarray(data, np.float64) for name, data in mesh.point_data.items()}
    return points, {name: data for name, data in arrays.items() if len(data) == len(points)}


def read_triangles(path: Path) -> Mesh:
    """The triangles of an STL file, mm, which need not be closed."""
    if path.suffix.lower() != ".stl":
        raise FormatError("not triangles that can be read; give .stl", path=str(path))
    mesh = _read_mesh(path, "an STL file")
    triangles = np.concatenate(
        [np.empty((0, 3), np.int64), *(one.data for one in mesh.cells if one.type == "triangle")]
    )
    points = np.asarray(mesh.points, np.float64)
    refuse_unusable(points[triangles.ravel()], np.empty(0), path, "triangles")
    return Mesh(points, triangles)


def _read_mesh(path: Path, kind: str) -> Any:
    """What meshio reads of a file that is of a kind, in words."""
    try:
        import meshio

        return meshio.read(path)
    except (Exception, SystemExit) as error:  # meshio raises what its parsers raise
        if isinstance(error, ImportError):
            raise
        raise FormatError(
            f"cannot be read as {kind} ({type(error).__name__})", path=str(path)
        ) from error


def _array_of(arrays: dict[str, Floats], column: str | None, path: Path) -> Floats:
    single = {name: data for name, data in arrays.items() if data.ndim == 1}
    if column is None and len(single) == 1:
        return next(iter(single.values()))
    if column is not None and column in single:
        return single[column]
    names = ", ".join(sorted(single)) or "none"
    raise FormatError(f"name one array at the points; there are: {names}", path=str(path))
