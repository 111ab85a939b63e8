"""How far segments lie from the walls of a power diagram.

Inside the convex cell of a site c, the distance to the cell's boundary is the least of the
distances to its bisectors, (power to m − power to c) / (2 |c − m|) over the neighbours m: linear
functions along a straight segment. Their lower envelope gives the greatest distance exactly, and
where the distance exceeds a reach is one interval in each cell. No sampling is needed.
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstFloatStack,
    ConstIntArray,
    FloatArray,
    IntArray,
)
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import ENTRY, INLINED, INTERNAL, compiled
from v3dcad.model import Floats, Ints

"""Arrays of the model, which may not be written to."""


def distance_to_walls(
    segments: Floats, hints: Ints, sites: Floats, weights: Floats, neighbours: Ints, reach: float
) -> tuple[Floats, Floats]:
    """For every segment (s, 2, 2), mm: its greatest distance to the walls of a power diagram
    (sites (n, 2), mm; weights (n,), mm²), and how much of its length is farther than `reach`, mm.

    `neighbours` (m, 2) are the pairs of sites that share a wall anywhere in the plane; `hints`
    (s,) are sites near the start of each segment. Both results are (s,), mm; with a single cell
    there is no wall, and the distance infinite.
    """
    both = np.concatenate([neighbours, neighbours[:, ::-1]]).astype(np.int64)
    both = both[np.argsort(both[:, 0], kind="stable")]
    first = np.searchsorted(both[:, 0], np.arange(len(sites) + 1)).astype(np.int64)
    farthest, beyond = np.empty(len(segments)), np.empty(len(segments))
    _distances(
        np.ascontiguousarray(segments),
        np.array(hints, np.int64),
        np.ascontiguousarray(sites),
        np.ascontiguousarray(weights),
        first,
        np.ascontiguousarray(both[:, 1]),
        reach,
        farthest,
        beyond,
    )
    return farthest, beyond


@compiled(INLINED)
def _power(sites: ConstFloatRows, weights: ConstFloatArray, site: int, x: float, y: float) -> float:
    power: float = (x - sites[site, 0]) ** 2 + (y - sites[site, 1]) ** 2 - weights[site]
    return power


@linked(INTERNAL)
def _owner(
    sites: ConstFloatRows,
    weights: ConstFloatArray,
    first: ConstIntArray,
    adjacent: ConstIntArray,
    site: int,
    x: float,
    y: float,
) -> int:
    """The site whose cell holds a point: go to a neighbour of less power while there is one."""
    power = _power(sites, weights, site, x, y)
    moved = True
    while moved:
        moved = False
        for at in range(first[site], first[site + 1]):
            other = _power(sites, weights, adjacent[at], x, y)
            if other < power:
                power, best, moved = other, adjacent[at], True
        if moved:
            site = best
    return site


@linked(INTERNAL)
def _greatest_least(
    start: FloatArray, slope: FloatArray, count: int, low: float, high: float
) -> float:
    """Greatest value, over low ≤ t ≤ high, of the least of the lines start + slope · t.

    Follow the lower envelope from `low` while it rises; each next line is less steep.
    """
    t, active = low, 0
    for k in range(1, count):
        here, least = start[k] + slope[k] * t, start[active] + slope[active] * t
        if here < least or (here == least and slope[k] < slope[active]):
            active = k
    while slope[active] > 0.0 and t < high:
        turn, after = high, -1
        for k in range(count):
            if slope[k] < slope[active]:
                meet = max(t, (start[k] - start[active]) / (slope[active] - slope[k]))
                if meet < turn:
                    turn, after = meet, k
        t = turn
        if after < 0:
            break
        active = after
    highest: float = start[active] + slope[active] * t
    return highest


@linked(INTERNAL)
def _above(
    start: FloatArray, slope: FloatArray, count: int, low: float, high: float, reach: float
) -> float:
    """Length of the interval of low ≤ t ≤ high in which all lines lie above `reach`."""
    for k in range(count):
        if slope[k] == 0.0:
            if start[k] <= reach:
                return 0.0
        else:
            crossing = (reach - start[k]) / slope[k]
            if slope[k] > 0.0:
                low = max(low, crossing)
            else:
                high = min(high, crossing)
    return max(0.0, high - low)


@compiled(ENTRY)
def _distances(
    segments: ConstFloatStack,
    hints: IntArray,
    sites: ConstFloatRows,
    weights: ConstFloatArray,
    first: ConstIntArray,
    adjacent: ConstIntArray,
    reach: float,
    farthest: FloatArray,
    beyond: FloatArray,
) -> None:
    most = 0
    for site in range(len(sites)):
        most = max(most, first[site + 1] - first[site])
    start, slope = np.empty(most), np.empty(most)
    for s in range(len(segments)):
        x, y = segments[s, 0, 0], segments[s, 0, 1]
        along_x, along_y = segments[s, 1, 0] - x, segments[s, 1, 1] - y
        length = np.hypot(along_x, along_y)
        site = _owner(sites, weights, first, adjacent, hints[s], x, y)
        farthest[s], beyond[s] = 0.0, 0.0
        entered, left = 0.0, -1
        while entered < 1.0:
            # Distances to the cell's bisectors along the segment: start + slope · t.
            degree = first[site + 1] - first[site]
            if degree == 0:
                farthest[s], beyond[s] = np.inf, length
                break
            exit_at, into = 1.0, -1
            for k in range(degree):
                other = adjacent[first[site] + k]
                apart_x = sites[other, 0] - sites[site, 0]
                apart_y = sites[other, 1] - sites[site, 1]
                scale = 2.0 * np.hypot(apart_x, apart_y)
                start[k] = (
                    _power(sites, weights, other, x, y) - _power(sites, weights, site, x, y)
                ) / scale
                slope[k] = -2.0 * (apart_x * along_x + apart_y * along_y) / scale
                if slope[k] < 0.0 and other != left:
                    crossing = -start[k] / slope[k]
                    if crossing < exit_at:
                        exit_at, into = max(crossing, entered), other
            high = _greatest_least(start, slope, degree, entered, exit_at)
            farthest[s] = max(farthest[s], high)
            if high > reach:
                beyond[s] += length * _above(start, slope, degree, entered, exit_at, reach)
            if into < 0:
                break
            left, site, entered = site, into, exit_at
