"""The certificate of overhang against points sampled on the walls: `python -m benchmarks.overhang`.

For the six cases of the layer loop: the largest distance of a layer's walls to what lies below,
as certified and as sampled every thousandth of the part's size, and the tilts.
"""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np
import shapely

from benchmarks.engine import CASES, sections
from v3dcad import FillSettings, fill_sections
from v3dcad.geometry.regions import section_area
from v3dcad.model import Floats, Layer
from v3dcad.structure.overhang import overhang

MOST = 45_000
"""Sites times layers looked at in each case, from the base up: what the sampling can bear."""


def sampled(layer: Layer, below: Layer, spacing: float) -> float:
    """The largest distance of sampled points on a layer's walls, over the section below."""
    lines = shapely.multilinestrings(list(below.diagram.vertices[below.diagram.edges]))
    shapely.prepare(lines)
    inner = layer.diagram.inner()
    ends = layer.diagram.vertices[layer.diagram.edges[inner]]
    points = np.concatenate([_along(segment, spacing) for segment in ends] or [np.empty((0, 2))])
    area = section_area(below.section)
    shapely.prepare(area)
    points = points[shapely.contains_xy(area, points)]
    return float(shapely.distance(lines, shapely.points(points)).max(initial=0.0))


def _along(segment: Floats, spacing: float) -> Floats:
    length = np.hypot(*(segment[1] - segment[0]))
    t = np.linspace(0, 1, 2 + int(length / spacing))[:, None]
    return (1 - t) * segment[0] + t * segment[1]


def main() -> None:
    print(
        f"{'case':>8} {'sites':>6} {'layers':>6} {'wall °':>7} {'strut °':>8} "
        f"{'certified mm':>13} {'sampled mm':>11} {'ratio':>6} {'s':>6}"
    )
    for name, count, layers, size, offset, outline in CASES:
        stack = sections(outline, size, layers)[: min(layers, MOST // count)]
        sites = np.random.default_rng(7).random((count, 2)) * size
        settings = FillSettings(offset=offset, max_overhang=90.0)
        made = list(fill_sections(stack, sites, settings).layers)
        began = time.perf_counter()
        told = overhang(made, 0.8)
        spent = time.perf_counter() - began
        found = max(sampled(layer, below, size / 1000) for below, layer in pairwise(made))
        certified = told.distance.max()
        print(
            f"{name:>8} {count:6} {len(made):6} {told.wall_tilt.max():7.1f} "
            f"{told.strut_tilt.max():8.1f} {certified:13.4f} {found:11.4f} "
            f"{certified / found:6.3f} {spent:6.1f}"
        )


if __name__ == "__main__":
    main()
