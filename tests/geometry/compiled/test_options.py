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


THREADS = """
import sys, threading
import halves
sys.setswitchinterval(1e-6)
started, found = threading.Barrier(4), []
def ask():
    started.wait()
    found.append(halves.quarter(6))
threads = [threading.Thread(target=ask) for _ in range(4)]
for thread in threads: thread.start()
for thread in threads: thread.join()
print(found, len(halves.quarter.overloads))
"""


def test_threads_that_call_a_function_first_at_once_compile_it_once(
    said_twice: Callable[[str, str], list[str]],
) -> None:
    assert said_twice(SOURCE, THREADS) == ["[1.5, 1.5, 1.5, 1.5] 1\n"] * 2
