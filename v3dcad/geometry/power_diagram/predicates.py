"""Exact predicates on integer points: orientation, and the power test with no ties.

Coordinates stay below 2²⁸ and weights below 2⁵³ (see `grid.py` and `epochs.py`), so that
orientation fits 64 bits.
The power test, a 3 × 3 determinant, is summed in 128 bits. Where it is zero, four weighted points
are orthogonal to one circle, and weights perturbed by infinitesimals decide: point 0 by the
largest, point 1 by an infinitely smaller one, and so on (Edelsbrunner and Mücke, "Simulation of
Simplicity", ACM Trans. Graphics 1990). The predicate is then never zero unless all four points
are collinear, and every set of distinct points has exactly one regular triangulation.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic

from v3dcad.geometry.compiled.arrays import POINT_ROWS, WORD
from v3dcad.geometry.compiled.options import INLINED


@intrinsic
def sign_of_sum(
    typing_context: Any, a: Any, b: Any, c: Any, d: Any, e: Any, f: Any
) -> tuple[Any, Any]:
    """The exact sign (−1, 0, 1) of ab + cd + ef for 64-bit integers, summed in 128 bits."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        wide, word = ir.IntType(128), ir.IntType(64)
        p, q, r, s, t, u = (builder.sext(argument, wide) for argument in arguments)
        total = builder.add(builder.add(builder.mul(p, q), builder.mul(r, s)), builder.mul(t, u))
        zero = ir.Constant(wide, 0)
        positive = builder.zext(builder.icmp_signed(">", total, zero), word)
        negative = builder.zext(builder.icmp_signed("<", total, zero), word)
        return builder.sub(positive, negative)

    return types.int64(*[types.int64] * 6), generate


@njit(WORD(POINT_ROWS, WORD, WORD, WORD), **INLINED)
def orientation(points, a, b, c):  # type: ignore[no-untyped-def]
    """Twice the signed area of points a, b, c: positive where they turn counter-clockwise."""
    x, y = points[a, 0], points[a, 1]
    return (points[b, 0] - x) * (points[c, 1] - y) - (points[b, 1] - y) * (points[c, 0] - x)


@njit(types.boolean(POINT_ROWS, WORD, WORD, WORD, WORD), **INLINED)
def conflicts(points, a, b, c, d):  # type: ignore[no-untyped-def]
    """Whether d lies inside the orthocircle of the counter-clockwise triangle a, b, c.

    That is: whether d, lifted to x² + y² − w, lies below the plane of the three, so that the
    triangle is not regular beside d.
    """
    x, y, weight = points[d, 0], points[d, 1], points[d, 2]
    ax, ay = points[a, 0] - x, points[a, 1] - y
    bx, by = points[b, 0] - x, points[b, 1] - y
    cx, cy = points[c, 0] - x, points[c, 1] - y
    of_a, of_b, of_c = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
    sign: Any = sign_of_sum(  # type: ignore[call-arg]
        ax * ax + ay * ay - points[a, 2] + weight,
        of_a,
        bx * bx + by * by - points[b, 2] + weight,
        of_b,
        cx * cx + cy * cy - points[c, 2] + weight,
        of_c,
    )
    if sign != 0:
        return sign > 0
    # The derivative by the weight of the lowest-numbered point that has any effect.
    first, answer = -1, False
    if of_a != 0:
        first, answer = a, of_a < 0
    if of_b != 0 and (first < 0 or b < first):
        first, answer = b, of_b < 0
    if of_c != 0 and (first < 0 or c < first):
        first, answer = c, of_c < 0
    of_d = of_a + of_b + of_c
    if of_d != 0 and (first < 0 or d < first):
        answer = of_d > 0
    return answer
