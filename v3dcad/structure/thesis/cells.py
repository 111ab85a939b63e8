"""Cells of a diagram as polygons, and how many corners they have."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from v3dcad.model import OUTSIDE, Diagram, Floats, Ints

DECIMALS = 6
"""Points that agree in so many decimals of a millimetre are one (Algorithm 3 leaves it open)."""

NO_AREA = 1e-12
"""A cell with less than this share of the largest cell's area is none."""


def present(diagram: Diagram, count: int) -> NDArray[np.bool_]:
    """(count,) which of `count` sites have a cell with area inside the section."""
    areas = diagram.areas(count)
    return np.asarray(areas > NO_AREA * areas.max(initial=0.0))


def rings(diagram: Diagram, site: int) -> list[Ints]:
    """A cell's boundary as rings of vertex ids, each (k,), the cell on their left.

    One ring for a cell in one piece, more where the section's holes or gaps divide it, none
    where the site has no cell. `OUTSIDE` gives the section's own rings.
    """
    onward = diagram.edges[diagram.edge_sites[:, 1] == site]
    back = diagram.edges[diagram.edge_sites[:, 0] == site]
    if site == OUTSIDE:
        return _linked(back)
    return _linked(np.concatenate([onward, back[:, ::-1]]))


def _linked(edges: Ints) -> list[Ints]:
    """Directed edges (e, 2) joined end to start to closed rings, from their smallest ids on."""
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    onward: dict[int, list[int]] = {}
    for start, stop in edges[order[::-1]].tolist():
        onward.setdefault(start, []).append(stop)
    found = []
    for first in edges[order, 0].tolist():
        ring = []
        vertex = first
        while onward.get(vertex):
            ring.append(vertex)
            vertex = onward[vertex].pop()
        if ring:
            found.append(np.array(ring))
    return found


def corner_signatures(diagram: Diagram) -> list[tuple[int, ...]]:
    """For each vertex the cells around it, ascending; `OUTSIDE` on the section's boundary."""
    around: list[set[int]] = [set() for _ in diagram.vertices]
    for edge, pair in zip(diagram.edges.tolist(), diagram.edge_sites.tolist(), strict=True):
        for vertex in edge:
            around[vertex].update(pair)
    return [tuple(sorted(sites)) for sites in around]


def corner_count(diagram: Diagram, site: int) -> int:
    """The number of distinct corners of a site's cell (Algorithm 4)."""
    ids = diagram.edges[(diagram.edge_sites == site).any(axis=1)]
    return len(np.unique(diagram.vertices[ids.ravel()].round(DECIMALS), axis=0))


def is_convex(polygon: Floats) -> bool:
    """Whether a counter-clockwise polygon (k, 2), mm, turns right nowhere.

    By more than 1e-6 mm to the side, that is: the rounding of its points is let pass.
    """
    along = np.roll(polygon, -1, axis=0) - polygon
    onward = np.roll(along, -1, axis=0)
    turn = along[:, 0] * onward[:, 1] - along[:, 1] * onward[:, 0]
    return bool((turn >= -1e-6 * np.hypot(*along.T)).all())


def area(polygon: Floats) -> float:
    """Signed area of a polygon (k, 2), mm²."""
    x, y = (polygon - polygon[0]).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
