"""The certificate of overhang against points sampled on the walls: `python -m benchmarks.overhang`.

For the six cases of the layer loop: the largest distance of a layer's walls to what lies below,
as certified and as sampled every hundredth of a cell, and the tilts. Where there are
many cells and layers both look at the same few layers, evenly chosen from the base to the top.
"""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np

from benchmarks.engine import CASES, CELL, filled
from benchmarks.sampling import distances_below
from v3dcad.structure.overhang import overhang

MOST = 100_000
"""Cells times layers looked at in each case: what the sampling can bear."""


def main() -> None:
    print(
        f"{'case':>8} {'cells':>6} {'layers':>6} {'seen':>5} {'wall °':>7} {'strut °':>8} "
        f"{'certified mm':>13} {'sampled mm':>11} {'ratio':>6} {'s a layer':>9}"
    )
    for name, count, layers, outline in CASES:
        made = filled(outline, count, layers).layers
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
            found = max(found, float(distances_below(layer, below, CELL / 100).max(initial=0)))
        print(
            f"{name:>8} {count:6} {layers:6} {len(seen):5} {wall:7.1f} {strut:8.1f} "
            f"{certified:13.4f} {found:11.4f} {certified / found:6.3f} {spent / len(seen):9.3f}"
        )


if __name__ == "__main__":
    main()
