"""How functions are compiled: a decorator, and the options that go with what a function does.

Each function has one signature, that of its annotations (`signatures.py`), and is compiled, or
taken from numba's cache, when it is first called: by Python, or by code that is being compiled.
Code that comes from the cache has in it what it calls.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

from numba import njit
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher

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
"""Short ones, and those of the innermost loops: passing many arrays would cost more than what they
do."""


def compiled(options: Options) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Compile an annotated function by numba, with options of this module, once it is called."""

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        made: Any = njit(**options)(function)
        template_for = made.get_call_template

        def call_template(arguments: Any, named: Any) -> Any:
            compile_now(made)
            return template_for(arguments, named)

        def compiled_for(*_: Any, **__: Any) -> Any:
            compile_now(made)
            return made

        made.get_call_template = call_template
        made._compile_for_args = compiled_for  # asked for what to call, where nothing fits yet
        called: Callable[P, R] = made
        return called

    return decorate


def compile_now(function: Any) -> None:
    """Compile a function that `compiled` decorates, or take it from numba's cache.

    Where several threads ask at once, one does it, and the others wait.
    """
    with global_compiler_lock:
        if not function.overloads:
            function.compile(signature_of(function.py_func))
            function.disable_compile()
            vars(function).pop("_compile_for_args", None)  # now what does not fit is an error


def called_by_python(value: object) -> bool:
    """Whether something is a function that `compiled` decorates and that Python may call."""
    return isinstance(value, Dispatcher) and "no_cpython_wrapper" not in value.targetoptions
