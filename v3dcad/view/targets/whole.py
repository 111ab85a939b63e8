"""Targets that go through all layers: the whole structure, a vertical cut, the overhang."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from itertools import islice
from typing import NamedTuple

import numpy as np

from v3dcad.model import Floats, Ints, Layer, Placement
from v3dcad.view.targets.one_layer import contours, walls_and_contours
from v3dcad.view.targets.shown import Labels, Lines, Preview, Scale
from v3dcad.view.vertical_cut import vertical_cut
from v3dcad.words import counted

MOST_LINES = 500_000
"""About how many lines are shown at most: of more, every so many layers are left out."""

NO_LABELS = Labels.none()

Span = tuple[float, float]
"""How high a layer is, and where it begins over its section, mm (`FillSettings.layer_span`)."""

NO_SPAN = (0.0, 0.0)


def layer_step(layers: Sequence[Layer], most: int = MOST_LINES) -> int:
    """Every how many layers one is shown, so that there are about `most` lines; of few, each.

    The layer in the middle stands for all.
    """
    if not layers:
        return 1
    return max(1, math.ceil(len(layers) * len(layers[len(layers) // 2].diagram.edges) / most))


def full(layers: Sequence[Layer], _: Span = NO_SPAN, *, most: int = MOST_LINES) -> Preview:
    """Walls and contours of all layers, or of every so many where there are very many lines."""
    step = layer_step(layers, most)
    drawn = [walls_and_contours(layer) for layer in islice(layers, 0, None, step)]
    lines = tuple(_joined(role, [one[k] for one in drawn]) for k, role in enumerate(_FULL))
    title = f"the whole structure, {_counted(layers, step)}"
    return Preview(target="full", title=title, lines=lines, labels=NO_LABELS, cells=_NONE)


def overhang(layers: Sequence[Layer], _: Span = NO_SPAN, *, most: int = MOST_LINES) -> Preview:
    """Walls of all layers by their tilt from the vertical, degrees, and the contours as context.

    Thinned like `full`.
    """
    step = layer_step(layers, most)
    drawn, tilts = [], [np.empty(0)]
    for layer in islice(layers, 0, None, step):
        drawn.append(walls_and_contours(layer))
        tilts.append(edge_tilts(layer)[layer.diagram.inner()])
    values = np.concatenate(tilts)
    scale = Scale("tilt", "°", 0.0, float(values.max(initial=0.0)))
    around, walls = (_joined(role, [one[k] for one in drawn]) for k, role in enumerate(_FULL))
    return Preview(
        target="overhang",
        title=f"walls lean up to {scale.high:.1f}°, {_counted(layers, step)}",
        lines=(
            Lines("context", around.points, around.pairs),
            Lines("wall", walls.points, walls.pairs, values),
        ),
        labels=NO_LABELS,
        cells=_NONE,
        scale=scale,
    )


def cut(layers: Sequence[Layer], span: Span = NO_SPAN) -> Preview:
    """Walls and contours in the plane y = 0 of the bed; bottom and top contours as context."""
    found = vertical_cut(layers, span=span)
    height, base = span
    ends = ((0, base), (-1, base + height)) if layers else ()
    lines = (
        _joined("context", [_lifted(contours(layers[index]), above) for index, above in ends]),
        Lines("contour", found.points, found.contours),
        Lines("wall", found.points, found.walls),
    )
    title = "vertical cut through the middle"
    return Preview(target="cut", title=title, lines=lines, labels=NO_LABELS, cells=_NONE)


SHOWS: dict[str, Callable[[Sequence[Layer], Span], Preview]] = {
    "full": full,
    "cut": cut,
    "overhang": overhang,
}


def edge_tilts(layer: Layer) -> Floats:
    """(e,) how far the wall at each edge leans from the vertical, degrees; NaN on contours."""
    inner = layer.diagram.inner()
    tilts = np.full(len(inner), np.nan)
    tilts[inner] = np.degrees(np.arctan(layer.slopes(layer.diagram.edge_sites[inner])))
    return tilts


class Edges(NamedTuple):
    """All edges of some layers, where the source lies."""

    points: Floats
    """(n, 3) mm"""
    pairs: Ints
    """(m, 2) which points each edge joins"""
    layer: Ints
    """(m,) the index of its layer"""
    sites: Ints
    """(m, 2) the sites beside it, i < j; −1 on the section's boundary"""
    tilts: Floats
    """(m,) degrees, as `edge_tilts` has them"""


def all_edges(layers: Iterable[Layer], placement: Placement) -> Edges:
    """All edges of layers. Goes through the layers once."""
    points, pairs = [np.empty((0, 3))], [np.empty((0, 2), np.int64)]
    indices, sites, tilts = [np.empty(0, np.int64)], [np.empty((0, 2), np.int64)], [np.empty(0)]
    first = 0
    for layer in layers:
        diagram = layer.diagram
        corners = len(diagram.vertices)
        points.append(np.column_stack([diagram.vertices, np.full(corners, layer.z)]))
        pairs.append(diagram.edges + first)
        indices.append(np.full(len(diagram.edges), layer.index))
        sites.append(diagram.edge_sites)
        tilts.append(edge_tilts(layer))
        first += corners
    return Edges(
        placement.to_source(np.concatenate(points)),
        np.concatenate(pairs),
        np.concatenate(indices),
        np.concatenate(sites),
        np.concatenate(tilts),
    )


_FULL = ("contour", "wall")
_NONE = np.empty(0, np.int64)


def _counted(layers: Sequence[Layer], step: int) -> str:
    whole = counted(len(layers), "layer")
    return whole if step == 1 else f"one in {step} of {whole}"


def _lifted(lines: Lines, above: float) -> Lines:
    """Lines so much higher, mm."""
    return replace(lines, points=lines.points + np.array([0.0, 0.0, above]))


def _joined(role: str, drawn: Sequence[Lines]) -> Lines:
    """Several lines as one."""
    if not drawn:
        return Lines(role, np.empty((0, 3)), np.empty((0, 2), np.int64))
    first = np.cumsum([0, *(len(lines.points) for lines in drawn[:-1])])
    pairs = [lines.pairs + start for lines, start in zip(drawn, first.tolist(), strict=True)]
    return Lines(role, np.concatenate([lines.points for lines in drawn]), np.concatenate(pairs))
