"""Cell edges cut off at the innermost perimeter, which they meet in shared vertices."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely

from v3dcad.model import CELLS, OUTSIDE, PERIMETER, Diagram, Floats, Ints
from v3dcad.toolpath.graph import PathGraph, loops_graph


def trimmed(diagram: Diagram, area: shapely.Geometry, perimeter: Sequence[Floats]) -> PathGraph:
    """The perimeter, rings (k, 2) around `area`, and what lies inside it of the cell edges.

    Every crossing of an edge and the perimeter is a vertex of both. Crossings of the segments
    are computed for the pairs whose boxes meet; a part belongs inside by its middle.
    """
    inner = diagram.inner()
    edges, sites = diagram.edges[inner], diagram.edge_sites[inner]
    rim = loops_graph(perimeter, PERIMETER)
    crossings = _crossings(diagram.vertices[edges], rim.vertices[rim.edges])
    count = len(diagram.vertices)
    vertices = np.concatenate([diagram.vertices, rim.vertices, crossings.points])
    ids = count + len(rim.vertices) + np.arange(len(crossings.edge))

    parts, edge = _parts(edges, crossings.edge, crossings.along_edge, ids)
    middle = vertices[parts].mean(axis=1)
    shapely.prepare(area)
    inside = shapely.contains_xy(area, middle[:, 0], middle[:, 1])
    parts, edge = parts[inside], edge[inside]

    around, _ = _parts(rim.edges + count, crossings.rim, crossings.along_rim, ids)
    return PathGraph(
        vertices,
        np.concatenate([parts, around]),
        np.repeat(np.array([CELLS, PERIMETER], dtype=np.int8), [len(parts), len(around)]),
        np.concatenate([sites[edge], np.full(around.shape, OUTSIDE)]),
        np.full((len(parts) + len(around), 2), np.nan),
    )


class Crossings(NamedTuple):
    """Where edges and the rim's segments cross: `along_…` runs from 0 to 1 on either."""

    edge: Ints
    rim: Ints
    along_edge: Floats
    along_rim: Floats
    points: Floats


def _crossings(edges: Floats, rim: Floats) -> Crossings:
    """Crossings of edges (e, 2, 2) and the rim's segments (s, 2, 2).

    Two segments cross where each has its ends on different sides of the other. The side of a
    shared vertex is computed in the same way for both segments that meet there, so a way
    through a corner of the rim crosses it exactly once.
    """
    tree = shapely.STRtree(shapely.linestrings(rim))
    edge, segment = tree.query(shapely.linestrings(edges))
    start, stop = edges[edge, 0], edges[edge, 1]
    corner, following = rim[segment, 0], rim[segment, 1]
    rim_from, rim_to = _side(start, stop, corner), _side(start, stop, following)
    edge_from, edge_to = _side(corner, following, start), _side(corner, following, stop)
    met = ((rim_from > 0) != (rim_to > 0)) & ((edge_from > 0) != (edge_to > 0))
    along_edge = edge_from[met] / (edge_from[met] - edge_to[met])
    along_rim = rim_from[met] / (rim_from[met] - rim_to[met])
    points = start[met] + along_edge[:, None] * (stop[met] - start[met])
    return Crossings(edge[met], segment[met], along_edge, along_rim, points)


def _side(start: Floats, stop: Floats, point: Floats) -> Floats:
    """Positive where a point (n, 2) lies on the left of the line from start to stop."""
    (x, y), (to_x, to_y) = (point - start).T, (stop - start).T
    return np.asarray(to_x * y - to_y * x)


def _parts(edges: Ints, of: Ints, along: Floats, ids: Ints) -> tuple[Ints, Ints]:
    """Edges split at crossings `ids` at `along` of edge `of`: the parts, and whose they are."""
    owner = np.concatenate([np.arange(len(edges)), of])
    order = np.lexsort((np.concatenate([np.full(len(edges), -1.0), along]), owner))
    start = np.concatenate([edges[:, 0], ids])[order]
    owner = owner[order]
    last = np.concatenate([owner[1:] != owner[:-1], np.ones(min(len(owner), 1), dtype=bool)])
    stop = np.concatenate([start[1:], start[:1]])
    stop[last] = edges[owner[last], 1]
    return np.column_stack([start, stop]), owner
