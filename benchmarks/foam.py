"""The foam's figures, each beside what it must be: `python -m benchmarks.foam [--quick]`.

Sections are those of qhull: the diagram of sites at a height is a power diagram, whose triangles
are the lower hull of the lifted sites. They are uncut: one period of the tile, each cell once.
`--quick` leaves out what takes minutes: a million sites, the layer loop, memory, stiffness.
"""

from __future__ import annotations

import argparse
import time
from math import sqrt

import numpy as np
from scipy.spatial import ConvexHull

from benchmarks import stiffness
from benchmarks.engine import loop_times, peak_memory
from benchmarks.sampling import distances_below
from v3dcad.geometry.voronoi.cells import voronoi_cells
from v3dcad.geometry.voronoi.measures import extents
from v3dcad.geometry.voronoi.steepest import steepest_wall
from v3dcad.model import Section
from v3dcad.settings import FillSettings
from v3dcad.structure.fill import fill_sections
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

PART, CELL, LAYER, PAIRS, SPACING = 100.0, 6.0, 0.2, 25, 0.05
"""mm: a cube, its cells and layers, how many pairs of layers are looked at, and points how far
apart on their walls."""


def row(what: str, must: str, aim: str, measured: str) -> None:
    """Print a row of the table."""
    print(f"| {what} | {must} | {aim} | {measured} |", flush=True)


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
    numbers = np.array(counts) / np.mean(counts) - 1
    size = side * foam.pitch / sqrt(np.mean(counts))
    cells = f"sections of {min(counts):,} to {max(counts):,} cells at {HEIGHTS} heights"
    told = f"{np.mean(spreads):.3f} on average, {max(spreads):.3f} at most"
    row(f"{cells}: CV of areas", "≤ 0.72", "0.6", told)
    row("the same: largest ÷ mean area", "≤ 3.5", "2.5", f"{max(largest):.2f}")
    row("cells a mm² over heights", "± 3 %", "", f"{numbers.min():+.1%} … {numbers.max():+.1%}")
    row("measured ÷ asked cell size", "± 2 %", "", f"{size - 1:+.2%}")


def shapes(foam: Pattern) -> None:
    """Print how tall cells are."""
    high = np.array(SIZE) * foam.multiple
    sites = foam.sites_in(np.zeros(3, np.int64), high - 1)[0].astype(np.float64)
    wanted = np.flatnonzero(((sites >= 0) & (sites < high)).all(axis=1))
    low, top = extents(voronoi_cells(sites, wanted))
    size = top - low
    ratio = sqrt(TAU_SQUARED) * size[:, 2] / size[:, :2].mean(axis=1)
    told = f"{ratio.mean():.2f} on average, {np.quantile(ratio, 0.95):.2f} for the tallest 5 %"
    row("default stretch at θ = 45°", "≤ 1.42", "1.25", f"{stretch_for(45):.3f}")
    row("height ÷ width of cells", "≤ 1.6", "1.35", told)


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
        told = f"{lean:.2f}° at a stretch of {stretch:.3f}"
        what = f"steepest wall of parts of ≥ {least:,} cells, {len(SEEDS)} seeds"
        row(what, f"≤ {angle:.0f}°", "", told)


def support() -> None:
    """Print how far points on walls lie from walls and contours of the layer below, sampled."""
    ring = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]) * PART
    lower = (np.arange(PAIRS) + 0.5) / PAIRS * PART
    sections = [Section(z, (ring,)) for low in lower for z in (low, low + LAYER)]
    for angle in ANGLES:
        settings = FillSettings(layer_height=LAYER, cell_size=CELL, max_overhang=angle)
        layers = list(fill_sections(sections, None, settings).layers)
        pairs = zip(layers[::2], layers[1::2], strict=True)
        far = np.concatenate([distances_below(layer, below, SPACING) for below, layer in pairs])
        told = f"{far.max():.4f} mm ({len(far):,} points)"
        must = f"≤ {LAYER * np.tan(np.radians(angle)):.4f} mm"
        row(f"farthest point of a wall from the layer below, θ = {angle:.0f}°", must, "", told)


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
        told = f"{found - began:.3f} s; certificate {ended - found:.2f} s"
        row(f"{len(sites):,} sites", "≤ 0.5 s", "0.1 s", told)


def engine() -> None:
    """Print the layer loop's ratios and memory."""
    for outline, cells, layers in (("square", 300, 150), ("square", 4000, 1000)):
        fast, slow = loop_times(outline, cells, layers)
        what = f"(scipy + shapely) ÷ layer loop, {cells:,} cells × {layers:,} layers"
        row(what, "≥ 20", "40", f"{slow / fast:.0f} ({fast:.3g} s)")
    told = f"{peak_memory(4000, 5000):.0f} MB"
    row("memory, 4,000 cells × 5,000 layers", "≤ 300 MB", "", told)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    foam = pattern(1.0, 0, 60.0)
    print(f"{len(tiles())} tile(s), {len(foam.sites):,} sites, {np.array(SIZE)} steps\n")
    row("what", "must", "aim", "measured")
    row("---", "---", "---", "---")
    overhang(27.0)
    support()
    shapes(foam)
    evenness(foam)
    times([27.0] if quick else [27.0, 60.0, 115.0])
    if not quick:
        engine()
        stiff, soft = stiffness.compare(quick=True)
        told = f"{np.mean(stiff) / np.mean(soft):.1f}"
        row(f"sideways stiffness, solid share {stiffness.SHARE}, ÷ columns", "≥ 3", "5", told)


if __name__ == "__main__":
    main()
