"""`.ont`: offset, layer height, sites and boundary of a structure (thesis §3.4).

Reads what the thesis shows (Fig. 3.20, Algorithms 9 and 10); writes what its importer
(Algorithm 10) accepts.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np

from v3dcad.errors import FormatError
from v3dcad.formats.stl import ascii_corners, ascii_stl, welded
from v3dcad.model import Floats, Recipe

OFFSET, HEIGHT, SITES, PART = (
    "OFFSET_VALUE",
    "LAYER_HEIGHT",
    "VORONOI_SEED_COORDINATES",
    "BREP_PART_STL",
)
SITES_IN_FIGURE = "INITIAL_LAYER_VORONOI_SEED_COORDINATES"
"""What Fig. 3.20 calls the section that Algorithms 9 and 10 call `SITES`."""


def ont_text(recipe: Recipe) -> str:
    """A recipe as the text of an `.ont` file, every number to the last bit."""
    sites = "".join("{!r},{!r},{!r}\n".format(*site) for site in recipe.sites.tolist())
    return (
        f"[{OFFSET}]\n{recipe.offset!r}\n\n"
        f"[{HEIGHT}]\n{recipe.layer_height!r}\n\n"
        f"[{SITES}]\n{sites}\n"
        f"[{PART}]\n{ascii_stl(recipe.boundary, 'mesh')}"
    )


def read_ont(path: Path) -> Recipe:
    """The recipe in an `.ont` file; `FormatError` with line and section where it is damaged."""
    try:
        text = path.read_bytes().decode("utf-8")
    except UnicodeDecodeError as error:
        raise FormatError("not a text file in UTF-8", path=str(path)) from error
    sections = _sections(text, str(path))

    def number(name: str, above: bool) -> float:
        line, body = _section(sections, name, str(path))
        words = [(line + k, row) for k, row in enumerate(body) if row]
        if len(words) != 1:
            raise FormatError(
                f"holds {len(words)} lines, one number is needed",
                path=str(path), line=line, section=name,
            )  # fmt: skip
        value = _number(words[0][1], str(path), words[0][0], name)
        if value < 0 or (above and value == 0):
            raise FormatError(
                f"{value:g} is not {'above 0' if above else '0 or more'}",
                path=str(path), line=words[0][0], section=name,
            )  # fmt: skip
        return value

    offset, layer_height = number(OFFSET, above=False), number(HEIGHT, above=True)
    sites = _read_sites(*_section(sections, SITES, str(path)), str(path))
    line, body = _section(sections, PART, str(path))
    mesh_text = "\n".join(body).encode()
    boundary = welded(ascii_corners(mesh_text, str(path), line), str(path))
    return Recipe(offset, layer_height, sites, boundary, path.stem)


def _sections(text: str, path: str) -> dict[str, tuple[int, list[str]]]:
    """Section name → line number of its first line, and its lines without comments."""
    found: dict[str, tuple[int, list[str]]] = {}
    body: list[str] | None = None
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.split("//")[0].strip()
        header = re.fullmatch(r"\[([A-Z0-9_]+)\]", line)
        if header:
            name = SITES if header[1] == SITES_IN_FIGURE else header[1]
            if name in found:
                raise FormatError("stands here a second time", path=path, line=number, section=name)
            body = []
            found[name] = (number + 1, body)
        elif body is not None:
            body.append(line)
        elif line:
            raise FormatError(
                "not an .ont file: text before the first [SECTION]", path=path, line=number
            )
    return found


def _section(
    sections: dict[str, tuple[int, list[str]]], name: str, path: str
) -> tuple[int, list[str]]:
    if name not in sections:
        raise FormatError("is missing; the file is not whole", path=path, section=name)
    return sections[name]


def _number(word: str, path: str, line: int, section: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise FormatError(
            f"{word[:40]!r} is not a finite number", path=path, line=line, section=section
        )
    return value


def _read_sites(first_line: int, body: list[str], path: str) -> Floats:
    sites: list[list[float]] = []
    for line, row in enumerate(body, start=first_line):
        if not row or row.replace(" ", "").upper() == "X,Y,Z":
            continue
        words = row.split(",")
        if len(words) != 3:
            raise FormatError(
                f"{len(words)} numbers, X,Y,Z are needed", path=path, line=line, section=SITES
            )
        sites.append([_number(word, path, line, SITES) for word in words])
    if not sites:
        raise FormatError("holds no sites", path=path, line=first_line, section=SITES)
    return np.array(sites)
