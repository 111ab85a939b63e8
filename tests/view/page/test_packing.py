"""Packed arrays, unpacked by the text's own description."""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from v3dcad.view.page.packing import Packed, pack

numbers = st.lists(st.integers(0, 2**32 - 1), max_size=20)


def unpacked(packed: Packed) -> dict[str, NDArray[Any]]:
    """As packed.js does."""
    data = zlib.decompress(base64.b64decode(packed.text))
    return {
        name: np.frombuffer(data, np.dtype(kind).newbyteorder("<"), count, at)
        for name, (kind, count, at) in packed.table.items()
    }


@given(st.lists(numbers, max_size=5), st.lists(st.floats(-1e6, 1e6, width=32), max_size=20))
def test_what_was_packed_comes_out(wholes: list[list[int]], floats: list[float]) -> None:
    arrays: dict[str, NDArray[Any]] = {
        f"whole {k}": np.array(one, np.int64) for k, one in enumerate(wholes)
    }
    arrays["floats"] = np.array(floats, np.float32)
    packed = pack(arrays)
    found = unpacked(packed)
    assert list(found) == list(arrays)
    for name, array in arrays.items():
        assert np.array_equal(found[name], array)
        kind, _, at = packed.table[name]
        assert at % np.dtype(kind).itemsize == 0, "typed arrays begin at multiples of their size"
    assert packed == pack(arrays)


def test_whole_numbers_are_as_narrow_as_they_can_be() -> None:
    arrays = {f"{top}": np.array([0, top]) for top in (0, 255, 256, 65535, 65536)}
    kinds = [kind for kind, _, _ in pack(arrays).table.values()]
    assert kinds == ["uint8", "uint8", "uint16", "uint16", "uint32"]


def test_rows_come_one_after_the_other() -> None:
    found = unpacked(pack({"rows": np.array([[1, 2], [3, 4]]).T}))
    assert found["rows"].tolist() == [1, 3, 2, 4]
