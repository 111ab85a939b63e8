"""G-code for a Marlin FFF printer."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TextIO

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.model import EXTRUDE, RETRACT, TRAVEL, Floats, Toolpath
from v3dcad.settings import PrintSettings

START = """\
G21 ; millimetres
G90 ; absolute positions
M82 ; absolute extrusion
M104 S{nozzle_temperature:g}
M140 S{bed_temperature:g}
G28 ; home
M190 S{bed_temperature:g}
M109 S{nozzle_temperature:g}
G92 E0
"""

END = """\
G91
G1 Z10 F600 ; clear of the part
G90
G28 X Y
M104 S0
M140 S0
M107
M84
"""


def check_fits(bounds: Floats, settings: PrintSettings) -> None:
    """Raise `SettingError` unless a part of these bounds (2, 3), mm, fits the bed.

    The bead's half width around the contour counts.
    """
    size = bounds[1, :2] - bounds[0, :2] + settings.bead_width
    for axis, needed, there in zip("xy", size, settings.bed_size(), strict=True):
        if needed > there:
            raise SettingError(
                "bed",
                f"--bed {settings.bed}: the part is {needed - there:.2f} mm too large in {axis}; "
                "name a larger bed or scale the part",
            )


def write_gcode(stream: TextIO, toolpaths: Iterable[Toolpath], settings: PrintSettings) -> None:
    """Toolpaths in bed coordinates, origin at the bed's centre, as G-code.

    E is absolute and computed from the whole volume so far, so that rounding (to 1e-5 mm of
    filament) never adds up. Printer coordinates have their origin at the bed's front left.
    """
    width, depth = settings.bed_size()
    filament = math.pi / 4 * settings.filament_diameter**2
    stream.write("; made by v3dcad\n")
    stream.write(
        START.format(
            nozzle_temperature=settings.nozzle_temperature,
            bed_temperature=settings.bed_temperature,
        )
    )
    laid = 0.0
    for path in toolpaths:
        stream.write(f";LAYER:{path.layer[0]}\n")
        extruded = (laid + np.cumsum(path.volume)) / filament
        laid += float(path.volume.sum())
        rows = zip(
            path.kind.tolist(),
            (path.points + np.array([width / 2, depth / 2, 0])).tolist(),
            extruded.tolist(),
            (path.speed * 60).tolist(),
            strict=True,
        )
        height = ""
        for kind, (x, y, z), e, feed in rows:
            if kind == EXTRUDE:
                stream.write(f"G1 X{x:.4f} Y{y:.4f} E{e:.5f} F{feed:.0f}\n")
            elif kind == TRAVEL:
                level = f" Z{z:.4f}"
                stream.write(
                    f"G0 X{x:.4f} Y{y:.4f}{level if level != height else ''} F{feed:.0f}\n"
                )
                height = level
            else:
                e -= settings.retraction if kind == RETRACT else 0
                stream.write(f"G1 E{e:.5f} F{feed:.0f}\n")
    stream.write(END)
