"""A minimum spanning tree of a planar graph, kept while the graph changes.

A lost branch is replaced by the shortest edge between the two pieces that it leaves, which takes
the time of looking through the smaller one; a new edge takes the place of the longest on the cycle
that it closes. An edge that is the longest of a triangle of the graph is in no tree. Where much has
changed the tree is made from scratch (`kruskal.py`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.clipping.interior import Cut
from v3dcad.geometry.compiled.arrays import Int32Array, Int32Rows, IntArray, IntRows
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import ALLOCATING, INLINED, INTERNAL, compiled
from v3dcad.geometry.graphs.spanning_tree import is_shorter, kruskal, root_of
from v3dcad.geometry.power_diagram.predicates import NUMBER
from v3dcad.geometry.power_diagram.triangle_mesh import (
    ABSENT,
    ACROSS,
    SENTINELS,
    Triangulation,
    corner_at,
    edge_to,
)

MASK = (1 << 32) - 1
FEW = 8
"""A tree is made from scratch where more than one edge in so many has changed."""


class Tree(NamedTuple):
    """A rooted minimum spanning forest of a triangulation's points; −1 is no point."""

    above: Int32Array
    """(p,) int32: the point that each hangs from"""
    below: Int32Array
    """(p,) int32: the first of those that hang from each"""
    beside: Int32Rows
    """(p, 2) int32: the one before and the one after it, hanging from the same point"""
    mark: Int32Array
    """(p,) int32: in which search each was last met"""
    found: Int32Rows
    """(2, p) int32: room for a search"""
    marks: IntArray
    """(1,) int64: how many marks have been used"""
    sizes: IntArray
    """(2,) int64: how many points a search has found in each of two pieces"""


def empty_tree(points: int) -> Tree:
    """A tree of nothing, for up to so many points."""
    return Tree(
        above=np.full(points, ABSENT, np.int32),
        below=np.full(points, ABSENT, np.int32),
        beside=np.full((points, 2), ABSENT, np.int32),
        mark=np.zeros(points, np.int32),
        found=np.empty((2, points), np.int32),
        marks=np.zeros(1, np.int64),
        sizes=np.empty(2, np.int64),
    )


@linked(INTERNAL)
def _cut_off(tree: Tree, point: int) -> None:
    """Take a point off the one that it hangs from, if it does."""
    above, beside = tree.above, tree.beside
    if above[point] != ABSENT:
        before, after = beside[point, 0], beside[point, 1]
        if before == ABSENT:
            tree.below[above[point]] = after
        else:
            beside[before, 1] = after
        if after != ABSENT:
            beside[after, 0] = before
        above[point] = ABSENT


@linked(INTERNAL)
def _hang(tree: Tree, point: int, under: int) -> None:
    """Turn the piece that a point belongs to so that it is its root, and hang it under another."""
    above, below, beside = tree.above, tree.below, tree.beside
    while point != ABSENT:
        following, first = above[point], below[under]
        _cut_off(tree, point)
        above[point], below[under] = under, point
        beside[point, 0], beside[point, 1] = ABSENT, first
        if first != ABSENT:
            beside[first, 0] = point
        point, under = following, point


@compiled(INLINED)
def _key_of(triangles: Int32Rows, pair_at: IntArray, triangle: int, i: int) -> int:
    """The key of edge i of a triangle, if the graph has that edge; else −1."""
    other = triangles[triangle, ACROSS + i]
    if other == ABSENT:
        return -1
    key = 3 * triangle + i
    if other < triangle:
        key = 3 * other + edge_to(triangles, other, triangle)
    return key if pair_at[key] != 0 else -1


@linked(INTERNAL)
def _may_be_branch(points: IntRows, triangles: Int32Rows, pair_at: IntArray, key: int) -> bool:
    """Whether the edge with a key is not the longest of a triangle of the graph."""
    first, i = key // 3, key % 3
    a, b = triangles[first, (i + 1) % 3], triangles[first, (i + 2) % 3]
    for side in range(2):
        triangle = first if side == 0 else triangles[first, ACROSS + i]
        j = i if side == 0 else edge_to(triangles, triangle, first)
        c, joined = triangles[triangle, j], True
        for k in range(1, 3):
            joined = joined and _key_of(triangles, pair_at, triangle, (j + k) % 3) >= 0
        if joined and is_shorter(points, a, c, a, b) and is_shorter(points, b, c, a, b):
            return False
    return True


@linked(INTERNAL)
def _are_joined(mesh: Triangulation, pair_at: IntArray, a: int, b: int) -> bool:
    """Whether the graph has an edge a–b."""
    triangles, first = mesh.triangles, mesh.triangle_of[a]
    if first == ABSENT:
        return False
    triangle = first
    while True:
        k = corner_at(triangles, triangle, a)
        if triangles[triangle, (k + 1) % 3] == b:
            return _key_of(triangles, pair_at, triangle, (k + 2) % 3) >= 0
        triangle = triangles[triangle, ACROSS + (k + 1) % 3]
        if triangle == first:
            return False


@linked(INTERNAL)
def _replace(mesh: Triangulation, cut: Cut, tree: Tree, lost: int) -> None:
    """Put the shortest edge between its two pieces, if there is one that is not new, in the place
    of the branch from the point `lost` to the one above it.
    """
    points, triangles, pair_at, before = mesh.points, mesh.triangles, cut.pair_at, cut.before
    above, beside, mark, found, sizes = tree.above, tree.beside, tree.mark, tree.found, tree.sizes
    tree.marks[0] += 2
    token, place = tree.marks[0], 0
    found[0, 0], found[1, 0], sizes[0], sizes[1] = lost, above[lost], 1, 1
    _cut_off(tree, lost)
    # Look through both pieces at the same pace, until one has been seen whole.
    for side in range(2):
        mark[found[side, 0]] = token + side
    while place < sizes[0] and place < sizes[1]:
        for side in range(2):
            point, own = found[side, place], token + side
            other, child = above[point], tree.below[point]
            while other != ABSENT or child != ABSENT:
                if other != ABSENT and mark[other] != own:
                    mark[other] = own
                    found[side, sizes[side]] = other
                    sizes[side] += 1
                other = child
                child = ABSENT if child == ABSENT else beside[child, 1]
        place += 1
    side = 0 if place == sizes[0] else 1
    inner, outer = ABSENT, ABSENT
    for place in range(sizes[side]):
        point = found[side, place]
        first = mesh.triangle_of[point]
        triangle = first
        while triangle != ABSENT:
            k = corner_at(triangles, triangle, point)
            other = triangles[triangle, (k + 1) % 3]
            if mark[other] != token + side and (
                inner == ABSENT or is_shorter(points, point, other, inner, outer)
            ):
                key = _key_of(triangles, pair_at, triangle, (k + 2) % 3)
                if key >= 0 and (before[key] < 0 or before[key] == pair_at[key]):
                    inner, outer = point, other
            triangle = triangles[triangle, ACROSS + (k + 1) % 3]
            if triangle == first:
                break
    if inner != ABSENT:
        _hang(tree, inner, outer)


@linked(INTERNAL)
def _join(mesh: Triangulation, tree: Tree, a: int, b: int) -> None:
    """Put in a new edge: between two pieces, or for the longest of the cycle that it closes."""
    points, above, mark = mesh.points, tree.above, tree.mark
    tree.marks[0] += 2
    own, other = tree.marks[0], tree.marks[0] + 1
    near, far, meeting = a, b, ABSENT
    while near != ABSENT or far != ABSENT:  # up from both, by turns
        if near != ABSENT:
            if mark[near] == other:
                meeting = near
                break
            mark[near] = own
            near = above[near]
        near, far, own, other = far, near, other, own
    if meeting == ABSENT:
        _hang(tree, b, a)
        return
    longest, start = ABSENT, a
    for end in (a, b):
        point = end
        while point != meeting:
            if longest == ABSENT or is_shorter(
                points, longest, above[longest], point, above[point]
            ):
                longest, start = point, end
            point = above[point]
    if is_shorter(points, a, b, longest, above[longest]):
        _cut_off(tree, longest)
        _hang(tree, start, b if start == a else a)


@linked(ALLOCATING)
def _make_tree(mesh: Triangulation, cut: Cut, tree: Tree) -> None:
    """Make it the tree of the cut's neighbours from scratch."""
    points, pair_at, halves, crossed = mesh.points, cut.pair_at, cut.halves, cut.crossed
    size, piece, whole = tree.found[0], tree.found[1], cut.state.whole
    edges, many = whole + cut.state.crossed, 0
    pairs = np.empty((edges, 2), np.int64)
    for edge in range(edges):
        key = halves[edge, 0] if edge < whole else crossed[edge - whole]
        if _may_be_branch(points, mesh.triangles, pair_at, key):
            pairs[many, 0], pairs[many, 1] = pair_at[key] >> 32, pair_at[key] & MASK
            many += 1
    for point in range(mesh.counts.points):
        size[point], piece[point] = 1, point
        tree.above[point] = tree.below[point] = ABSENT
    branches = kruskal(points, pairs[:many])
    for branch in range(len(branches)):
        a, b = branches[branch, 0], branches[branch, 1]
        c, d = root_of(piece, a), root_of(piece, b)
        if size[c] > size[d]:
            a, b, c, d = b, a, d, c
        _hang(tree, a, b)  # the smaller piece: no point turns more than log n times
        piece[c] = d
        size[d] += size[c]


@linked(INTERNAL)
def renew_tree(mesh: Triangulation, cut: Cut, tree: Tree) -> None:
    """Make it the tree of the cut's neighbours again, after what the cut says has changed."""
    above, pair_at, before, changed = tree.above, cut.pair_at, cut.before, cut.changed
    count = cut.state.changed
    if FEW * count > cut.state.whole + cut.state.crossed:
        _make_tree(mesh, cut, tree)
    else:
        for place in range(count):
            key = changed[place]
            pair = before[key]
            a, b = pair >> 32, pair & MASK
            if (
                pair > 0
                and pair != pair_at[key]
                and (above[a] == b or above[b] == a)
                and not _are_joined(mesh, pair_at, a, b)
            ):
                _replace(mesh, cut, tree, a if above[a] == b else b)
        for place in range(count):
            key = changed[place]
            pair = pair_at[key]
            a, b = pair >> 32, pair & MASK
            if (
                pair > 0
                and pair != before[key]
                and above[a] != b
                and above[b] != a
                and _may_be_branch(mesh.points, mesh.triangles, pair_at, key)
            ):
                _join(mesh, tree, a, b)
    for place in range(count):
        before[changed[place]] = -1
    cut.state.changed = 0


@linked(INTERNAL)
def write_tree(mesh: Triangulation, tree: Tree, branches: IntRows, row: int) -> int:
    """Write the tree's pairs of sites, i < j, from `row` on; returns the row after."""
    points, above = mesh.points, tree.above
    for point in range(SENTINELS, mesh.counts.points):
        if above[point] != ABSENT:
            i, j = points[point, NUMBER], points[above[point], NUMBER]
            branches[row, 0], branches[row, 1] = min(i, j), max(i, j)
            row += 1
    return row
