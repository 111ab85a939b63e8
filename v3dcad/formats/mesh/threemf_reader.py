"""Reading 3MF: all that its build holds, placed, in mm, in one mesh.

By the core specification (3MF consortium, 1.3) and `path` of its production extension. lib3mf,
which writes our files, does not read them: a file of 3 kB whose components repeat each other takes
it minutes, and it rounds coordinates to single precision.
"""

from __future__ import annotations

import posixpath
import zipfile
from pathlib import Path
from typing import IO, NamedTuple
from xml.etree import ElementTree

import numpy as np

from v3dcad.errors import FormatError
from v3dcad.model import Floats, Ints, Mesh

MAX_UNPACKED_BYTES = 2**30
"""Largest size that a file may unpack to."""

MAX_TRIANGLES = 20_000_000
MAX_COMPONENTS = 100_000
MAX_DEPTH = 32
"""Limits, since in a small file components that repeat each other could fill the memory."""

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
PATH = "{http://schemas.microsoft.com/3dmanufacturing/production/2015/06}path"
MODEL = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"

MILLIMETRES = {
    "micron": 0.001,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "inch": 25.4,
    "foot": 304.8,
    "meter": 1000.0,
}


class _Use(NamedTuple):
    """An object, in which model part of the package, and how it is moved: (4, 3)."""

    part: str
    number: str
    motion: Floats


class _Object(NamedTuple):
    kind: str
    vertices: Floats
    triangles: Ints
    components: list[_Use]


class _Model(NamedTuple):
    unit: str
    objects: dict[str, _Object]
    items: list[_Use]


def read_threemf(path: Path) -> tuple[Mesh, list[str]]:
    """The meshes of a 3MF file's build, placed and in mm, and what was left out.

    Support objects are left out. Raises `FormatError` where the file is cut off or damaged, holds
    no triangles, or unpacks to more than the limits above.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
            if size > MAX_UNPACKED_BYTES:
                message = (
                    f"it unpacks to {size:,} bytes, more than the {MAX_UNPACKED_BYTES:,} allowed"
                )
                raise FormatError(message, path=str(path))
            build = _Build(archive, str(path))
            root = _root(archive)
            for item in build.model(root).items:
                build.add(item, 0)
            scale = MILLIMETRES[build.model(root).unit]
    except (zipfile.BadZipFile, OSError, EOFError, NotImplementedError, RuntimeError) as error:
        message = f"not a whole 3MF file ({error}); export it again"
        raise FormatError(message, path=str(path)) from error
    except (ElementTree.ParseError, KeyError, ValueError, OverflowError) as error:
        message = f"damaged ({type(error).__name__}: {error}); export it again"
        raise FormatError(message, path=str(path)) from error
    if not build.triangles:
        raise FormatError("its build contains no triangles; export it again", path=str(path))
    left_out = [f"{build.support} support objects were left out"] if build.support else []
    return Mesh(np.concatenate(build.vertices) * scale, np.concatenate(build.triangles)), left_out


def _root(archive: zipfile.ZipFile) -> str:
    """The package's main model part."""
    for relation in ElementTree.fromstring(archive.read("_rels/.rels")):
        if relation.get("Type") == MODEL:
            return relation.attrib["Target"].lstrip("/")
    raise KeyError("_rels/.rels names no 3D model")


class _Build:
    """Meshes gathered from the objects of a package's build."""

    def __init__(self, archive: zipfile.ZipFile, path: str) -> None:
        self.archive = archive
        self.path = path
        self.models: dict[str, _Model] = {}
        self.vertices: list[Floats] = []
        self.triangles: list[Ints] = []
        self.components = self.count = self.held = self.support = 0

    def model(self, part: str) -> _Model:
        if part not in self.models:
            with self.archive.open(part) as stream:
                self.models[part] = _read_model(stream, part)
        return self.models[part]

    def add(self, use: _Use, depth: int) -> None:
        """Add an object and, moved with it, its components."""
        found = self.model(use.part).objects[use.number]
        if "support" in found.kind:
            self.support += 1
            return
        self.components += 1
        self.count += len(found.triangles)
        if max(self.components / MAX_COMPONENTS, self.count / MAX_TRIANGLES, depth / MAX_DEPTH) > 1:
            message = (
                f"more than {MAX_TRIANGLES:,} triangles, {MAX_COMPONENTS:,} components, or "
                f"{MAX_DEPTH} of them within each other; simplify it"
            )
            raise FormatError(message, path=self.path)
        if len(found.triangles):
            # A mirror image turns triangles inside out.
            mirrored = np.linalg.det(use.motion[:3]) < 0
            rows = found.triangles[:, ::-1] if mirrored else found.triangles
            self.triangles.append(rows + self.held)
            self.vertices.append(found.vertices @ use.motion[:3] + use.motion[3])
            self.held += len(found.vertices)
        for part, number, motion in found.components:
            turned = motion[:3] @ use.motion[:3]
            shifted = motion[3] @ use.motion[:3] + use.motion[3]
            self.add(_Use(part, number, np.vstack([turned, shifted])), depth + 1)


def _read_model(stream: IO[bytes], part: str) -> _Model:
    """One model part; elements are let go as they are read."""
    unit = "millimeter"
    objects: dict[str, _Object] = {}
    items: list[_Use] = []
    vertices: list[tuple[float, ...]] = []
    triangles: list[tuple[int, ...]] = []
    components: list[_Use] = []
    for event, element in ElementTree.iterparse(stream, ("start", "end")):
        name = element.tag.removeprefix(CORE)
        if event == "start":
            if name == "model":
                unit = element.get("unit", unit)
            continue
        get = element.attrib
        if name == "vertex":
            vertices.append((float(get["x"]), float(get["y"]), float(get["z"])))
        elif name == "triangle":
            triangles.append((int(get["v1"]), int(get["v2"]), int(get["v3"])))
        elif name in ("component", "item"):
            where = posixpath.normpath(get.get(PATH, part)).lstrip("/")
            use = _Use(where, get["objectid"], _motion(get.get("transform")))
            (components if name == "component" else items).append(use)
        elif name == "object":
            corners = np.array(triangles, np.int64).reshape(-1, 3)
            points = np.array(vertices).reshape(-1, 3)
            if len(corners) and not 0 <= corners.min() <= corners.max() < len(points):
                raise ValueError(f"object {get['id']} refers to a vertex that does not exist")
            objects[get["id"]] = _Object(get.get("type", "model"), points, corners, components)
            vertices, triangles, components = [], [], []
        element.clear()
    return _Model(unit, objects, items)


def _motion(text: str | None) -> Floats:
    """(4, 3): three rows that turn a row of coordinates, and the shift."""
    if text is None:
        return np.vstack([np.eye(3), np.zeros(3)])
    return np.array([float(word) for word in text.split()]).reshape(4, 3)
