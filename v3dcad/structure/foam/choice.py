"""Which sites a part is filled with: what the settings say, or those that are given."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from v3dcad.arguments import rows
from v3dcad.errors import SettingError
from v3dcad.model import Floats
from v3dcad.settings import FillSettings
from v3dcad.structure.foam.explicit import column_sites, explicit_sites
from v3dcad.structure.foam.sites import FoamSites
from v3dcad.structure.foam.space import steepest_in, tilt
from v3dcad.structure.foam.tile import MARGIN_CELLS, stretch_for
from v3dcad.structure.foam.uniform import refuse_larger, refuse_many, uniform_sites
from v3dcad.structure.sites import scatter_sites

CELLS = 40
"""In the base rectangle, if nobody says otherwise, as long as cells are within"""
LEAST, MOST = 3.0, 15.0
"""mm."""

TAU, LEAST_TAU = 1.67, 1.41
"""The usual and the least τ of cells of many sizes: with a smaller one, walls lean less, and it
takes longer."""


def foam_for(
    low: Floats, high: Floats, sites: Floats | None, settings: FillSettings
) -> tuple[FoamSites, FillSettings]:
    """The sites for a part in the box low … high (3,), mm, and settings without "auto".

    `sites` (n, 3) or (n, 2), mm, if the user gives them. Raises `SettingError` where settings do
    not fit the part or each other, `GeometryError` for sites that cannot be computed with.
    """
    if sites is not None:
        return _given(low, high, rows("sites", sites, "x, y, z", "x, y for columns"), settings)
    columns, stretch = settings.stretch == "columns", _uniform_stretch(settings)
    size = settings.cell_size
    if size == "auto":
        size = auto_cell_size(high - low)
    if not isinstance(size, float | int):
        raise SettingError(
            "cell_size",
            "a cell size that differs from place to place needs a part: call fill, not "
            "fill_sections",
        )
    refuse_larger(size, (high - low) / np.array([1, 1, stretch]))
    if columns:
        foam = _columns(low, high, size, settings.random_seed)
        return foam, replace(settings, cell_size=size)
    foam = uniform_sites(low, high, size, stretch, settings.random_seed)
    return foam, replace(settings, cell_size=size, stretch=stretch)


def largest_cell_size(bounds: Floats, settings: FillSettings) -> float:
    """The largest size, mm, of cells of one size in a part with bounds (2, 3), mm."""
    width, depth, height = np.ptp(bounds, axis=0).tolist()
    return float(max(width, depth, height / _uniform_stretch(settings)))


def _uniform_stretch(settings: FillSettings) -> float:
    """The stretch of a foam of cells of one size; columns have no end."""
    least = stretch_for(settings.max_overhang)
    if settings.stretch == "columns":
        return np.inf
    return settled_stretch(settings, least, least, "walls")


def graded_stretch(settings: FillSettings) -> float:
    """The stretch of a foam of cells of many sizes.

    Raises `SettingError` for columns, and for one with which no sites would be found.
    """
    if settings.stretch == "columns":
        raise SettingError(
            "stretch", "--stretch columns: cells of many sizes need a number, or auto"
        )
    usual, least = (stretch_for(settings.max_overhang, tau) for tau in (TAU, LEAST_TAU))
    return settled_stretch(settings, usual, least, "with cells of many sizes, walls")


def auto_cell_size(size: Floats) -> float:
    """The cell size, mm, that nobody gave, for a part of a size (3,), mm."""
    even = max(float(np.sqrt(size[0] * size[1] / CELLS)), LEAST)
    return min(even, MOST, float(size[:2].max()))


def settled_stretch(settings: FillSettings, usual: float, least: float, walls: str) -> float:
    """The stretch of a foam: the usual one, or the one that is given.

    Raises `SettingError` for one below the least, with which `walls` (in words) lean too much.
    """
    if isinstance(settings.stretch, str):
        return usual
    if settings.stretch < least:
        raise SettingError(
            "stretch",
            f"--stretch {settings.stretch:g}: {walls} would lean more than "
            f"{settings.max_overhang:g}°; give at least {least:.4g}, leave it to auto, or allow "
            "more with --max-overhang",
        )
    return float(settings.stretch)


def _columns(low: Floats, high: Floats, cell_size: float, random_seed: int) -> FoamSites:
    """Upright cells, scattered evenly in the base rectangle and around it."""
    margin = MARGIN_CELLS * cell_size
    rectangle = np.array([low[:2] - margin, high[:2] + margin])
    count = max(1, round(float(np.prod(rectangle[1] - rectangle[0])) / cell_size**2))
    refuse_many(count, cell_size)
    return column_sites(scatter_sites(rectangle, count, random_seed), low, high)


def _given(
    low: Floats, high: Floats, sites: Floats, settings: FillSettings
) -> tuple[FoamSites, FillSettings]:
    if sites.shape[1] == 2:
        return column_sites(sites, low, high), replace(settings, stretch="columns")
    if isinstance(settings.stretch, str):
        raise SettingError(
            "stretch", f"--stretch {settings.stretch}: sites in space need a number; give it"
        )
    foam = explicit_sites(sites, settings.stretch, low, high)
    refuse_overhang(foam, low, high, settings.max_overhang)
    return foam, settings


def refuse_overhang(foam: FoamSites, low: Floats, high: Floats, max_overhang: float) -> None:
    """Raise `SettingError` if a wall in a box leans more than an angle, degrees."""
    worst = steepest_in(foam, low, high)
    angle = tilt(worst, foam.stretch)
    if max_overhang < 90 and angle > max_overhang * (1 + 1e-12):
        i, j = worst.sites
        raise SettingError(
            "max_overhang",
            f"the wall between sites {i} and {j} leans {angle:.4g}°, more than {max_overhang:g}°: "
            "move them, stretch them more, or allow it with --max-overhang",
        )
