"""Signatures for numba, read from a function's annotations: types are written once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, get_args, get_origin, get_type_hints

from numba import from_dtype, types

from v3dcad.geometry.compiled.records import Record

SCALARS: dict[Any, Any] = {
    int: types.int64,
    float: types.float64,
    bool: types.boolean,
    None: types.void,
    type(None): types.void,
}
"""What numba calls Python's own types: numbers are of 64 bits."""


def numba_type(hint: Any) -> Any:
    """Numba's type for an annotation.

    Takes `int`, `float`, `bool`, `None`, tuples and lists of these, the arrays of `arrays.py`,
    records, and named tuples whose fields are annotated so. Raises `TypeError` for anything else.
    """
    if hint in SCALARS:
        return SCALARS[hint]
    origin = get_origin(hint)
    if origin is Annotated:
        return get_args(hint)[1]
    if origin is tuple:
        return types.Tuple(tuple(map(numba_type, get_args(hint))))
    if origin is list:
        return types.List(numba_type(get_args(hint)[0]))
    if isinstance(hint, type) and issubclass(hint, Record):
        return from_dtype(hint.layout())
    if isinstance(hint, type) and issubclass(hint, tuple) and hasattr(hint, "_fields"):
        fields = get_type_hints(hint, include_extras=True)
        return types.BaseTuple.from_types(list(map(numba_type, fields.values())), hint)
    raise TypeError(f"compiled functions take no {hint!r}: annotate with a type of arrays.py")


def signature_of(function: Callable[..., Any]) -> Any:
    """Numba's signature for an annotated function, all of whose parameters go by position."""
    hints = get_type_hints(function, include_extras=True)
    result = numba_type(hints.pop("return"))
    return result(*map(numba_type, hints.values()))
