"""The certificate of overhang against points sampled on the walls: `python -m benchmarks.overhang`.

For the six cases of the layer loop: the largest distance of a layer's walls to what lies below,
as certified and as sampled every thousandth of the part's size, and the tilts. Where there are
many sites and layers both look at the same few layers, evenly chosen from the base to the top.
"""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np
import shapely

from benchmarks.engine import CASES, CELL, filled
from v3dcad.geometry.section_area import section_area
from v3dcad.model import Floats, Layer
from v3dcad.structure.overhang import overhang

MOST = 100_000
"""Sites times layers looked at in each case: what the sampling can bear."""


def sampled(layer: Layer, below: Layer, spacing: float) -> float:
    """The largest distance of sampled points on a layer's walls, over the section below."""
    lines = shapely.linestrings(below.diagram.vertices[below.diagram.edges])
    inner = layer.diagram.inner()
    ends = layer.diagram.vertices[layer.diagram.edges[inner]]
    points = np.concatenate([_along(segment, spacing) for segment in ends] or [np.empty((0, 2))])
    area = section_area(below.section)
    shapely.prepare(area)
    points = shapely.points(points[shapely.contains_xy(area, points)])
    nearest = shapely.STRtree(lines).query_nearest(points, return_distance=True, all_matches=False)
    return float(nearest[1].max(initial=0.0))


def _along(segment: Floats, spacing: float) -> Floats:
    length = np.hypot(*(segment[1] - segment[0]))
    t = np.linspace(0, 1, 2 + int(length / spacing))[:, None]
    return (1 - t) * segment[0] + t * segment[1]


def main() -> None:
    print(
        f"{'case':>8} {'cells':>6} {'layers':>6} {'seen':>5} {'wall °':>7} {'strut °':>8} "
        f"{'certified mm':>13} {'sampled mm':>11} {'ratio':>6} {'s a layer':>9}"
    )
    for name, count, layers, outline in CASES:
        made = filled(outline, count, layers).layers
        size = CELL * np.sqrt(count)
        seen = np.unique(np.linspace(1, layers - 1, min(layers - 1, MOST // count)).astype(int))
        certified = found = spent = wall = strut = 0.0
        for below, layer in pairwise(made):
            if layer.index not in seen:
                continue
            began = time.process_time()
            told = overhang([below, layer], 0.8)
            spent += time.process_time() - began
            certified = max(certified, told.distance[1])
            wall, strut = max(wall, told.wall_tilt[1]), max(strut, told.strut_tilt[1])
            found = max(found, sampled(layer, below, size / 1000))
        print(
            f"{name:>8} {count:6} {layers:6} {len(seen):5} {wall:7.1f} {strut:8.1f} "
            f"{certified:13.4f} {found:11.4f} {certified / found:6.3f} {spent / len(seen):9.3f}"
        )


if __name__ == "__main__":
    main()
