"""How the weights of points change with time, and the heap of moments when something is due.

A point weighs base + growth · time, in whole grid units, so that the power test of an edge is
linear in time: the moment at which it fails is known. The moments are floats, a little early.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, Int32Array, Int32Rows, IntArray, IntRows
from v3dcad.geometry.compiled.intrinsics import sign_of_sum
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INLINED, INTERNAL, compiled
from v3dcad.geometry.compiled.records import Record
from v3dcad.geometry.power_diagram.predicates import NUMBER, WEIGHT

NEVER = np.inf

ROUNDING = 4e-15
"""Bound of the relative error of the floating power test (some 20 operations)."""

EVERYTHING = -1
"""How many triangles have been touched when there is no telling which."""


class MotionState(Record):
    """Where a motion has got to."""

    due: int
    """length of the heap"""
    touched: int
    """how many triangles have been touched, or `EVERYTHING`"""
    now: int
    """the whole time that the weights belong to"""
    last: int
    """the last time that can be asked for"""


class Motion(NamedTuple):
    """How the weights of a triangulation's points change, and what is due when."""

    base: IntArray
    """(p,) weight at time 0, steps²"""
    growth: IntArray
    """(p,) weight gained in one unit of time, steps²"""
    stamp: Int32Array
    """(3 t,) which entry of the heap about this edge is valid"""
    due: FloatArray
    """(h,) heap of moments"""
    due_edge: Int32Rows
    """(h, 2) 3 · triangle + edge, and its stamp"""
    touched: Int32Array
    """(t,) triangles that came, changed or went since somebody last emptied this list"""
    state: MotionState


@compiled(INLINED)
def strut(
    points: IntRows, base: IntArray, growth: IntArray, a: int, b: int, c: int
) -> tuple[float, float, float, float]:
    """Where the orthocentre of a triangle is at time 0, and how it moves per unit of time.

    (x, y, x velocity, y velocity) in grid steps. The point with the lowest number comes first, so
    that the same triangle gives the same bits whatever its history.
    """
    first, second, third = points[a, NUMBER], points[b, NUMBER], points[c, NUMBER]
    if second < first and second < third:
        a, b, c = b, c, a
    elif third < first and third < second:
        a, b, c = c, a, b
    x, y = points[a, 0], points[a, 1]
    bx, by, cx, cy = points[b, 0] - x, points[b, 1] - y, points[c, 0] - x, points[c, 1] - y
    half = 0.5 / (bx * cy - by * cx)
    still_b = float(bx * bx + by * by - base[b] + base[a])
    still_c = float(cx * cx + cy * cy - base[c] + base[a])
    grown_b, grown_c = growth[a] - growth[b], growth[a] - growth[c]
    return (
        x + (cy * still_b - by * still_c) * half,
        y + (bx * still_c - cx * still_b) * half,
        (cy * grown_b - by * grown_c) * half,
        (bx * grown_c - cx * grown_b) * half,
    )


@compiled(INLINED)
def failure(
    points: IntRows, growth: IntArray, a: int, b: int, c: int, d: int, now: int
) -> tuple[float, bool]:
    """A moment surely before d gets into the orthocircle of a, b, c; and whether the weights bring
    it closer.

    Where they do not the moment is `NEVER`, unless the four may be orthogonal to one circle for
    good: that is for the exact test to decide, now.
    """
    dx, dy, weight, speed = points[d, 0], points[d, 1], points[d, WEIGHT], growth[d]
    ax, ay = points[a, 0] - dx, points[a, 1] - dy
    bx, by = points[b, 0] - dx, points[b, 1] - dy
    cx, cy = points[c, 0] - dx, points[c, 1] - dy
    of_a, of_b, of_c = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
    faster_a, faster_b, faster_c = speed - growth[a], speed - growth[b], speed - growth[c]
    by_a, by_b, by_c = of_a * float(faster_a), of_b * float(faster_b), of_c * float(faster_c)
    slope, least = by_a + by_b + by_c, ROUNDING * (abs(by_a) + abs(by_b) + abs(by_c))
    if abs(slope) <= least:
        slope = least * sign_of_sum(of_a, faster_a, of_b, faster_b, of_c, faster_c)
    from_a = float(ax * ax + ay * ay - points[a, WEIGHT] + weight) * of_a
    from_b = float(bx * bx + by * by - points[b, WEIGHT] + weight) * of_b
    from_c = float(cx * cx + cy * cy - points[c, WEIGHT] + weight) * of_c
    power = from_a + from_b + from_c
    doubt = ROUNDING * (abs(from_a) + abs(from_b) + abs(from_c))
    if slope <= 0:
        return float(now) if power + doubt >= 0.0 else NEVER, False
    early = power + doubt
    return now - early / (slope + least if early < 0 else slope), True


@compiled(INLINED)
def _sift(motion: Motion, at: int, length: int) -> None:
    """Let the entry at a place of the heap sink to where it belongs."""
    due, edges = motion.due, motion.due_edge
    moment, edge, stamp = due[at], edges[at, 0], edges[at, 1]
    while True:
        below = 2 * at + 1
        if below >= length:
            break
        if below + 1 < length and due[below + 1] < due[below]:
            below += 1
        if due[below] >= moment:
            break
        due[at], edges[at, 0], edges[at, 1] = due[below], edges[below, 0], edges[below, 1]
        at = below
    due[at], edges[at, 0], edges[at, 1] = moment, edge, stamp


@linked(INTERNAL)
def _drop_stale(motion: Motion) -> None:
    """Take entries out of the heap that no longer hold: what stays is at most one an edge."""
    due, edges, stamp = motion.due, motion.due_edge, motion.stamp
    length = 0
    for at in range(motion.state.due):
        if stamp[edges[at, 0]] == edges[at, 1]:
            due[length], edges[length, 0], edges[length, 1] = due[at], edges[at, 0], edges[at, 1]
            length += 1
    motion.state.due = length
    for at in range(length // 2 - 1, -1, -1):
        _sift(motion, at, length)


@linked(INTERNAL)
def push(motion: Motion, moment: float, edge: int, stamp: int) -> None:
    """Enter that an edge is due at a moment; the entry holds while the edge has that stamp."""
    due, edges, state = motion.due, motion.due_edge, motion.state
    if state.due == len(due):
        _drop_stale(motion)
    at = state.due
    state.due += 1
    while at > 0 and due[(at - 1) >> 1] > moment:
        above = (at - 1) >> 1
        due[at], edges[at, 0], edges[at, 1] = due[above], edges[above, 0], edges[above, 1]
        at = above
    due[at], edges[at, 0], edges[at, 1] = moment, edge, stamp


@linked(INTERNAL)
def pop(motion: Motion) -> int:
    """Take the first entry out; returns its edge, or −1 where it no longer holds."""
    due, edges, state = motion.due, motion.due_edge, motion.state
    edge, stamp = edges[0, 0], edges[0, 1]
    last = state.due - 1
    state.due = last
    due[0], edges[0, 0], edges[0, 1] = due[last], edges[last, 0], edges[last, 1]
    if last > 0:
        _sift(motion, 0, last)
    return edge if motion.stamp[edge] == stamp else -1
