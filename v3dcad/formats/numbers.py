"""Numbers as text: written to the last bit, read in every form that C's `strtod` knows."""

from __future__ import annotations

import re

NUMBER = (
    r"[+-]?(?:0[xX](?:[0-9a-fA-F]++(?:\.[0-9a-fA-F]*+)?+|\.[0-9a-fA-F]++)(?:[pP][+-]?[0-9]++)?+"
    r"|(?:[0-9]++(?:\.[0-9]*+)?+|\.[0-9]++)(?:[eE][+-]?[0-9]++)?+)"
)
"""Decimal, with or without point and exponent, or hexadecimal; ASCII only, and never inf or nan.
Possessive throughout, so that no text takes more than one pass."""

MAX_CHARACTERS = 800
"""Characters; no double needs more, in any of these forms."""

_WHOLE = re.compile(NUMBER)


def number_text(value: float) -> str:
    """The shortest decimal that reads back to the same bits, without a trailing `.0`."""
    return repr(float(value)).removesuffix(".0")


def matched_number(word: str) -> float:
    """The value of a word that `NUMBER` matches; infinite where it is beyond a double."""
    try:
        return float(word)
    except ValueError:
        return _from_hex(word)


def number_in(word: str) -> float | None:
    """The value of a word; None where it is not a number."""
    if len(word) > MAX_CHARACTERS or not _WHOLE.fullmatch(word):
        return None
    return matched_number(word)


def _from_hex(word: str) -> float:
    try:
        return float.fromhex(word)
    except OverflowError:
        return float("inf")
