"""How segments and places lie to a convex cell, told by its corners in counter-clockwise order."""

from __future__ import annotations

from v3dcad.geometry.compiled.arrays import ConstFloatRows, ConstIntArray, FloatRows
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled

GRAZING = 1e-6
"""mm: contours so near to a cell's box are looked at."""
NEARLY = 1e-4
"""The share of the way from a cell's corner to its middle at which the corner is looked at."""


@compiled(UNCOUNTED)
def look_inside(corners: ConstFloatRows, first: ConstIntArray, seen: FloatRows) -> None:
    """Fill in a place inside each convex cell, near its first corner; there are cells without."""
    for cell in range(len(seen)):
        low, high = first[cell], first[cell + 1]
        for axis in range(2 if low < high else 0):
            middle = 0.0
            for k in range(low, high):
                middle += corners[k, axis]
            middle /= high - low
            seen[cell, axis] = corners[low, axis] + NEARLY * (middle - corners[low, axis])


@compiled(INTERNAL)
def crossing(
    now: ConstFloatRows, low: int, high: int, ax: float, ay: float, bx: float, by: float
) -> tuple[bool, bool, float, int, float, int]:
    """How a segment a → b meets a convex cell, the corners low … high of `now`.

    Whether a and b lie inside; the share of the way at which it enters and through which side;
    and the same of where it leaves. It misses the cell where it leaves before it enters.
    """
    a_inside, b_inside = True, True
    enters, leaves, way_in, way_out = 0.0, 1.0, -1, -1
    for k in range(low, high):
        after = k + 1 if k + 1 < high else low
        dx, dy = now[after, 0] - now[k, 0], now[after, 1] - now[k, 1]
        a = dx * (ay - now[k, 1]) - dy * (ax - now[k, 0])
        b = dx * (by - now[k, 1]) - dy * (bx - now[k, 0])
        if a < 0:
            a_inside = False
            if b < 0:
                enters, leaves = 1.0, 0.0
            elif a / (a - b) >= enters:
                enters, way_in = a / (a - b), k
        if b < 0:
            b_inside = False
            if a >= 0 and a / (a - b) <= leaves:
                leaves, way_out = a / (a - b), k
    return a_inside, b_inside, enters, way_in, leaves, way_out


@compiled(INTERNAL)
def comes_near(
    rim: ConstFloatRows,
    begin: int,
    end: int,
    left: float,
    bottom: float,
    right: float,
    top: float,
) -> bool:
    """Whether a segment's box comes so near to a cell's that the segment has to be looked at."""
    ax, ay, bx, by = rim[begin, 0], rim[begin, 1], rim[end, 0], rim[end, 1]
    across = (max(ax, bx) >= left - GRAZING) & (min(ax, bx) <= right + GRAZING)
    along = (max(ay, by) >= bottom - GRAZING) & (min(ay, by) <= top + GRAZING)
    return across & along


@compiled(INTERNAL)
def place_along(now: ConstFloatRows, low: int, high: int, side: int, x: float, y: float) -> float:
    """Where (x, y) lies along a cell's sides: the side's number and the share of it passed."""
    after = side + 1 if side + 1 < high else low
    dx, dy = now[after, 0] - now[side, 0], now[after, 1] - now[side, 1]
    share = ((x - now[side, 0]) * dx + (y - now[side, 1]) * dy) / max(dx * dx + dy * dy, 1e-300)
    return side - low + min(max(share, 0.0), 1.0 - 1e-15)
