"""What a fill will take, told before it begins where it is much."""

from __future__ import annotations

import os
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from v3dcad.errors import SettingError
from v3dcad.words import counted

if TYPE_CHECKING:
    from v3dcad.model import Floats
    from v3dcad.settings import FillSettings

SECONDS = 5.0, 0.004, 0.0007
"""What a fill with G-code takes: in all, for a layer, and for a cell of a layer."""
BYTES = 20_000, 4_000, 400
"""What G-code takes, in the same way; and"""
MEMORY = 300e6, 3_000, 50
"""memory. Measured on samples/pyramid.stl: 50 to 1,000 layers, 61 to 2,138 cells in one."""

WORTH_TELLING = 60.0
"""Seconds; shorter fills begin without a word."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """What a fill takes at most, about."""

    layers: int
    cells: float
    """in a layer that is as large as the base rectangle"""

    @property
    def seconds(self) -> float:
        """Time with G-code, on a machine of 2026."""
        return self._sum(SECONDS)

    @property
    def gcode(self) -> float:
        """Bytes of G-code."""
        return self._sum(BYTES)

    @property
    def memory(self) -> float:
        """Bytes of memory."""
        return self._sum(MEMORY)

    def _sum(self, rates: tuple[float, float, float]) -> float:
        once, layer, cell = rates
        return once + self.layers * (layer + cell * self.cells)

    def words(self, gcode: bool) -> str:
        """The estimate as a line to show, with that of the G-code or without."""
        minutes = max(round(self.seconds / 60), 1)
        time = f"{minutes} min" if minutes < 120 else f"{minutes / 60:,.0f} h"
        needs = [f"up to about {time}", f"{_size(self.memory)} of memory"]
        needs += [f"{_size(self.gcode)} of G-code"] if gcode else []
        listed = f"{', '.join(needs[:-1])} and {needs[-1]}"
        layers, cells = counted(self.layers, "layer"), counted(round(self.cells), "cell")
        return f"{layers} of up to {cells}: {listed}"


def estimated(bounds: Floats, settings: FillSettings) -> Estimate | None:
    """What the fill of a part with bounds (2, 3), mm, takes; None where only the fill can tell, or
    refuses so many cells.

    Raises `SettingError` where layers are too many or too high.
    """
    from v3dcad.structure.foam.choice import auto_cell_size
    from v3dcad.structure.foam.uniform import MOST
    from v3dcad.structure.placement import layer_heights

    width, depth, height = (bounds[1] - bounds[0]).tolist()
    layers = len(layer_heights(height, settings.layer_height))
    if settings.method == "thesis":
        return Estimate(layers, settings.sites)
    size = settings.cell_size
    if size == "auto":
        size = auto_cell_size(bounds[1] - bounds[0])
    plain = settings.wish() is None and settings.roof_size == "off"
    if not isinstance(size, float | int) or not plain:
        return None
    cells = width * depth / size**2
    return Estimate(layers, cells) if cells * height / size < 2 * MOST else None


def tell(estimate: Estimate, gcode: Path | None) -> None:
    """Say on stderr what takes long; `SettingError` for what this machine has no room for."""
    words = estimate.words(gcode is not None)
    remedy = "take larger cells, or layers farther apart"
    memory = _memory()
    if memory is not None and estimate.memory > memory:
        raise SettingError("cell_size", f"{words}, of which there are {_size(memory)}; {remedy}")
    if gcode is not None:
        free = _room(gcode)
        if free is not None and estimate.gcode > free:
            raise SettingError(
                "gcode", f"{gcode}: {words}, but {_size(free)} are free; make room there, {remedy}"
            )
    if estimate.seconds > WORTH_TELLING:
        print(f"v3dcad: {words}", file=sys.stderr, flush=True)


def _memory() -> int | None:
    """Bytes of memory of this machine; None where it does not say."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):  # Windows has no sysconf
        return None


def _room(file: Path) -> int | None:
    """Bytes that are free where a file is to be; None for a device or pipe."""
    from v3dcad.files import is_stream

    if is_stream(file):
        return None
    there = next(
        folder for folder in (file.absolute(), *file.absolute().parents) if folder.exists()
    )
    return shutil.disk_usage(there).free


def _size(count: float) -> str:
    if count >= 100e9:
        return f"{count / 1e9:,.0f} GB"
    return f"{count / 1e9:.2g} GB" if count >= 1e9 else f"{count / 1e6:.0f} MB"
