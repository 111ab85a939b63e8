"""A field of sizes on a grid, made so smooth that cells can follow it.

Cells that change their size faster than by `SLOPE` from place to place cannot all be kept from
leaning too much. Where a field is steeper, sizes are lowered until it is not: the largest field
below it whose gradient is nowhere over `SLOPE` (Persson, "Mesh size functions for implicit
geometries and PDE-based gradient limiting", Engineering with Computers 2006), by the fast sweeping
method (Zhao, Mathematics of Computation 2005).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, FloatStack
from v3dcad.geometry.compiled.options import ENTRY, INLINED, INTERNAL, compiled
from v3dcad.model import Floats

SLOPE = 0.3
"""The steepest gradient of a size in the stretched space."""

NODES = 2_000_000
"""About how many nodes a grid has at most."""

FEW = 30_000
"""With so many it is found out how small and large sizes are."""

FINE = 0.3
"""In the smallest sizes: no side of a cube need be shorter."""

STILL = 1e-6
"""Sweeps end when no size changes by more than this share."""

Field = Callable[[Floats], Floats]
"""Sizes (n,) at places (n, 3)."""


class SizeGrid(NamedTuple):
    """Sizes at the nodes of a cubic grid, linear between them; beyond, that of the nearest one."""

    corner: FloatArray
    """(3,) the lowest node"""
    side: float
    """of a cube"""
    sizes: FloatStack
    """(a, b, c), each at least 2"""


class Sampled(NamedTuple):
    """A field on a grid, and what had to be changed in it."""

    grid: SizeGrid
    asked: Floats
    """(m,) the sizes that were asked for at the nodes"""
    made: Floats
    """(m,) those that are made there: nowhere larger"""


def sampled(field: Field, low: Floats, high: Floats) -> Sampled:
    """A field over the box low … high (3,), nowhere steeper than `SLOPE`."""
    size = high - low
    some = field(_lattice(_axes(low, high, side_of(size, FEW))))
    side = max(side_of(size, NODES), FINE * float(some.min()))
    axes = _axes(low, high, side)
    asked = field(_lattice(axes)).reshape([len(axis) for axis in axes])
    grid = SizeGrid(low, side, asked.copy())
    limit_slope(grid, SLOPE)
    return Sampled(grid, asked.ravel(), grid.sizes.ravel())


def side_of(size: Floats, nodes: int) -> float:
    """The side of cubes of which about so many fill a box of a size (3,)."""
    return float(max(np.cbrt(size.prod() / nodes), size.max() / nodes))


def _axes(low: Floats, high: Floats, side: float) -> list[Floats]:
    """The coordinates of a grid's nodes over a box along each axis, none beyond it."""
    return [
        np.minimum(start + side * np.arange(max(2, int(np.ceil((end - start) / side)) + 1)), end)
        for start, end in zip(low.tolist(), high.tolist(), strict=True)
    ]


def _lattice(axes: list[Floats]) -> Floats:
    """All nodes (n, 3), the last axis running fastest."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


@compiled(INLINED)
def size_at(grid: SizeGrid, x: float, y: float, z: float) -> float:
    """The size at a place."""
    shape = grid.sizes.shape
    a = min(max((x - grid.corner[0]) / grid.side, 0.0), shape[0] - 1.0)
    b = min(max((y - grid.corner[1]) / grid.side, 0.0), shape[1] - 1.0)
    c = min(max((z - grid.corner[2]) / grid.side, 0.0), shape[2] - 1.0)
    i, j, k = min(int(a), shape[0] - 2), min(int(b), shape[1] - 2), min(int(c), shape[2] - 2)
    a, b, c = a - i, b - j, c - k
    size = 0.0
    for corner in range(8):
        di, dj, dk = corner & 1, (corner >> 1) & 1, corner >> 2
        share = (a if di else 1 - a) * (b if dj else 1 - b) * (c if dk else 1 - c)
        size += share * grid.sizes[i + di, j + dj, k + dk]
    return size


@compiled(INTERNAL)
def least_beside(sizes: FloatStack, axis: int, i: int, j: int, k: int) -> float:
    """The smaller of a node's two neighbours along an axis."""
    at = i if axis == 0 else (j if axis == 1 else k)
    least = np.inf
    for step in (-1, 1):
        if 0 <= at + step < sizes.shape[axis]:
            beside = sizes[
                i + (step if axis == 0 else 0),
                j + (step if axis == 1 else 0),
                k + (step if axis == 2 else 0),
            ]
            least = min(least, beside)
    return least


@compiled(INTERNAL)
def highest_over(a: float, b: float, c: float, rise: float) -> float:
    """The size over neighbours a, b, c along the axes with a gradient of `rise` a side.

    The upwind scheme of Godunov: Σ max(size − neighbour, 0)² = rise².
    """
    low, high = min(a, b, c), max(a, b, c)
    middle = a + b + c - low - high if high < np.inf else max(min(a, b), min(max(a, b), c))
    size = low + rise
    if size > middle:
        size = (low + middle + np.sqrt(2 * rise * rise - (low - middle) ** 2)) / 2
        if size > high:
            total = low + middle + high
            squares = low * low + middle * middle + high * high
            size = (total + np.sqrt(total * total - 3 * (squares - rise * rise))) / 3
    return size


@compiled(ENTRY)
def limit_slope(grid: SizeGrid, slope: float) -> None:
    """Lower sizes until their gradient is nowhere over a slope."""
    sizes, rise = grid.sizes, slope * grid.side
    shape = sizes.shape
    changed = True
    while changed:
        changed = False
        for sweep in range(8):
            for i0 in range(shape[0]):
                i = i0 if sweep & 1 else shape[0] - 1 - i0
                for j0 in range(shape[1]):
                    j = j0 if sweep & 2 else shape[1] - 1 - j0
                    for k0 in range(shape[2]):
                        k = k0 if sweep & 4 else shape[2] - 1 - k0
                        size = highest_over(
                            least_beside(sizes, 0, i, j, k),
                            least_beside(sizes, 1, i, j, k),
                            least_beside(sizes, 2, i, j, k),
                            rise,
                        )
                        if size < sizes[i, j, k] * (1 - STILL):
                            sizes[i, j, k] = size
                            changed = True
