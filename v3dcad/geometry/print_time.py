"""How long a printer takes: trapezoidal speeds, corners taken by junction deviation.

A move speeds up, runs and slows down at an acceleration of its own. The angle between two moves
limits the speed at their junction (Jeon 2011, as in Grbl, Marlin and Klipper). A pass backward and
a pass forward over the moves then give the speed at every junction.
"""

from __future__ import annotations

import math

import numpy as np

from v3dcad.geometry.arcs import lengths
from v3dcad.geometry.compiled.arrays import ConstFloatArray, ConstFloatRows, FloatArray
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.model import (
    BRIDGE,
    EXTRUDE,
    FEATURES,
    PERIMETER,
    RETRACT,
    SOLID,
    UNRETRACT,
    Floats,
    Toolpath,
)
from v3dcad.settings import PrintSettings


def step_seconds(toolpath: Toolpath, before: Floats, settings: PrintSettings) -> Floats:
    """(p,) seconds of each step of a toolpath that begins, at rest, at `before` (3,), mm."""
    start = np.vstack([before, toolpath.points[:-1]])[: len(toolpath.points)]
    length = lengths(start, toolpath.points, toolpath.centre)
    pulled = (toolpath.kind == RETRACT) | (toolpath.kind == UNRETRACT)
    return move_seconds(
        toolpath.points - start,
        length,
        np.where(pulled, settings.retraction, 0.0),
        toolpath.speed,
        np.where(
            toolpath.kind == EXTRUDE,
            feature_accelerations(settings)[toolpath.feature],
            settings.acceleration_of("travel"),
        ),
        settings.corner_speed,
    )


def feature_accelerations(settings: PrintSettings) -> Floats:
    """(FEATURES,) mm/s² at which each feature is extruded."""
    found = np.full(FEATURES, settings.acceleration)
    found[PERIMETER] = settings.acceleration_of("perimeter")
    found[SOLID] = settings.acceleration_of("solid")
    found[BRIDGE] = settings.acceleration_of("bridge")
    return found


def move_seconds(
    steps: Floats,
    length: Floats,
    still: Floats,
    speed: Floats,
    acceleration: Floats,
    corner_speed: float,
) -> Floats:
    """(n,) seconds of moves that begin and end at rest.

    `steps` (n, 3) are their directions, `length` (n,) their lengths, mm, `still` (n,) the mm of
    filament moved while the nozzle does not move, `speed` (n,) the requested mm/s, `acceleration`
    (n,) mm/s². A right angle is taken at `corner_speed`, mm/s.
    """
    seconds = np.empty(len(steps))
    _plan(
        np.ascontiguousarray(steps, np.float64),
        np.ascontiguousarray(length, np.float64),
        np.ascontiguousarray(still, np.float64),
        np.ascontiguousarray(speed, np.float64),
        np.ascontiguousarray(acceleration, np.float64),
        corner_speed**2 * (math.sqrt(2) - 1),
        seconds,
    )
    return seconds


@compiled(ENTRY)
def _plan(
    steps: ConstFloatRows,
    length: ConstFloatArray,
    still: ConstFloatArray,
    speed: ConstFloatArray,
    acceleration: ConstFloatArray,
    corner: float,
    seconds: FloatArray,
) -> None:
    count = len(length)
    # entry[k] is the square of the speed at which move k begins; the last one ends at rest.
    entry = np.zeros(count + 1)
    for k in range(1, count):
        if length[k] > 0 and length[k - 1] > 0:
            across, square, squared = 0.0, 0.0, 0.0
            for axis in range(3):
                across += steps[k - 1, axis] * steps[k, axis]
                square += steps[k - 1, axis] ** 2
                squared += steps[k, axis] ** 2
            if square > 0 and squared > 0:
                cosine = across / math.sqrt(square * squared)
                # Sine of half the angle at the junction: 1 is straight on.
                half = math.sqrt(max(0.0, min(1.0, (1 + cosine) / 2)))
                limit = min(speed[k - 1], speed[k]) ** 2
                if corner * half < limit * (1 - half):
                    limit = corner * half / (1 - half)
                entry[k] = limit
    for k in range(count - 1, -1, -1):
        entry[k] = min(entry[k], entry[k + 1] + 2 * acceleration[k] * length[k])
    for k in range(count):
        entry[k + 1] = min(entry[k + 1], entry[k] + 2 * acceleration[k] * length[k])
        way = length[k] if length[k] > 0 else still[k]
        # The square of the highest speed that way, start and end allow.
        peak = min(speed[k] ** 2, acceleration[k] * way + (entry[k] + entry[k + 1]) / 2)
        top = math.sqrt(peak)
        if top == 0:
            seconds[k] = 0.0
            continue
        ramps = (2 * peak - entry[k] - entry[k + 1]) / (2 * acceleration[k])
        seconds[k] = (
            (2 * top - math.sqrt(entry[k]) - math.sqrt(entry[k + 1])) / acceleration[k]
            + max(0.0, way - ramps) / top
        )  # fmt: skip
