"""The types of the arrays and numbers that compiled functions take."""

from __future__ import annotations

from numba import types

WORD = types.int64
POINT_ROWS = types.int64[:, ::1]

FLOAT = types.float64
FLOATS, FLOAT_ROWS = types.float64[::1], types.float64[:, ::1]
INTS, INT_ROWS = types.int64[::1], types.int64[:, ::1]
ROW, ROWS = types.int32[::1], types.int32[:, ::1]
