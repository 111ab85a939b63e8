"""Functions that only compiled code calls: compiled with their callers, and not loaded again."""

from __future__ import annotations

from collections.abc import Callable

SOURCE = """
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled

@compiled(INTERNAL)
def half(number: float) -> float:
    return number / 2

@compiled(ENTRY)
def quarter(number: float) -> float:
    return half(half(number + 1) - 1 / 2)
"""
SHOW = "import halves; print(halves.quarter(6), list(halves.half.overloads))"


def test_an_inner_function_has_its_one_signature_and_is_not_loaded_where_its_caller_is_cached(
    said_twice: Callable[[str, str], list[str]],
) -> None:
    assert said_twice(SOURCE, SHOW) == ["1.5 [(float64,)]\n", "1.5 []\n"]
