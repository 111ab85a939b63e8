"""Lines and rings in the plane as SVG: 1 unit is 1 mm, y upwards as on the bed.

Files are as large as what they show. A picture for a screen is as large as is wanted, in pixels,
and so are its lines.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

WALL, CONTOUR = "#0072b2", "#d55e00"

MARGIN = 1.0
"""mm around what is drawn"""

WALL_WIDTH, OUTLINE_WIDTH = 0.2, 0.1
"""mm: how wide a layer's edges and a section's contours are drawn"""

PIXEL = 25.4 / 96
"""mm: what a pixel of SVG measures"""

ON_SCREEN, SCREEN_LINE = 480.0, 1.2
"""Pixels: the longer side of what a notebook shows, and how wide its lines are."""


class Outlined(Protocol):
    """A horizontal section, as a drawing needs it."""

    @property
    def z(self) -> float:
        """Height above the bed, mm."""

    @property
    def rings(self) -> Sequence[Floats]:
        """Its contours, each (k, 2) mm, open."""


def lines_svg(
    title: str, lines: Mapping[str, tuple[str, Floats]], pixels: float | None = None
) -> str:
    """Lines (m, 2, 2) as one path for each name, in its colour; `pixels` is the longer side."""
    head, width = _head((ends.reshape(-1, 2) for _, ends in lines.values()), WALL_WIDTH, pixels)
    paths = [
        f'<path id="{name}" stroke="{colour}" d="{_segments(ends)}"/>'
        for name, (colour, ends) in lines.items()
    ]
    return "\n".join(
        [
            head,
            f"<title>{title}</title>",
            f'<g fill="none" stroke-width="{width:g}" stroke-linecap="round">',
            *paths,
            "</g>",
            "</svg>",
            "",
        ]
    )


def sections_svg(sections: Sequence[Outlined], pixels: float | None = None) -> Iterator[str]:
    """The lines of an SVG of sections (gone through twice), one group with its height for each.

    The material is what the even-odd rule fills. `pixels` is the longer side.
    """
    rings = (ring for section in sections for ring in section.rings)
    head, width = _head(rings, OUTLINE_WIDTH, pixels)
    yield head + "\n"
    yield (
        f'<g fill="{WALL}" fill-opacity="0.1" fill-rule="evenodd" stroke="{WALL}" '
        f'stroke-width="{width:g}">\n'
    )
    for number, section in enumerate(sections):
        outline = " ".join(map(_ring, section.rings))
        yield f'<g id="section-{number}" data-z="{section.z:.9g}"><path d="{outline}"/></g>\n'
    yield "</g>\n</svg>\n"


def _head(parts: Iterable[Floats], width: float, pixels: float | None) -> tuple[str, float]:
    """The opening tag of an SVG with room for all points of its parts, each (n, 2), mm.

    And how wide its lines are, mm: in a file they have a given width.
    """
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for points in parts:
        low = np.minimum(low, points.min(axis=0, initial=np.inf))
        high = np.maximum(high, points.max(axis=0, initial=-np.inf))
    if not np.isfinite(low).all():
        low, high = np.zeros(2), np.zeros(2)
    low, high = low - MARGIN, high + MARGIN
    across, up = (high - low).tolist()
    scale = 1.0
    if pixels is not None:
        scale = pixels * PIXEL / max(across, up)
        width = SCREEN_LINE * PIXEL / scale
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" '
        f'width="{scale * across:.6g}mm" height="{scale * up:.6g}mm" '
        f'viewBox="{low[0]:.6f} {-high[1]:.6f} {across:.6f} {up:.6f}">'
    ), width


def _segments(ends: Floats) -> str:
    """Segments (m, 2, 2) as path data; SVG's y axis points down."""
    return " ".join(
        f"M{x0:.6f} {-y0:.6f}L{x1:.6f} {-y1:.6f}" for (x0, y0), (x1, y1) in ends.tolist()
    )


def _ring(ring: Floats) -> str:
    """A ring (k, 2) as path data."""
    return "M" + "L".join(f"{x:.6f} {-y:.6f}" for x, y in ring.tolist()) + "Z"
