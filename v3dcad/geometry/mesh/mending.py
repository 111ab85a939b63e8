"""Mending where triangles do not meet: near corners welded, edges of odd many triangles opened."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from v3dcad.geometry.mesh.bodies import sides_of
from v3dcad.model import Floats, Ints

NEAR = 1e-6
"""Share of a mesh's greatest coordinate or size: sixteen times the rounding of single precision."""

ROUNDS = 8
"""Most times that triangles are dropped at edges that an odd number of them share."""


def near_welded(vertices: Floats, triangles: Ints, findings: list[str]) -> Ints:
    """The triangles (t, 3) with corners at open edges joined that are nearer than `NEAR`.

    Of the corners that are joined the first in order is kept. Where that opens more edges than it
    closes, the triangles stay as they are. A mesh without open edges stays as it is.
    """
    open_before = _open_edges(triangles)
    if not len(open_before):
        return triangles
    used = vertices[triangles.ravel()]
    reach = NEAR * max(float(np.abs(used).max()), float(np.ptp(used, axis=0).max()))
    rim = np.unique(open_before)
    pairs = KDTree(vertices[rim]).query_pairs(reach, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), (len(rim),) * 2)
    group = connected_components(graph, directed=False)[1]
    _, first = np.unique(group, return_index=True)
    kept = np.arange(len(vertices))
    kept[rim] = rim[first[group]]
    joined = kept[triangles]
    joined = joined[np.all(joined != np.roll(joined, 1, axis=1), axis=1)]
    if len(_open_edges(joined)) >= len(open_before):
        return triangles
    moved = np.linalg.norm(vertices[kept] - vertices, axis=1).max()
    findings.append(
        f"joined {int((kept != np.arange(len(kept))).sum())} corners that lay up to {moved:.2g} mm "
        "beside another"
    )
    return np.asarray(joined)


def _open_edges(triangles: Ints) -> Ints:
    """(k, 2) the ends of edges that an odd number of triangles share."""
    sides = sides_of(triangles)
    return sides.ends[sides.starts[:-1][sides.uses() % 2 == 1]]


def without_odd_edges(triangles: Ints, findings: list[str]) -> Ints:
    """The triangles (t, 3) without those at edges of three or five of them, which leaves holes.

    Fins, which hang on such an edge with open edges of their own, go first: they leave none.
    """
    before = len(triangles)
    for _ in range(ROUNDS):
        sides = sides_of(triangles)
        uses = np.repeat(sides.uses(), sides.uses())
        odd = np.unique(sides.triangle[(uses > 2) & (uses % 2 == 1)])
        if not len(odd):
            break
        fins = np.intersect1d(odd, sides.triangle[uses == 1])
        triangles = np.delete(triangles, fins if len(fins) else odd, axis=0)
    if len(triangles) < before:
        findings.append(
            f"dropped {before - len(triangles)} triangles at edges that an odd number of them share"
        )
    return triangles
