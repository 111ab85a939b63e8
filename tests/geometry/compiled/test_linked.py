"""Linked functions: called by name, not taken into their callers, and found again from a cache."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numba import njit

from v3dcad.geometry.compiled.arrays import ConstFloatArray, FloatArray
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import ENTRY

UNCACHED = {**ENTRY, "cache": False}


@linked(UNCACHED)
def scaled(numbers: ConstFloatArray, count: int, factor: float) -> FloatArray:
    if count > len(numbers):
        raise ValueError("too many")
    found = np.empty(count)
    for k in range(count):
        found[k] = factor * numbers[k]
    return found


@njit(**UNCACHED)
def total(numbers, count):
    sums = 0.0
    for number in scaled(numbers, count, 2):
        sums += number
    return sums + scaled(numbers, 1, 0.5)[0]


def test_compiled_code_calls_it_with_whatever_can_be_converted() -> None:
    numbers = np.array([3.0, 4.0, 5.0])
    frozen = numbers.copy()
    frozen.flags.writeable = False
    assert scaled(frozen, 2, 3.0).tolist() == [9.0, 12.0]
    assert total(numbers, 2) == total(frozen, 2) == 15.5


def test_its_errors_are_its_callers() -> None:
    with pytest.raises(ValueError, match="too many"):
        total(np.zeros(3), 4)


def test_callers_hold_its_name_and_not_its_code() -> None:
    total(np.zeros(3), 3)
    for code in total.inspect_llvm().values():
        lines = [line for line in code.splitlines() if f"{__name__}.scaled" in line]
        assert any(line.startswith("declare") for line in lines)
        assert not any(line.startswith("define") for line in lines)
        assert "too many" not in code


def test_a_cached_caller_finds_it_in_another_process(
    said_twice: Callable[[str, str], list[str]],
) -> None:
    source = (
        "from numba import njit\n"
        "from v3dcad.geometry.compiled.linked import linked\n"
        "@linked({'cache': True})\n"
        "def half(number: float) -> float:\n"
        "    return number / 2\n"
        "@njit(cache=True)\n"
        "def quarter(number):\n"
        "    return half(half(number))\n"
    )
    show = (
        "import halves; print(halves.quarter(6.0), sum(halves.quarter.stats.cache_hits.values()))"
    )
    assert said_twice(source, show) == ["1.5 0\n", "1.5 1\n"]
