"""Which sites grow, every second level of the spanning tree, and by how much."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components
from scipy.spatial import KDTree

from v3dcad.model import Floats, Ints
from v3dcad.settings import FillSettings

USUAL = FillSettings().max_overhang
"""Degrees: the limit of those who set none."""


def growing(count: int, tree: Ints) -> NDArray[np.bool_]:
    """(count,) which sites grow: those on odd levels of the tree (m, 2), rooted at site 0.

    Pieces of a forest are rooted at their smallest site. A tree is bipartite, so that of two
    sites joined by it exactly one grows.
    """
    pieces = connected_components(_graph(count, tree), directed=False)[1]
    roots = np.unique(pieces, return_index=True)[1]
    # A level below all others: one site more, which the roots hang from.
    hung = np.column_stack([np.full(len(roots), count), roots])
    whole = _graph(count + 1, np.concatenate([tree, hung]))
    above = breadth_first_order(whole, count, directed=False)[1]
    above[count] = count
    odd = above != count
    while (above != count).any():  # each time twice as far up
        odd, above = odd ^ odd[above], above[above]
    return np.asarray(odd[:count])


def _graph(count: int, pairs: Ints) -> csr_array:
    return csr_array((np.ones(len(pairs)), pairs.T), (count, count))


def settled_offset(
    settings: FillSettings, sites: Floats, grows: NDArray[np.bool_], safe: float
) -> float:
    """The offset, mm² a layer: the one that is set, or the largest that is allowed for "auto".

    `safe`, mm² a layer, takes a weight to the end of the engine's range on the last layer. "auto"
    takes half of it at most; and where 90° sets no limit, what `USUAL` degrees allow. An offset
    that is set is not refused: the thesis's method only reports its overhang.
    """
    limit = settings.max_overhang
    if isinstance(settings.offset, str):
        tilt = limit if limit < 90 else USUAL
        most = largest_offset(sites, grows, settings.layer_height, tilt)
        return 0.0 if math.isinf(most) else min(most, safe / 2)
    return float(settings.offset)


def largest_offset(
    sites: Floats, grows: NDArray[np.bool_], layer_height: float, max_overhang: float
) -> float:
    """The largest offset, mm² a layer, with which no wall leans more than `max_overhang` degrees.

    A wall of sites d apart leans by tan θ = offset / (2 · d · layer_height). Of all pairs of a
    growing and a resting site the nearest one are neighbours in the Voronoi diagram (a third
    site within the circle over them would make a nearer pair), so the bound is met at the base
    already. Infinite at 90°, or where all sites are of one kind.
    """
    if max_overhang >= 90 or grows.all() or not grows.any():
        return math.inf
    nearest = np.min(KDTree(sites[grows]).query(sites[~grows])[0])
    return float(2 * nearest * layer_height * np.tan(np.radians(max_overhang)))
