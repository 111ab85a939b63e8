"""Make the shipped tiles: `python -m v3dcad.structure.foam.make_tile [FILE]`.

Sites are scattered at random, evened out by Lloyd's method, and relaxed until no wall leans over τ.
That makes cells less even. So they are evened out a little and relaxed again, some times, and of
all that come out the tile with the most even sections is taken. Each is rounded to the tile's grid
and certified there before it counts. Takes some minutes; the same file every time.
"""

from __future__ import annotations

import sys
from math import sqrt
from pathlib import Path
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.voronoi.cells import VoronoiCells, voronoi_cells
from v3dcad.geometry.voronoi.measures import extents, section_areas, volumes_and_centroids
from v3dcad.geometry.voronoi.periodic import with_copies
from v3dcad.geometry.voronoi.steepest import SteepestWall, steepest_wall
from v3dcad.model import Floats, Ints
from v3dcad.structure.foam.darts import poisson_disk
from v3dcad.structure.foam.relaxing import STAGES, relax
from v3dcad.structure.foam.tile import SIZE, TAU_SQUARED, TILES

RADIUS = 1 << 12
"""The radius of the darts, in the tile's steps: the tile is 32 radii wide."""

SEEDS = (1,)
"""One tile for each."""

EVENING = 4
"""Lloyd's steps for scattered sites."""

ROUNDS = 24
"""How often sites are evened out and relaxed again."""

FIRST_MARGIN, LATER_MARGIN = 0.02, 0.005
"""By which share walls lean less than τ allows. With more of it at first, less is spoilt later."""

GENTLE = 0.5
"""The share of Lloyd's step that is taken then."""

SLACK = 0.001
"""In squared radii: rounding to the grid moves no bisector as far."""

MARGIN = 4.0
"""In radii: sites as far away have no part in a cell."""

HEIGHTS = 64
"""Sections that evenness is judged by."""

WAVES = 6
"""How many harmonics of the number of cells over height are levelled."""


class Quality(NamedTuple):
    """How even a tile is."""

    cells_per_section: float
    """their number, on average over all heights"""
    fewest: float
    most: float
    """the numbers of cells in sections, in shares of the average"""
    spread: float
    """the coefficient of variation of areas, in the most uneven section"""
    mean_spread: float
    largest: float
    """the largest area in any section, in shares of its mean one"""
    height: float
    """height over width of the cells, on average, where stretched to 45°"""
    volume_spread: float


def cells_of(places: Floats, box: Floats) -> tuple[VoronoiCells, Floats]:
    """The cells of sites (n, 3) in a periodic box (3,), and the places of all around too."""
    around = with_copies(places, box, MARGIN)
    return voronoi_cells(around, np.arange(len(places))), around


def judged(places: Floats, box: Floats) -> Quality:
    """The quality of sites (n, 3) in a periodic box (3,), radii."""
    cells, around = cells_of(places, box)
    low, high = extents(cells)
    size = high - low
    copies = np.array([-1, 0, 1]) * box[2]
    cut = []
    for height in (np.arange(HEIGHTS) + 0.5) / HEIGHTS * box[2]:
        areas = np.sum([section_areas(cells, level) for level in height + copies], axis=0)
        cut.append(areas[areas > 0])
    mean = size[:, 2].sum() / box[2]
    spreads = [area.std() / area.mean() for area in cut]
    volumes, _ = volumes_and_centroids(cells, around)
    return Quality(
        cells_per_section=float(mean),
        fewest=float(min(len(area) for area in cut) / mean),
        most=float(max(len(area) for area in cut) / mean),
        spread=float(max(spreads)),
        mean_spread=float(np.mean(spreads)),
        largest=max(float(area.max() / area.mean()) for area in cut),
        height=sqrt(TAU_SQUARED) * float((size[:, 2] / size[:, :2].mean(axis=1)).mean()),
        volume_spread=float(volumes.std() / volumes.mean()),
    )


def evened(places: Floats, box: Floats, share: float) -> Floats:
    """Sites (n, 3) moved a share of the way to their cells' centroids (Lloyd, "Least squares
    quantization in PCM", IEEE Trans. Information Theory 1982), and levelled.

    Where sections have too many cells, sites are moved apart in height: by as much as their number,
    taken as waves over the height, is over the average.
    """
    cells, around = cells_of(places, box)
    _, centroids = volumes_and_centroids(cells, around)
    low, high = extents(cells)
    lift = np.zeros(len(places))
    for wave in range(1, WAVES + 1):
        turn = 2 * np.pi * wave / box[2]
        # The number of cells over height, a sum of steps, has these coefficients exactly.
        cosines = (np.sin(turn * high[:, 2]) - np.sin(turn * low[:, 2])).sum()
        sines = (np.cos(turn * low[:, 2]) - np.cos(turn * high[:, 2])).sum()
        of_mean = 2 / turn / (high[:, 2] - low[:, 2]).sum()
        height = turn * places[:, 2]
        lift += (cosines * np.sin(height) - sines * np.cos(height)) * of_mean / turn
    moved = places + share * (centroids - places)
    moved[:, 2] += lift
    return np.mod(moved, box)


def certified(sites: Ints) -> SteepestWall:
    """The steepest wall of sites (n, 3) in the periodic tile, steps."""
    margin = MARGIN * RADIUS
    around = with_copies(sites.astype(np.float64), np.array(SIZE, np.float64), margin)
    return steepest_wall(around.astype(np.int64), np.zeros(3, np.int64), np.array(SIZE))


def reaches_of(sites: Ints) -> Ints:
    """How far the cells of a tile's sites (n, 3) reach below and above them, steps, rounded up."""
    cells, _ = cells_of(sites / RADIUS, np.array(SIZE) / RADIUS)
    low, high = (corner[:, 2] * RADIUS for corner in extents(cells))
    z = sites[:, 2]
    return np.ceil(np.column_stack([z - low, high - z]) + 0.5).astype(np.int64)


def make_tile(random_seed: int) -> tuple[Ints, float]:
    """The sites (n, 3) of a tile, steps, and how many cells a section has; prints its quality."""
    box, tau = np.array(SIZE) / RADIUS, sqrt(TAU_SQUARED)
    places = poisson_disk(box, 1.0, random_seed)
    radii = np.ones(len(places))
    for _ in range(EVENING):
        places = evened(places, box, 1.0)
    best: tuple[float, Ints, Quality, SteepestWall] | None = None
    for turn in range(ROUNDS):
        if turn:
            places = evened(places, box, GENTLE)
        stages = () if turn else STAGES
        places = relax(
            places,
            radii,
            box,
            tau,
            stages=stages,
            margin=LATER_MARGIN if turn else FIRST_MARGIN,
            slack=SLACK,
            random_seed=max(turn - 1, 0),
            progress=lambda stage, bad: print(
                f"   τ = {stage:.3g}: {bad} sites at bad walls", flush=True
            ),
        )
        sites = np.rint(places * RADIUS).astype(np.int64) % np.array(SIZE)
        wall, quality = certified(sites), judged(sites / RADIUS, box)
        print(f"round {turn}: {len(sites)} sites, steepest wall τ = {wall.tau:.4f}", flush=True)
        print("   " + ", ".join(f"{k} {v:.4g}" for k, v in quality._asdict().items()), flush=True)
        if wall.within(TAU_SQUARED) and (best is None or quality.spread < best[0]):
            best = quality.spread, sites, quality, wall
    if best is None:
        raise SystemExit(f"seed {random_seed}: no round gave a tile that is certified")
    _, sites, quality, wall = best
    # Sites that are near each other follow each other: slabs of height, strips, and along them.
    slabs = sites[:, [2, 1]] // (2 * RADIUS)
    order = np.lexsort((sites[:, 0], slabs[:, 1], slabs[:, 0]))
    print(f"seed {random_seed}: τ = {wall.tau:.4f}, {quality}", flush=True)
    return sites[order], quality.cells_per_section


def main() -> None:
    """Make all tiles and write them to the file given, or where the package has them."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / TILES
    made = [make_tile(seed) for seed in SEEDS]
    np.savez(
        path,
        sites=np.concatenate([sites for sites, _ in made]).astype(np.uint32),
        reaches=np.concatenate([reaches_of(sites) for sites, _ in made]).astype(np.uint16),
        starts=np.cumsum([0, *(len(sites) for sites, _ in made)]),
        cells_per_section=np.array([cells for _, cells in made]),
    )


if __name__ == "__main__":
    main()
