"""The shipped sites, which repeat without end, and the sites around a part made of them.

**The tile** is a periodic box of some thousand sites in the stretched space, whole numbers on a
grid of its own: `SIZE` steps. Its walls lean at most as `TAU_SQUARED` allows, certified on
that grid, so that s = max(1, τ / tan θ) stretches it to any θ.

**How the grids fit.** A tile's side is as long as the square root of its cells in a section, in
cell sizes: so one step of its grid is `step` mm, for a cell size. The structure's grid has to be so
fine that 2²⁴ steps span the part's frame. Sites are not to be rounded onto it, since a wall could
come to lean more: so the structure's pitch is chosen as a whole fraction of the tile's step,
`pitch` = `step` / `multiple`, the finest one that spans the frame. A frame so gets larger by less
than the factor 1 + 1 / multiple. A structure's site is then a tile's site times the multiple,
exactly, and the structure's certificate is the tile's. Over 2²⁴ tile steps, some thousand cells,
the frame's grid would be coarser than the tile's: that is an error.

**Heights** are whole numbers on the same grid, in the stretched space: a site at k steps is at
k · pitch · s mm. A layer at z mm is snapped to t / 2 steps, t = 2 z / (s · pitch) rounded; there
the weight of a site is k · t − k², in steps².

**Sites** are those of all repetitions in a box, at whole shifts of the tile; a random seed picks
the tile, its shift, and a quarter turn. They are numbered by repetition, lowest first, then by
the tile's own order: the same for every way to compute them.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from importlib.resources import files
from math import sqrt

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.geometry.compiled.arrays import IntArray, IntRows
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.geometry.power_diagram.grid import STEPS
from v3dcad.model import Ints
from v3dcad.structure.foam.random import random_bits

SIDE, HEIGHT = 1 << 17, 1 << 15
"""Steps of the tile's grid along its sides and upward. It is wide so that sections have a thousand
cells, as even as those of any larger part."""

SIZE = (SIDE, SIDE, HEIGHT)

TAU_SQUARED = Fraction(25, 16)
"""τ², as whole numbers: no wall of a tile has |Δz|² over τ² |Δxy|². τ is 1.25."""

MARGIN_CELLS = 2
"""Cells around a box that its own cells may depend on."""

TILES = "tiles.npz"
"""The package data that `make_tile` writes: `sites` (n, 3) uint32, `reaches` (n, 2) uint16,
`starts` (t + 1,), and `cells_per_section` (t,)."""


@dataclass(frozen=True, eq=False, slots=True)
class Tile:
    """Sites in a periodic box of `SIZE` steps."""

    sites: Ints
    """(n, 3): x, y and the stretched space's z, from 0 to below `SIZE`"""
    reaches: Ints
    """(n, 2): how far the cell reaches below and above its site, steps, rounded up"""
    cells_per_section: float
    """how many cells a horizontal plane cuts, on average over all heights"""


@dataclass(frozen=True, eq=False, slots=True)
class Pattern:
    """A tile shifted, turned and repeated without end, for a cell size and a structure's grid."""

    sites: Ints
    """(n, 3): the sites of one repetition, in tile steps"""
    reaches: Ints
    """(n, 2): how far their cells reach below and above them, in tile steps"""
    pitch: float
    """mm: one step of the structure's grid, in x and y; in z it is stretched"""
    multiple: int
    """structure steps to one tile step"""
    margin: int
    """structure steps: how far around a box sites are needed"""

    def count_in(self, low: Ints, high: Ints) -> int:
        """How many sites `sites_in` gives."""
        return int(count_sites(self.sites, *self._reach(low, high)))

    def sites_in(self, low: Ints, high: Ints) -> tuple[Ints, Ints]:
        """All sites (n, 3) in reach of the box low … high (3,), and the lowest and highest z (n, 2)
        of their cells, in the structure's steps.

        That is within the margin on all sides, so that all within the box is as it would be among
        all sites. For cells that are whole beyond the box too, ask for a box larger by a margin.
        z is the stretched space's.
        """
        low, high = self._reach(low, high)
        count = count_sites(self.sites, low, high)
        found, spans = np.empty((count, 3), np.int64), np.empty((count, 2), np.int64)
        write_sites(self.sites, self.reaches, low, high, self.multiple, found, spans)
        return found, spans

    def _reach(self, low: Ints, high: Ints) -> tuple[Ints, Ints]:
        """The box with its margin in tile steps, as far as sites can lie."""
        low = np.asarray(low, np.int64) - self.margin
        high = np.asarray(high, np.int64) + self.margin
        return -(-low // self.multiple), high // self.multiple


@cache
def tiles() -> tuple[Tile, ...]:
    """The shipped tiles."""
    with (files(__package__) / TILES).open("rb") as file, np.load(file) as data:
        sites, starts = data["sites"].astype(np.int64), data["starts"]
        reaches = data["reaches"].astype(np.int64)
        cells = data["cells_per_section"].tolist()
    parts = [np.split(rows, starts[1:-1]) for rows in (sites, reaches)]
    return tuple(Tile(*one) for one in zip(*parts, cells, strict=True))


def stretch_for(max_overhang: float, tau: float = sqrt(TAU_SQUARED)) -> float:
    """The least stretch at which no wall of sites with a τ leans more than an angle, degrees.

    `tau` is the tiles' by default.
    """
    # Rounded, so that 45° is 1.25 and not the next number.
    return max(1.0, round(tau / float(np.tan(np.radians(max_overhang))), 12))


def pattern(cell_size: float, random_seed: int, frame: float) -> Pattern:
    """The tiles' pattern for a cell size, mm, on a grid that spans a frame, mm.

    There are 1 / cell_size² cells a mm² of a horizontal section. `SettingError` for cells so small
    that the grid would be coarser than the tile's.
    """
    state = np.array([random_seed], np.uint64)
    shipped = tiles()
    tile = shipped[int(random_bits(state)) % len(shipped)]
    turn = int(random_bits(state)) % 4
    shift = np.array([int(random_bits(state)) % size for size in SIZE])
    side = cell_size * sqrt(tile.cells_per_section)
    step = side / SIDE
    multiple = int(step * STEPS / frame)
    if multiple == 0:
        least = frame / STEPS * SIDE / sqrt(tile.cells_per_section)
        raise SettingError(
            "cell_size",
            f"--cell-size {cell_size:g}: the grid of a part of {frame:g} mm does not resolve such "
            f"cells; {least:.3g} mm are the least",
        )
    x, y, z = tile.sites.T
    for _ in range(turn):
        x, y = -y, x
    sites = (np.column_stack([x, y, z]) + shift) % np.array(SIZE)
    pitch = step / multiple
    margin = int(np.ceil(MARGIN_CELLS * cell_size / pitch))
    return Pattern(sites, tile.reaches, pitch, multiple, margin)


@compiled(ENTRY)
def count_sites(sites: IntRows, low: IntArray, high: IntArray) -> int:
    """How many of the tile's sites (n, 3) and all their repetitions are in a box, tile steps."""
    count = 0
    for site in range(len(sites)):
        along = 1
        for axis in range(3):
            first = -((sites[site, axis] - low[axis]) // SIZE[axis])
            last = (high[axis] - sites[site, axis]) // SIZE[axis]
            along *= max(last - first + 1, 0)
        count += along
    return count


@compiled(ENTRY)
def write_sites(
    sites: IntRows,
    reaches: IntRows,
    low: IntArray,
    high: IntArray,
    multiple: int,
    found: IntRows,
    spans: IntRows,
) -> None:
    """Write these sites and their cells' lowest and highest z, times the multiple; by repetition,
    then in the tile's order.
    """
    row = 0
    for k in range(low[2] // HEIGHT, high[2] // HEIGHT + 1):
        for j in range(low[1] // SIDE, high[1] // SIDE + 1):
            for i in range(low[0] // SIDE, high[0] // SIDE + 1):
                for site in range(len(sites)):
                    x = sites[site, 0] + i * SIDE
                    y = sites[site, 1] + j * SIDE
                    z = sites[site, 2] + k * HEIGHT
                    inside = low[0] <= x <= high[0] and low[1] <= y <= high[1]
                    if inside and low[2] <= z <= high[2]:
                        found[row, 0] = x * multiple
                        found[row, 1] = y * multiple
                        found[row, 2] = z * multiple
                        spans[row, 0] = (z - reaches[site, 0]) * multiple
                        spans[row, 1] = (z + reaches[site, 1]) * multiple
                        row += 1
