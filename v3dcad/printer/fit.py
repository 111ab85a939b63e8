"""Whether a file fits a machine: bed, height, nozzle, temperatures. No I/O."""

from __future__ import annotations

import math
from dataclasses import dataclass

from v3dcad.settings import PrintSettings

TOLERANCE = 0.01
"""mm that a file may lie outside; what numbers written with two decimals may be off."""

Point = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class Machine:
    """What a printer can do; what is None is not known, and so not checked."""

    bed: tuple[float, float] | None = None
    """width and depth, mm"""
    height: float | None = None
    """mm"""
    centred: bool = False
    """x and y are 0 in the middle of the bed, otherwise at its corner"""
    nozzle: float | None = None
    """diameter, mm"""
    hottest_nozzle: float | None = None
    """°C"""
    hottest_bed: float | None = None

    @classmethod
    def of(cls, settings: PrintSettings) -> Machine:
        """The machine of a profile."""
        return cls(
            bed=settings.bed_size(),
            height=settings.build_height,
            centred=settings.bed_origin == "centre",
        )


@dataclass(frozen=True, slots=True)
class Needs:
    """What a file asks of a printer besides room."""

    nozzle: float | None = None
    """diameter, mm, where a comment of the slicer names it"""
    nozzle_temperature: float = 0.0
    """the highest, °C"""
    bed_temperature: float = 0.0


def misfit(machine: Machine, least: Point | None, greatest: Point | None, needs: Needs) -> str:
    """Why a file does not fit, "" if it does.

    `least` and `greatest` are the corners of all extrusion (mm); None where there is none.
    """
    reasons = _outside(machine, least, greatest) if least and greatest else []
    for what, asked, limit in (
        ("nozzle", needs.nozzle_temperature, machine.hottest_nozzle),
        ("bed", needs.bed_temperature, machine.hottest_bed),
    ):
        if limit is not None and asked > limit:
            reasons.append(f"it heats the {what} to {asked:g} °C, at most {limit:g} are allowed")
    if machine.nozzle and needs.nozzle and not math.isclose(machine.nozzle, needs.nozzle):
        reasons.append(f"it is for a {needs.nozzle:g} mm nozzle, not {machine.nozzle:g}")
    return "; ".join(reasons)


def _outside(machine: Machine, least: Point, greatest: Point) -> list[str]:
    reasons = []
    if machine.bed is not None:
        for axis, size, low, high in zip("xy", machine.bed, least, greatest, strict=False):
            start = -size / 2 if machine.centred else 0.0
            if low < start - TOLERANCE or high > start + size + TOLERANCE:
                reasons.append(
                    f"{axis} runs from {low:g} to {high:g} mm, the bed from {start:g} to "
                    f"{start + size:g}"
                )
    if machine.height is not None and greatest[2] > machine.height + TOLERANCE:
        reasons.append(f"it is {greatest[2]:g} mm high, the printer {machine.height:g}")
    return reasons
