"""Figures of graded foams, each beside what it must be: `python -m benchmarks.grading [--quick]`.

Sizes differ by 5 : 1 in a box of 60 × 60 × 90 mm. They are counted in windows of five cells: a
section has half as many cells as corners, where three walls meet. `--quick` takes one seed and no
100,000 sites.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from benchmarks.foam import row
from v3dcad.model import Floats
from v3dcad.settings import FillSettings
from v3dcad.structure.foam.choice import LEAST_TAU, TAU
from v3dcad.structure.foam.explicit import explicit_sites
from v3dcad.structure.foam.graded import Graded, graded_sites
from v3dcad.structure.foam.size_grid import SLOPE, sampled
from v3dcad.structure.foam.space import space_of

LEAST, MOST = 1.0, 5.0
"""mm: the sizes of all fields."""

BOX = np.array([[0.0, 0, 0], [60, 60, 90]])
"""mm."""

WINDOWS, CELLS, PLANES = 400, 5.0, 8
"""How many windows are counted in each foam, how many cells wide and tall, and at how many heights
of each."""

SEEDS = range(3)
ANGLE = 45.0

Field = Callable[[Floats], Floats]


def ramp(value: Floats, start: float, slope: float) -> Floats:
    """From the least size at the start to the largest, by a slope."""
    return np.clip(LEAST + slope * (value - start), LEAST, MOST)


def waves(at: Floats) -> Floats:
    """Smooth noise: waves of 70 mm in many directions."""
    ways = np.random.default_rng(5).normal(size=(12, 3))
    ways *= 2 * np.pi / (70 * np.linalg.norm(ways, axis=1, keepdims=True))
    noise = np.sin(at @ ways.T + np.arange(12)).sum(axis=1) / 8
    return np.asarray(np.sqrt(LEAST * MOST) * (MOST / LEAST) ** np.clip(noise, -0.5, 0.5))


FIELDS: dict[str, Field] = {
    "as steep as may be, sideways": lambda at: ramp(at[:, 0], 12, SLOPE),
    "as steep as may be, upward": lambda at: ramp(at[:, 2], 12, SLOPE / TAU),
    "around a hole": lambda at: ramp(np.hypot(at[:, 0] - 30, at[:, 1] - 30), 11, SLOPE),
    "under a roof, in one step": lambda at: np.where(at[:, 2] > 80, LEAST, MOST),
    "waves": waves,
}


class Found(NamedTuple):
    """What one foam showed."""

    cells: int
    steepest: float
    """°"""
    over: int
    """walls over `ANGLE`"""
    ratios: Floats
    """(w, 2): made ÷ asked size in each window, in its middle section and over its height"""
    coarse: Floats
    """(w,): whether a window is of the third with the largest sizes"""


def smoothed(field: Field, stretch: float) -> Field:
    """The sizes that can be met, as a foam of a stretch goes by them."""
    squeezed = np.array([1, 1, 1 / stretch])
    grid = sampled(lambda places: field(places / squeezed), *(BOX * squeezed)).grid
    axes = [
        low + grid.side * np.arange(count)
        for low, count in zip(grid.corner, grid.sizes.shape, strict=True)
    ]
    sizes = RegularGridInterpolator(axes, grid.sizes)
    return lambda at: np.asarray(sizes(at * squeezed))


def windows(wanted: Field, stretch: float) -> tuple[Floats, Floats]:
    """Random windows in the box: their middles (w, 3) and half their sizes (w, 3), mm."""
    middles = BOX[0] + (BOX[1] - BOX[0]) * np.random.default_rng(0).random((100 * WINDOWS, 3))
    half = CELLS / 2 * wanted(middles)[:, None] * np.array([1, 1, stretch])
    within = ((middles - half >= BOX[0]) & (middles + half <= BOX[1])).all(axis=1)
    chosen = np.flatnonzero(within)[:WINDOWS]
    return middles[chosen], half[chosen]


def found_in(made: Graded, wanted: Field) -> Found:
    """Count walls and windows of a foam that should have the sizes of a field."""
    space = space_of(explicit_sites(made.sites, made.stretch, *BOX), BOX)
    tilts, axes = space.walls().tilts, space.strut_axes().ends
    middles, halves = windows(wanted, made.stretch)
    share = (np.arange(PLANES) + 0.5) / PLANES * 2 - 1
    inside = np.stack(np.meshgrid(share, share, share), axis=-1).reshape(-1, 3)
    ratios = []
    for middle, half in zip(middles, halves, strict=True):
        near = axes[(np.abs(axes.mean(axis=1) - middle) < half + 3 * MOST).all(axis=1)]
        heights = middle[2] + np.append(0.0, share) * half[2]
        corners = np.array([corners_at(near, z, middle[:2], half[:2]) for z in heights])
        counted = np.array([corners[0], corners[1:].mean()]) / 2 / (4 * half[0] * half[1])
        asked = [
            np.mean(wanted(middle + some * half) ** -2.0)
            for some in (inside * np.array([1, 1, 0]), inside)
        ]
        ratios.append(np.sqrt(asked / np.maximum(counted, 1e-9)))
    coarse = halves[:, 0] >= np.quantile(halves[:, 0], 2 / 3)
    cells = int(((made.sites >= BOX[0]) & (made.sites <= BOX[1])).all(axis=1).sum())
    over = int((tilts > ANGLE).sum())
    return Found(cells, float(tilts.max()), over, np.array(ratios), coarse)


def corners_at(axes: Floats, z: float, middle: Floats, half: Floats) -> int:
    """How many struts (n, 2, 3), lower end first, a plane cuts in a rectangle."""
    low, high = axes[(axes[:, 0, 2] <= z) & (axes[:, 1, 2] > z)].swapaxes(0, 1)
    along = (z - low[:, 2]) / (high[:, 2] - low[:, 2])
    points = low[:, :2] + along[:, None] * (high - low)[:, :2]
    return int((np.abs(points - middle) <= half).all(axis=1).sum())


def fields(stretch: float, seeds: range) -> None:
    """Print walls and sizes of all fields and seeds at a stretch."""
    for name, field in FIELDS.items():
        wanted = smoothed(field, stretch)
        chosen = [
            FillSettings(cell_size="x", random_seed=seed, stretch=stretch, max_overhang=ANGLE)
            for seed in seeds
        ]
        found = [found_in(graded_sites(field, *BOX, one), wanted) for one in chosen]
        what = f"{name}: {len(seeds)} × {min(one.cells for one in found):,} cells and more"
        steepest = max(one.steepest for one in found)
        told = f"{sum(one.over for one in found)} ({steepest:.2f}° the steepest)"
        row(f"{what}, stretch {stretch}: walls over {ANGLE:g}°", "0", "", told)
        ratios = np.concatenate([one.ratios for one in found])
        flat, solid = np.sqrt(np.mean((ratios - 1) ** 2, axis=0))
        bias = np.mean(np.concatenate([one.ratios[one.coarse, 1] for one in found])) - 1
        told = f"{flat:.1%} ({solid:.1%} over the window's height; coarse third {bias:+.1%})"
        row("the same: sizes in windows of five cells, RMS", "10 %", "5 %", told)


def times(counts: list[int], stretch: float) -> None:
    """Print processor times for about so many sites of the waves, and how time grows."""
    before: tuple[int, float] | None = None
    for count in counts:
        # The waves make about 31,600 sites in the box, those around it among them.
        scale = (31_600 / count) ** (1 / 3)
        settings = FillSettings(cell_size="x", stretch=stretch, max_overhang=ANGLE)
        began, clock = time.process_time(), time.perf_counter()
        made = graded_sites(lambda at, scale=scale: scale * waves(at), *BOX, settings)
        took, clock = time.process_time() - began, time.perf_counter() - clock
        told = f"{took:.1f} s (by the clock {clock:.1f} s)"
        must, aim = ("10 s", "5 s") if len(made.sites) < 30_000 else ("120 s", "60 s")
        if before is not None:
            more, longer = len(made.sites) / before[0], took / before[1]
            told += f"; {more:.1f} times the sites of the row above take {longer:.1f} times as long"
        row(f"{len(made.sites):,} sites at a stretch of {stretch}", must, aim, told)
        before = len(made.sites), took


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    row("what", "must", "aim", "measured")
    row("---", "---", "---", "---")
    row("stretch at 45°", f"≤ {TAU}", f"{LEAST_TAU}", f"{TAU}, or {LEAST_TAU} if asked for")
    for stretch in (TAU,) if quick else (TAU, LEAST_TAU):
        times([10_000] if quick else [10_000, 100_000], stretch)
    fields(TAU, SEEDS[:1] if quick else SEEDS)


if __name__ == "__main__":
    main()
