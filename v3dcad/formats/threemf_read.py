"""Reading 3MF by lib3mf: all that its build holds, in mm, in one mesh."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from lib3mf import Lib3MF

from v3dcad.errors import FormatError
from v3dcad.model import Floats, Ints, Mesh

MOST_BYTES = 2**30
"""What a file may claim to unpack to: zip bombs are refused before they are opened."""

MOST_TRIANGLES = 20_000_000
"""Components that repeat each other may make any number of a small file."""

MILLIMETRES = {
    Lib3MF.ModelUnit.MicroMeter: 0.001,
    Lib3MF.ModelUnit.MilliMeter: 1.0,
    Lib3MF.ModelUnit.CentiMeter: 10.0,
    Lib3MF.ModelUnit.Inch: 25.4,
    Lib3MF.ModelUnit.Foot: 304.8,
    Lib3MF.ModelUnit.Meter: 1000.0,
}


def read_threemf(path: Path) -> tuple[Mesh, list[str]]:
    """The meshes of a 3MF file's build, placed and in mm, and what was left out.

    Support objects are left out. Raises `FormatError` where the file is cut off, holds no mesh,
    or unpacks to more than `MOST_BYTES` or `MOST_TRIANGLES`.
    """
    _check_size(path)
    model = Lib3MF.Wrapper().CreateModel()
    try:
        reader = model.QueryReader("3mf")
        reader.ReadFromFile(str(path))
        build = _Build(model, str(path))
        items = model.GetBuildItems()
        while items.MoveNext():
            item = items.GetCurrent()
            build.add(item.GetObjectResource(), _motion(item.GetObjectTransform()))
    except Lib3MF.ELib3MFException as error:
        message = f"lib3mf cannot read it ({error}); export it again"
        raise FormatError(message, path=str(path)) from error
    if not build.triangles:
        raise FormatError("its build holds no triangles; export it again", path=str(path))
    left_out = [f"{build.support} support objects were left out"] if build.support else []
    scale = MILLIMETRES[model.GetUnit()]
    return Mesh(np.concatenate(build.vertices) * scale, np.concatenate(build.triangles)), left_out


def _check_size(path: Path) -> None:
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
    except (zipfile.BadZipFile, OSError, ValueError) as error:
        message = f"not a whole 3MF file ({error}); export it again"
        raise FormatError(message, path=str(path)) from error
    if size > MOST_BYTES:
        message = f"it claims to unpack to {size:,} bytes, at most {MOST_BYTES:,} are read"
        raise FormatError(message, path=str(path))


class _Build:
    """Meshes gathered from a model's objects."""

    def __init__(self, model: Any, path: str) -> None:
        self.model = model
        self.path = path
        self.vertices: list[Floats] = []
        self.triangles: list[Ints] = []
        self.count = 0
        self.held = 0
        self.support = 0
        self.meshes: dict[int, tuple[Floats, Ints]] = {}

    def add(self, item: Any, motion: Floats) -> None:
        """Add an object, moved by the matrix (4, 3)."""
        number = item.GetResourceID()
        if item.GetType() in (Lib3MF.ObjectType.Support, Lib3MF.ObjectType.SolidSupport):
            self.support += 1
        elif item.IsMeshObject():
            self._add_mesh(number, motion)
        elif item.IsComponentsObject():
            whole = self.model.GetComponentsObjectByID(number)
            for index in range(whole.GetComponentCount()):
                self._count(1)  # components without triangles take time too
                component = whole.GetComponent(index)
                inner = _motion(component.GetTransform())
                placed = np.vstack([inner[:3] @ motion[:3], inner[3] @ motion[:3] + motion[3]])
                self.add(component.GetObjectResource(), placed)

    def _add_mesh(self, number: int, motion: Floats) -> None:
        if number not in self.meshes:
            mesh = self.model.GetMeshObjectByID(number)
            self.meshes[number] = (
                _rows(mesh.GetVertices(), "<f4").astype(np.float64),
                _rows(mesh.GetTriangleIndices(), "<u4").astype(np.int64),
            )
        vertices, triangles = self.meshes[number]
        self._count(len(triangles))
        # A mirror image turns triangles inside out.
        mirrored = np.linalg.det(motion[:3]) < 0
        self.triangles.append((triangles[:, ::-1] if mirrored else triangles) + self.held)
        self.vertices.append(vertices @ motion[:3] + motion[3])
        self.held += len(vertices)

    def _count(self, more: int) -> None:
        self.count += more
        if self.count > MOST_TRIANGLES:
            raise FormatError(
                f"its components make more than {MOST_TRIANGLES:,} triangles; simplify it",
                path=self.path,
            )


def _rows(records: list[Any], kind: str) -> Any:
    """lib3mf's records of three numbers as rows."""
    return np.frombuffer(b"".join(map(bytes, records)), kind).reshape(-1, 3)


def _motion(transform: Any) -> Floats:
    """(4, 3): three rows that turn a row of coordinates, and the shift."""
    return np.ctypeslib.as_array(transform.Fields).astype(np.float64)
