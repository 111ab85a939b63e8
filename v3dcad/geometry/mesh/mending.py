"""Mending where triangles do not meet: near corners joined; doubles, fins, inner walls dropped."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from v3dcad.geometry.mesh.bodies import sheets_of, sides_of
from v3dcad.model import Floats, Ints
from v3dcad.words import counted

NEAR = 1e-6
"""Share of a mesh's greatest coordinate or size: sixteen times the rounding of single precision."""

ROUGH = 1e-3
"""The same share for a mesh that is to be repaired, reached by steps of ten;"""

OF_EDGE = 0.1
"""and the largest share of an open edge's usual length."""

CROWDED = 50
"""Corners within reach of one, on average, among which none is welded: they are no rounding."""


def without_doubles(vertices: Floats, triangles: Ints, findings: list[str]) -> Ints:
    """The triangles (t, 3) once each, and none of those that lie on each other back to back.

    As where bodies share a face. But a body of which all triangles are there both ways, and which
    they close, is a body all the same; where they do not, it is a sheet without thickness.
    """
    ordered = np.sort(triangles, axis=1)
    _, first, group = np.unique(ordered, axis=0, return_index=True, return_inverse=True)
    if len(first) == len(triangles):
        return triangles
    net = np.bincount(group.ravel(), _ways(triangles, ordered))
    cancels = net == 0
    node_body = _joined_nodes(len(vertices), triangles)
    body = node_body[triangles[first, 0]]
    whole = np.bincount(body, ~cancels, node_body.max() + 1) == 0
    odd = _odd_edges(triangles[first])
    whole[node_body[odd[:, 0]]] = False
    cancels &= ~whole[body]
    repeated = len(triangles) - len(first) - int(cancels.sum())
    if repeated:
        findings.append(f"dropped {repeated} repeated triangles")
    return triangles[np.sort(first[~cancels])]


def _ways(triangles: Ints, ordered: Ints) -> Ints:
    """(t,) 1 for triangles that pass their corners as their sorted ones do, −1 for others."""
    turn = (triangles.argmin(axis=1)[:, None] + np.arange(3)) % 3
    begun = np.take_along_axis(triangles, turn, axis=1)
    return np.where(begun[:, 1] == ordered[:, 1], 1, -1)


def _joined_nodes(count: int, triangles: Ints) -> Ints:
    """(v,) which nodes triangles join, straight or through others."""
    one, other = triangles[:, [0, 1]].T.ravel(), triangles[:, [1, 2]].T.ravel()
    graph = coo_array((np.ones(len(one), np.int8), (one, other)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)


def near_welded(
    vertices: Floats, triangles: Ints, findings: list[str], *, repair: bool = False
) -> Ints:
    """The triangles (t, 3) with corners at open edges joined that are nearer than `NEAR`.

    With `repair`, and as long as edges are open, those nearer than ten times that, and so on up to
    `ROUGH`; never more than `OF_EDGE` of the open edges' median length. Of the corners that are
    joined the first in order is kept. Where that opens more edges than it closes, the triangles
    stay as they are. A mesh without open edges stays as it is.
    """
    odd = _odd_edges(triangles)
    if not len(odd):
        return triangles
    used = vertices[triangles.ravel()]
    size = max(float(np.abs(used).max()), float(np.ptp(used, axis=0).max()))
    place = np.arange(len(vertices))
    welded, share = triangles, NEAR
    while len(odd) and share <= (ROUGH if repair else NEAR):
        usual = float(np.median(np.linalg.norm(vertices[odd[:, 0]] - vertices[odd[:, 1]], axis=1)))
        kept = _joined(vertices, np.unique(odd), min(share * size, OF_EDGE * usual))
        joined = kept[welded]
        joined = joined[np.all(joined != np.roll(joined, 1, axis=1), axis=1)]
        still = _odd_edges(joined)
        if len(still) < len(odd):
            welded, place, odd = joined, kept[place], still
        share *= 10
    if welded is not triangles:
        moved = np.linalg.norm(vertices[place] - vertices, axis=1).max()
        corners = counted(int((place != np.arange(len(place))).sum()), "corner")
        findings.append(f"joined {corners} that lay up to {moved:.2g} mm beside another")
    return welded


def _joined(vertices: Floats, nodes: Ints, reach: float) -> Ints:
    """(v,) which node each is when those of `nodes` that are nearer than `reach`, mm, are one."""
    kept = np.arange(len(vertices))
    tree = KDTree(vertices[nodes])
    if tree.count_neighbors(tree, reach) > CROWDED * len(nodes):
        return kept
    pairs = tree.query_pairs(reach, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs), np.int8), pairs.T), (len(nodes),) * 2)
    group = connected_components(graph, directed=False)[1]
    _, first = np.unique(group, return_index=True)
    kept[nodes] = nodes[first[group]]
    return kept


def _odd_edges(triangles: Ints) -> Ints:
    """(k, 2) the ends of edges that an odd number of triangles share."""
    sides = sides_of(triangles)
    return sides.ends[sides.starts[:-1][sides.uses() % 2 == 1]]


def without_inner_sheets(vertices: Floats, triangles: Ints, findings: list[str]) -> Ints:
    """The triangles (t, 3) without fins and walls inside, which hang on edges of three or five.

    A sheet is what hangs together across edges of two triangles. The smallest goes first, and each
    that leaves fewer edges of an odd number of triangles than there were; but not the largest.
    """
    sides = sides_of(triangles)
    uses = sides.uses()
    if not np.any((uses > 2) & (uses % 2 == 1)):
        return triangles
    sheet = sheets_of(triangles, sides)
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    area = np.bincount(sheet, np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2)
    edge = np.repeat(np.arange(len(uses)), uses)
    rim = np.flatnonzero(uses[edge] != 2)
    pairs, count = np.unique(
        np.column_stack([sheet[sides.triangle[rim]], edge[rim]]), axis=0, return_counts=True
    )
    starts = np.searchsorted(pairs[:, 0], np.arange(len(area) + 1))
    gone = np.zeros(len(area), np.bool_)
    for number in np.argsort(area, kind="stable")[:-1].tolist():
        own = slice(starts[number], starts[number + 1])
        edges, sharing = pairs[own, 1], count[own]
        odd = uses[edges] % 2 == 1
        if not np.any(odd & (uses[edges] > 2)):
            continue
        if np.where(odd, 1, -1)[sharing % 2 == 1].sum() > 0:
            gone[number] = True
            uses[edges] -= sharing
    dropped = gone[sheet]
    if dropped.any():
        findings.append(
            f"dropped fins and inner walls: {counted(int(gone.sum()), 'sheet')} of "
            f"{counted(int(dropped.sum()), 'triangle')}"
        )
    return triangles[~dropped]
