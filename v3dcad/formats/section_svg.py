"""Sections as SVG, in millimetres, y upwards as on the bed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from v3dcad.model import Floats, Section

LINE_WIDTH = 0.1
"""mm"""


def section_svg(sections: Sequence[Section], margin: float = 1.0) -> Iterator[str]:
    """The lines of an SVG of sections (gone through twice), one group with its height for each.

    1 unit is 1 mm; the material is what the even-odd rule fills.
    """
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for section in sections:
        for ring in section.rings:
            low, high = np.minimum(low, ring.min(axis=0)), np.maximum(high, ring.max(axis=0))
    if not np.isfinite(low).all():
        low, high = np.zeros(2), np.zeros(2)
    low, high = low - margin, high + margin
    across, up = (high - low).tolist()
    yield (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{across:.6g}mm" height="{up:.6g}mm" '
        f'viewBox="{low[0]:.6f} {-high[1]:.6f} {across:.6f} {up:.6f}">\n'
    )
    yield (
        f'<g fill="#1f6f8b" fill-opacity="0.1" fill-rule="evenodd" stroke="#1f6f8b" '
        f'stroke-width="{LINE_WIDTH:g}">\n'
    )
    for number, section in enumerate(sections):
        outline = " ".join(map(_path, section.rings))
        yield f'<g id="section-{number}" data-z="{section.z:.9g}"><path d="{outline}"/></g>\n'
    yield "</g>\n</svg>\n"


def _path(ring: Floats) -> str:
    """A ring (k, 2) as path data; SVG's y axis points down."""
    return "M" + "L".join(f"{x:.6f} {-y:.6f}" for x, y in ring.tolist()) + "Z"
