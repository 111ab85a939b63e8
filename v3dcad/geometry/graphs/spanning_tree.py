"""Minimum spanning trees from scratch, by Kruskal's algorithm (1956).

Lengths are exact, and ties go by the points' numbers, so that there is only one tree.
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import ConstIntRows, Int32Array, IntRows
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import ENTRY, INLINED, INTERNAL, compiled
from v3dcad.geometry.power_diagram.predicates import NUMBER
from v3dcad.model import Ints


@linked(INTERNAL)
def is_shorter(points: ConstIntRows, a: int, b: int, c: int, d: int) -> bool:
    """Whether the edge a–b comes before c–d: by length, then by the points' numbers."""
    ax, ay = points[a, 0] - points[b, 0], points[a, 1] - points[b, 1]
    cx, cy = points[c, 0] - points[d, 0], points[c, 1] - points[d, 1]
    difference = ax * ax + ay * ay - cx * cx - cy * cy
    if difference != 0:
        return difference < 0
    a, b = points[a, NUMBER], points[b, NUMBER]
    c, d = points[c, NUMBER], points[d, NUMBER]
    return min(a, b) < min(c, d) or (min(a, b) == min(c, d) and max(a, b) < max(c, d))


@compiled(INLINED)
def root_of(piece: Int32Array, site: int) -> int:
    """The root of a site's piece, with the way there halved."""
    while piece[site] != site:
        piece[site] = piece[piece[site]]
        site = piece[site]
    return site


@compiled(ENTRY)
def kruskal(points: ConstIntRows, pairs: IntRows) -> IntRows:
    """The minimum spanning forest (k, 2) of pairs (m, 2) of points, shortest first."""
    count, chosen = len(pairs), 0
    order, lengths = np.empty(count, np.int64), np.empty(count, np.int64)
    for edge in range(count):
        x = points[pairs[edge, 0], 0] - points[pairs[edge, 1], 0]
        y = points[pairs[edge, 0], 1] - points[pairs[edge, 1], 1]
        order[edge], lengths[edge] = edge, x * x + y * y
    to_order, to_lengths, width = np.empty(count, np.int64), np.empty(count, np.int64), 1
    while width < count:  # merge sort
        for start in range(0, count, 2 * width):
            left, middle = start, min(start + width, count)
            right, stop = middle, min(start + 2 * width, count)
            for to in range(start, stop):
                if left == middle or right == stop:
                    from_left = right == stop
                elif lengths[left] != lengths[right]:
                    from_left = lengths[left] < lengths[right]
                else:
                    a, b = order[left], order[right]
                    from_left = not is_shorter(
                        points, pairs[b, 0], pairs[b, 1], pairs[a, 0], pairs[a, 1]
                    )
                source = left if from_left else right
                to_order[to], to_lengths[to] = order[source], lengths[source]
                if from_left:
                    left += 1
                else:
                    right += 1
        order, to_order = to_order, order
        lengths, to_lengths, width = to_lengths, lengths, 2 * width
    piece, tree = np.empty(len(points), np.int32), np.empty((count, 2), np.int64)
    for point in range(len(points)):
        piece[point] = point
    for place in range(count):
        edge = order[place]
        a, b = root_of(piece, pairs[edge, 0]), root_of(piece, pairs[edge, 1])
        if a != b:
            piece[a] = b
            tree[chosen, 0], tree[chosen, 1] = pairs[edge, 0], pairs[edge, 1]
            chosen += 1
    return tree[:chosen]


def spanning_tree(places: Ints, pairs: Ints) -> Ints:
    """The minimum spanning forest (k, 2) of pairs (m, 2), i < j, of places (n, 2) on the grid.

    By length, ties by the places' numbers; shortest first.
    """
    points = np.zeros((len(places), 4), np.int64)
    points[:, :2], points[:, NUMBER] = places, np.arange(len(places))
    tree: Ints = kruskal(points, np.ascontiguousarray(pairs, np.int64))
    return tree
