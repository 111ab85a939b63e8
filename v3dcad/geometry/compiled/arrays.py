"""The arrays that compiled functions take, as annotations: what mypy knows and what numba knows.

All are contiguous, the last index running fastest. A function only reads arrays called `Const…`.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numba import types
from numpy.typing import NDArray

Word = Annotated[int, types.uint64]
"""64 bits without a sign."""

IntArray = Annotated[NDArray[np.int64], types.int64[::1]]
IntRows = Annotated[NDArray[np.int64], types.int64[:, ::1]]
Int16Array = Annotated[NDArray[np.int16], types.int16[::1]]
Int32Array = Annotated[NDArray[np.int32], types.int32[::1]]
Int32Rows = Annotated[NDArray[np.int32], types.int32[:, ::1]]
Int32Stack = Annotated[NDArray[np.int32], types.int32[:, :, ::1]]
FloatArray = Annotated[NDArray[np.float64], types.float64[::1]]
FloatRows = Annotated[NDArray[np.float64], types.float64[:, ::1]]
FloatStack = Annotated[NDArray[np.float64], types.float64[:, :, ::1]]
WordArray = Annotated[NDArray[np.uint64], types.uint64[::1]]
ByteArray = Annotated[NDArray[np.uint8], types.uint8[::1]]
BoolArray = Annotated[NDArray[np.bool_], types.boolean[::1]]
BoolRows = Annotated[NDArray[np.bool_], types.boolean[:, ::1]]


def _read_only(number: types.Type, dimensions: int) -> types.Type:
    return types.Array(number, dimensions, "C", readonly=True)


ConstInt8Array = Annotated[NDArray[np.int8], _read_only(types.int8, 1)]
ConstIntArray = Annotated[NDArray[np.int64], _read_only(types.int64, 1)]
ConstIntRows = Annotated[NDArray[np.int64], _read_only(types.int64, 2)]
ConstFloatArray = Annotated[NDArray[np.float64], _read_only(types.float64, 1)]
ConstFloatRows = Annotated[NDArray[np.float64], _read_only(types.float64, 2)]
ConstFloatStack = Annotated[NDArray[np.float64], _read_only(types.float64, 3)]
ConstByteArray = Annotated[NDArray[np.uint8], _read_only(types.uint8, 1)]
ConstBoolRows = Annotated[NDArray[np.bool_], _read_only(types.boolean, 2)]
