"""Layers as the arrays that the page draws, one layer after the other.

Beside `walls`, whose rows belong to layers, `walls_from` (k + 1,) says where each layer's begin.
Edges name the vertices of their own layer, counted from 0, and so their numbers stay small.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from v3dcad.model import OUTSIDE, Diagram, Floats, Ints, Layer

Arrays = dict[str, NDArray[Any]]

UPRIGHT = 90
"""Is added to degrees from the vertical, so that none is below 0."""

GROUPS: dict[str, Arrays] = {
    "vertices": {"vertices": np.empty((0, 2))},
    "walls": {
        "walls": np.empty((0, 2), np.int64),
        "wall_sites": np.empty((0, 2), np.int64),
        "wall_leans": np.empty(0, np.uint8),
    },
    "contours": {
        "contours": np.empty((0, 2), np.int64),
        "contour_sites": np.empty(0, np.int64),
    },
    "struts": {"struts": np.empty((0, 2), np.int64)},
    "trees": {"trees": np.empty((0, 2), np.int64)},
    "cells": {"cells": np.empty(0, np.int64), "cell_places": np.empty((0, 2), np.float32)},
}
"""What is told of a layer, empty: the arrays of a group have the same rows.

| array | holds |
|---|---|
| `vertices` | fractions of the part's width and depth |
| `walls`, `contours` | the two vertices of each edge |
| `wall_sites`, `contour_sites` | the cells right and left of a wall, the cell inside a contour |
| `wall_leans` | degrees from the vertical towards the left, rounded, plus `UPRIGHT` |
| `struts` | a vertex of this layer, and one of the next that is shown, where the same cells meet |
| `trees` | rows of the layer's `cells` |
| `cells`, `cell_places` | site numbers, and where the sites stand, mm |
"""


class LayerArrays(NamedTuple):
    """What is told of one layer."""

    z: float
    number: int
    told: Arrays
    meeting: Ints
    """(m, 4) a vertex and the three sites whose cells meet there"""

    @classmethod
    def of(cls, layer: Layer) -> LayerArrays:
        """All that the layer by itself can tell: all but its struts."""
        diagram, inner = layer.diagram, layer.diagram.inner()
        cells = diagram.sites()
        told = {
            "vertices": diagram.vertices,
            "walls": diagram.edges[inner],
            "wall_sites": diagram.edge_sites[inner],
            "wall_leans": _leans(layer, diagram.edge_sites[inner]),
            "contours": diagram.edges[~inner],
            "contour_sites": diagram.edge_sites[~inner, 1],
            "trees": np.searchsorted(cells, layer.tree),
            "cells": cells,
            "cell_places": layer.state.sites[cells, :2].astype(np.float32),
        }
        return cls(layer.z, layer.index, told, _meeting(diagram))

    def edges(self) -> int:
        """How many edges the layer has."""
        return len(self.told["walls"]) + len(self.told["contours"])


def layer_arrays(layers: Sequence[LayerArrays], bounds: Floats) -> Arrays:
    """The arrays of layers, ascending, in a part with bounds (2, 3), mm."""
    above = [*layers[1:], None]
    rows = [
        {**one.told, "struts": _struts(one, following)}
        for one, following in zip(layers, above, strict=True)
    ]
    found: Arrays = {
        "z": np.array([one.z for one in layers], np.float32),
        "index": np.array([one.number for one in layers], np.uint32),
    }
    for group, columns in GROUPS.items():
        for name, empty in columns.items():
            found[name] = np.concatenate([empty, *(row[name] for row in rows)])
        counts = [len(row[group]) for row in rows]
        found[f"{group}_from"] = np.cumsum([0, *counts]).astype(np.uint32)
    found["vertices"] = fractions(found["vertices"], bounds[:, :2])
    return found


def fractions(points: Floats, bounds: Floats) -> NDArray[np.uint16]:
    """Points (n, d) in bounds (2, d) as whole numbers: 0 at the least, 65535 at the greatest.

    In a part of 100 mm they err by less than a thousandth of a millimetre.
    """
    low, high = bounds
    share: Floats = (points - low) / np.maximum(high - low, np.finfo(float).tiny)
    return np.asarray(np.rint(np.clip(share, 0, 1) * 65535), np.uint16)


def _leans(layer: Layer, sites: Ints) -> NDArray[np.uint8]:
    """(m,) by how many degrees, plus `UPRIGHT`, walls lean from site i towards j, of sites (m, 2).

    As the layers rise, a wall moves away from the site whose weight grows more.
    """
    growth = layer.state.growth[sites]
    towards = np.sign(growth[:, 0] - growth[:, 1])
    leans = towards * np.degrees(np.arctan(layer.slopes(sites)))
    return np.asarray(np.rint(leans + UPRIGHT), np.uint8)


def _meeting(diagram: Diagram) -> Ints:
    """(m, 4) the vertices where exactly three cells meet, and the cells' sites, ascending."""
    corners = np.repeat(diagram.edges.ravel(), 2)
    sites = np.repeat(diagram.edge_sites, 2, axis=0).ravel()
    around = np.unique(np.column_stack([corners, sites]), axis=0)
    count = np.bincount(around[:, 0], minlength=len(diagram.vertices))
    inside = np.ones(len(diagram.vertices), np.bool_)
    inside[around[around[:, 1] == OUTSIDE, 0]] = False
    vertices = np.flatnonzero((count == 3) & inside)
    chosen = np.isin(around[:, 0], vertices)
    return np.column_stack([vertices, around[chosen, 1].reshape(-1, 3)])


def _struts(lower: LayerArrays, upper: LayerArrays | None) -> Ints:
    """(s, 2) vertices of two layers, one above the other, where the same three cells meet."""
    if upper is None:
        return np.empty((0, 2), np.int64)
    places = {tuple(sites): vertex for vertex, *sites in upper.meeting.tolist()}
    pairs = [
        (vertex, places[tuple(sites)])
        for vertex, *sites in lower.meeting.tolist()
        if tuple(sites) in places
    ]
    return np.array(pairs, np.int64).reshape(-1, 2)
