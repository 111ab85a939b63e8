"""What a part weighs as printed, and the cell size with which it has the mass that is asked for."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.model import Floats, Layer, Progress, Section, unheard
from v3dcad.settings import FillSettings, PrintSettings, option
from v3dcad.structure.foam.choice import largest_cell_size
from v3dcad.toolpath.plastic import Plastic, Rooms

DECIMALS = 3
"""Of a cell size in mm, so that users can read it."""

CLOSE, ENOUGH = 0.005, 0.02
"""Of what is asked: a size that misses by less is taken at once, or if there is no better one."""

TRIES = 10
"""Cell sizes that are tried."""

LEAST_WALLS = 1.5
"""Cells smaller than so many widths of a wall are not tried: they would be nearly solid."""

MOST_CELLS = 2_000_000
"""Nor are those of which the part's box has more."""

SOLID_WALLS = 0.85
"""Widths of a wall: regular cells of about this size would leave nothing open."""


@dataclass(frozen=True, slots=True)
class Expected:
    """What a part takes as printed, without brim and skirt, expected from a few of its layers."""

    density: float
    """share of the part's volume"""
    mass: float
    """g"""


def expected_print(
    layers: Sequence[Layer], settings: FillSettings, printing: PrintSettings
) -> Expected:
    """What layers that were filled by some settings take as printed."""
    rooms = Rooms((layer.section for layer in layers), settings.layer_height, printing)
    return _expected(rooms, rooms.plastic(layers), printing)


def _expected(rooms: Rooms, plastic: Plastic, printing: PrintSettings) -> Expected:
    volume = plastic.total()
    density = volume / rooms.volume if rooms.volume else 0.0
    return Expected(density, volume * printing.filament_density / 1000)


def with_cell_size(
    sections: Sequence[Section],
    bounds: Floats,
    settings: FillSettings,
    printing: PrintSettings,
    fill: Callable[[FillSettings], Sequence[Layer]],
    progress: Progress = unheard,
) -> tuple[FillSettings, Expected | None]:
    """The settings with a cell size for the density or the mass in them, and what is expected.

    That is None where they ask for neither. `bounds` (2, 3), mm, are the part's; `fill` fills its
    sections by settings that say a cell size. Brim and skirt do not count. For each size that is
    tried, beads are laid on some layers. Raises `SettingError` where no size gives what is asked,
    and says what can be reached.
    """
    wish = settings.wish()
    if wish is None:
        return settings, None
    name, asked = wish
    rooms = Rooms(sections, settings.layer_height, printing)
    grams = printing.filament_density / 1000
    unit = grams if name == "mass" else 1 / rooms.volume
    wall = printing.wall_width()
    largest = largest_cell_size(bounds, settings)
    least = (float(np.prod(np.ptp(bounds, axis=0))) / MOST_CELLS) ** (1 / 3)
    least = min(max(least, LEAST_WALLS * wall), largest)
    tried: dict[float, Plastic] = {}

    def plastic(size: float) -> Plastic:
        if size not in tried:
            progress("finding the cell size", min(len(tried), TRIES), TRIES)
            tried[size] = rooms.plastic(fill(_sized(settings, size)))
        return tried[size]

    size = _nearest(plastic, asked / unit, rooms.whole(), SOLID_WALLS * wall, (least, largest))
    if abs(plastic(size).total() * unit / asked - 1) <= ENOUGH:
        return _sized(settings, size), _expected(rooms, plastic(size), printing)
    low, high = (plastic(_rounded(end, least, largest)) for end in (largest, least))
    fixed = low.perimeters + low.skins
    of, lightest = " g" if name == "mass" else "", low.total() * unit
    fewer = "; fewer --perimeters or --top-layers, or --open, take less" if asked < lightest else ""
    raise SettingError(
        name,
        f"{option(name)} {asked:g}{of}: cannot be reached; cells of {largest:.4g} mm give "
        f"{lightest:.3g}{of}, those of {least:.3g} mm {high.total() * unit:.3g}{of}; "
        f"perimeters and skins alone are {fixed * unit:.3g}{of}{fewer}",
    )


def _sized(settings: FillSettings, size: float) -> FillSettings:
    """The settings with a cell size, mm, in place of a density or a mass."""
    return replace(settings, cell_size=size, density="off", mass="off")


def _nearest(
    plastic: Callable[[float], Plastic],
    wanted: float,
    rooms: Plastic,
    solid: float,
    limits: tuple[float, float],
) -> float:
    """Of the cell sizes (mm) that are tried, the one that comes nearest to what is wanted, mm³.

    Regular cells of size s leave (1 − c / s)² of their room open. So 1 − √(open share) goes about
    as 1 / s, which gives the next size, until one lies on either side; then the secant does, over
    the logarithm of s. Regular cells of the size `solid` leave nothing open.
    """
    size = solid / _closed(wanted, rooms, rooms)
    finer = coarser = 0.0
    missed: dict[float, float] = {}
    while len(missed) < TRIES:
        size = _rounded(size, *limits)
        if size in missed:
            break
        found = plastic(size)
        missed[size] = abs(found.total() - wanted)
        if missed[size] <= CLOSE * wanted:
            break
        if found.total() > wanted:
            finer, most = size, found.total()
        else:
            coarser, least = size, found.total()
        if finer and coarser:
            share = min(max((most - wanted) / (most - least), 0.1), 0.9)
            size = finer * (coarser / finer) ** share
        else:
            size *= _closed(found.total(), found, rooms) / _closed(wanted, found, rooms)
    return min(missed, key=missed.__getitem__)


def _closed(total: float, found: Plastic, rooms: Plastic) -> float:
    """1 − √(open share) of the cells' room if all takes so much (mm³), from 0.01 to 1.

    What perimeters and skins take is as found.
    """
    share = (total - found.perimeters - found.skins) / rooms.cells if rooms.cells else 0.0
    return max(1 - math.sqrt(1 - min(max(share, 0.0), 1.0)), 0.01)


def _rounded(size: float, least: float, largest: float) -> float:
    """A cell size within limits, mm, as `DECIMALS` write it."""
    step: int = 10**DECIMALS
    low, high = math.ceil(least * step), math.floor(largest * step)
    steps: int = max(min(round(size * step), high), low)
    return steps / step
