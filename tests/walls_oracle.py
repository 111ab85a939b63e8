"""Walls by an independent way: the lower hull of the sites lifted to four dimensions (qhull)."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from v3dcad.geometry.solid.facets import Facets, welded_facets
from v3dcad.model import Floats

Key = tuple[int, ...]


def power_walls(sites: Floats, growth: Floats, base: Floats, low: Floats, high: Floats) -> Facets:
    """Walls of sites (n, 2) with weights base + growth · z, in the box low … high (3,).

    With z² added to every power function, site i is (p, b/2) with the weight a + b²/4. A corner
    is where two sites' wall meets two others (or sides of the box): these four name it.
    """
    count = len(sites)
    places = np.column_stack([sites, growth / 2])
    weights = base + growth**2 / 4
    middle, reach = (low + high) / 2, 50 * (np.abs(high - low).max() + np.ptp(places, axis=0).max())
    far = middle + reach * np.array([[1, 1.1, 1.2], [-1.1, -1, 1], [-1, 1.2, -1], [1.2, -1, -1.1]])
    points = np.vstack([places, far]) - middle
    heavy = np.concatenate([weights, np.full(4, weights.max())])
    hull = ConvexHull(np.column_stack([points, (points**2).sum(axis=1) - heavy]))
    simplices = np.sort(hull.simplices[hull.equations[:, 3] < -1e-12], axis=1)
    around: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for simplex in simplices.tolist():
        for a in range(4):
            for b in range(a + 1, 4):
                i, j = simplex[a], simplex[b]
                if j < count:
                    rest = [k for k in simplex if k not in (i, j)]
                    around.setdefault((i, j), []).append((rest[0], rest[1]))
    lifted = np.column_stack([2 * points, heavy - (points**2).sum(axis=1)])

    def corner(key: Key) -> Floats:
        rows, right = [], []
        first = key[-2]  # the wall's own sites stand last
        for k in key[:-2] + key[-1:]:
            if k < 0:  # a side of the box
                axis, side = divmod(-1 - k, 2)
                row = np.zeros(3)
                row[axis] = 1.0
                rows.append(row)
                right.append((low, high)[side][axis] - middle[axis])
            else:
                rows.append(lifted[k, :3] - lifted[first, :3])
                right.append(lifted[first, 3] - lifted[k, 3])
        return np.linalg.solve(np.array(rows), np.array(right)) + middle

    corners: list[Floats] = []
    starts, pairs = [0], []
    for (i, j), links in sorted(around.items()):
        labels = _ring(links)
        if labels is None:
            continue
        ring = [(labels[k - 1], labels[k]) for k in range(len(labels))]
        where = [corner((min(ab), max(ab), i, j)) for ab in ring]
        for axis in range(3):
            for side in range(2):
                bound = (low, high)[side][axis]
                ring, where = _clip(
                    ring,
                    where,
                    -1 - (2 * axis + side),
                    axis,
                    bound,
                    side,
                    lambda a, b, i=i, j=j: corner((min(a, b), max(a, b), i, j)),
                )
        if len(ring) < 3:
            continue
        corners += where
        starts.append(len(corners))
        pairs.append((i, j))
    pairs_array = np.array(pairs, np.int64).reshape(-1, 2)
    return welded_facets(pairs_array, np.reshape(corners, (-1, 3)), np.array(starts), places)


def _ring(links: list[tuple[int, int]]) -> list[int] | None:
    ways: dict[int, list[int]] = {}
    for a, b in links:
        ways.setdefault(a, []).append(b)
        ways.setdefault(b, []).append(a)
    if any(len(found) != 2 for found in ways.values()):
        return None
    first = min(ways)
    ring = [first, ways[first][0]]
    while True:
        a, b = ways[ring[-1]]
        following = b if a == ring[-2] else a
        if following == first:
            return ring
        ring.append(following)


def _clip(ring, where, plane, axis, bound, side, corner):  # type: ignore[no-untyped-def]
    """Clip a polygon whose corners lie between edges named (before, after) by one side."""
    inside = [(at[axis] <= bound) if side else (at[axis] >= bound) for at in where]
    if all(inside) or not any(inside):
        return (ring, where) if all(inside) else ([], [])
    new_ring, new_where = [], []
    for k in range(len(ring)):
        following = (k + 1) % len(ring)
        if inside[k]:
            new_ring.append(ring[k])
            new_where.append(where[k])
        if inside[k] != inside[following]:
            along = ring[k][1]
            name = (along, plane) if inside[k] else (plane, along)
            new_ring.append(name)
            new_where.append(corner(*name))
    return new_ring, new_where
