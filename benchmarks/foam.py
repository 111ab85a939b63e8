"""How even the foam's cells are, and how long sites take: `python -m benchmarks.foam [--quick]`.

Sections are those of qhull: the diagram of sites at a height is a power diagram, whose triangles
are the lower hull of the lifted sites. They are uncut: one period of the tile, each cell once.
"""

from __future__ import annotations

import argparse
import time
from math import sqrt

import numpy as np
from scipy.spatial import ConvexHull

from v3dcad.geometry.voronoi.cells import voronoi_cells
from v3dcad.geometry.voronoi.measures import extents
from v3dcad.geometry.voronoi.steepest import steepest_wall
from v3dcad.structure.foam.tile import (
    SIZE,
    TAU_SQUARED,
    Pattern,
    pattern,
    stretch_for,
    tiles,
)

HEIGHTS = 20
ANGLES = (30.0, 45.0, 60.0)
SEEDS = range(5)


def section_areas(sites: np.ndarray, height: float) -> np.ndarray:
    """The area (n,) of each site's cell in the plane at a height, by lifted qhull."""
    places = sites.astype(np.float64)
    scale = float(np.ptp(places[:, 0]))
    across = (places[:, :2] - places[:, :2].mean(axis=0)) / scale
    up = (places[:, 2] - height) / scale
    hull = ConvexHull(np.column_stack([across, (across**2).sum(axis=1) + up**2]))
    lower = hull.equations[:, 2] < 0
    triangles, planes = hull.simplices[lower], hull.equations[lower]
    # The plane of a lower face is z = 2 c · x + …, c the triangle's power centre.
    centres = -planes[:, :2] / planes[:, 2:3] / 2
    sites_of, centre_of = triangles.ravel(), np.repeat(np.arange(len(triangles)), 3)
    counts = np.bincount(sites_of, minlength=len(sites))
    middles = (
        np.column_stack([np.bincount(sites_of, centres[centre_of, k], len(sites)) for k in (0, 1)])
        / np.maximum(counts, 1)[:, None]
    )
    around = centres[centre_of] - middles[sites_of]
    order = np.lexsort((np.arctan2(around[:, 1], around[:, 0]), sites_of))
    site, corner = sites_of[order], around[order]
    after = np.arange(1, len(site) + 1)
    last = np.flatnonzero(np.append(site[1:] != site[:-1], True))
    after[last] = np.concatenate([[0], last[:-1] + 1])
    parts = (corner[:, 0] * corner[after, 1] - corner[:, 1] * corner[after, 0]) / 2
    return np.bincount(site, parts, len(sites)) * scale**2


def evenness(foam: Pattern) -> None:
    """Print how even sections are, over heights that fill the tile, the tile's own period."""
    side, rise = SIZE[0] * foam.multiple, SIZE[2] * foam.multiple
    spreads, largest, counts = [], [], []
    for level in (np.arange(HEIGHTS) + 0.37) / HEIGHTS * rise:
        low = np.array([0, 0, round(level)])
        sites = foam.sites_in(low, np.array([side - 1, side - 1, round(level)]))[0]
        own = ((sites[:, :2] >= 0) & (sites[:, :2] < side)).all(axis=1)
        areas = section_areas(sites, level)[own]
        areas = areas[areas > 0]
        assert abs(areas.sum() / side**2 - 1) < 1e-4, "sections have to fill the plane"
        spreads.append(areas.std() / areas.mean())
        largest.append(areas.max() / areas.mean())
        counts.append(len(areas))
    numbers = np.array(counts) / np.mean(counts)
    asked = np.mean(counts) / (side * foam.pitch) ** 2
    print(f"sections of {min(counts)} … {max(counts)} cells at {HEIGHTS} heights")
    print(f"  CV of areas        {np.mean(spreads):.3f} on average, {max(spreads):.3f} at most")
    print(f"  largest ÷ mean     {max(largest):.2f}")
    print(f"  cells a mm² over heights  {numbers.min() - 1:+.1%} … {numbers.max() - 1:+.1%}")
    print(f"  cells a mm² ÷ asked       {asked:.4f}")


def shapes(foam: Pattern) -> None:
    """Print how tall cells are."""
    high = np.array(SIZE) * foam.multiple
    sites = foam.sites_in(np.zeros(3, np.int64), high - 1)[0].astype(np.float64)
    wanted = np.flatnonzero(((sites >= 0) & (sites < high)).all(axis=1))
    low, top = extents(voronoi_cells(sites, wanted))
    size = top - low
    ratio = sqrt(TAU_SQUARED) * size[:, 2] / size[:, :2].mean(axis=1)
    print(f"stretch at 45°       {stretch_for(45):.3f}")
    print(f"height ÷ width       {ratio.mean():.2f}, {np.quantile(ratio, 0.95):.2f} for 5 %")


def overhang(width: float) -> None:
    """Print the steepest wall of parts of a width, cells, at all angles and seeds."""
    for angle in ANGLES:
        stretch, worst, least = stretch_for(angle), 0.0, 1 << 62
        for seed in SEEDS:
            foam = pattern(1.0, seed, width + 4)
            high = np.full(3, round(width / foam.pitch))
            sites = foam.sites_in(np.zeros(3, np.int64), high)[0]
            least = min(least, int(((sites >= 0) & (sites <= high)).all(axis=1).sum()))
            worst = max(worst, steepest_wall(sites, np.zeros(3, np.int64), high).tau)
        lean = np.degrees(np.arctan(worst / stretch))
        print(f"θ {angle:.0f}°, stretch {stretch:.3f}: steepest wall {lean:.2f}°, ≥ {least} cells")


def times(widths: list[float]) -> None:
    """Print processor times for sites and certificate of parts of some widths, cells."""
    for width in widths:
        foam = pattern(1.0, 0, width + 4)
        high = np.full(3, round(width / foam.pitch))
        began = time.process_time()
        sites = foam.sites_in(np.zeros(3, np.int64), high)[0]
        found = time.process_time()
        steepest_wall(sites, np.zeros(3, np.int64), high)
        ended = time.process_time()
        print(f"{len(sites):>9} sites: {found - began:.3f} s, certificate {ended - found:.2f} s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    foam = pattern(1.0, 0, 60.0)
    print(f"{len(tiles())} tile(s), {len(foam.sites)} sites, {np.array(SIZE)} steps")
    shapes(foam)
    evenness(foam)
    overhang(27.0)
    times([27.0] if quick else [27.0, 60.0, 115.0])


if __name__ == "__main__":
    main()
