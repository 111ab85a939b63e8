"""G-code lines from columns of integers: the part of writing that has to be fast."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from v3dcad.geometry.compiled.arrays import (
    ByteArray,
    ConstBoolRows,
    ConstByteArray,
    ConstIntArray,
    ConstIntRows,
)
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled
from v3dcad.model import Ints

COLUMNS = 7
XYZ, IJ, E, F = slice(0, 3), slice(3, 5), 5, 6
"""Columns of `Lines.words`: X Y Z, I J, E and F."""
LETTERS = np.frombuffer(b"XYZIJEF", dtype=np.uint8)
DECIMALS = np.array([3, 3, 3, 3, 3, 5, 0])
"""How many decimals each word has: X12.345 is 12345 in `Lines.words`."""
MAX_LINE_BYTES = 8 + COLUMNS * 22
"""No line is longer: a command and seven words of up to 19 digits."""

Text = NDArray[np.uint8]


@dataclass(slots=True)
class Lines:
    """G-code commands and their words, line by line."""

    commands: Ints
    """(n,) the number after G"""
    words: Ints
    """(n, 7) values of X Y Z I J E F as integers with the decimals of `DECIMALS`"""
    present: NDArray[np.bool_]
    """(n, 7) which of the words the line has"""
    comments: Ints
    """(n,) number of the comment before the line; 0 for none"""

    def part(self, start: int, stop: int) -> Lines:
        """Lines start … stop."""
        here = slice(start, stop)
        return Lines(self.commands[here], self.words[here], self.present[here], self.comments[here])


def rendered(lines: Lines, comments: list[bytes]) -> bytes:
    """The lines as ASCII, each ended by a newline; `comments` are whole lines.

    Numbers have no needless zeros; time and memory are linear in the number of lines.
    """
    table = np.frombuffer(b"".join(comments), dtype=np.uint8)
    bounds = np.cumsum([0, *map(len, comments)])
    extra = int(np.diff(bounds)[lines.comments].sum())
    out = np.empty(len(lines.commands) * MAX_LINE_BYTES + extra, dtype=np.uint8)
    size = _render(
        np.array(lines.commands),
        np.array(lines.words),
        np.array(lines.present),
        np.array(lines.comments),
        np.array(table),
        bounds,
        out,
    )
    return out[:size].tobytes()


@compiled(INTERNAL)
def _write_number(out: ByteArray, at: int, value: int, decimals: int) -> int:
    """Write value · 10^−decimals, without needless zeros, from byte `at` on; returns its end."""
    if value < 0:
        out[at] = 45  # minus
        at += 1
        value = -value
    while decimals > 0 and value % 10 == 0:
        value //= 10
        decimals -= 1
    digits = 1
    rest = value // 10
    while rest > 0:
        digits += 1
        rest //= 10
    digits = max(digits, decimals + 1)
    end = at + digits + (1 if decimals > 0 else 0)
    for digit in range(digits):
        if digit == decimals and decimals > 0:
            out[end - 1 - digit] = 46  # point
        shift = 1 if decimals > 0 and digit >= decimals else 0
        out[end - 1 - digit - shift] = 48 + value % 10
        value //= 10
    return end


@compiled(ENTRY)
def _render(
    commands: ConstIntArray,
    words: ConstIntRows,
    present: ConstBoolRows,
    comments: ConstIntArray,
    table: ConstByteArray,
    bounds: ConstIntArray,
    out: ByteArray,
) -> int:
    """Write lines, each after its comment from `table`, as ASCII to `out`; returns their bytes."""
    at = 0
    for line in range(len(commands)):
        for byte in range(bounds[comments[line]], bounds[comments[line] + 1]):
            out[at] = table[byte]
            at += 1
        out[at] = 71  # G
        at = _write_number(out, at + 1, commands[line], 0)
        for word in range(COLUMNS):
            if present[line, word]:
                out[at] = 32  # space
                out[at + 1] = LETTERS[word]
                at = _write_number(out, at + 2, words[line, word], DECIMALS[word])
        out[at] = 10  # newline
        at += 1
    return at
