"""G-code for FFF printers: Marlin, RepRapFirmware and Klipper.

The moves are written to a temporary file first. Header and progress need the time of the whole
print, and the last layer may still raise an error: the caller's stream gets its first byte when
no error can come any more.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from typing import IO, TextIO

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.formats.gcode.blocks import (
    Totals,
    acceleration_line,
    ending,
    heading,
    temperature_lines,
)
from v3dcad.formats.gcode.lines import rendered
from v3dcad.formats.gcode.moves import MoveWriter, origin
from v3dcad.geometry.print_time import feature_accelerations, step_seconds
from v3dcad.model import (
    BRIDGE,
    BRIM,
    CELLS,
    EXTRUDE,
    FEATURES,
    INNER_PERIMETER,
    PERIMETER,
    SKIRT,
    SOLID,
    Floats,
    Toolpath,
)
from v3dcad.settings import PrintSettings

COMMENTS = {
    PERIMETER: b";TYPE:WALL-OUTER\n",
    INNER_PERIMETER: b";TYPE:WALL-INNER\n",
    CELLS: b";TYPE:FILL\n",
    SOLID: b";TYPE:SKIN\n",
    BRIDGE: b";BRIDGE\n;TYPE:SKIN\n",
    BRIM: b";TYPE:SKIRT\n",
    SKIRT: b";TYPE:SKIRT\n",
}
"""What is printed, in the words of Cura, which viewers know."""
LINES_PER_BLOCK = 1024
"""Lines between two reports of progress."""


def check_fits(bounds: Floats, settings: PrintSettings) -> None:
    """Raise `SettingError` unless a part of these bounds (2, 3), mm, fits the printer.

    The bead's half width around the contour counts where the contour is printed on its centre.
    """
    margin = settings.bead_width if settings.contour == "centre" else 0.0
    size = bounds[1, :2] - bounds[0, :2] + margin
    for axis, needed, there in zip("xy", size, settings.bed_size(), strict=True):
        if needed > there:
            raise SettingError(
                "bed",
                f"--bed {settings.bed}: the part is {needed - there:.2f} mm too large in {axis}; "
                "name a larger bed or scale the part",
            )
    if bounds[1, 2] > settings.build_height:
        raise SettingError(
            "build_height",
            f"--build-height {settings.build_height:g}: the part is {bounds[1, 2]:.2f} mm high; "
            "name a higher printer or scale the part",
        )


def write_gcode(
    stream: TextIO,
    toolpaths: Iterable[Toolpath],
    settings: PrintSettings,
    thumbnail: bytes | None = None,
) -> Totals:
    """Write toolpaths, whose origin is the bed's centre, as G-code; returns the totals.

    `toolpaths` are read once, one in memory at a time; `thumbnail` is a PNG. E is the rounded sum
    of all filament so far less the rounded sum at the layer's start, so that rounding (1e-5 mm of
    filament, 1e-3 mm of position) never adds up. The same input gives the same bytes.
    Raises `SettingError`, before a byte is written, where a move leaves the bed, a placeholder
    is unknown or E would overflow.
    """
    totals = Totals()
    with tempfile.TemporaryFile() as body:
        progress = _write_body(body, toolpaths, settings, totals)
        head = heading(settings, totals, thumbnail)
        tail = ending(settings, totals)
        stream.write(head)
        body.seek(0)
        shown = None
        for size, seconds in progress:
            left = totals.time_s - seconds
            reached = (int(100 * seconds / max(totals.time_s, 1e-9)), int(left / 60 + 0.5))
            if reached != shown:
                stream.write(f"M73 P{reached[0]} R{reached[1]}\n")
                shown = reached
            stream.write(body.read(size).decode("ascii"))
        stream.write(tail)
    return totals


def _write_body(
    body: IO[bytes], toolpaths: Iterable[Toolpath], settings: PrintSettings, totals: Totals
) -> list[tuple[int, float]]:
    """The layers' lines; for each block its size in bytes and when it begins, in seconds."""
    progress: list[tuple[int, float]] = []
    writer, blowing = MoveWriter(settings), 0
    before: Floats | None = None
    for toolpath in toolpaths:
        if not len(toolpath.points):
            continue
        _check_bed(toolpath, settings)
        before = toolpath.points[0] if before is None else before
        at = totals.time_s + np.cumsum(step_seconds(toolpath, before, settings))
        before = toolpath.points[-1]
        lines, step = writer.lines(toolpath)
        power = _fan(settings, totals.layers)
        heating = temperature_lines(settings) if totals.layers == 1 else []
        # The first layer goes on from the retraction before it.
        anew = totals.layers > 0 and not settings.counts_from_before()
        told = [*(["G92 E0"] if anew else []), *heating, *_blow(power, blowing)]
        opening = "\n".join([f";LAYER:{toolpath.layer[0]}", *told, ""]).encode("ascii")
        comments, blowing = _comments(toolpath, settings, power)
        body.write(opening)
        progress.append((len(opening), totals.time_s))
        for start in range(0, len(step), LINES_PER_BLOCK):
            block = rendered(lines.part(start, start + LINES_PER_BLOCK), comments)
            body.write(block)
            begins = at[step[start] - 1] if step[start] else totals.time_s
            progress.append((len(block), float(begins)))
        _count(totals, toolpath, float(at[-1]), settings)
    return progress


def _blow(power: int, blowing: int) -> list[str]:
    return [f"M106 S{power}"] if power != blowing else []


def _comments(toolpath: Toolpath, settings: PrintSettings, power: int) -> tuple[list[bytes], int]:
    """What is written before the lines of each feature, and the fan's power at a layer's end.

    The last is what is written before a travel. The fan blows with `power`, 0 to 255, but on
    bridges; accelerations are told where they are not all the same.
    """
    values = [*feature_accelerations(settings).tolist(), settings.acceleration_of("travel")]
    steady = len({*values[:FEATURES]}) == 1 and not settings.switches_for_travel()
    told = [b"" if steady else acceleration_line(settings, value) for value in values]
    comments = [COMMENTS.get(feature, b"") for feature in range(FEATURES)]
    extruded = toolpath.feature[toolpath.kind == EXTRUDE]
    over_air = round(settings.bridge_fan * 2.55)
    if over_air != power and BRIDGE in extruded:
        powers = [over_air if feature == BRIDGE else power for feature in range(FEATURES)]
        comments = [
            comment + f"M106 S{blown}\n".encode("ascii") if comment else comment
            for comment, blown in zip(comments, powers, strict=True)
        ]
        power = powers[int(extruded[-1])]
    found = [
        comment + line if comment else comment
        for comment, line in zip(comments, told[:-1], strict=True)
    ]
    return [*found, told[-1]], power


def _fan(settings: PrintSettings, number: int) -> int:
    """Power of the fan, 0 to 255, on a layer: it rises evenly up to `fan_full_layer`."""
    first = settings.fan_from_layer
    if number < first:
        return 0
    share = min(1.0, (number - first + 1) / (max(settings.fan_full_layer - first, 0) + 1))
    return round(settings.fan * 2.55 * share)


def _check_bed(toolpath: Toolpath, settings: PrintSettings) -> None:
    points = toolpath.points
    for axis, size in enumerate(settings.bed_size()):
        worst = points[np.argmax(np.abs(points[:, axis])), axis]
        if 2 * abs(worst) > size * (1 + 1e-9):
            raise SettingError(
                "bed",
                f"--bed {settings.bed}: layer {toolpath.layer[0]} goes to {'xy'[axis]} = "
                f"{worst:.2f} mm from the bed's centre, {abs(worst) - size / 2:.2f} mm beyond its "
                "edge; name a larger bed, a smaller skirt or brim, or scale the part",
            )
    highest = float(points[toolpath.kind == EXTRUDE, 2].max(initial=0))
    if highest > settings.build_height:
        raise SettingError(
            "build_height",
            f"--build-height {settings.build_height:g}: layer {toolpath.layer[0]} is at "
            f"{highest:.2f} mm; name a higher printer or scale the part",
        )


def _count(totals: Totals, toolpath: Toolpath, time: float, settings: PrintSettings) -> None:
    volume = float(toolpath.volume.sum())
    totals.time_s = time
    totals.filament_mm += volume / settings.filament_area()
    totals.mass_g += volume * settings.filament_density / 1000
    totals.layers += 1
    extruded = toolpath.points[toolpath.kind == EXTRUDE] + origin(settings)
    if len(extruded):
        totals.bounds[0] = np.minimum(totals.bounds[0], extruded.min(axis=0))
        totals.bounds[1] = np.maximum(totals.bounds[1], extruded.max(axis=0))
