"""B-spline basis functions and their slopes, for compiled code.

Knots and poles lie in one array of numbers, the `heap`, at a given place: the evaluators of
`curves` and `surfaces` read all of a part's geometry from one heap.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic

from v3dcad.geometry.compiled.options import INTERNAL

FLOAT = types.float64
HEAP = types.Array(FLOAT, 1, "C", readonly=True)
ROWS = types.float64[:, ::1]
"""What compiled code takes: a number, the heap, and points it may write to."""


MOST_POLES = 26
"""In a span of a spline, along one parameter: OCCT makes none of a degree above 25."""


def _on_stack(typing_context: Any) -> tuple[Any, Any]:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return cgutils.alloca_once(builder, ir.DoubleType(), MOST_POLES)

    return types.CPointer(FLOAT)(), generate


on_stack: Any = intrinsic(_on_stack)
"""Where MOST_POLES numbers have room until the compiled function that asks for it returns."""


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


@njit(**INTERNAL)
def basis(heap, knots, span, degree, t, values, slopes):  # type: ignore[no-untyped-def]
    """Write values and slopes (degree + 1,) of the basis functions that do not vanish on a span.

    Piegl and Tiller, The NURBS Book (1997), A2.2 and equation 2.7.
    """
    values[0], slopes[0] = 1.0, 0.0
    for order in range(1, degree + 1):
        carried = 0.0
        for r in range(order):
            right = heap[knots + span + r + 1]
            left = heap[knots + span + r + 1 - order]
            if order == degree:
                share = degree * values[r] / (right - left)
                slopes[r] -= share
                slopes[r + 1] = share
            share = values[r] / (right - left)
            values[r] = carried + (right - t) * share
            carried = (t - left) * share
        values[order] = carried


@njit(**INTERNAL)
def wrapped(t, first, last, periodic):  # type: ignore[no-untyped-def]
    """The parameter t within first … last, where the curve is periodic."""
    if periodic and (t < first or t > last):
        return first + (t - first) % (last - first)
    return t
