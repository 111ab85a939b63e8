"""B-spline basis functions and their slopes, for compiled code.

Knots and poles lie in the `coefficients` of a part (see `curves`), at a given index.
"""

from __future__ import annotations

from v3dcad.geometry.compiled.arrays import ConstFloatArray
from v3dcad.geometry.compiled.intrinsics import StackArray
from v3dcad.geometry.compiled.options import INTERNAL, compiled


@compiled(INTERNAL)
def span_of(coefficients: ConstFloatArray, knots: int, count: int, degree: int, t: float) -> int:
    """The i with knot i ≤ t < knot i + 1, of a clamped knot vector of `count` knots at `knots`.

    Before the first knot and beyond the last the end spans are taken.
    """
    low, high = degree, count - degree - 1
    while high - low > 1:
        middle = (low + high) // 2
        if t < coefficients[knots + middle]:
            high = middle
        else:
            low = middle
    while low > degree and coefficients[knots + low] == coefficients[knots + low + 1]:
        low -= 1
    return low


@compiled(INTERNAL)
def basis(
    coefficients: ConstFloatArray,
    knots: int,
    span: int,
    degree: int,
    t: float,
    values: StackArray,
    slopes: StackArray,
) -> None:
    """Write values and slopes (degree + 1,) of the basis functions that do not vanish on a span.

    Piegl and Tiller, The NURBS Book (1997), A2.2 and equation 2.7.
    """
    values[0], slopes[0] = 1.0, 0.0
    for order in range(1, degree + 1):
        carried = 0.0
        for r in range(order):
            right = coefficients[knots + span + r + 1]
            left = coefficients[knots + span + r + 1 - order]
            if order == degree:
                share = degree * values[r] / (right - left)
                slopes[r] -= share
                slopes[r + 1] = share
            share = values[r] / (right - left)
            values[r] = carried + (right - t) * share
            carried = (t - left) * share
        values[order] = carried


@compiled(INTERNAL)
def wrapped(t: float, first: float, last: float, periodic: bool) -> float:
    """The parameter t within first … last, where the curve is periodic."""
    if periodic and (t < first or t > last):
        return first + (t - first) % (last - first)
    return t
