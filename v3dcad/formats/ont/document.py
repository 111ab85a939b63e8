"""`.ont`: a structure as the few numbers that make it again (thesis §3.4; docs/ont.md).

Reads what the thesis shows (Fig. 3.20, Algorithms 9 and 10) and what `ont_text` writes: the
thesis's sections first and in its words, so that its importer (Algorithm 10) reads them, then
further sections that it skips.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from v3dcad.errors import FormatError, SettingError
from v3dcad.formats.mesh.stl import ascii_stl, welded
from v3dcad.formats.mesh.stl_ascii import ascii_corners
from v3dcad.formats.numbers import number_text
from v3dcad.formats.ont.armor import MARK, checked, packed, unpacked
from v3dcad.formats.ont.mesh_codec import mesh_bytes, mesh_in
from v3dcad.formats.ont.sections import PART, SITES, Body, Field, Fields, sections_in
from v3dcad.formats.ont.settings import settings_fields, settings_from
from v3dcad.model import Brep, Checksum, Floats, Mesh, Placement, Recipe
from v3dcad.settings import FillSettings, declared

FORMAT = 2
"""The version that we write and read. Format 1 was never released."""

OFFSET, HEIGHT = "OFFSET_VALUE", "LAYER_HEIGHT"
OURS, SETTINGS, BOUNDARY, CHECKSUM = "V3DCAD", "SETTINGS", "BOUNDARY", "CHECKSUM"

MAX_FILE_BYTES = 1 << 28
"""256 MiB: the largest file that is read; some ten times as much memory is the most it can take."""
MAX_SITES = 10_000_000

PACKING = "lzma-base85"
BREP_BEGINS = b"\nOpen CASCADE Topology V"

PACKED_FILES = {
    b"PK\x03\x04": "zip", b"\x1f\x8b": "gzip", b"\xfd7zXZ": "xz", b"BZh": "bzip2",
    b"Rar!": "RAR", b"7z\xbc\xaf": "7z", b"(\xb5/\xfd": "zstd",
}  # fmt: skip


def ont_text(recipe: Recipe, boundary: str) -> str:
    """A recipe as the text of an `.ont` file, every number to the last bit.

    `boundary` is "stl" (the thesis's form; the recipe must hold a mesh and sites) or "exact".
    """
    # Readers of the thesis's form expect the section; a foam has no offset.
    thesis = recipe.settings.method == "thesis"
    lines = [f"[{OFFSET}]", number_text(float(recipe.settings.offset)) if thesis else "0"]
    lines += [f"[{HEIGHT}]", number_text(recipe.settings.layer_height)]
    if recipe.sites is not None:
        lines.append(f"[{SITES}]")
        lines += [",".join(map(number_text, site)) for site in recipe.sites.tolist()]
    if boundary == "stl":
        if not isinstance(recipe.boundary, Mesh) or (thesis and recipe.sites is None):
            raise ValueError("this form needs triangles, and the thesis's method a list of sites")
        lines += [f"[{PART}]", ascii_stl(recipe.boundary, "mesh").removesuffix("\n")]
    ours = {"format": str(FORMAT), "software": recipe.software or "unknown", "units": "mm"}
    if recipe.placement.translation.any():
        ours["shift"] = _numbers(recipe.placement.translation)
    lines += _fields(OURS, ours)
    lines += _fields(SETTINGS, settings_fields(recipe.settings))
    if boundary == "exact":
        lines += _exact_boundary(recipe)
    if recipe.checksum is not None:
        lines += _fields(CHECKSUM, recipe.checksum.as_text())
    return "\n".join(lines) + "\n"


def read_ont(path: Path) -> Recipe:
    """The recipe in an `.ont` file; `FormatError` with line and section where it is damaged."""
    with path.open("rb") as file:
        data = file.read(MAX_FILE_BYTES + 1)
    return recipe_in(data, str(path))


def recipe_in(data: bytes, path: str) -> Recipe:
    """The recipe in the bytes of an `.ont` file; `path` is only named in errors."""
    sections = sections_in(_text(data, path), path)
    offset = _setting(_section(sections, OFFSET, path), "offset")
    layer_height = _setting(_section(sections, HEIGHT, path), "layer_height")
    sites = _sites(sections[SITES]) if SITES in sections else None
    exact = BOUNDARY in sections
    if exact and PART in sections:
        raise sections[BOUNDARY].error(f"comes in addition to [{PART}]; keep only one boundary")
    ours = exact or any(name in sections for name in (OURS, SETTINGS, CHECKSUM))
    software, placement = "", Placement.none()
    announced: dict[str, Field] = {}
    if ours:
        software, placement = _ours(_section(sections, OURS, path))
        announced = _whole(_section(sections, SETTINGS, path)).rest()
    count = None if sites is None else len(sites)
    settings = settings_from(announced, offset, layer_height, count)
    if sites is None and not exact and settings.method == "thesis":
        raise FormatError("is missing; the file is not whole", path=path, section=SITES)
    checksum = _checksum(sections[CHECKSUM]) if CHECKSUM in sections else None
    boundary = _exact(sections[BOUNDARY]) if exact else _triangles(_section(sections, PART, path))
    return Recipe(
        name=Path(path).stem,
        settings=settings,
        sites=sites,
        boundary=boundary,
        placement=placement,
        checksum=checksum,
        software=software,
    )


def _fields(name: str, fields: dict[str, str]) -> list[str]:
    return [f"[{name}]", *(f"{key} = {value}" for key, value in fields.items())]


def _numbers(values: Floats) -> str:
    return " ".join(map(number_text, values.tolist()))


def _exact_boundary(recipe: Recipe) -> list[str]:
    boundary = recipe.boundary
    if isinstance(boundary, Brep):
        data, low, high = boundary.data, *boundary.bounds
        fields = {"kind": "brep", "low": _numbers(low), "high": _numbers(high)}
    else:
        data = mesh_bytes(boundary, recipe.placement.translation)
        fields = {"kind": "mesh"}
    fields |= {"packing": PACKING, "size": str(len(data)), "crc32": checked(data)}
    return [*_fields(BOUNDARY, fields), *packed(data)]


def _text(data: bytes, path: str) -> str:
    if len(data) > MAX_FILE_BYTES:
        raise FormatError(f"larger than {MAX_FILE_BYTES} bytes, the most that is read", path=path)
    for begins, name in PACKED_FILES.items():
        if data.startswith(begins):
            raise FormatError(f"this is compressed ({name}); unpack it first", path=path)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise FormatError("not a text file in UTF-8", path=path, line=line) from error
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _section(sections: dict[str, Body], name: str, path: str) -> Body:
    if name not in sections:
        raise FormatError("is missing; the file is not whole", path=path, section=name)
    return sections[name]


def _setting(body: Body, name: str) -> float:
    value = body.number()
    try:
        declared(FillSettings, name).checked(name, value)
    except SettingError as error:
        raise body.error(error.message) from error
    return value


def _sites(body: Body) -> Floats:
    numbers = array("d")
    for at, row in body.rows():
        words = [word.strip() for word in row.split(",", 3)]
        if not numbers and [word.upper() for word in words] == ["X", "Y", "Z"]:
            continue
        if len(words) != 3:
            raise body.error(f"{row[:40]!r} is not three numbers X,Y,Z", at)
        if len(numbers) >= 3 * MAX_SITES:
            raise body.error(f"more than {MAX_SITES} sites", at)
        numbers.extend(body.number_from(word, at) for word in words)
    if not numbers:
        raise body.error("contains no sites")
    return np.frombuffer(numbers, np.float64).reshape(-1, 3)


def _triangles(body: Body) -> Mesh:
    corners = ascii_corners(body.text, body.start, body.stop, body.error)
    return welded(corners, body.path, body.name)


def _whole(body: Body) -> Fields:
    return Fields(body, body.rows())


def _ours(body: Body) -> tuple[str, Placement]:
    fields = _whole(body)
    version = fields.take("format")
    if version.count() < FORMAT:
        raise version.error(
            f"the file has format {version.value}, of columns that grew, which v3dcad no longer "
            "makes; fill the part again"
        )
    if version.count() > FORMAT:
        raise version.error(
            f"the file has format {version.value}, this v3dcad reads format {FORMAT}; update v3dcad"
        )
    software = fields.take("software").matching(r"[\w.+ -]{1,64}", "a program's name and version")
    fields.take("units").one_of("mm")
    shift = fields.take_if_there("shift")
    fields.end()
    moved = np.zeros(3) if shift is None else np.array(shift.numbers(3))
    return software, Placement(np.eye(3), moved)


def _exact(body: Body) -> Brep | Mesh:
    digits = StringIO()
    fields = Fields(body, _apart(body.rows(), digits))
    kind = fields.take("kind").one_of("brep", "mesh")
    bounds = []
    if kind == "brep":
        bounds = [fields.take("low").numbers(3), fields.take("high").numbers(3)]
    fields.take("packing").one_of(PACKING)
    size, check = fields.take("size").count(), fields.take("crc32").value
    fields.end()
    try:
        data = unpacked(digits.getvalue(), size, check)
        if kind == "mesh":
            mesh = mesh_in(data)
            return welded(mesh.vertices[mesh.triangles], body.path, body.name)
    except ValueError as error:
        raise body.error(str(error)) from error
    if not data.startswith(BREP_BEGINS):
        raise body.error("does not contain a B-rep")
    if not (np.array(bounds[0]) < np.array(bounds[1])).all():
        raise body.error("its `low` does not lie below its `high`")
    return Brep(data, np.array(bounds))


def _apart(rows: Iterable[tuple[int, str]], digits: StringIO) -> Iterator[tuple[int, str]]:
    """The rows that are not packed lines; what is packed goes into `digits`."""
    for at, row in rows:
        if row.startswith(MARK):
            digits.write(row.removeprefix(MARK))
        else:
            yield at, row


def _checksum(body: Body) -> Checksum:
    fields = _whole(body)
    found: dict[str, Any] = {name: fields.take(name).count() for name in Checksum.COUNTS}
    found |= {
        name: fields.take(name).matching(f"[0-9a-f]{{{digits}}}", f"{digits} hexadecimal digits")
        for name, digits in Checksum.DIGITS.items()
    }
    fields.end()
    return Checksum(**found)
