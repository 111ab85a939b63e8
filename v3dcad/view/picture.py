"""A picture of a structure: layers drawn in perspective, the upper ones in front."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from v3dcad.model import Floats, Layer

BACKGROUND, WALL, CONTOUR = "#ffffff", "#1f6f8b", "#d1495b"


def draw(layers: Sequence[Layer], path: Path, shown: int = 24, pixels: int = 1200) -> None:
    """Draw about `shown` of the layers, evenly chosen, as a PNG of pixels × pixels.

    A central projection from the front right above; walls in one colour, contours in another,
    lower layers fainter.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

    indices = np.unique(np.linspace(0, len(layers) - 1, min(shown, len(layers))).astype(int))
    drawn = [(k, layers[int(k)]) for k in indices]
    points = np.concatenate(
        [
            np.column_stack([d.vertices, np.full(len(d.vertices), layer.z)])
            for _, layer in drawn
            for d in (layer.diagram,)
        ]
    )
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    figure = Figure(figsize=(pixels / 100, pixels / 100), dpi=100, facecolor=BACKGROUND)
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.96))
    for rank, (_, layer) in enumerate(drawn):
        diagram = layer.diagram
        flat = _project(
            np.column_stack([diagram.vertices, np.full(len(diagram.vertices), layer.z)]) - centre,
            size,
        )
        inner = diagram.inner()
        depth = (rank + 1) / len(drawn)
        for edges, colour in ((diagram.edges[inner], WALL), (diagram.edges[~inner], CONTOUR)):
            axes.add_collection(
                LineCollection(
                    list(flat[edges]), colors=colour, linewidths=0.5 + 1.3 * depth**3,
                    alpha=0.25 + 0.75 * depth**2, capstyle="round",
                )
            )  # fmt: skip
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.set_axis_off()
    figure.savefig(path, format="png", facecolor=BACKGROUND, metadata={"Software": None})


def _project(points: Floats, size: float) -> Floats:
    """Points (n, 3) around the origin seen from the front right above, as (n, 2)."""
    turn, tilt = np.radians(-30), np.radians(38)
    x, y, z = points.T
    right = x * np.cos(turn) - y * np.sin(turn)
    away = x * np.sin(turn) + y * np.cos(turn)
    up = z * np.cos(tilt) + away * np.sin(tilt)
    depth = away * np.cos(tilt) - z * np.sin(tilt)
    scale = 2.2 * size / (2.2 * size + depth)
    return np.column_stack([right * scale, up * scale])
