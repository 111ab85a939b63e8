"""Edges drawn back into an area, where they stick out of it."""

from __future__ import annotations

import numpy as np
import shapely

from v3dcad.model import Floats

HAIR = 1e-3
"""Of an edge's length: ends that lie nearer to the border of the area are not outside."""


def trimmed(edges: Floats, area: shapely.Geometry, most: float = np.inf) -> Floats:
    """Edges (e, 2, 2), mm; of those that end outside the area only the longest piece in it.

    They keep their direction. One that lies outside shrinks to the nearest point of the area. Edges
    with an end farther than `most` mm from the area stay as they are.
    """
    if area.is_empty or not len(edges):
        return edges
    shapely.prepare(area)
    inward = edges + HAIR * (edges[:, ::-1] - edges)
    out = np.flatnonzero(~shapely.contains_xy(area, *np.moveaxis(inward, 2, 0)).all(axis=1))
    far = shapely.distance(shapely.points(edges[out]), area).max(axis=1, initial=0.0)
    out = out[far <= most]
    cut = shapely.intersection(shapely.linestrings(edges[out]), area)
    pieces, of = shapely.get_parts(cut, return_index=True)
    order = np.lexsort((shapely.length(pieces), of))
    pieces, of = pieces[order], of[order]
    longest = np.append(of[1:] != of[:-1], True)[: len(of)]
    found = shapely.get_coordinates(
        shapely.shortest_line(area, shapely.points(edges[out].mean(axis=1)))
    ).reshape(-1, 2, 2)[:, [0, 0]]
    line = longest & (shapely.length(pieces) > 0)
    ends = [shapely.get_point(pieces[line], place) for place in (0, -1)]
    found[of[line]] = np.stack([shapely.get_coordinates(end) for end in ends], axis=1)
    along = edges[out, 1] - edges[out, 0]
    turned = ((found[:, 1] - found[:, 0]) * along).sum(axis=1) < 0
    found[turned] = found[turned][:, ::-1]
    kept = edges.copy()
    kept[out] = found
    return kept
