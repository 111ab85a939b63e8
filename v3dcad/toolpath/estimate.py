"""What a print takes: time, filament and mass."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from v3dcad.geometry.print_time import step_seconds
from v3dcad.model import Toolpath
from v3dcad.settings import PrintSettings


@dataclass(frozen=True, slots=True)
class Estimate:
    """Time, filament and mass of a print."""

    time_s: float
    filament_mm: float
    mass_g: float


def estimate(toolpaths: Iterable[Toolpath], settings: PrintSettings) -> Estimate:
    """The time, filament and mass that toolpaths take; they are gone through once.

    Each toolpath begins and ends at rest; heating and homing do not count.
    """
    seconds = volume = 0.0
    before = None
    for toolpath in toolpaths:
        if not len(toolpath.points):
            continue
        before = toolpath.points[0] if before is None else before
        seconds += float(step_seconds(toolpath, before, settings).sum())
        volume += float(toolpath.volume.sum())
        before = np.asarray(toolpath.points[-1])
    return Estimate(
        time_s=seconds,
        filament_mm=volume / settings.filament_area(),
        mass_g=volume * settings.filament_density / 1000,
    )
