"""Annotations say to numba what they say to a reader."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from numba import types

from v3dcad.geometry.compiled import arrays
from v3dcad.geometry.compiled.arrays import ConstFloatRows, FloatRows, IntArray
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.geometry.compiled.records import Record
from v3dcad.geometry.compiled.signatures import numba_type, signature_of

ARRAYS = [name for name in vars(arrays) if name.endswith(("Array", "Rows", "Stack"))]
ARRAYS.remove("NDArray")
DIMENSIONS = {"Array": 1, "Rows": 2, "Stack": 3}


class Bundle(NamedTuple):
    """Two arrays."""

    numbers: IntArray
    points: FloatRows


def mixed(bundle: Bundle, points: ConstFloatRows, pair: tuple[int, float]) -> bool:
    return len(points) > 0


def test_a_signature_has_the_types_of_the_annotations() -> None:
    points = types.Array(types.float64, 2, "C", readonly=True)
    bundle = types.NamedTuple([types.int64[::1], types.float64[:, ::1]], Bundle)
    pair = types.Tuple((types.int64, types.float64))
    assert signature_of(mixed) == types.boolean(bundle, points, pair)


@pytest.mark.parametrize(
    ("hint", "expected"),
    [
        (int, types.int64),
        (float, types.float64),
        (bool, types.boolean),
        (None, types.void),
        (tuple[int, int], types.UniTuple(types.int64, 2)),
        (list[float], types.List(types.float64)),
    ],
)
def test_plain_types(hint: object, expected: object) -> None:
    assert numba_type(hint) == expected


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_are_what_their_names_say(name: str) -> None:
    kind = numba_type(getattr(arrays, name))
    assert kind.layout == "C"
    assert kind.mutable != name.startswith("Const")
    assert [size for ending, size in DIMENSIONS.items() if name.endswith(ending)] == [kind.ndim]


def test_what_numba_does_not_know_is_refused() -> None:
    with pytest.raises(TypeError, match="annotate with a type"):
        numba_type(str)


@compiled({**ENTRY, "cache": False})
def total(bundle: Bundle) -> int:
    sums = 0
    for number in bundle.numbers:
        sums += number
    return sums


def test_compiled_functions_take_bundles() -> None:
    assert total(Bundle(np.arange(5), np.zeros((1, 2)))) == 10


class Counts(Record):
    """Two numbers."""

    rows: int
    total: int


@compiled({**ENTRY, "cache": False})
def count(counts: Counts, numbers: IntArray) -> None:
    for number in numbers:
        counts.rows += 1
        counts.total += number


def test_what_compiled_functions_write_into_records_shows() -> None:
    counts = Counts.of(total=10)
    assert (counts.rows, counts.total) == (0, 10)
    count(counts, np.arange(5))
    assert (counts.rows, counts.total) == (5, 20)
