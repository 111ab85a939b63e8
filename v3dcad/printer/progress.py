"""What a print is made of, and how far it is."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from v3dcad.printer.ends import End


class Phase(StrEnum):
    """What a job is doing."""

    PRINTING = "printing"
    PAUSING = "pausing"
    PAUSED = "paused"
    RESUMING = "resuming"
    CANCELLING = "cancelling"
    FINISHING = "finishing"
    ENDED = "ended"


@dataclass(frozen=True, slots=True)
class Line:
    """One command of a file."""

    number: int
    """counted from 1, lines without a command left out"""
    command: str
    offset: int
    """bytes of the file up to the line's end"""


class Recorder(Protocol):
    """What keeps a job's progress; `journal.Journal` does so in a file."""

    def sent(self, line: int, wire: int) -> None:
        """Line `line` of the file is about to go out under number `wire`."""

    def acknowledged(self, line: int, wire: int) -> None:
        """The printer has all lines up to `line` of the file, and up to number `wire`."""

    def parked(self, lift: float, retraction: float) -> None:
        """The nozzle stands so much (mm) above its place, and so much filament is pulled back."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """How far a job is, to be shown."""

    phase: Phase
    end: End | None
    line: int
    """the file's last command acknowledged"""
    offset: int
    """bytes of the file up to it"""
    layer: int
    height: float | None
    """of the layer, mm"""
    minutes_left: float | None
    """as the file's own M73 says, None where it says nothing"""
    temperatures: dict[str, tuple[float, float | None]]
    """heaters, what they have and should have, °C"""
    doing: str
    """what a busy printer says that it does"""
    speed: int
    flow: int
    """overrides, %"""
    resent: int
