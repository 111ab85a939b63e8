"""Numbers with their nouns, and points, as messages tell them."""

from __future__ import annotations

from collections.abc import Iterable

PLURALS = {"vertex": "vertices"}
"""Nouns whose plural has no rule."""


def counted(number: int, noun: str) -> str:
    """A number with its noun, which may follow an adjective: `1 layer`, `1,200 open edges`."""
    return f"{number:,} {noun if number == 1 else plural(noun)}"


def plural(noun: str) -> str:
    """The plural of an English noun: `layers`, `cavities`, `meshes`, `vertices`."""
    if noun in PLURALS:
        return PLURALS[noun]
    if noun.endswith("y") and noun[-2] not in "aeiou":
        return f"{noun[:-1]}ies"
    return f"{noun}es" if noun.endswith(("s", "x", "sh", "ch")) else f"{noun}s"


def point_words(point: Iterable[float]) -> str:
    """A point in mm: `(1, 2.5, -3)`. What lies within half a nanometre of 0 is rounding, and 0."""
    return "(" + ", ".join(f"{round(value, 6) + 0.0:.6g}" for value in point) + ")"
