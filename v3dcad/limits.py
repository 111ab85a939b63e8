"""What nozzle, hot end, machine and cells allow: settings that do not fit are refused."""

from __future__ import annotations

import math

from v3dcad.errors import SettingError
from v3dcad.model import BRIDGE, CELLS, Floats
from v3dcad.settings import Field, FillSettings, PrintSettings, option
from v3dcad.toolpath.bead import bead_areas

NARROWEST, WIDEST = 0.6, 2.5
"""Times the nozzle's diameter: beads that it can lay."""
BEADS_ACROSS = 2.0
"""Bead widths: smaller cells have no room for a bead along either side."""
SPEEDS = ("print_speed", "perimeter_speed", "solid_speed", "bridge_speed", "first_layer_speed")


def check_limits(filling: FillSettings, printing: PrintSettings) -> None:
    """Raise `SettingError` where a structure cannot be printed so, and say what can be.

    Beads must fit the nozzle, layers the beads, speeds the machine, and what is laid at these
    speeds the hot end.
    """
    width, nozzle = printing.bead_width, printing.nozzle_diameter
    if not NARROWEST * nozzle <= width <= WIDEST * nozzle:
        raise SettingError(
            "bead_width",
            f"--bead-width {width:g}: a nozzle of {nozzle:g} mm lays beads of "
            f"{NARROWEST * nozzle:g} to {WIDEST * nozzle:g} mm; give one of these, or the "
            "--nozzle-diameter",
        )
    heights = {
        "layer_height": filling.layer_height,
        "first_layer_height": printing.first_layer_height,
    }
    for name, height in heights.items():
        if height > min(width, nozzle):
            raise SettingError(
                name,
                f"{option(name)} {height:g}: layers do not bond that are higher than the nozzle "
                f"({nozzle:g} mm) or the bead ({width:g} mm) is wide; give at most "
                f"{min(width, nozzle):g}",
            )
    _check_speeds(heights, printing)


def check_cells(largest: float | str | Field, bounds: Floats, printing: PrintSettings) -> None:
    """Raise `SettingError` where even the largest cells of a part, mm, are smaller than two beads.

    A part with `bounds` (2, 3), mm, that is itself smaller takes cells as wide as it is. Of a field
    and of "auto" nothing is known yet.
    """
    if not isinstance(largest, float | int):
        return
    across = float((bounds[1] - bounds[0])[:2].max())
    least = min(BEADS_ACROSS * printing.bead_width, across)
    if largest < least:
        raise SettingError(
            "cell_size",
            f"--cell-size {largest:g}: cells smaller than two beads of {printing.bead_width:g} mm "
            f"cannot be printed; give at least {least:.4g}, or a smaller --bead-width",
        )


def _check_speeds(heights: dict[str, float], printing: PrintSettings) -> None:
    for name in (*SPEEDS, "travel_speed"):
        if getattr(printing, name) > printing.most_speed:
            raise SettingError(
                name,
                f"{option(name)} {getattr(printing, name):g}: more than the "
                f"{printing.most_speed:g} mm/s of the machine; give less, or the --most-speed "
                "that it has",
            )
    for name in SPEEDS:
        first = name == "first_layer_speed"
        height = heights["first_layer_height" if first else "layer_height"]
        feature = BRIDGE if name == "bridge_speed" else CELLS
        area = float(bead_areas(printing, height, first=first)[feature])
        speed = getattr(printing, name)
        if speed * area > printing.most_flow * (1 + 1e-9):
            raise SettingError(
                name,
                f"{option(name)} {speed:g}: beads of {printing.bead_width:g} × {height:g} mm take "
                f"{speed * area:.1f} mm³/s, and the hot end melts {printing.most_flow:g}; give at "
                f"most {math.floor(printing.most_flow / area)} mm/s, or the --most-flow that it "
                "has",
            )
