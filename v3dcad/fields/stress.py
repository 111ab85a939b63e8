"""The von Mises stress in a result of a finite-element analysis.

CalculiX's .frd, as FreeCAD's FEM workbench has it (G. Dhondt, "CalculiX CrunchiX user's manual",
the chapter on the frd format), and VTU files.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from v3dcad.errors import FormatError
from v3dcad.fields.table import read_vtk, refuse_unusable
from v3dcad.model import Floats

VON_MISES = re.compile(r"von[ _-]*mises", re.IGNORECASE)
COMPONENTS = 6
WIDTH = 12
"""Characters of a number in an .frd file."""


def read_stress(path: Path) -> tuple[Floats, Floats]:
    """The nodes (n, 3), mm, of a result and the von Mises stress at them (n,), in its unit.

    Of several steps the last. Raises `FormatError` for a file that is damaged or has no stress.
    """
    if path.suffix.lower() == ".frd":
        points, values = _read_frd(path)
    elif path.suffix.lower() in (".vtu", ".vtk"):
        points, values = _read_vtk_stress(path)
    else:
        raise FormatError("not a result that can be read; give .frd, .vtu or .vtk", path=str(path))
    refuse_unusable(points, values, path, "nodes with a stress")
    return points, values


def von_mises(stress: Floats) -> Floats:
    """The von Mises stress (n,) of stresses (n, 6): xx, yy, zz, xy, yz, zx."""
    xx, yy, zz, xy, yz, zx = stress.T
    shear = xy**2 + yz**2 + zx**2
    return np.asarray(
        np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * shear), np.float64
    )


def _read_vtk_stress(path: Path) -> tuple[Floats, Floats]:
    points, arrays = read_vtk(path)
    for name in sorted(arrays):
        if VON_MISES.search(name) and arrays[name].ndim == 1:
            return points, arrays[name]
    names = ", ".join(sorted(arrays)) or "none"
    raise FormatError(
        f"contains no von Mises stress at its points; its arrays are: {names}", path=str(path)
    )


def _read_frd(path: Path) -> tuple[Floats, Floats]:
    nodes: dict[int, list[float]] = {}
    stress: dict[int, list[float]] = {}
    reading: dict[int, list[float]] | None = None
    count, digits = 0, 10
    try:
        with path.open(encoding="latin-1") as file:
            for number, line in enumerate(file, start=1):
                if line[:6] == "    2C":
                    reading, count = nodes, 3
                    digits = _digits(line, path, number)
                elif line[:3] == " -4":
                    is_stress = line[3:13].split()[:1] == ["STRESS"]
                    reading, count = (stress, COMPONENTS) if is_stress else (None, 0)
                    if is_stress:
                        stress.clear()
                elif line[:3] == " -3":
                    reading = None
                elif line[:3] == " -1" and reading is not None:
                    name, values = _row(line, digits, count, path, number)
                    reading[name] = values
    except OSError as error:
        raise FormatError(f"cannot be read ({error.strerror})", path=str(path)) from error
    if not stress:
        raise FormatError("contains no stress; let CalculiX write it (*EL FILE, S)", path=str(path))
    missing = [name for name in stress if name not in nodes]
    if missing:
        raise FormatError(f"has a stress for node {missing[0]}, but not the node", path=str(path))
    names = sorted(stress)
    points = np.array([nodes[name] for name in names]).reshape(-1, 3)
    return points, von_mises(np.array([stress[name] for name in names]).reshape(-1, COMPONENTS))


def _digits(line: str, path: Path, number: int) -> int:
    """How many characters a node's number has, by the format that the block states."""
    stated = line.split()[-1]
    if stated == "2":
        raise FormatError("is binary; write it as text", path=str(path), line=number)
    return 5 if stated == "0" else 10


def _row(line: str, digits: int, count: int, path: Path, number: int) -> tuple[int, list[float]]:
    """A node's number and its values."""
    start = 3 + digits
    try:
        name = int(line[3:start])
        values = [float(line[at : at + WIDTH]) for at in range(start, start + count * WIDTH, WIDTH)]
    except ValueError as error:
        raise FormatError("is not a node with its values", path=str(path), line=number) from error
    return name, values
