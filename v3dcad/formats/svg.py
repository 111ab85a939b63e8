"""A layer as SVG, in millimetres, y upwards as on the bed."""

from __future__ import annotations

import numpy as np

from v3dcad.model import Floats, Layer

WALL, CONTOUR = "#1f6f8b", "#d1495b"


def svg_text(layer: Layer, width: float = 0.2, margin: float = 1.0) -> str:
    """The layer's walls and contours as two paths, drawn `width` mm wide; 1 unit is 1 mm."""
    diagram = layer.diagram
    points = diagram.vertices if len(diagram.vertices) else np.zeros((1, 2))
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    across, up = (high - low).tolist()
    inner = diagram.inner()
    paths = [
        f'<path id="{name}" stroke="{colour}" d="{_path(diagram.vertices[diagram.edges[rows]])}"/>'
        for name, colour, rows in (("walls", WALL, inner), ("contours", CONTOUR, ~inner))
    ]
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{across:.6g}mm" height="{up:.6g}mm" '
            f'viewBox="{low[0]:.6f} {-high[1]:.6f} {across:.6f} {up:.6f}">',
            f"<title>layer {layer.index}, z {layer.z:g} mm</title>",
            f'<g fill="none" stroke-width="{width:g}" stroke-linecap="round">',
            *paths,
            "</g>",
            "</svg>",
            "",
        ]
    )


def _path(ends: Floats) -> str:
    """Segments (m, 2, 2) as path data; SVG's y axis points down."""
    return " ".join(
        f"M{x0:.6f} {-y0:.6f}L{x1:.6f} {-y1:.6f}" for (x0, y0), (x1, y1) in ends.tolist()
    )
