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


AT_ONCE = """
import threading, time, halves
from numba.core.compiler_lock import global_compiler_lock

found = []
threads = [threading.Thread(target=lambda: found.append(halves.quarter(6))) for _ in range(3)]
with global_compiler_lock:
    for thread in threads:
        thread.start()
    time.sleep(0.3)  # all of them have seen by now that it is not compiled
for thread in threads:
    thread.join()
print(found)
"""


def test_threads_that_need_a_function_at_once_get_it(
    said_twice: Callable[[str, str], list[str]],
) -> None:
    assert said_twice(SOURCE, AT_ONCE) == ["[1.5, 1.5, 1.5]\n"] * 2
