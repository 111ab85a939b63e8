"""A vertical plane through a structure, seen as its layers see it.

Each wall of a foam is plane, so a vertical plane cuts it in a straight line. Every layer knows one
point of that line: where the plane crosses the wall between the same two sites. Points of one wall
on two layers, one above the other, are joined. That needs nothing but the layers, stays inside the
part, and holds for the thesis's method too. Contours are joined in their order along the plane,
where it crosses as many as on the layer below; where it does not, they end.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from v3dcad.model import Floats, Ints, Layer


class VerticalCut(NamedTuple):
    """Lines in a plane parallel to x and z, bed coordinates."""

    points: Floats
    """(n, 3) mm: where edges of layers cross the plane"""
    walls: Ints
    """(w, 2) rows of `points`"""
    contours: Ints
    """(c, 2) rows of `points`"""


class _Crossings(NamedTuple):
    """Where one layer's edges cross the plane, from left to right."""

    x: Floats
    sites: Ints
    """(k, 2) between which sites"""
    first: int
    """the row of the first"""

    def contours(self) -> Ints:
        return self.first + np.flatnonzero(self.sites[:, 0] < 0)

    def walls(self) -> dict[tuple[int, ...], int]:
        return {
            tuple(pair): self.first + row
            for row, pair in enumerate(self.sites.tolist())
            if pair[0] >= 0
        }


def vertical_cut(layers: Iterable[Layer], y: float = 0.0) -> VerticalCut:
    """The cut of a structure by the plane at y, mm, bed coordinates: by default the part's middle.

    Goes through the layers once.
    """
    points = [np.empty((0, 3))]
    walls: list[tuple[int, int]] = []
    contours: list[tuple[int, int]] = []
    below = _Crossings(np.empty(0), np.empty((0, 2), np.int64), 0)
    for layer in layers:
        here = _crossings(layer, y, below.first + len(below.x))
        points.append(
            np.column_stack([here.x, np.full_like(here.x, y), np.full_like(here.x, layer.z)])
        )
        lower, upper = below.walls(), here.walls()
        walls += [(lower[pair], row) for pair, row in upper.items() if pair in lower]
        if len(below.contours()) == len(here.contours()):
            contours += zip(below.contours().tolist(), here.contours().tolist(), strict=True)
        below = here
    return VerticalCut(np.concatenate(points), _rows(walls), _rows(contours))


def _crossings(layer: Layer, y: float, first: int) -> _Crossings:
    """Where edges of a layer cross the plane; one that ends on it counts where it lies above."""
    diagram = layer.diagram
    start, stop = np.moveaxis(diagram.vertices[diagram.edges], 1, 0)
    crossing = (start[:, 1] < y) != (stop[:, 1] < y)
    start, stop = start[crossing], stop[crossing]
    share = (y - start[:, 1]) / (stop[:, 1] - start[:, 1])
    x = start[:, 0] + share * (stop[:, 0] - start[:, 0])
    order = np.argsort(x, kind="stable")
    return _Crossings(x[order], diagram.edge_sites[crossing][order], first)


def _rows(pairs: list[tuple[int, int]]) -> Ints:
    return np.array(pairs, np.int64).reshape(-1, 2)
