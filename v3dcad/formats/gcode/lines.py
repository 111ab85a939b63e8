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
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.model import Ints

COLUMNS = 7
PLACE, CENTRE, E, F = slice(0, 3), slice(3, 5), 5, 6
"""Columns of `Lines.words`: X Y Z, I J, E and F."""
LETTERS = np.frombuffer(b"XYZIJEF", dtype=np.uint8)
DECIMALS = np.array([3, 3, 3, 3, 3, 5, 0])
"""How many decimals each word has: X12.345 is 12345 in `Lines.words`."""
LONGEST = 8 + COLUMNS * 22
"""No line is longer: a command and seven words of up to 19 digits."""

Text = NDArray[np.uint8]


@dataclass(slots=True)
class Lines:
    """G-code commands and what they say, line by line."""

    commands: Ints
    """(n,) the number after G"""
    words: Ints
    """(n, 7) values of X Y Z I J E F as integers with the decimals of `DECIMALS`"""
    said: NDArray[np.bool_]
    """(n, 7) which words the line has"""
    remarks: Ints
    """(n,) which of the remarks stands before the line; 0 for none"""

    def part(self, start: int, stop: int) -> Lines:
        """Lines start … stop."""
        here = slice(start, stop)
        return Lines(self.commands[here], self.words[here], self.said[here], self.remarks[here])


def rendered(lines: Lines, remarks: list[bytes]) -> bytes:
    """The lines as ASCII, each ended by a newline; `remarks` are whole lines.

    Numbers have no needless zeros; time and memory are linear in the number of lines.
    """
    table = np.frombuffer(b"".join(remarks), dtype=np.uint8)
    bounds = np.cumsum([0, *map(len, remarks)])
    extra = int(np.diff(bounds)[lines.remarks].sum())
    out = np.empty(len(lines.commands) * LONGEST + extra, dtype=np.uint8)
    size = _render(
        np.array(lines.commands),
        np.array(lines.words),
        np.array(lines.said),
        np.array(lines.remarks),
        np.array(table),
        bounds,
        LETTERS.copy(),
        DECIMALS,
        out,
    )
    return out[:size].tobytes()


@compiled(ENTRY)
def _write_number(out: ByteArray, at: int, value: int, decimals: int) -> int:
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
    for place in range(digits):
        if place == decimals and decimals > 0:
            out[end - 1 - place] = 46  # point
        shift = 1 if decimals > 0 and place >= decimals else 0
        out[end - 1 - place - shift] = 48 + value % 10
        value //= 10
    return end


@compiled(ENTRY)
def _render(
    commands: ConstIntArray,
    words: ConstIntRows,
    said: ConstBoolRows,
    remarks: ConstIntArray,
    table: ConstByteArray,
    bounds: ConstIntArray,
    letters: ConstByteArray,
    decimals: ConstIntArray,
    out: ByteArray,
) -> int:
    at = 0
    for line in range(len(commands)):
        for place in range(bounds[remarks[line]], bounds[remarks[line] + 1]):
            out[at] = table[place]
            at += 1
        out[at] = 71  # G
        at = _write_number(out, at + 1, commands[line], 0)
        for word in range(len(letters)):
            if said[line, word]:
                out[at] = 32  # space
                out[at + 1] = letters[word]
                at = _write_number(out, at + 2, words[line, word], decimals[word])
        out[at] = 10  # newline
        at += 1
    return at
