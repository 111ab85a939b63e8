"""How meshes in text are encoded: UTF-8, with its mark or without, but not UTF-16."""

from __future__ import annotations

from v3dcad.errors import FormatError

UTF8_MARK = b"\xef\xbb\xbf"
UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")
LOOKED_AT = 4
"""Bytes of a file's head that tell."""


def mark_length(head: bytes, path: str) -> int:
    """How many bytes of a text's head (its first `LOOKED_AT`) are a mark and no text.

    Raises `FormatError` for UTF-16: it has its own mark, or every second byte of it is 0.
    """
    zeros = [byte == 0 for byte in head]
    if head.startswith(UTF16_MARKS) or zeros in ([False, True] * 2, [True, False] * 2):
        raise FormatError("text in UTF-16: save it as UTF-8, or export it again", path=path)
    return len(UTF8_MARK) if head.startswith(UTF8_MARK) else 0
