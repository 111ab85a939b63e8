"""Minimum spanning trees of planar graphs: from scratch, and kept while the graph changes.

From scratch by Kruskal's algorithm (1956). Afterwards a lost branch is replaced by the shortest
edge out of the piece that it leaves behind, and a new edge takes the place of the longest on the
cycle that it closes. An edge that is the longest of a triangle of the graph is in no tree.
Lengths are exact, and ties go by site numbers, so that there is only one tree.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.core.types import NamedTuple as TupleType

from v3dcad.geometry.cut import CHANGED, CROSSED, CUT, WHOLE
from v3dcad.geometry.exact import COMPILED, INLINED, INTERNAL, POINT_ROWS, WORD
from v3dcad.geometry.triangulation import (
    ACROSS,
    MESH,
    NOTHING,
    POINTS,
    SENTINELS,
    TRIANGLE_ROWS,
    corner_at,
    edge_to,
)
from v3dcad.model import Ints

LENGTHS, PAIRS, ROW = types.int64[::1], types.int64[:, ::1], types.int32[::1]
MASK = (1 << 32) - 1
FEW = 8
"""A tree is made from scratch where more than one edge in so many has changed."""


class Tree(NamedTuple):
    """A rooted minimum spanning forest of a triangulation's points."""

    above: Any
    """(p,) int32: the point that each hangs from, or −1"""
    mark: Any
    """(p,) int32: in which search each was last met"""
    state: Any
    """(1,) int64: number of searches"""


TREE = TupleType([ROW, ROW, LENGTHS], Tree)


def empty_tree(points: int) -> Tree:
    """A tree of nothing, for up to so many points."""
    return Tree(np.full(points, -1, np.int32), np.zeros(points, np.int32), np.zeros(1, np.int64))


def tree_with_room(tree: Tree, points: int) -> Tree:
    """The same for up to so many points."""
    longer = empty_tree(points)
    longer.above[: len(tree.above)], longer.mark[: len(tree.mark)] = tree.above, tree.mark
    longer.state[:] = tree.state
    return longer


@njit(types.boolean(POINT_ROWS, LENGTHS, *[WORD] * 4), **INTERNAL)
def _shorter(points, site_of, a, b, c, d):  # type: ignore[no-untyped-def]
    """Whether the edge a–b comes before c–d: by length, then by sites."""
    ax, ay = points[a, 0] - points[b, 0], points[a, 1] - points[b, 1]
    cx, cy = points[c, 0] - points[d, 0], points[c, 1] - points[d, 1]
    difference = ax * ax + ay * ay - cx * cx - cy * cy
    if difference != 0:
        return difference < 0
    a, b, c, d = site_of[a], site_of[b], site_of[c], site_of[d]
    return min(a, b) < min(c, d) or (min(a, b) == min(c, d) and max(a, b) < max(c, d))


@njit(WORD(ROW, WORD), **INLINED)
def _root(piece, site):  # type: ignore[no-untyped-def]
    while piece[site] != site:
        piece[site] = piece[piece[site]]
        site = piece[site]
    return site


@njit(types.void(ROW, WORD, WORD), **INTERNAL)
def _hang(above, point, under):  # type: ignore[no-untyped-def]
    """Turn the piece that a point belongs to so that it is its root, and hang it under another."""
    while point != NOTHING:
        following = above[point]
        above[point] = under
        point, under = following, point


@njit(PAIRS(POINT_ROWS, LENGTHS, PAIRS), **COMPILED)
def kruskal(points, site_of, pairs):  # type: ignore[no-untyped-def]
    """The minimum spanning forest (k, 2) of pairs (m, 2) of points, shortest first."""
    count, chosen = len(pairs), 0
    order, other, width = np.empty(count, np.int64), np.empty(count, np.int64), 1
    for edge in range(count):
        order[edge] = edge
    while width < count:  # merge sort
        for start in range(0, count, 2 * width):
            left, middle = start, min(start + width, count)
            right, stop = middle, min(start + 2 * width, count)
            for to in range(start, stop):
                if right == stop:
                    from_left = True
                elif left == middle:
                    from_left = False
                else:
                    a, b = order[left], order[right]
                    from_left = not _shorter(
                        points, site_of, pairs[b, 0], pairs[b, 1], pairs[a, 0], pairs[a, 1]
                    )
                if from_left:
                    other[to] = order[left]
                    left += 1
                else:
                    other[to] = order[right]
                    right += 1
        order, other, width = other, order, 2 * width
    piece, tree = np.empty(len(points), np.int32), np.empty((count, 2), np.int64)
    for point in range(len(points)):
        piece[point] = point
    for place in range(count):
        edge = order[place]
        a, b = _root(piece, pairs[edge, 0]), _root(piece, pairs[edge, 1])
        if a != b:
            piece[a] = b
            tree[chosen, 0], tree[chosen, 1] = pairs[edge, 0], pairs[edge, 1]
            chosen += 1
    return tree[:chosen]


@njit(WORD(TRIANGLE_ROWS, LENGTHS, WORD, WORD), **INLINED)
def _key_of(triangles, pair_at, triangle, i):  # type: ignore[no-untyped-def]
    """The key of edge i of a triangle, if the graph has that edge; else −1."""
    other = triangles[triangle, ACROSS + i]
    if other == NOTHING:
        return -1
    key = 3 * triangle + i
    if other < triangle:
        key = 3 * other + edge_to(triangles, other, triangle)
    return key if pair_at[key] != 0 else -1


@njit(types.boolean(POINT_ROWS, TRIANGLE_ROWS, LENGTHS, LENGTHS, WORD), **INTERNAL)
def _may_be_branch(points, triangles, site_of, pair_at, key):  # type: ignore[no-untyped-def]
    """Whether the edge with a key is not the longest of a triangle of the graph."""
    first, i = key // 3, key % 3
    a, b = triangles[first, (i + 1) % 3], triangles[first, (i + 2) % 3]
    for side in range(2):
        triangle = first if side == 0 else triangles[first, ACROSS + i]
        j = i if side == 0 else edge_to(triangles, triangle, first)
        c, joined = triangles[triangle, j], True
        for k in range(1, 3):
            joined = joined and _key_of(triangles, pair_at, triangle, (j + k) % 3) >= 0
        if (
            joined
            and _shorter(points, site_of, a, c, a, b)
            and _shorter(points, site_of, b, c, a, b)
        ):
            return False
    return True


@njit(types.boolean(MESH, LENGTHS, WORD, WORD), **INTERNAL)
def _are_joined(mesh, pair_at, a, b):  # type: ignore[no-untyped-def]
    """Whether the graph has an edge a–b."""
    triangles, first = mesh.triangles, mesh.triangle_of[a]
    if first == NOTHING:
        return False
    triangle = first
    while True:
        k = corner_at(triangles, triangle, a)
        if triangles[triangle, (k + 1) % 3] == b:
            return _key_of(triangles, pair_at, triangle, (k + 2) % 3) >= 0
        triangle = triangles[triangle, ACROSS + (k + 1) % 3]
        if triangle == first:
            return False


@njit(types.void(MESH, CUT, TREE, LENGTHS, WORD), **INTERNAL)
def _reattach(mesh, cut, tree, site_of, root):  # type: ignore[no-untyped-def]
    """Join a piece to another by the shortest edge of those that are not new, if there is one."""
    points, triangles, triangle_of = mesh.points, mesh.triangles, mesh.triangle_of
    above, mark, pair_at, before = tree.above, tree.mark, cut.pair_at, cut.before
    if triangle_of[root] == NOTHING:
        return
    tree.state[0] += 1
    token = tree.state[0]
    piece, count = np.empty(mesh.count[POINTS], np.int32), 1
    piece[0], mark[root] = root, token
    for finding in range(2):
        # First find the piece's points, then its shortest way out.
        place, inner, outer = 0, NOTHING, NOTHING
        while place < count:
            point = piece[place]
            place += 1
            first = triangle_of[point]
            triangle = first
            while True:
                k = corner_at(triangles, triangle, point)
                other = triangles[triangle, (k + 1) % 3]
                if mark[other] != token:
                    if finding == 0:
                        if above[other] == point:
                            mark[other] = token
                            piece[count] = other
                            count += 1
                    elif inner == NOTHING or _shorter(points, site_of, point, other, inner, outer):
                        key = _key_of(triangles, pair_at, triangle, (k + 2) % 3)
                        if key >= 0 and (before[key] < 0 or before[key] == pair_at[key]):
                            inner, outer = point, other
                triangle = triangles[triangle, ACROSS + (k + 1) % 3]
                if triangle == first:
                    break
    if inner != NOTHING:
        _hang(above, inner, outer)


@njit(types.void(MESH, TREE, LENGTHS, WORD, WORD), **INTERNAL)
def _join(mesh, tree, site_of, a, b):  # type: ignore[no-untyped-def]
    """Put in a new edge: between two pieces, or for the longest of the cycle that it closes."""
    points, above, mark = mesh.points, tree.above, tree.mark
    tree.state[0] += 1
    token, point = tree.state[0], a
    while point != NOTHING:
        mark[point] = token
        point = above[point]
    meeting = b
    while meeting != NOTHING and mark[meeting] != token:
        meeting = above[meeting]
    if meeting == NOTHING:
        _hang(above, b, a)
        return
    longest, holder, start = NOTHING, NOTHING, a
    for end in (a, b):
        point = end
        while point != meeting:
            if longest == NOTHING or _shorter(
                points, site_of, longest, above[longest], point, above[point]
            ):
                longest, start = point, end
            point = above[point]
    holder = above[longest]
    if _shorter(points, site_of, a, b, longest, holder):
        above[longest] = NOTHING
        _hang(above, start, b if start == a else a)


@njit(types.void(ROW, PAIRS), **INTERNAL)
def _root_all(above, branches):  # type: ignore[no-untyped-def]
    """Hang a forest's points from each other, starting anywhere."""
    size, piece = np.empty(len(above), np.int32), np.empty(len(above), np.int32)
    for point in range(len(above)):
        size[point], piece[point] = 1, point
    for branch in range(len(branches)):
        a, b = branches[branch, 0], branches[branch, 1]
        c, d = _root(piece, a), _root(piece, b)
        if size[c] > size[d]:
            a, b, c, d = b, a, d, c
        _hang(above, a, b)  # the smaller piece: no point turns more than log n times
        piece[c] = d
        size[d] += size[c]


@njit(types.void(MESH, CUT, TREE, LENGTHS), **INTERNAL)
def renew_tree(mesh, cut, tree, site_of):  # type: ignore[no-untyped-def]
    """Make it the tree of the cut's neighbours again, after what the cut says has changed."""
    above, pair_at, before, changed = tree.above, cut.pair_at, cut.before, cut.changed
    points, triangles = mesh.points, mesh.triangles
    count, whole = cut.state[CHANGED], cut.state[WHOLE]
    if FEW * count > whole + cut.state[CROSSED]:
        halves, crossed, edges = cut.halves, cut.crossed, whole + cut.state[CROSSED]
        pairs, many = np.empty((edges, 2), np.int64), 0
        for edge in range(edges):
            key = halves[edge, 0] if edge < whole else crossed[edge - whole]
            if _may_be_branch(points, triangles, site_of, pair_at, key):
                pairs[many, 0], pairs[many, 1] = pair_at[key] >> 32, pair_at[key] & MASK
                many += 1
        for point in range(mesh.count[POINTS]):
            above[point] = NOTHING
        branches = kruskal(mesh.points[: mesh.count[POINTS]], site_of, pairs[:many])
        _root_all(above, branches)
    else:
        torn, some = np.empty(count, np.int32), 0
        for place in range(count):
            pair = before[changed[place]]
            a, b = pair >> 32, pair & MASK
            lost = pair > 0 and pair != pair_at[changed[place]] and (above[a] == b or above[b] == a)
            if lost and not _are_joined(mesh, pair_at, a, b):
                torn[some] = a if above[a] == b else b
                above[torn[some]] = NOTHING
                some += 1
        for place in range(some):
            if above[torn[place]] == NOTHING:
                _reattach(mesh, cut, tree, site_of, torn[place])
        for place in range(count):
            key = changed[place]
            pair = pair_at[key]
            a, b = pair >> 32, pair & MASK
            if (
                pair > 0
                and pair != before[key]
                and above[a] != b
                and above[b] != a
                and _may_be_branch(points, triangles, site_of, pair_at, key)
            ):
                _join(mesh, tree, site_of, a, b)
    for place in range(count):
        before[changed[place]] = -1
    cut.state[CHANGED] = 0


@njit(WORD(MESH, TREE, LENGTHS, PAIRS, WORD), **INTERNAL)
def write_tree(mesh, tree, site_of, branches, row):  # type: ignore[no-untyped-def]
    """Write the tree's pairs of sites, i < j, from `row` on; returns the row after."""
    above = tree.above
    for point in range(SENTINELS, mesh.count[POINTS]):
        if above[point] != NOTHING:
            i, j = site_of[point], site_of[above[point]]
            branches[row, 0], branches[row, 1] = min(i, j), max(i, j)
            row += 1
    return row


def spanning_tree(places: Ints, pairs: Ints) -> Ints:
    """The minimum spanning forest (k, 2) of pairs (m, 2), i < j, of places (n, 2) on the grid.

    By length, ties by site numbers; shortest first.
    """
    points = np.zeros((len(places), 3), np.int64)
    points[:, :2] = places
    tree: Ints = kruskal(points, np.arange(len(places)), np.ascontiguousarray(pairs, np.int64))
    return tree
