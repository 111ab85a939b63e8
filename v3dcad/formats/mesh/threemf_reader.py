"""Reading 3MF: all that its build holds, placed, in mm, in one mesh.

By the core specification (3MF consortium, 1.3) and `path` of its production extension. lib3mf,
which writes our files, does not read them: a file of 3 kB whose components repeat each other takes
it minutes, and it rounds coordinates to single precision.
"""

from __future__ import annotations

import lzma
import posixpath
import zipfile
import zlib
from collections import Counter
from pathlib import Path
from typing import IO, NamedTuple
from xml.etree import ElementTree

import numpy as np

from v3dcad.errors import FormatError
from v3dcad.formats.mesh.threemf_roles import MATERIAL, MODIFIER, NEGATIVE, Roles, read_roles
from v3dcad.geometry.mesh.boolean import subtracted
from v3dcad.geometry.mesh.check import checked_mesh
from v3dcad.model import Floats, Ints, Mesh
from v3dcad.words import counted

MAX_UNPACKED_BYTES = 2**30
"""Largest size that a file may unpack to."""

MAX_TRIANGLES = 20_000_000
MAX_COMPONENTS = 100_000
MAX_DEPTH = 32
"""Limits, since in a small file components that repeat each other could fill the memory."""

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
PATH = "{http://schemas.microsoft.com/3dmanufacturing/production/2015/06}path"
BEAMS = "{http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02}beamlattice"
SLICES = "{http://schemas.microsoft.com/3dmanufacturing/slice/2015/07}slicestackid"
MODEL = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"

CANNOT_UNPACK = (
    zipfile.BadZipFile, zlib.error, lzma.LZMAError, OSError, EOFError, NotImplementedError,
    RuntimeError,
)  # fmt: skip
"""What `zipfile` raises for archives that are cut off, damaged, encrypted or packed unusually."""

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
    printable: bool = True


class _Object(NamedTuple):
    kind: str
    vertices: Floats
    triangles: Ints
    components: list[_Use]
    unread: list[str]
    """what else it holds that is not read"""


class _Model(NamedTuple):
    unit: str
    objects: dict[str, _Object]
    items: list[_Use]


def read_threemf(path: Path) -> tuple[Mesh, list[str]]:
    """The meshes of a 3MF file's build, placed and in mm, and what was left out.

    Objects that are no model (support, other), that are not to be printed, and slicers' modifiers
    are left out, negative volumes subtracted. Raises `FormatError` where the file is cut off or
    damaged, holds no triangles, or unpacks to more than the limits above, `GeometryError` where a
    negative volume or what it is subtracted from is not closed.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
            if size > MAX_UNPACKED_BYTES:
                message = (
                    f"it unpacks to {size:,} bytes, more than the {MAX_UNPACKED_BYTES:,} allowed"
                )
                raise FormatError(message, path=str(path))
            build = _Build(archive, str(path), read_roles(archive))
            root = _root(archive)
            for item in build.model(root).items:
                build.add(item, "")
            scale = MILLIMETRES[build.model(root).unit]
    except CANNOT_UNPACK as error:
        message = f"not a whole 3MF file ({error}); export it again"
        raise FormatError(message, path=str(path)) from error
    except (ElementTree.ParseError, KeyError, ValueError, OverflowError) as error:
        message = f"damaged ({type(error).__name__}: {error}); export it again"
        raise FormatError(message, path=str(path)) from error
    material = build.mesh(MATERIAL, scale)
    told = build.told()
    if material is None:
        message = "its build contains no triangles of a model"
        message += f" ({'; '.join(told)})" if told else ""
        raise FormatError(f"{message}; export it again as a mesh", path=str(path))
    negative = build.mesh(NEGATIVE, scale)
    if negative is not None:
        closed, tool = checked_mesh(material)[0], checked_mesh(negative)[0]
        material = subtracted(closed, [tool])
    return material, told


def _root(archive: zipfile.ZipFile) -> str:
    """The package's main model part."""
    for relation in ElementTree.fromstring(archive.read("_rels/.rels")):
        if relation.get("Type") == MODEL:
            return relation.attrib["Target"].lstrip("/")
    raise KeyError("_rels/.rels names no 3D model")


class _Build:
    """Meshes gathered from the objects of a package's build, by what they are."""

    def __init__(self, archive: zipfile.ZipFile, path: str, roles: Roles) -> None:
        self.archive = archive
        self.path = path
        self.roles = roles
        self.models: dict[str, _Model] = {}
        self.meshes: dict[str, list[Mesh]] = {}
        self.components = self.count = 0
        self.left_out: Counter[str] = Counter()

    def model(self, part: str) -> _Model:
        if part not in self.models:
            with self.archive.open(part) as stream:
                self.models[part] = _read_model(stream, part)
        return self.models[part]

    def add(self, use: _Use, within: str, depth: int = 0, role: str = MATERIAL) -> None:
        """Add an object that lies within another and, moved with it, its components."""
        if not use.printable:
            self.left_out["unprintable object"] += 1
            return
        found = self.model(use.part).objects[use.number]
        if found.kind != "model":
            kind = "support" if "support" in found.kind else f"{found.kind!r}"
            self.left_out[f"{kind} object"] += 1
            return
        role = self.roles.components.get((within, use.number), role)
        self.components += 1
        self.count += len(found.triangles)
        if max(self.components / MAX_COMPONENTS, self.count / MAX_TRIANGLES, depth / MAX_DEPTH) > 1:
            message = (
                f"more than {MAX_TRIANGLES:,} triangles, {MAX_COMPONENTS:,} components, or "
                f"{MAX_DEPTH} of them within each other; simplify it"
            )
            raise FormatError(message, path=self.path)
        for what in found.unread:
            self.left_out[what] += 1
        if len(found.triangles):
            self._add_mesh(found, use, role)
        for part, number, motion, printable in found.components:
            turned = motion[:3] @ use.motion[:3]
            shifted = motion[3] @ use.motion[:3] + use.motion[3]
            inner = _Use(part, number, np.vstack([turned, shifted]), printable)
            self.add(inner, use.number, depth + 1, role)

    def _add_mesh(self, found: _Object, use: _Use, role: str) -> None:
        points = found.vertices @ use.motion[:3] + use.motion[3]
        # A mirror image turns triangles inside out.
        mirrored = np.linalg.det(use.motion[:3]) < 0
        rows = found.triangles[:, ::-1] if mirrored else found.triangles
        ranges = self.roles.triangles.get(use.number) or [(0, len(rows) - 1, role)]
        for first, last, own in ranges:
            some = rows[first : last + 1]
            if own == MODIFIER:
                self.left_out["modifier"] += 1
            elif len(some):
                self.meshes.setdefault(own, []).append(Mesh(points, some))

    def mesh(self, role: str, scale: float) -> Mesh | None:
        """All meshes of a role in one, their coordinates times a scale; None where there is none.

        Where a slicer lists triangles as several volumes, their vertices are there several times.
        """
        meshes = self.meshes.get(role)
        if not meshes:
            return None
        held = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
        rows = [mesh.triangles + start for mesh, start in zip(meshes, held, strict=True)]
        return Mesh(
            np.concatenate([mesh.vertices for mesh in meshes]) * scale, np.concatenate(rows)
        )

    def told(self) -> list[str]:
        """What to report of what was left out or subtracted."""
        lines = [f"left out {counted(count, what)}" for what, count in self.left_out.items()]
        negatives = len(self.meshes.get(NEGATIVE, ()))
        taken = [f"subtracted {counted(negatives, 'negative volume')}"] if negatives else []
        return lines + taken


def _read_model(stream: IO[bytes], part: str) -> _Model:
    """One model part; elements are let go as they are read."""
    unit = "millimeter"
    objects: dict[str, _Object] = {}
    items: list[_Use] = []
    vertices: list[tuple[float, ...]] = []
    triangles: list[tuple[int, ...]] = []
    components: list[_Use] = []
    unread: list[str] = []
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
            printable = get.get("printable", "1") not in ("0", "false")
            use = _Use(where, get["objectid"], _motion(get.get("transform")), printable)
            (components if name == "component" else items).append(use)
        elif name == BEAMS:
            unread.append("beam lattice")
        elif name == "object":
            if SLICES in get:
                unread.append("slice stack")
            corners = np.array(triangles, np.int64).reshape(-1, 3)
            points = np.array(vertices).reshape(-1, 3)
            if len(corners) and not 0 <= corners.min() <= corners.max() < len(points):
                raise ValueError(f"object {get['id']} refers to a vertex that does not exist")
            objects[get["id"]] = _Object(
                get.get("type", "model"), points, corners, components, unread
            )
            vertices, triangles, components, unread = [], [], [], []
        element.clear()
    return _Model(unit, objects, items)


def _motion(text: str | None) -> Floats:
    """(4, 3): three rows that turn a row of coordinates, and the shift."""
    if text is None:
        return np.vstack([np.eye(3), np.zeros(3)])
    return np.array([float(word) for word in text.split()]).reshape(4, 3)
