"""What a G-code file of any slicer does: bounds, lengths, time, filament, layers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TextIO

import numpy as np

from v3dcad.errors import FormatError
from v3dcad.geometry.print_time import move_seconds
from v3dcad.settings import PrintSettings

WORD = re.compile(r"([A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))\s*")
COMMENT = re.compile(r"\([^()]*\)|;.*|\*\d+\s*$")
LIMIT = re.compile(r"\b(ACCEL|SQUARE_CORNER_VELOCITY)\s*=\s*([\d.]+)", re.I)
MAX_LINE_CHARACTERS = 4096
ARC_STEP = 1.0
"""mm of the straight steps that an arc's motion is planned in."""
MAX_ARC_STEPS = 360
"""Steps of one arc: in a longer one they are longer, so that no line takes long to read."""
INCH = 25.4
MOVES_PER_PLAN = 50_000
"""Moves planned at a time."""


@dataclass(frozen=True, slots=True)
class Summary:
    """What a G-code file does; mm and s."""

    time_s: float
    filament_mm: float
    """the greatest length ever taken from the spool, so that retractions do not count"""
    extruded_mm: float
    travelled_mm: float
    layers: int
    """how often extrusion begins at another height, the first included"""
    moves: int
    least: tuple[float, float, float] | None
    """least coordinates of all extrusion; None where there is none"""
    greatest: tuple[float, float, float] | None


def read_gcode(path: Path, settings: PrintSettings | None = None) -> Summary:
    """Read a G-code file of any size, a line at a time.

    Time follows from the file's feeds and accelerations (M204, SET_VELOCITY_LIMIT), and from
    `settings` where it says none; heating and homing do not count. Raises `FormatError` for
    binary content, a line that is not G-code, or a file without moves.
    """
    reader = _Reader(settings or PrintSettings(), str(path))
    with path.open(encoding="latin-1") as stream:
        for number, line in enumerate(_lines(stream, str(path)), start=1):
            reader.take(line, number)
    return reader.summary()


def _lines(stream: TextIO, path: str) -> Iterator[str]:
    number = 0
    while line := stream.readline(MAX_LINE_CHARACTERS):
        number += 1
        if "\0" in line or (len(line) == MAX_LINE_CHARACTERS and not line.endswith("\n")):
            raise FormatError("this is not G-code; name a text file", path=path, line=number)
        yield line


class _Reader:
    """A simulated printer: takes lines, and keeps its state and what they add up to."""

    def __init__(self, settings: PrintSettings, path: str) -> None:
        self.settings = settings
        self.path = path
        # NaN is a coordinate not yet known: what it takes to get there does not count.
        self.position = [math.nan, math.nan, math.nan]
        self.feed = settings.travel_speed
        self.acceleration = settings.acceleration
        self.travel_acceleration = settings.acceleration_of("travel")
        self.unit = 1.0
        self.absolute = self.absolute_e = True
        self.e = 0.0
        self.spooled = 0.0
        self.filament = 0.0
        self.seconds = 0.0
        self.extruded = 0.0
        self.travelled = 0.0
        self.moves = 0
        self.layers = 0
        self.height = math.nan
        self.least = [math.inf] * 3
        self.greatest = [-math.inf] * 3
        self.pending: list[tuple[float, ...]] = []

    def take(self, line: str, number: int) -> None:
        """Execute one line."""
        code = COMMENT.sub("", line).strip()
        if code[:1].upper() == "N":
            code = re.sub(r"^[Nn]\d+\s*", "", code)
        if not code:
            return
        if code.upper().startswith("SET_VELOCITY_LIMIT"):
            self._limit({name.upper(): float(value) for name, value in LIMIT.findall(code)})
            return
        command = re.match(r"([GM])0*(\d+)(?![\d.])", code.upper())
        if command is None:
            return
        name = command[1] + command[2]
        if name in ("G0", "G1", "G2", "G3", "G92", "G4", "M204"):
            words = self._words(code.upper()[command.end() :], number)
            if name == "G92":
                self._set_position(words)
            elif name == "G4":
                self._flush()
                self.seconds += words.get("S", 0.0) + words.get("P", 0.0) / 1000
            elif name == "M204":
                both = words.get("S", 0.0)
                self._accelerate(words.get("P", both), words.get("T", both))
            else:
                self._move(name, words)
        elif name in ("G20", "G21"):
            self.unit = INCH if name == "G20" else 1.0
        elif name in ("G90", "G91"):
            self.absolute = self.absolute_e = name == "G90"
        elif name in ("M82", "M83"):
            self.absolute_e = name == "M82"
        elif name == "G28":
            homed = [a for a in "XYZ" if a in code.upper()[3:]] or list("XYZ")
            for axis in homed:
                self.position["XYZ".index(axis)] = math.nan

    def summary(self) -> Summary:
        """The summary of all lines; `FormatError` if nothing moved."""
        self._flush()
        if not self.moves:
            raise FormatError("no moves (G0 to G3) in it; name a G-code file", path=self.path)
        printed = self.layers > 0
        x, y, z = self.least
        right, back, top = self.greatest
        return Summary(
            time_s=self.seconds,
            filament_mm=self.filament,
            extruded_mm=self.extruded,
            travelled_mm=self.travelled,
            layers=self.layers,
            moves=self.moves,
            least=(x, y, z) if printed else None,
            greatest=(right, back, top) if printed else None,
        )

    def _words(self, text: str, number: int) -> dict[str, float]:
        words: dict[str, float] = {}
        at = 0
        text = text.strip()
        while at < len(text):
            match = WORD.match(text, at)
            if match is None:
                raise FormatError(
                    f"{text[at : at + 20]!r} is not a word of G-code, such as X12.5",
                    path=self.path,
                    line=number,
                )
            words[match[1]] = float(match[2])
            at = match.end()
        if not all(map(math.isfinite, words.values())):
            raise FormatError("a number is too large", path=self.path, line=number)
        return words

    def _set_position(self, words: dict[str, float]) -> None:
        self.e = words.get("E", 0.0 if not words else self.e / self.unit) * self.unit
        for k, axis in enumerate("XYZ"):
            if axis in words:
                self.position[k] = words[axis] * self.unit

    def _accelerate(self, printing: float, travelling: float) -> None:
        """Take accelerations, mm/s²; one that makes no sense changes nothing."""
        if 0 < printing <= 1_000_000:
            self.acceleration = printing
        if 0 < travelling <= 1_000_000:
            self.travel_acceleration = travelling

    def _limit(self, limits: dict[str, float]) -> None:
        both = limits.get("ACCEL", 0.0)
        self._accelerate(both, both)
        if 0 <= limits.get("SQUARE_CORNER_VELOCITY", -1.0) <= 2000:
            self._flush()
            self.settings = replace(self.settings, corner_speed=limits["SQUARE_CORNER_VELOCITY"])

    def _move(self, name: str, words: dict[str, float]) -> None:
        self.moves += 1
        self.feed = words["F"] * self.unit / 60 if words.get("F", 0.0) > 0 else self.feed
        start = list(self.position)
        for k, axis in enumerate("XYZ"):
            if axis in words:
                asked = words[axis] * self.unit
                self.position[k] = asked if self.absolute else self.position[k] + asked
        fed = 0.0
        if "E" in words:
            asked = words["E"] * self.unit
            fed = asked - self.e if self.absolute_e else asked
            self.e += fed
            self.spooled += fed
            self.filament = max(self.filament, self.spooled)
        points = [start, self.position]
        if name in ("G2", "G3") and not any(map(math.isnan, start)):
            points = _arc(start, self.position, words, self.unit, clockwise=name == "G2")
        for here, there in pairwise(points):
            self._step(here, there, fed)

    def _step(self, here: list[float], there: list[float], fed: float) -> None:
        x, y, z = (0.0 if math.isnan(b - a) else b - a for a, b in zip(here, there, strict=True))
        length = math.sqrt(x * x + y * y + z * z)
        still = 0.0 if length else abs(fed)
        acceleration = self.acceleration if fed > 0 and length > 0 else self.travel_acceleration
        self.pending.append((x, y, z, length, still, self.feed, acceleration))
        if len(self.pending) >= MOVES_PER_PLAN:
            self._flush()
        if fed > 0 and length > 0:
            self.extruded += length
            self.layers += there[2] != self.height
            self.height = there[2]
            for point in (here, there):
                # Comparing with NaN is false, so a coordinate not yet known is left out.
                self.least = list(map(min, self.least, point))
                self.greatest = list(map(max, self.greatest, point))
        else:
            self.travelled += length

    def _flush(self) -> None:
        if self.pending:
            moves = np.array(self.pending)
            steps, (length, still, speed, acceleration) = moves[:, :3], moves[:, 3:].T
            corner = self.settings.corner_speed
            self.seconds += float(
                move_seconds(steps, length, still, speed, acceleration, corner).sum()
            )
            self.pending = []


def _arc(
    start: list[float], stop: list[float], words: dict[str, float], unit: float, *, clockwise: bool
) -> list[list[float]]:
    """Points along a G2 or G3, start and stop included."""
    dx, dy = stop[0] - start[0], stop[1] - start[1]
    if "R" in words:
        radius = words["R"] * unit
        chord = math.hypot(dx, dy)
        if chord == 0:
            return [start, stop]
        off = math.sqrt(max(radius**2 - chord**2 / 4, 0)) / chord
        # The centre of an arc below half a turn lies on the side that it turns to.
        side = -off if clockwise == (radius > 0) else off
        i, j = dx / 2 - side * dy, dy / 2 + side * dx
    else:
        i, j = words.get("I", 0.0) * unit, words.get("J", 0.0) * unit
    radius = math.hypot(i, j)
    first = math.atan2(-j, -i)
    turned = (math.atan2(dy - j, dx - i) - first) % (2 * math.pi)
    # An arc that ends where it starts is a whole circle.
    sweep = turned - 2 * math.pi if clockwise else turned or 2 * math.pi
    count = min(max(1, math.ceil(abs(sweep) * radius / ARC_STEP)), MAX_ARC_STEPS)
    points = [start]
    for number in range(1, count):
        turn = first + sweep * number / count
        rise = start[2] + (stop[2] - start[2]) * number / count
        points.append(
            [start[0] + i + radius * math.cos(turn), start[1] + j + radius * math.sin(turn), rise]
        )
    return [*points, stop]
