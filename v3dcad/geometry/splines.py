"""B-spline basis functions and their slopes, for compiled code.

Knots and poles lie in one array of numbers, the `heap`, at a given place: the evaluators of
`curves` and `surfaces` read all of a part's geometry from one heap.
"""

from __future__ import annotations

import numpy as np
from numba import njit, types

from v3dcad.geometry.exact import ALLOCATING, INTERNAL

FLOAT = types.float64
HEAP = types.Array(FLOAT, 1, "C", readonly=True)
ROWS = types.float64[:, ::1]
"""What compiled code takes: a number, the heap, and points it may write to."""


@njit(**INTERNAL)
def span_of(heap, knots, count, degree, t):  # type: ignore[no-untyped-def]
    """The i with knot i ≤ t < knot i + 1, of a clamped knot vector of `count` knots at `knots`.

    Before the first and beyond the last knot the end spans go on.
    """
    low, high = degree, count - degree - 1
    while high - low > 1:
        middle = (low + high) // 2
        if t < heap[knots + middle]:
            high = middle
        else:
            low = middle
    while low > degree and heap[knots + low] == heap[knots + low + 1]:
        low -= 1
    return low


@njit(**ALLOCATING)
def basis(heap, knots, span, degree, t):  # type: ignore[no-untyped-def]
    """Values and slopes (degree + 1,) of the basis functions that do not vanish on a span.

    Piegl and Tiller, The NURBS Book (1997), A2.2 and equation 2.7.
    """
    values = np.zeros(degree + 1)
    lower = np.zeros(degree + 1)
    slopes = np.zeros(degree + 1)
    values[0] = 1.0
    for order in range(1, degree + 1):
        if order == degree:
            for r in range(degree):
                lower[r] = values[r]
        carried = 0.0
        for r in range(order):
            right = heap[knots + span + r + 1]
            left = heap[knots + span + r + 1 - order]
            share = values[r] / (right - left)
            values[r] = carried + (right - t) * share
            carried = (t - left) * share
        values[order] = carried
    for r in range(degree):
        share = (
            degree * lower[r] / (heap[knots + span + r + 1] - heap[knots + span + r + 1 - degree])
        )
        slopes[r] -= share
        slopes[r + 1] += share
    return values, slopes


@njit(**INTERNAL)
def wrapped(t, first, last, periodic):  # type: ignore[no-untyped-def]
    """The parameter t within first … last, where the curve is periodic."""
    if periodic and (t < first or t > last):
        return first + (t - first) % (last - first)
    return t
