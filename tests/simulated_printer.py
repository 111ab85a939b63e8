"""A printer that obeys G-code, written without v3dcad: arcs, both E modes, both retractions."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np


@dataclass
class Move:
    start: tuple[float, float, float]
    stop: tuple[float, float, float]
    extruded: float
    length: float
    layer: int
    kind: str
    feed: float
    arc: bool = False

    @property
    def prints(self) -> bool:
        return self.extruded > 0 and self.length > 0


@dataclass
class Printer:
    flavour: str = "marlin"
    position: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    e: float = 0.0
    absolute: bool = True
    absolute_e: bool = True
    retracted: float = 0.0
    firmware_retracted: bool = False
    layer: int = -1
    kind: str = ""
    feed: float = 0.0
    moves: list[Move] = field(default_factory=list)
    commands: list[str] = field(default_factory=list)

    def run(self, text: str) -> Printer:
        for line in text.split("\n"):
            code, _, remark = line.partition(";")
            if remark.startswith("LAYER:"):
                self.layer = int(remark[6:])
            if remark.startswith("TYPE:"):
                self.kind = remark[5:]
            if code.split():
                self.obey(code.split())
        return self

    def obey(self, words: list[str]) -> None:
        name = words[0]
        self.commands.append(" ".join(words))
        if name in ("G0", "G1", "G2", "G3"):
            self.move(name, {word[0]: float(word[1:]) for word in words[1:]})
        elif name == "G92":
            assert words[1].startswith("E")
            self.e = float(words[1][1:])
        elif name in ("G90", "G91"):
            self.absolute = self.absolute_e = name == "G90"
        elif name in ("M82", "M83"):
            self.absolute_e = name == "M82"
        elif name == "G10":
            assert not self.firmware_retracted
            self.firmware_retracted = True
        elif name == "G11":
            assert self.firmware_retracted
            self.firmware_retracted = False

    def move(self, name: str, values: dict[str, float]) -> None:
        start = tuple(self.position)
        for axis, letter in enumerate("XYZ"):
            if letter in values:
                self.position[axis] = values[letter] + (0 if self.absolute else self.position[axis])
        fed = 0.0
        if "E" in values:
            fed = values["E"] - (self.e if self.absolute_e else 0.0)
            self.e += fed
        self.feed = values.get("F", self.feed)
        assert self.feed > 0
        stop = tuple(self.position)
        length = math.dist(start, stop)
        arc = name in ("G2", "G3")
        if arc:
            length = self.arc_length(start, stop, values, clockwise=name == "G2")
        if length == 0:
            self.retracted -= fed
        elif fed > 0:
            assert abs(self.retracted) < 1e-9, "extrudes while retracted"
            assert not self.firmware_retracted, "extrudes while retracted"
        self.moves.append(Move(start, stop, fed, length, self.layer, self.kind, self.feed, arc))

    @staticmethod
    def arc_length(start: tuple, stop: tuple, values: dict[str, float], clockwise: bool) -> float:
        centre = (start[0] + values["I"], start[1] + values["J"])
        one, other = (math.dist(centre, end[:2]) for end in (start, stop))
        assert abs(one - other) < 0.003, "an arc's ends are not on one circle"
        first, last = (math.atan2(end[1] - centre[1], end[0] - centre[0]) for end in (start, stop))
        swept = (first - last if clockwise else last - first) % (2 * math.pi)
        assert swept < 1.01 * math.pi
        return swept * one

    def printing(self, kind: str | None = None) -> list[Move]:
        return [m for m in self.moves if m.prints and m.layer >= 0 and kind in (None, m.kind)]

    def ends(self, kind: str | None = None) -> np.ndarray:
        """(k, 2, 2) flat ends of the moves that print."""
        rows = [(m.start[:2], m.stop[:2]) for m in self.printing(kind)]
        return np.array(rows).reshape(-1, 2, 2)
