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
    tree = shapely.STRtree(shapely.linestrings(rim))
    edge, segment = tree.query(shapely.linestrings(edges))
    start, step = edges[edge, 0], edges[edge, 1] - edges[edge, 0]
    corner, side = rim[segment, 0], rim[segment, 1] - rim[segment, 0]
    turn = _cross(step, side)
    with np.errstate(divide="ignore", invalid="ignore"):
        along_edge = _cross(corner - start, side) / turn
        along_rim = _cross(corner - start, step) / turn
    # A segment's end belongs to the next one, so that no crossing is counted twice.
    met = (turn != 0) & (along_edge >= 0) & (along_edge <= 1)
    met &= (along_rim >= 0) & (along_rim < 1)
    along_edge = along_edge[met]
    points = start[met] + along_edge[:, None] * step[met]
    return Crossings(edge[met], segment[met], along_edge, along_rim[met], points)


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


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
