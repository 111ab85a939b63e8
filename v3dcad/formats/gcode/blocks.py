"""The text before and after the moves: header, thumbnail, start and end blocks."""

from __future__ import annotations

import base64
import re
from dataclasses import dataclass, field, fields

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.model import Floats
from v3dcad.settings import PrintSettings, option

FLAVOURS = {"marlin": "Marlin", "reprapfirmware": "RepRap", "klipper": "Klipper"}
PLACEHOLDER = re.compile(r"\{\{|\}\}|\{(\w+)\}|[{}]")
THUMBNAIL_LINE = 76
"""Characters of a thumbnail in one line; readers stop at 78."""
PRIME_MARGIN = 3.0
PRIME_WIDTH = 0.6
"""The prime line's distance from the bed's edges, and the width of its bead, mm."""
DIALECT = "; comments in the words of Cura_SteamEngine (v3dcad)"
"""By this name PrusaSlicer's viewer and Moonraker tell how to read the comments. Without it the
one shows no features, the other neither time, filament, layers nor heights."""
PNG = b"\x89PNG\r\n\x1a\n"


@dataclass(slots=True)
class Totals:
    """What a whole print takes."""

    time_s: float = 0.0
    filament_mm: float = 0.0
    mass_g: float = 0.0
    layers: int = 0
    bounds: Floats = field(default_factory=lambda: np.array([[np.inf] * 3, [-np.inf] * 3]))
    """(2, 3) mm, least and greatest coordinates extruded to, as the printer counts them"""


def heading(settings: PrintSettings, totals: Totals, thumbnail: bytes | None) -> str:
    """All before the first layer. Raises `SettingError` for an unknown placeholder."""
    lines = [
        f";FLAVOR:{FLAVOURS[settings.flavour]}",
        f";TIME:{totals.time_s:.0f}",
        f";Filament used: {totals.filament_mm / 1000:.5f}m",
        f";Layer height: {_layer_height(settings, totals):.4g}",
    ]
    if totals.layers:
        for name, corner in zip(("MIN", "MAX"), totals.bounds.tolist(), strict=True):
            lines += [f";{name}{a}:{value:.3f}" for a, value in zip("XYZ", corner, strict=True)]
    lines += [
        ";Generated with v3dcad",
        DIALECT,
        f"; printer = {' '.join(settings.machine.split())}",
        f"; estimated printing time (normal mode) = {duration_text(totals.time_s)}",
        f"; filament used [mm] = {totals.filament_mm:.2f}",
        f"; filament used [g] = {totals.mass_g:.2f}",
    ]
    if thumbnail is not None:
        lines += _thumbnail(thumbnail)
    lines += [
        filled(settings.start_gcode, "start_gcode", settings, totals).rstrip("\n"),
        "G21",
        "G90",
        "M83" if settings.counts_from_before() else "M82",
        "G92 E0",
        *_prime_line(settings),
        *_acceleration(settings),
        *_pressure_advance(settings),
        "M107",
        *_retraction(settings),
        f";LAYER_COUNT:{totals.layers}",
    ]
    return "\n".join(lines) + "\n"


def ending(settings: PrintSettings, totals: Totals) -> str:
    """All after the last layer. Raises `SettingError` for an unknown placeholder."""
    end = filled(settings.end_gcode, "end_gcode", settings, totals).rstrip("\n")
    return f"M73 P100 R0\n{end}\n"


def filled(block: str, name: str, settings: PrintSettings, totals: Totals) -> str:
    """A start or end block, its placeholders replaced by values.

    `{z_hop}` is replaced by that setting, and so are `{time_s}`, `{filament_mm}`, `{layers}` and
    `{height}`; `{{` and `}}` by braces. Temperatures of a start block are those of the first layer.
    Raises `SettingError` for an unknown placeholder, or a brace by itself.
    """
    known = {f.name: getattr(settings, f.name) for f in fields(settings)}
    if name == "start_gcode":
        first = settings.first_layer_temperatures()
        known["nozzle_temperature"], known["bed_temperature"] = first
    del known["start_gcode"], known["end_gcode"]
    known |= {"time_s": round(totals.time_s), "layers": totals.layers}
    known["filament_mm"] = round(totals.filament_mm, 2)
    known["height"] = round(float(totals.bounds[1, 2]), 3) if totals.layers else 0.0

    def value(match: re.Match[str]) -> str:
        word = match[1]
        if match[0] in ("{", "}"):
            raise SettingError(
                name,
                f"{option(name)}: a brace by itself; write {{name}} for the value of a setting, or "
                f"{2 * match[0]} for the brace itself",
            )
        if word is None:
            return match[0][0]
        if word not in known:
            raise SettingError(
                name,
                f"{option(name)}: {{{word}}} is not a known placeholder; write the name of a "
                f"setting, {{time_s}}, {{filament_mm}}, {{layers}} or {{height}}, or "
                f"{{{{{word}}}}} for the braces themselves",
            )
        found = known[word]
        return f"{found:g}" if isinstance(found, float) else str(found)

    return PLACEHOLDER.sub(value, block)


def check_blocks(settings: PrintSettings) -> None:
    """Raise `SettingError` where a start or end block cannot be filled in."""
    for name in ("start_gcode", "end_gcode"):
        filled(getattr(settings, name), name, settings, Totals())


def duration_text(seconds: float) -> str:
    """A duration as slicers write it, such as 1h 2m 3s."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    days, hours = divmod(hours, 24)
    parts = [(days, "d"), (hours, "h"), (minutes, "m"), (rest, "s")]
    while len(parts) > 1 and parts[0][0] == 0:
        parts = parts[1:]
    return " ".join(f"{count}{unit}" for count, unit in parts)


def _prime_line(settings: PrintSettings) -> list[str]:
    """A line along the bed's left edge, there and back: it fills the nozzle and wipes it."""
    width, depth = settings.bed_size()
    length = min(settings.prime_line, depth - 2 * PRIME_MARGIN)
    if length <= 0:
        return []
    left, front = (-width / 2, -depth / 2) if settings.bed_origin == "centre" else (0.0, 0.0)
    x, y = left + PRIME_MARGIN, front + PRIME_MARGIN
    height = settings.first_layer_height
    filament = length * height * PRIME_WIDTH / settings.filament_area()
    feed, travel, rise = (
        round(60 * speed)
        for speed in (settings.first_layer_speed, settings.travel_speed, settings.z_speed)
    )
    return [
        f"G1 Z2 F{rise}",
        f"G1 X{x:g} Y{y:g} F{travel}",
        f"G1 Z{height:g} F{rise}",
        f"G1 Y{y + length:g} E{filament:.5f} F{feed}",
        "G92 E0",
        f"G1 X{x + PRIME_WIDTH:g} F{feed}",
        f"G1 Y{y:g} E{filament / 2:.5f} F{feed}",
        "G92 E0",
        f"G1 Z2 F{rise}",
    ]


def _retraction(settings: PrintSettings) -> list[str]:
    """Pulls the filament back before the way to the first stroke, at whose start it is pushed on.

    That way may lead across the whole bed.
    """
    if not settings.retracts():
        return []
    if settings.retraction_by == "firmware":
        return ["G10"]
    return [f"G1 E-{settings.retraction:g} F{round(60 * settings.retraction_speed)}"]


def _acceleration(settings: PrintSettings) -> list[str]:
    if settings.flavour == "klipper":
        return [
            f"SET_VELOCITY_LIMIT ACCEL={settings.acceleration:g} "
            f"SQUARE_CORNER_VELOCITY={settings.corner_speed:g}"
        ]
    return [f"M204 P{settings.acceleration:g} T{settings.acceleration_of('travel'):g}"]


def acceleration_line(settings: PrintSettings, value: float) -> bytes:
    """What sets the acceleration of extruding moves, mm/s²; in Klipper that of all."""
    klipper = settings.flavour == "klipper"
    return (
        f"SET_VELOCITY_LIMIT ACCEL={value:g}\n".encode()
        if klipper
        else f"M204 P{value:g}\n".encode()
    )


def _layer_height(settings: PrintSettings, totals: Totals) -> float:
    """From the nozzle's heights on the first and the last layer, mm; of one layer, its own."""
    if totals.layers < 2:
        return settings.first_layer_height
    return float(np.ptp(totals.bounds[:, 2])) / (totals.layers - 1)


def temperature_lines(settings: PrintSettings) -> list[str]:
    """What heats nozzle and bed from the second layer on, without waiting, where that differs."""
    nozzle, bed = settings.first_layer_temperatures()
    wanted = ("M104", nozzle, settings.nozzle_temperature), ("M140", bed, settings.bed_temperature)
    return [f"{code} S{later:g}" for code, first, later in wanted if first != later]


def _pressure_advance(settings: PrintSettings) -> list[str]:
    value = settings.pressure_advance
    if isinstance(value, str):
        return []
    words = {
        "marlin": f"M900 K{value:g}",
        "reprapfirmware": f"M572 D0 S{value:g}",
        "klipper": f"SET_PRESSURE_ADVANCE ADVANCE={value:g}",
    }
    return [words[settings.flavour]]


def _thumbnail(png: bytes) -> list[str]:
    if not png.startswith(PNG) or len(png) < 24:
        raise SettingError("thumbnail", "the thumbnail is not a PNG; give the bytes of a PNG")
    width, height = (int.from_bytes(png[at : at + 4], "big") for at in (16, 20))
    text = base64.b64encode(png).decode("ascii")
    rows = [text[at : at + THUMBNAIL_LINE] for at in range(0, len(text), THUMBNAIL_LINE)]
    return [
        f"; thumbnail begin {width}x{height} {len(text)}",
        *(f"; {row}" for row in rows),
        "; thumbnail end",
    ]
