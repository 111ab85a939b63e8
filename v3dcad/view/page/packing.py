"""Arrays as text, small enough to lie in a page."""

from __future__ import annotations

import base64
import zlib
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

ALIGNMENT = 4
"""Bytes: arrays begin at multiples of it, as JavaScript's typed arrays want it."""


class Packed(NamedTuple):
    """Arrays in one piece of text."""

    table: dict[str, list[Any]]
    """of each array its type, how many numbers it has, and at which byte it begins"""
    text: str
    """base64 of the deflated bytes, little-endian"""


def pack(arrays: Mapping[str, NDArray[Any]]) -> Packed:
    """Arrays of float32 and whole numbers from 0, packed in their order, row after row.

    Whole numbers take 1, 2 or 4 bytes, as the largest needs. The same arrays make the same text.
    """
    table: dict[str, list[Any]] = {}
    pieces: list[bytes] = []
    length = 0
    for name, array in arrays.items():
        narrow = narrowed(array)
        data = narrow.astype(narrow.dtype.newbyteorder("<")).tobytes()
        table[name] = [narrow.dtype.name, narrow.size, length]
        padded = data + bytes(-len(data) % ALIGNMENT)
        pieces.append(padded)
        length += len(padded)
    deflated = zlib.compress(b"".join(pieces), 9)
    return Packed(table, base64.b64encode(deflated).decode())


def narrowed(array: NDArray[Any]) -> NDArray[Any]:
    """Whole numbers in the narrowest type that holds them all; others as they are."""
    if array.dtype.kind == "f":
        return array
    largest = int(array.max(initial=0))
    return array.astype(np.min_scalar_type(largest))
