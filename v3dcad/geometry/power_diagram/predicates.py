"""Exact predicates on integer points: orientation, and the power test with no ties.

Coordinates stay below 2²⁸ and weights below 2⁵³ (see `grid.py`), so that orientation fits 64 bits.
The power test, a 3 × 3 determinant, is summed in 128 bits. Where it is zero, four weighted points
are orthogonal to one circle, and weights perturbed by infinitesimals decide: that of the point
with the lowest number by the largest, that of the next by an infinitely smaller one, and so on
(Edelsbrunner and Mücke, "Simulation of Simplicity", ACM Trans. Graphics 1990). The predicate is
then never zero unless all four points are collinear, and every set of distinct points has exactly
one regular triangulation.
"""

from __future__ import annotations

from v3dcad.geometry.compiled.arrays import IntRows
from v3dcad.geometry.compiled.intrinsics import sign_of_sum
from v3dcad.geometry.compiled.options import INLINED, compiled

WEIGHT, NUMBER = 2, 3
"""Columns of points (p, 4), after x and y: the weight, and the number by which ties are broken,
which goes with the site, whatever row its point has."""

LAST = (1 << 63) - 1
"""Above every number."""


@compiled(INLINED)
def orientation(points: IntRows, a: int, b: int, c: int) -> int:
    """Twice the signed area of points a, b, c: positive where they turn counter-clockwise."""
    x, y = points[a, 0], points[a, 1]
    return (points[b, 0] - x) * (points[c, 1] - y) - (points[b, 1] - y) * (points[c, 0] - x)


@compiled(INLINED)
def conflicts(points: IntRows, a: int, b: int, c: int, d: int) -> bool:
    """Whether d lies inside the orthocircle of the counter-clockwise triangle a, b, c.

    That is: whether d, lifted to x² + y² − w, lies below the plane of the three, so that the
    triangle is not regular beside d.
    """
    x, y, weight = points[d, 0], points[d, 1], points[d, WEIGHT]
    ax, ay = points[a, 0] - x, points[a, 1] - y
    bx, by = points[b, 0] - x, points[b, 1] - y
    cx, cy = points[c, 0] - x, points[c, 1] - y
    of_a, of_b, of_c = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
    sign = sign_of_sum(
        ax * ax + ay * ay - points[a, WEIGHT] + weight,
        of_a,
        bx * bx + by * by - points[b, WEIGHT] + weight,
        of_b,
        cx * cx + cy * cy - points[c, WEIGHT] + weight,
        of_c,
    )
    if sign != 0:
        return sign > 0
    # The derivative by the weight of the lowest-numbered point that has any effect.
    first, answer = LAST, False
    if of_a != 0:
        first, answer = points[a, NUMBER], of_a < 0
    if of_b != 0 and points[b, NUMBER] < first:
        first, answer = points[b, NUMBER], of_b < 0
    if of_c != 0 and points[c, NUMBER] < first:
        first, answer = points[c, NUMBER], of_c < 0
    of_d = of_a + of_b + of_c
    if of_d != 0 and points[d, NUMBER] < first:
        answer = of_d > 0
    return answer
