"""Minimum spanning trees of planar graphs, by Borůvka's algorithm (1926)."""

from __future__ import annotations

import numpy as np
from numba import njit, types

from v3dcad.geometry.exact import COMPILED, INLINED, WORD

PAIRS, LENGTHS, ROW = types.int64[:, ::1], types.int64[::1], types.int32[::1]


@njit(types.boolean(PAIRS, LENGTHS, WORD, WORD), **INLINED)
def _shorter(pairs, squared, a, b):  # type: ignore[no-untyped-def]
    """Whether pair a comes before pair b: by length, then by sites. No two pairs are equal."""
    if squared[a] != squared[b]:
        return squared[a] < squared[b]
    if pairs[a, 0] != pairs[b, 0]:
        return pairs[a, 0] < pairs[b, 0]
    return pairs[a, 1] < pairs[b, 1]


@njit(PAIRS(PAIRS, LENGTHS, WORD), **COMPILED)
def spanning_tree(pairs, squared, count):  # type: ignore[no-untyped-def]
    """The minimum spanning forest (k, 2) of pairs (m, 2) of sites below `count`, i < j.

    `squared` (m,) are their squared lengths; ties go to the pair of smaller sites. The tree's
    pairs keep the order of `pairs`.
    """
    piece = np.empty(count, np.int32)
    for site in range(count):
        piece[site] = site
    best = np.full(count, -1, np.int32)
    left, chosen = np.empty(len(pairs), np.int32), np.zeros(len(pairs), np.bool_)
    for pair in range(len(pairs)):
        left[pair] = pair
    waiting, size, joined = len(pairs), 0, True
    while joined:
        joined = False
        kept = 0
        for row in range(waiting):
            pair = left[row]
            a, b = piece[pairs[pair, 0]], piece[pairs[pair, 1]]
            if a == b:
                continue
            left[kept] = pair
            kept += 1
            if best[a] < 0 or _shorter(pairs, squared, pair, best[a]):
                best[a] = pair
            if best[b] < 0 or _shorter(pairs, squared, pair, best[b]):
                best[b] = pair
        waiting = kept
        for site in range(count):
            pair = best[site]
            if pair >= 0:
                best[site] = -1
                a, b = pairs[pair, 0], pairs[pair, 1]
                while piece[a] != a:
                    a = piece[a]
                while piece[b] != b:
                    b = piece[b]
                if a != b:
                    piece[max(a, b)] = min(a, b)
                    chosen[pair], joined = True, True
                    size += 1
        for site in range(count):  # roots are smaller: one pass reaches them
            piece[site] = piece[piece[site]]
    tree = np.empty((size, 2), np.int64)
    size = 0
    for pair in range(len(pairs)):
        if chosen[pair]:
            tree[size, 0], tree[size, 1] = pairs[pair, 0], pairs[pair, 1]
            size += 1
    return tree
