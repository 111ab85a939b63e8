"""What state a printer is in after the lines it was given: where it stands, modes, heat. No I/O.

Needed to park and come back when a print is paused, and to put a printer that was reset into the
state that a line of the file takes for granted.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

from v3dcad.printer.lines import name_of

WORD = re.compile(r"([A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))")
MOVES = frozenset(("G0", "G1", "G2", "G3", "G5"))
KEPT = """
    M92 M200 M201 M203 M204 M205 M207 M208 M209 M220 M221 M301 M302 M304 M566 M572 M900
    SET_PRESSURE_ADVANCE SET_VELOCITY_LIMIT
"""
"""Commands that set something which a reset loses; the last of each is given again."""
_KEPT = frozenset(KEPT.split())
LIFT = 2.0
"""mm that the nozzle is raised by before X and Y are homed over a part."""
TRAVEL, RISE = 3000.0, 600.0
"""mm/min of moves to and from a place beside the part."""
INCH = 25.4
FIRST = "T0"
"""The tool in use until a file takes another."""


@dataclass(slots=True)
class MachineState:
    """A printer as the lines so far leave it; `follow` takes the next. Lengths in mm."""

    place: dict[str, float] = field(default_factory=dict)
    """X, Y and Z where they are known"""
    e: float = 0.0
    """the filament's coordinate, which G92 may rename"""
    held: float = 0.0
    """mm of filament that is pulled back"""
    feed: float = 0.0
    """mm/min; 0 while none was given"""
    absolute: bool = True
    absolute_e: bool = True
    inches: bool = False
    nozzles: dict[str, float] = field(default_factory=dict)
    """°C of each nozzle, by its tool; the one set last is the last"""
    bed: float | None = None
    chamber: float | None = None
    fan: float = 0.0
    """0 to 255"""
    tool: str = ""
    kept: dict[str, str] = field(default_factory=dict)
    """the last line of each command in `KEPT`"""
    layer: int = 0
    """how often extrusion went on at another height"""
    height: float | None = None
    """of the layer, mm"""

    def copy(self) -> MachineState:
        """The same state, to be kept."""
        return replace(
            self, place=dict(self.place), nozzles=dict(self.nozzles), kept=dict(self.kept)
        )

    @property
    def nozzle(self) -> float | None:
        """What the nozzle in use should have, °C. Tools may share one that was set for another."""
        return self.nozzles.get(self.tool or FIRST, next(reversed(self.nozzles.values()), None))

    def follow(self, command: str) -> None:
        """Take one command. What is not understood changes nothing."""
        name = name_of(command)
        if name in MOVES:
            self._move(_words(command))
        elif name == "G92":
            words = _words(command)
            self.e = self._mm(words["E"]) if "E" in words else self.e
            self.place |= {axis: self._mm(words[axis]) for axis in "XYZ" if axis in words}
        elif name in ("G20", "G21"):
            self.inches = name == "G20"
        elif name in ("G90", "G91"):
            self.absolute = self.absolute_e = name == "G90"
        elif name in ("M82", "M83"):
            self.absolute_e = name == "M82"
        elif name == "G28":
            self._home(command)
        elif name in ("M104", "M109"):
            number = _words(command).get("T")
            tool = (self.tool or FIRST) if number is None else f"T{number:g}"
            wanted = temperature(command, self.nozzles.pop(tool, None))
            self.nozzles |= {} if wanted is None else {tool: wanted}
        elif name in ("M140", "M190"):
            self.bed = temperature(command, self.bed)
        elif name in ("M141", "M191"):
            self.chamber = temperature(command, self.chamber)
        elif name in ("M106", "M107"):
            self.fan = _words(command).get("S", 255.0) if name == "M106" else 0.0
        elif name.startswith("T") and name[1:].isdigit():
            self.tool = name
        elif name in _KEPT:
            self.kept[name] = command

    def park(self, place: tuple[float, float] | None, lift: float, retraction: float) -> list[str]:
        """Lines that pull the filament back, raise the nozzle and move it aside.

        `place` is X and Y of the bed (mm), None to stay over the part. A printer whose position is
        not known yet, since it was not homed, stays where it is.
        """
        if "Z" not in self.place:
            return []
        lines = ["G21", *self._feed(-retraction), "G91", f"G1 Z{lift:g} F{RISE:g}", "G90"]
        if place is not None and {"X", "Y"} <= self.place.keys():
            lines += [f"G1 X{place[0]:g} Y{place[1]:g} F{TRAVEL:g}"]
        return lines

    def come_back(self, retraction: float) -> list[str]:
        """Lines that undo `park`: heat, back to the place, then modes, coordinate and feed.

        `retraction` is how much filament is pulled back. A nozzle that is at its place stays there.
        """
        if "Z" not in self.place:
            return self.heat()
        return [
            *self.heat(),
            "G21",
            "G90",
            *self._go(),
            *self._feed(retraction),
            *self._modes(),
        ]

    def heat(self) -> list[str]:
        """Lines that heat all to what they should have, and wait."""
        heaters = [("M140", "M190", "", self.bed), ("M141", "M191", "", self.chamber)]
        # The one in use comes last: RepRapFirmware takes the tool that it waits for.
        heaters += [
            ("M104", "M109", self._named(tool), self.nozzles[tool])
            for tool in sorted(self.nozzles, key=(self.tool or FIRST).__eq__)
        ]
        heaters = [heater for heater in heaters if heater[3]]
        return [
            *(f"{begin}{tool} S{wanted:g}" for begin, _, tool, wanted in heaters),
            *(f"{wait}{tool} S{wanted:g}" for _, wait, tool, wanted in heaters),
        ]

    def cool(self) -> list[str]:
        """Lines that turn off the heaters that the file has turned on."""
        hot = [tool for tool, wanted in self.nozzles.items() if wanted]
        lines = [f"M104{self._named(tool)} S0" for tool in hot]
        lines += ["M140 S0"] if self.bed else []
        return [*lines, "M141 S0"] if self.chamber else lines

    def _named(self, tool: str) -> str:
        """A tool as it is named in a command; a file without tools needs no names."""
        return f" {tool}" if self.tool or tool != FIRST else ""

    def after_reset(self, height: float, retraction: float) -> list[str]:
        """Lines that put a printer which was reset into this state, over a part on the bed.

        `height` (mm) is where the nozzle stands. Z is never homed: it would run into the part. So
        the printer is told its height, and X and Y are homed a little above. `retraction` (mm) is
        how much filament is pulled back; on the way it is as much as in this state. The nozzle
        comes down with the file's next line, which names its height: this state's is that of the
        layer below, above which part of the layer stands by now. Relative moves count from there.
        """
        return [
            *self.heat(),
            *self.kept.values(),
            *([self.tool] if self.tool else []),
            "G21",
            *self._feed(round(retraction - self.held, 5)),
            f"G92 Z{height:g}",
            "G91",
            f"G1 Z{LIFT:g} F{RISE:g}",
            "G90",
            "G28 X Y",
            *(self._over() if self.absolute else self._go()),
            f"M106 S{self.fan:g}" if self.fan else "M107",
            *self._modes(),
        ]

    def _feed(self, length: float) -> list[str]:
        """Filament moved, unless the nozzle may be cold: Klipper takes that for an error."""
        return ["M83", f"G1 E{length:g} F1800"] if self.nozzle and length else []

    def _over(self) -> list[str]:
        flat = [f"{axis}{self.place[axis]:.10g}" for axis in "XY" if axis in self.place]
        return [f"G1 {' '.join(flat)} F{TRAVEL:g}"] if flat else []

    def _go(self) -> list[str]:
        down = [f"G1 Z{self.place['Z']:.10g} F{RISE:g}"] if "Z" in self.place else []
        return [*self._over(), *down]

    def _modes(self) -> list[str]:
        """G90 and G91 also set the mode of E in Marlin, so M82 and M83 come after them."""
        lines = [f"G92 E{self.e:.10g}"]
        if self.feed:
            lines += [f"G1 F{self.feed:.10g}"]
        lines += ["G20"] if self.inches else []
        lines += ["G90" if self.absolute else "G91"]
        return [*lines, "M82" if self.absolute_e else "M83"]

    def _mm(self, value: float) -> float:
        return value * INCH if self.inches else value

    def _home(self, command: str) -> None:
        """Where a switch or probe stands is the printer's secret: the place is unknown."""
        named = [axis for axis in "XYZ" if axis in command.upper()[3:]] or list("XYZ")
        for axis in named:
            self.place.pop(axis, None)

    def _move(self, words: dict[str, float]) -> None:
        self.feed = self._mm(words["F"]) if words.get("F", 0.0) > 0 else self.feed
        moves = False
        for axis in "XYZ":
            if axis in words:
                asked = self._mm(words[axis])
                moves = moves or axis != "Z"
                if self.absolute:
                    self.place[axis] = asked
                elif axis in self.place:
                    self.place[axis] += asked
        if "E" in words:
            asked = self._mm(words["E"])
            fed = asked - self.e if self.absolute_e else asked
            self.e += fed
            self.held = max(self.held - fed, 0.0)
            height = self.place.get("Z")
            if fed > 0 and moves and height != self.height:
                self.layer += 1
                self.height = height


def _words(command: str) -> dict[str, float]:
    return {letter: float(value) for letter, value in WORD.findall(command.upper())}


def temperature(command: str, before: float | None = None) -> float | None:
    """°C that a command asks for; `before` if it names none."""
    words = _words(command)
    return words.get("S", words.get("R", before))
