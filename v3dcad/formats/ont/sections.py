"""The sections of an `.ont` text, in any order; each knows its position in its file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import islice

from v3dcad.errors import FormatError
from v3dcad.formats.numbers import number_in

PART = "BREP_PART_STL"
SITES = "VORONOI_SEED_COORDINATES"
SITES_IN_FIGURE = "INITIAL_LAYER_VORONOI_SEED_COORDINATES"
"""What Fig. 3.20 calls the section that Algorithms 9 and 10 call `SITES`."""

MAX_SECTIONS = MAX_FIELDS = 200
"""Far more than any file needs; without a limit a hostile file could fill the memory with them."""

_HEADER = re.compile(
    r"^[ \t]*+(?:\[([^\[\]\n]{1,64})\][ \t]*+(?://[^\n]*+)?|solid[^\n]*+)$",
    re.MULTILINE | re.IGNORECASE,
)


@dataclass(frozen=True, slots=True)
class Body:
    """The lines of one section."""

    path: str
    text: str
    name: str
    head: int
    """offset of the section's own line"""
    start: int
    """offset of its content"""
    stop: int

    def error(self, message: str, at: int | None = None) -> FormatError:
        """The error that something is wrong at an offset into the text, or with the section."""
        line = self.text.count("\n", 0, self.head if at is None else at) + 1
        return FormatError(message, path=self.path, line=line, section=self.name)

    def rows(self) -> Iterator[tuple[int, str]]:
        """Offset and content of each line that is not empty or a comment."""
        at = self.start
        while at < self.stop:
            end = self.text.find("\n", at, self.stop)
            end = self.stop if end < 0 else end
            row = self.text[at:end].split("//", 1)[0].strip()
            if row:
                yield at, row
            at = end + 1

    def number(self) -> float:
        """The one number that the section contains."""
        rows = list(islice(self.rows(), 2))
        if len(rows) != 1:
            many = "more than one line" if rows else "nothing"
            raise self.error(f"contains {many}; one number is needed")
        at, word = rows[0]
        return self.number_from(word, at)

    def number_from(self, word: str, at: int) -> float:
        """The finite number that a word is; `at` is the offset to name in the error."""
        value = number_in(word)
        if value is None or not abs(value) < float("inf"):
            hint = "; write a decimal point, not a comma" if "," in word else ""
            raise self.error(f"{word[:40]!r} is not a finite number{hint}", at)
        return value


@dataclass(frozen=True, slots=True)
class Field:
    """The value of one `key = value` line."""

    body: Body
    at: int
    value: str

    def error(self, message: str) -> FormatError:
        """The error that something is wrong with this value."""
        return self.body.error(message, self.at)

    def count(self) -> int:
        """The value as a whole number of at most 18 digits."""
        if not re.fullmatch("[0-9]{1,18}", self.value):
            raise self.error(f"{self.value[:40]!r} is not a whole number")
        return int(self.value)

    def numbers(self, count: int) -> list[float]:
        """The value as a given count of finite numbers."""
        words = self.value.split(maxsplit=count)
        if len(words) != count:
            raise self.error(f"{self.value[:40]!r} is not {count} numbers")
        return [self.body.number_from(word, self.at) for word in words]

    def one_of(self, *values: str) -> str:
        """The value, which must be one of these."""
        if self.value not in values:
            known = " or ".join(map(repr, values))
            raise self.error(f"{self.value[:40]!r} is unknown to this v3dcad, which reads {known}")
        return self.value

    def matching(self, pattern: str, what: str) -> str:
        """The value, which must match a pattern."""
        if not re.fullmatch(pattern, self.value, re.ASCII):
            raise self.error(f"{self.value[:40]!r} is not {what}")
        return self.value


class Fields:
    """The `key = value` lines of a section, taken one by one; `end` refuses those left over."""

    def __init__(self, body: Body, rows: Iterable[tuple[int, str]]) -> None:
        self.body = body
        self._fields: dict[str, Field] = {}
        for at, row in rows:
            key, equals, value = (word.strip() for word in row.partition("="))
            if not equals:
                raise body.error(f"{row[:40]!r} is not `key = value`", at)
            if key in self._fields:
                raise body.error(f"`{key[:40]}` is given twice", at)
            if len(self._fields) >= MAX_FIELDS:
                raise body.error(f"contains more than {MAX_FIELDS} fields", at)
            self._fields[key] = Field(body, at, value)

    def take(self, key: str) -> Field:
        """The field of a key that must be there."""
        found = self.take_if_there(key)
        if found is None:
            raise self.body.error(f"`{key}` is missing; the file is not whole")
        return found

    def take_if_there(self, key: str) -> Field | None:
        """The field of a key that may be missing."""
        return self._fields.pop(key, None)

    def end(self) -> None:
        """Refuse keys that have not been taken."""
        for key, field in self._fields.items():
            raise field.error(f"`{key[:40]}` is unknown to this v3dcad; update it")

    def rest(self) -> dict[str, Field]:
        """All fields that have not been taken."""
        return self._fields


def sections_in(text: str, path: str) -> dict[str, Body]:
    """The sections of a text, whose lines are ended by line feeds, by name.

    A `solid` line outside `PART` begins that section, as it does for Algorithm 10. Raises
    `FormatError` for a section that is given twice and for text before the first.
    """
    starts: list[tuple[str, int, int]] = []
    for header in _HEADER.finditer(text):
        name = header[1]
        if name is not None:
            starts.append((name, header.start(), header.end() + 1))
        elif not starts or starts[-1][0] != PART:
            starts.append((PART, header.start(), header.start()))
        if len(starts) > MAX_SECTIONS:
            raise FormatError(f"contains more than {MAX_SECTIONS} sections", path=path)
    first = starts[0][1] if starts else len(text)
    for at, row in Body(path, text, "", 0, 0, first).rows():
        line = text.count("\n", 0, at) + 1
        raise FormatError(
            f"not an .ont file: {row[:40]!r} comes before the first [SECTION]",
            path=path, line=line,
        )  # fmt: skip
    found: dict[str, Body] = {}
    for place, (name, head, start) in enumerate(starts):
        stop = starts[place + 1][1] if place + 1 < len(starts) else len(text)
        if name == SITES_IN_FIGURE:
            name = SITES
        body = Body(path, text, name, head, min(start, len(text)), stop)
        if name in found:
            raise body.error("is given twice")
        found[name] = body
    return found
