"""Bytes as lines of text and back: LZMA, then base 85; length and check sum are stated beside."""

from __future__ import annotations

import base64
import lzma
import zlib
from typing import Any

MAX_UNPACKED_BYTES = 1 << 27
"""128 MiB: largest size that packed lines may unpack to, and so the memory that they take."""

WIDTH = 100
"""Characters of one line."""

MARK = ":"
"""Begins each line. It is no digit of base 85, so that no line can be taken for a section, a
comment or the word `solid`, whatever the bytes are."""


def _filters(size: int) -> list[dict[str, Any]]:
    """LZMA's settings for a number of bytes; not stored, so that no file can claim more memory."""
    dictionary = max(1 << 12, min(size, 1 << 24))
    return [
        {"id": lzma.FILTER_LZMA1, "dict_size": dictionary, "lc": 3, "lp": 0, "pb": 0}
        | {"mode": lzma.MODE_NORMAL, "nice_len": 273, "mf": lzma.MF_BT4, "depth": 512}
    ]


def packed(data: bytes) -> list[str]:
    """Bytes as lines of text."""
    pressed = lzma.compress(data, lzma.FORMAT_RAW, filters=_filters(len(data)))
    digits = base64.b85encode(pressed).decode()
    return [MARK + digits[at : at + WIDTH] for at in range(0, len(digits), WIDTH)]


def checked(data: bytes) -> str:
    """The check sum of bytes before packing: CRC-32 as eight hexadecimal digits."""
    return f"{zlib.crc32(data):08x}"


def unpacked(digits: str, size: int, check: str) -> bytes:
    """The `size` bytes in what `packed` made, joined without marks; takes no more memory than that.

    `ValueError` says what is wrong where they are damaged, longer or shorter than stated, or
    stated to be longer than `MAX_UNPACKED_BYTES`.
    """
    if size > MAX_UNPACKED_BYTES:
        raise ValueError(f"states {size} bytes, more than the {MAX_UNPACKED_BYTES} allowed")
    expander = lzma.LZMADecompressor(lzma.FORMAT_RAW, filters=_filters(size))
    try:
        data = expander.decompress(base64.b85decode(digits), max_length=size + 1)
    except (ValueError, lzma.LZMAError) as error:
        raise ValueError("its packed lines are damaged") from error
    if len(data) != size:
        more = "more" if len(data) > size else f"{len(data)}"
        raise ValueError(f"states {size} bytes and contains {more}")
    if checked(data) != check:
        raise ValueError("its packed lines are damaged: their CRC-32 does not match")
    return data
