"""How functions are compiled: a decorator, and the options that go with what a function does.

Signatures come from annotations (`signatures.py`), so that a function is compiled, or taken from
numba's cache, when its module is loaded. One that only compiled code calls has to wait until such
code is compiled: where all comes from the cache, it is in its callers already, and is not loaded.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from numba import njit

from v3dcad.geometry.compiled.signatures import signature_of

P = ParamSpec("P")
R = TypeVar("R")

Options = dict[str, Any]

ENTRY: Options = {
    "cache": True,
    "nogil": True,
    "boundscheck": False,
    "error_model": "numpy",
    "no_cfunc_wrapper": True,
}
"""Functions that Python calls, and that may make arrays. No fastmath, so that bits do not depend on
the machine, and no exceptions for divisions by zero, which would prevent inlining."""

ALLOCATING: Options = {**ENTRY, "no_cpython_wrapper": True}
"""Functions that may make arrays and that only compiled code calls: without an entry from Python,
which takes a second to compile. To call one from Python is to crash."""

UNCOUNTED: Options = {**ENTRY, "_nrt": False}
"""Functions that Python calls and that neither make arrays nor return any, so that references need
not be counted. Each access to a bundle of arrays would count one, atomically: a quarter of all
time."""

INTERNAL: Options = {**UNCOUNTED, "no_cpython_wrapper": True}
"""Most functions: only compiled code calls them, and they make no arrays."""

INLINED: Options = {**INTERNAL, "forceinline": True}
"""Short ones: passing many arrays would cost more than what they do."""


def compiled(options: Options) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Compile an annotated function by numba, with options of this module."""

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        if "no_cpython_wrapper" in options:
            return _when_called(function, options)
        made: Callable[P, R] = njit(signature_of(function), **options)(function)
        return made

    return decorate


def _when_called(function: Callable[P, R], options: Options) -> Callable[P, R]:
    """A function that is compiled, for its one signature, when a caller is."""
    made: Any = njit(**options)(function)
    template_for = made.get_call_template

    def call_template(arguments: Any, named: Any) -> Any:
        if not made.overloads:
            made.compile(signature_of(function))
            made.disable_compile()
        return template_for(arguments, named)

    made.get_call_template = call_template
    called: Callable[P, R] = made
    return called
