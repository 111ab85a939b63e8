"""How far from a place of a bead its own room goes, and what of a notch at a bend is its own.

On either side of a point of a bead's line this ends where a circle that touches the line there
meets another line: at their medial axis (Blum 1967).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from v3dcad.geometry.compiled.arrays import FloatRows, IntArray
from v3dcad.geometry.compiled.options import INLINED, INTERNAL, compiled
from v3dcad.geometry.loops.reach import within
from v3dcad.geometry.loops.segments import Segments

TOUCHING = 1 - 1e-6
"""Bead widths: lines as far apart as they should be take no room from each other."""
AHEAD = 1e-12
"""mm: what is less far ahead lies beside or behind."""


class Near(NamedTuple):
    """What is near a bead, as far as it is known; room for as many as there are."""

    stamp: IntArray
    """(n,) for `beside`"""
    found: IntArray
    """(n + 1,) beads that may be near"""
    contacts: FloatRows
    """(n, 2) shares of the bead between which others share its room"""
    others: IntArray
    """(n,) beads that are near a piece of it"""
    spans: FloatRows
    """(n, 2) shares of the piece between which each is"""


@compiled(INLINED)
def around(
    segments: Segments,
    width: float,
    near: Near,
    found: int,
    one: int,
    ax: float,
    ay: float,
    bx: float,
    by: float,
) -> int:
    """How many others, of those `found`, are near a piece a → b of a bead; `near` has them."""
    count = 0
    for k in range(found):
        other = near.found[k]
        low, high = within(ax, ay, bx, by, segments.ends, other, TOUCHING * width)
        if other != one and low <= high:
            near.others[count] = other
            near.spans[count, 0], near.spans[count, 1] = low, high
            count += 1
    return count


@compiled(INLINED)
def _room(square: float, mixed: float, rest: float, ahead: float, rise: float) -> float:
    """Radius of the circle that touches a place p, its middle towards a unit n, and a segment v.

    The least of |q − p|² ÷ 2 (q − p) · n over the points q of the segment: along it a convex
    function, least where its derivative, a quadratic, is zero. It is given by v · v and, with u the
    way from p to where the segment begins, u · v, u · u, u · n and v · n.
    """
    if abs(rise) < AHEAD:
        share = -mixed / max(square, 1e-300)
    else:
        root = square * square * ahead * ahead - square * rise * (2 * mixed * ahead - rise * rest)
        share = (math.sqrt(max(root, 0.0)) - square * ahead) / (square * rise)
    share = min(max(share, 0.0), 1.0)
    ahead += share * rise
    if ahead < AHEAD:
        return math.inf
    return (rest + share * (2 * mixed + share * square)) / (2 * ahead)


@compiled(INLINED)
def own(
    segments: Segments,
    near: Near,
    count: int,
    x: float,
    y: float,
    nx: float,
    ny: float,
    share: float,
    most: float,
) -> tuple[float, float]:
    """How far from (x, y), a place of a piece, its room goes towards (nx, ny), and away from it.

    `share` is where on the piece that is; so many others are near. `most`, mm, where it is free.
    """
    ends, left, right = segments.ends, most, most
    for k in range(count):
        if near.spans[k, 0] <= share <= near.spans[k, 1]:
            other = near.others[k]
            ux, uy, vx, vy = ends[other, 0], ends[other, 1], ends[other, 2], ends[other, 3]
            ux, uy, vx, vy = ux - x, uy - y, vx - ux, vy - uy
            ahead, beyond = ux * nx + uy * ny, (ux + vx) * nx + (uy + vy) * ny
            square, mixed, rest = vx * vx + vy * vy, ux * vx + uy * vy, ux * ux + uy * uy
            rise = vx * nx + vy * ny
            if max(ahead, beyond) >= AHEAD:
                left = min(left, _room(square, mixed, rest, ahead, rise))
            if min(ahead, beyond) <= -AHEAD:
                right = min(right, _room(square, mixed, rest, -ahead, -rise))
    return left, right


@compiled(INTERNAL)
def fan(
    segments: Segments,
    near: Near,
    count: int,
    x: float,
    y: float,
    ux: float,
    uy: float,
    bend: float,
    end: int,
    most: float,
) -> float:
    """What a bead in the direction (ux, uy) has of the notch outside a bend at one end, (x, y).

    Mm²: half of the fan there, by two rays; `most` is its radius, mm, where nothing is near.
    """
    area, outward = 0.0, -1.0 if bend > 0 else 1.0
    for ray in range(1, 4, 2):
        angle = (bend if end else -bend) * ray / 8
        sine, cosine = outward * math.sin(angle), outward * math.cos(angle)
        nx, ny = -uy * cosine - ux * sine, ux * cosine - uy * sine
        radius, _ = own(segments, near, count, x, y, nx, ny, end, most)
        area += abs(bend) / 8 * radius * radius
    return area
