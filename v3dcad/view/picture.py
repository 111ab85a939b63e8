"""A picture of a structure: its layers in perspective, each hiding what lies below it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO

import numpy as np

from v3dcad.model import Floats, Layer

BACKGROUND, INSIDE, WALL, CONTOUR = "#ffffff", "#f3f7f8", "#1f6f8b", "#d1495b"

TURN, TILT = np.radians(-30), np.radians(38)
"""Where the eye is: to the front right of the part, and above it."""

DISTANCE = 2.2
"""From the eye to the part's middle, in sizes of the part."""


def draw(
    layers: Sequence[Layer], target: Path | BinaryIO, shown: int = 120, pixels: int = 1200
) -> None:
    """Draw about `shown` of the layers, evenly chosen, as a PNG of pixels × pixels.

    From the lowest to the highest each section is painted over those below, its walls in one
    colour and its contours in another, so that what the eye sees is what a print shows.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    indices = np.unique(np.linspace(0, len(layers) - 1, min(shown, len(layers))).astype(int))
    drawn = [layers[int(index)] for index in indices]
    corners = np.concatenate([_raised(layer, layer.diagram.vertices) for layer in drawn])
    centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
    size = float(np.linalg.norm(np.ptp(corners, axis=0)))
    figure = Figure(figsize=(pixels / 100, pixels / 100), dpi=100, facecolor=BACKGROUND)
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.96))
    for order, layer in enumerate(drawn):
        diagram = layer.diagram
        outlines = [
            Outline(np.vstack([flat, flat[:1]]), closed=True)
            for flat in (_seen(_raised(layer, ring) - centre, size) for ring in layer.section.rings)
        ]
        if not outlines:
            continue
        axes.add_patch(
            PathPatch(
                Outline.make_compound_path(*outlines), facecolor=INSIDE, linewidth=0, zorder=order
            )
        )
        vertices = _seen(_raised(layer, diagram.vertices) - centre, size)
        inner = diagram.inner()
        for edges, colour, width in (
            (diagram.edges[inner], WALL, 1.6),
            (diagram.edges[~inner], CONTOUR, 0.8),
        ):
            axes.add_collection(
                LineCollection(
                    list(vertices[edges]), colors=colour, linewidths=width, zorder=order + 0.5
                )
            )
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.set_axis_off()
    figure.savefig(target, format="png", facecolor=BACKGROUND, metadata={"Software": None})


def _raised(layer: Layer, points: Floats) -> Floats:
    """Points (n, 2) of a layer as (n, 3)."""
    return np.column_stack([points, np.full(len(points), layer.z)])


def _seen(points: Floats, size: float) -> Floats:
    """Points (n, 3) around the origin as the eye sees them, (n, 2)."""
    x, y, z = points.T
    right = x * np.cos(TURN) - y * np.sin(TURN)
    away = x * np.sin(TURN) + y * np.cos(TURN)
    up = z * np.cos(TILT) + away * np.sin(TILT)
    depth = away * np.cos(TILT) - z * np.sin(TILT)
    scale = DISTANCE * size / (DISTANCE * size + depth)
    return np.column_stack([right * scale, up * scale])
