"""What Python code gives: as the numbers and arrays it stands for, or an error that names it.

NumPy's scalars and anything that is a real number to Python are numbers here; text and booleans
are none. No function changes what it is given.
"""

from __future__ import annotations

import math
import operator
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from v3dcad.errors import OutOfRangeError, SettingError

if TYPE_CHECKING:
    from v3dcad.model import Floats, Ints


def finite(name: str, value: Any, unit: str = "mm") -> float:
    """A finite number; `SettingError` for anything else."""
    number = _number(value)
    if number is None or not math.isfinite(number):
        raise SettingError(name, f"{name} {_shown(value)}: give a finite number, {unit}")
    return number


def above_zero(name: str, value: Any, unit: str = "mm") -> float:
    """A finite number above 0, such as a thickness; `SettingError` for anything else.

    A factor has no `unit`: an empty text.
    """
    number = _number(value)
    if number is None or not 0 < number < math.inf:
        wanted = f"a number above 0 {unit}".rstrip()
        raise SettingError(name, f"{name} {_shown(value)}: give {wanted}")
    return number


def place(name: str, index: Any, count: int, things: str, *, from_end: bool = False) -> int:
    """The number of one of `count` things (in words), from 0; `from_end` takes −1 for the last.

    `OutOfRangeError` for a number of none, `SettingError` for what is no whole number.
    """
    try:
        found = operator.index(index)
    except TypeError:
        found = None
    if found is None or isinstance(index, bool):
        raise SettingError(name, f"{name} {_shown(index)}: give a whole number")
    if not (-count if from_end else 0) <= found < count:
        raise OutOfRangeError(name, f"{name} {found}: the {things} are 0 to {count - 1}")
    return found % count


def numbers(name: str, values: Any, count: int | None = None) -> Floats:
    """(k,) finite numbers from a sequence of them, k = `count` if given; else `SettingError`."""
    found = _array(values)
    if found is None or found.ndim != 1 or count not in (None, len(found)):
        many = "" if count is None else f"{count} "
        raise SettingError(name, f"{name} {_shown(values)}: give a sequence of {many}numbers")
    if not np.isfinite(found).all():
        raise SettingError(name, f"{name} {_shown(values)}: not all of them are finite numbers")
    return found


def rows(name: str, values: Any, *columns: str) -> Floats:
    """(k, n) numbers from rows of them, one number for each of the columns ("x, y, z").

    Where several kinds of columns are given, rows may be of any. `SettingError` for anything else;
    whether the numbers are finite is left to the caller.
    """
    widths = [kind.count(",") + 1 for kind in columns]
    found = _array(values)
    if found is not None and found.shape == (0,):
        found = found.reshape(0, widths[0])
    if found is None or found.ndim != 2 or found.shape[1] not in widths:
        raise SettingError(name, f"{name}{_shape(values)}: give rows of {', or of '.join(columns)}")
    return found


def whole_rows(name: str, values: Any, columns: str) -> Ints:
    """(k, n) whole numbers, as `rows`; those of floating point must be whole."""
    found = rows(name, values, columns)
    if not np.array_equal(found, np.rint(found)):
        raise SettingError(name, f"{name}: not all of them are whole numbers")
    return found.astype(np.int64)


def _number(value: Any) -> float | None:
    """The value as a number, where it is one; text and booleans are none."""
    if getattr(value, "shape", None) == ():
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, Real):
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _array(values: Any) -> Floats | None:
    """The values as an array of numbers, where they are one."""
    try:
        found = np.asarray(values)
    except ValueError:  # rows of unequal length
        return None
    if found.size and found.dtype.kind not in "iuf":
        return None
    return found.astype(np.float64)


def _shape(values: Any) -> str:
    """The shape of an array, as words after its name."""
    found = _array(values)
    if found is None:
        return " are not numbers in rows of equal length"
    return f" of shape {found.shape}"


def _shown(value: Any) -> str:
    """A value as it is written in Python, cut off where it is long."""
    text = repr(value.item() if getattr(value, "shape", None) == () else value)
    return text if len(text) <= 40 else f"{text[:40]}…"
