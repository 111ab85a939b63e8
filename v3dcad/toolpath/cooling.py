"""Layers that would be printed too quickly to cool are printed slower."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from v3dcad.geometry.print_time import step_seconds
from v3dcad.model import EXTRUDE, Floats, Toolpath
from v3dcad.settings import PrintSettings

TRIALS = 12
"""Halvings of the range of speeds: the speed found is within 1/4096 of the range."""


def cooled(toolpath: Toolpath, before: Floats, settings: PrintSettings) -> tuple[Toolpath, float]:
    """A layer that takes `minimum_layer_time`, if it can, and the seconds that it takes.

    The layer begins, at rest, at `before` (3,), mm. All that is extruded faster than one speed is
    slowed down to it: the highest, found by bisection, at which the layer takes long enough, or
    `slowest_speed`. Travels keep their speed.
    """
    seconds = _seconds(toolpath, before, settings)
    extruding = toolpath.kind == EXTRUDE
    if seconds >= settings.minimum_layer_time or not extruding.any():
        return toolpath, seconds
    slow, fast = settings.slowest_speed, float(toolpath.speed[extruding].max())
    limited = _limited(toolpath, slow)
    seconds = _seconds(limited, before, settings)
    if seconds < settings.minimum_layer_time:
        return limited, seconds
    for _ in range(TRIALS):
        trial = (slow + fast) / 2
        tried = _limited(toolpath, trial)
        taken = _seconds(tried, before, settings)
        if taken < settings.minimum_layer_time:
            fast = trial
        else:
            slow, limited, seconds = trial, tried, taken
    return limited, seconds


def _seconds(toolpath: Toolpath, before: Floats, settings: PrintSettings) -> float:
    return float(step_seconds(toolpath, before, settings).sum())


def _limited(toolpath: Toolpath, most: float) -> Toolpath:
    extruding = toolpath.kind == EXTRUDE
    return replace(
        toolpath,
        speed=np.where(extruding, np.minimum(toolpath.speed, most), toolpath.speed),
    )
