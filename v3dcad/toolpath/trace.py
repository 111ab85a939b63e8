"""A layer's edges in the order they are printed: contours first, then the nearest next edge."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from scipy.spatial import KDTree

from v3dcad.model import EXTRUDE, RETRACT, TRAVEL, UNRETRACT, Diagram, Floats, Ints, Layer, Toolpath
from v3dcad.settings import PrintSettings


def trace(layers: Iterable[Layer], settings: PrintSettings) -> Iterator[Toolpath]:
    """One toolpath a layer: every edge of its diagram extruded once.

    A layer is printed at its section's height plus the first layer's height; its beads are
    rectangles of `bead_width` times the distance to the layer below.
    """
    here = np.zeros(2)
    below = 0.0
    for layer in layers:
        z = layer.z + settings.first_layer_height
        strokes = _strokes(layer.diagram, here)
        if strokes:
            here = layer.diagram.vertices[strokes[-1][-1]]
            area = settings.bead_width * (z - below) * settings.flow / 100
            yield _toolpath(layer, strokes, z, area, settings)
        below = z


def _strokes(diagram: Diagram, here: Floats) -> list[list[int]]:
    """Vertex ids, stroke by stroke: together they pass every edge once.

    From where it is, a stroke goes on along an edge not yet passed, contours before walls;
    where there is none, the next starts at the nearest vertex that has one.
    """
    inner = diagram.inner()
    strokes: list[list[int]] = []
    for edges in (diagram.edges[~inner], diagram.edges[inner]):
        passed = np.zeros(len(edges), dtype=bool)
        first, edges_at = _incidence(edges, len(diagram.vertices))
        cursor = first[:-1].copy()

        def next_edge(
            vertex: int,
            passed: np.ndarray = passed,
            first: Ints = first,
            edges_at: Ints = edges_at,
            cursor: Ints = cursor,
        ) -> int:
            while cursor[vertex] < first[vertex + 1]:
                edge = int(edges_at[cursor[vertex]])
                if not passed[edge]:
                    return edge
                cursor[vertex] += 1
            return -1

        left = len(edges)
        while left:
            vertex = _nearest_open(diagram.vertices, edges[~passed], here)
            stroke = [vertex]
            while (edge := next_edge(vertex)) >= 0:
                passed[edge] = True
                left -= 1
                vertex = int(edges[edge].sum()) - vertex
                stroke.append(vertex)
            strokes.append(stroke)
            here = diagram.vertices[vertex]
    return strokes


def _incidence(edges: Ints, count: int) -> tuple[Ints, Ints]:
    """The edges at each vertex, as rows first[v] … first[v + 1] of one list."""
    order = np.argsort(edges.ravel(), kind="stable")
    degree = np.bincount(edges.ravel(), minlength=count)
    return np.concatenate([[0], np.cumsum(degree)]), order // 2


def _nearest_open(vertices: Floats, edges: Ints, here: Floats) -> int:
    """The nearest vertex with an edge to pass; first choice are those of odd degree.

    A stroke that starts at an odd vertex ends at another one, which saves a travel.
    """
    degree = np.bincount(edges.ravel(), minlength=len(vertices))
    odd = np.nonzero(degree % 2)[0]
    open_ = odd if len(odd) else np.nonzero(degree)[0]
    return int(open_[KDTree(vertices[open_]).query(here)[1]])


def _toolpath(
    layer: Layer, strokes: list[list[int]], z: float, area: float, settings: PrintSettings
) -> Toolpath:
    ids: list[int] = []
    kinds: list[int] = []
    for stroke in strokes:
        ids += [stroke[0], stroke[0], stroke[0], *stroke[1:]]
        kinds += [RETRACT, TRAVEL, UNRETRACT] + [EXTRUDE] * (len(stroke) - 1)
    kind = np.array(kinds, dtype=np.int8)
    flat = layer.diagram.vertices[ids]
    # The filament is pulled back where the stroke before ended, not where the next one starts.
    flat[1:][kind[1:] == RETRACT] = flat[:-1][kind[1:] == RETRACT]
    keep = (kind == TRAVEL) | (kind == EXTRUDE) if settings.retraction == 0 else kind >= 0
    length = np.concatenate([[0.0], np.hypot(*np.diff(flat, axis=0).T)])
    extruding = kind == EXTRUDE
    return Toolpath(
        points=np.column_stack([flat, np.full(len(flat), z)])[keep],
        kind=kind[keep],
        volume=np.where(extruding, length * area, 0.0)[keep],
        speed=np.where(extruding, settings.print_speed, settings.travel_speed)[keep],
        layer=np.full(np.count_nonzero(keep), layer.index),
    )
