"""ASCII STL text to triangle corners, each mistake with its line."""

from __future__ import annotations

import math
import re
from array import array
from collections.abc import Callable

import numpy as np

from v3dcad.errors import FormatError
from v3dcad.formats.numbers import MAX_CHARACTERS, NUMBER, matched_number
from v3dcad.model import Floats

Refusal = Callable[[str, int], FormatError]
"""Makes the error for a message and an offset into the text."""

_GAP = r"[ \t]++"
_REST = r"(?:\s++|//[^\n]*+)*+"
_END = rf"[ \t]*+(?://[^\n]*+)?+\n{_REST}"
_WORD = r"[^\s/]++"
_VERTEX = rf"vertex{_GAP}({NUMBER}){_GAP}({NUMBER}){_GAP}({NUMBER}){_END}"
_FACET = re.compile(
    rf"facet{_GAP}normal{_GAP}{_WORD}{_GAP}{_WORD}{_GAP}{_WORD}{_END}"
    rf"outer{_GAP}loop{_END}{_VERTEX * 3}endloop{_END}endfacet{_END}",
    re.IGNORECASE,
)
_LINES = [
    re.compile(line, re.IGNORECASE)
    for line in (
        rf"facet{_GAP}normal{_GAP}{_WORD}{_GAP}{_WORD}{_GAP}{_WORD}{_END}",
        rf"outer{_GAP}loop{_END}",
        *[_VERTEX] * 3,
        rf"endloop{_END}",
        rf"endfacet{_END}",
    )
]
_EXPECTED = ["facet normal nx ny nz", "outer loop", *["vertex x y z"] * 3, "endloop", "endfacet"]
_SOLID = re.compile(rf"solid[^\n]*+\n{_REST}", re.IGNORECASE)
_ENDSOLID = re.compile(rf"endsolid[^\n]*+(?:\n{_REST}|\Z)", re.IGNORECASE)
_SPACE = re.compile(_REST)


def ascii_corners(text: str, start: int, stop: int, refuse: Refusal) -> Floats:
    """Corners (t, 3, 3), mm, of the solids in `text[start:stop]`, lines ended by line feeds.

    Normals are ignored. Any case, any indent, `//` comments at the end of lines. Raises the error
    that `refuse` makes for a mistake: an incomplete facet, a word that is not a finite number, a
    solid without end, text that is not STL.
    """
    corners = array("d")
    at = _skip(text, start, stop)
    if at == stop or not _SOLID.match(text, at, stop):
        raise refuse(f"{_line(text, at, stop)!r} is not the `solid` line of an ASCII STL", at)
    while at < stop:
        solid = _SOLID.match(text, at, stop)
        if not solid:
            raise refuse(f"{_line(text, at, stop)!r} comes after the end of the solid", at)
        at = _read_facets(text, solid.end(), stop, corners, refuse)
        ending = _ENDSOLID.match(text, at, stop)
        if not ending:
            raise _mistake(text, at, stop, refuse)
        at = ending.end()
    return np.frombuffer(corners, np.float64).reshape(-1, 3, 3)


def _read_facets(text: str, at: int, stop: int, corners: array[float], refuse: Refusal) -> int:
    """Append the corners of facets from `at` on; returns the offset after the last."""
    facet = _FACET.match(text, at, stop)
    while facet:
        numbers = [matched_number(word) for word in facet.groups()]
        if not all(map(math.isfinite, numbers)):
            raise refuse("this facet has a number that is not finite", at)
        corners.extend(numbers)
        at = facet.end()
        facet = _FACET.match(text, at, stop)
    return at


def _mistake(text: str, at: int, stop: int, refuse: Refusal) -> FormatError:
    """Which line of the facet at `at` is wrong."""
    for line, expected in zip(_LINES, _EXPECTED, strict=True):
        found = line.match(text, at, stop)
        if not found:
            shown = _line(text, at, stop)
            if not shown:
                return refuse(
                    f"cut off: `{expected}` or `endsolid` is missing; export it again", at
                )
            return refuse(f"{shown!r} is not `{expected}`, which belongs here", at)
        at = found.end()
    raise AssertionError("a facet whose every line is right is a facet")


def _skip(text: str, at: int, stop: int) -> int:
    found = _SPACE.match(text, at, stop)
    assert found is not None
    return found.end()


def _line(text: str, at: int, stop: int) -> str:
    return text[at : min(stop, at + MAX_CHARACTERS)].split("\n", 1)[0].strip()[:60]
