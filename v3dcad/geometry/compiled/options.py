"""How compiled functions are compiled: the options that numba gets, by what a function does."""

from __future__ import annotations

from typing import Any

COMPILED: dict[str, Any] = {
    "cache": True,
    "nogil": True,
    "boundscheck": False,
    "error_model": "numpy",
    "no_cfunc_wrapper": True,
}
"""How everything in the engine is compiled: no fastmath, so that bits do not depend on it, and no
exceptions for divisions by zero, which would be in the way of inlining."""

ALLOCATING = {**COMPILED, "no_cpython_wrapper": True}
"""How functions are that only compiled code calls: without a way in from Python, which
costs a second to compile. To call one from Python is to crash."""

UNCOUNTED = {**COMPILED, "_nrt": False}
"""How functions are that make no arrays and hand none back, so that references need not be counted.
Each look into a bundle of arrays would count one, atomically: a quarter of all time."""

INTERNAL = {**UNCOUNTED, "no_cpython_wrapper": True}
"""How most functions are: both."""

INLINED = {**INTERNAL, "forceinline": True}
"""How the small ones are: calls that pass many arrays cost more than they do."""
