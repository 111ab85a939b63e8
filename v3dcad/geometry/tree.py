"""Minimum spanning trees of a planar graph that changes little by little.

Kruskal's algorithm (1956) on few edges. What was neither in the last tree nor is new can only be
needed where the loss of a branch has torn the tree, and then it joins two of its pieces.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.core.types import NamedTuple as TupleType

from v3dcad.geometry.exact import COMPILED, INLINED, INTERNAL, WORD
from v3dcad.model import Ints

LENGTHS, PAIRS, ROW = types.int64[::1], types.int64[:, ::1], types.int32[::1]
COUNT, GENERATION = range(2)
"""What `Tree.state` holds: how many branches there are, and how often it was renewed."""


class Tree(NamedTuple):
    """A minimum spanning forest, and the graph that it was made of.

    Every edge of the graph has a key: it may keep it or not when the graph changes.
    """

    first: Any
    """(k,) int32: the smaller site of the edge that last had this key"""
    second: Any
    """(k,) int32: its larger site"""
    seen: Any
    """(k,) int32: in which generation"""
    branches: Any
    """(n,) int32: keys of the tree's edges, shortest first"""
    state: Any
    """(2,) int64"""


TREE = TupleType([ROW, ROW, ROW, ROW, LENGTHS], Tree)


def empty_tree(sites: int, keys: int) -> Tree:
    """A tree for up to so many sites, and edges with keys below `keys`."""
    first, second, seen = np.zeros((3, keys), np.int32)
    return Tree(first, second, seen, np.empty(sites, np.int32), np.zeros(2, np.int64))


@njit(WORD(PAIRS, WORD, WORD), **INLINED)
def _squared(places, i, j):  # type: ignore[no-untyped-def]
    dx, dy = places[i, 0] - places[j, 0], places[i, 1] - places[j, 1]
    return dx * dx + dy * dy


@njit(types.boolean(ROW, ROW, PAIRS, WORD, WORD), **INLINED)
def _shorter(first, second, places, a, b):  # type: ignore[no-untyped-def]
    """Whether the edge with key a comes before that with key b: by length, then by sites."""
    i, j, k, m = first[a], second[a], first[b], second[b]
    difference = _squared(places, i, j) - _squared(places, k, m)
    if difference != 0:
        return difference < 0
    return i < k or (i == k and j < m)


@njit(WORD(ROW, WORD), **INLINED)
def _root(piece, site):  # type: ignore[no-untyped-def]
    while piece[site] != site:
        piece[site] = piece[piece[site]]
        site = piece[site]
    return site


@njit(types.void(ROW, ROW, PAIRS, ROW, WORD), **INTERNAL)
def _sort(first, second, places, keys, count):  # type: ignore[no-untyped-def]
    """Sort keys, shortest first: by heap, in place."""
    for start in range(count // 2 - 1, -count, -1):
        if start >= 0:
            length, at = count, start
        else:
            length, at = count + start, 0
            keys[0], keys[length] = keys[length], keys[0]
        while True:
            below = 2 * at + 1
            if below >= length:
                break
            if below + 1 < length and _shorter(first, second, places, keys[below], keys[below + 1]):
                below += 1
            if not _shorter(first, second, places, keys[at], keys[below]):
                break
            keys[at], keys[below] = keys[below], keys[at]
            at = below


@njit(types.void(TREE, PAIRS, PAIRS, ROW, WORD, WORD), **COMPILED)
def renew_tree(tree, places, pairs, keys, row, count):  # type: ignore[no-untyped-def]
    """Make it the tree of the pairs (i < j) from `row` to the end, with their `keys`.

    `places` (n, 2) are all sites in grid steps, `count` how many of them there are.
    """
    first, second, seen, branches = tree.first, tree.second, tree.seen, tree.branches
    generation = tree.state[GENERATION] + 1
    edges = len(keys)
    new, piece = np.empty(edges, np.int32), np.empty(count, np.int32)
    added = 0
    for edge in range(edges):
        key, i, j = keys[edge], pairs[row + edge, 0], pairs[row + edge, 1]
        if seen[key] != generation - 1 or first[key] != i or second[key] != j:
            first[key], second[key] = i, j
            seen[key] = -generation  # new: no branch of the tree before
            new[added] = key
            added += 1
        else:
            seen[key] = generation
    for site in range(count):
        piece[site] = site
    kept = 0
    for branch in range(tree.state[COUNT]):
        key = branches[branch]
        if seen[key] == generation:
            branches[kept] = key
            kept += 1
            piece[_root(piece, first[key])] = _root(piece, second[key])
    if kept < tree.state[COUNT]:
        for site in range(count):
            piece[site] = _root(piece, site)
        for edge in range(edges):
            i, j = pairs[row + edge, 0], pairs[row + edge, 1]
            if piece[i] != piece[j] and seen[keys[edge]] == generation:
                new[added] = keys[edge]
                added += 1
    for edge in range(added):
        seen[new[edge]] = generation
    if added > 0:
        _sort(first, second, places, new, added)
        old = np.empty(kept, np.int32)
        for branch in range(kept):
            old[branch] = branches[branch]
        for site in range(count):
            piece[site] = site
        at_old, at_new, size = 0, 0, 0
        while at_old < kept or at_new < added:
            if at_new == added or (
                at_old < kept and _shorter(first, second, places, old[at_old], new[at_new])
            ):
                key = old[at_old]
                at_old += 1
            else:
                key = new[at_new]
                at_new += 1
            a, b = _root(piece, first[key]), _root(piece, second[key])
            if a != b:
                piece[a] = b
                branches[size] = key
                size += 1
        kept = size
    tree.state[COUNT], tree.state[GENERATION] = kept, generation


def spanning_tree(places: Ints, pairs: Ints) -> Ints:
    """The minimum spanning forest (k, 2) of pairs (m, 2), i < j, of places (n, 2) on the grid.

    By length, ties by site numbers; shortest first.
    """
    pairs = np.ascontiguousarray(pairs)
    tree = empty_tree(len(places), len(pairs))
    renew_tree(tree, places, pairs, np.arange(len(pairs), dtype=np.int32), 0, len(places))
    keys = tree.branches[: tree.state[COUNT]]
    return np.column_stack([tree.first[keys], tree.second[keys]]).astype(np.int64)
