"""What a printer says, line by line, as values. No I/O.

Replies differ little between firmwares. The forms read here, and where they are written:

- `ok`, and Marlin's advanced `ok N5 P15 B3`: the number of the line, free places for moves, free
  places for lines (`RingBuffer::ok_to_send` in Marlin's `gcode/queue.cpp`); `ok T:20.1 /0.0` as
  the answer to M105 (Marlin's `gcode/temp/M105.cpp`, `cmd_M105` in Klipper's `extras/heaters.py`)
- `Resend: 5` (Marlin, Repetier), `rs 5` (the older form, named in RepRap's G-code documentation)
- `skip 5`, Repetier's answer to a line that it has already, or that is not the one which it asked
  for again (`gcode.cpp`, `checkAndPushCommand`)
- `echo:busy: processing` (Marlin's `host_keepalive`), `busy:processing` (Repetier's `keepAlive`)
- `wait`, from a printer that has nothing to do (Repetier's WAITING_IDENTIFIER, Marlin's
  NO_TIMEOUTS)
- `start`, said after a reset; `Error:` and what is wrong; `!!` and why Klipper stopped;
  `fatal:` and why Repetier obeys no line any more (`reportFatalError`), though it says `ok` to all
- `//action:pause` and the like (Marlin's HOST_ACTION_COMMANDS)
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

LONGEST = 4096
"""Bytes of a reply that are kept; a longer one is not a printer's."""


@dataclass(frozen=True, slots=True)
class Ok:
    """A line is done, or in the printer's buffer; `number` and `room` where the printer says."""

    number: int | None = None
    room: int | None = None
    """free places for lines in the printer's buffer"""
    temperatures: dict[str, tuple[float, float | None]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Resend:
    """The printer has every line before this number, and now expects this one."""

    number: int


@dataclass(frozen=True, slots=True)
class Skipped:
    """The printer did not obey this line: it has it already, or wants another one."""

    number: int


@dataclass(frozen=True, slots=True)
class Busy:
    """The printer is at work on a line and lives."""

    doing: str


@dataclass(frozen=True, slots=True)
class Waiting:
    """The printer has nothing to do."""


@dataclass(frozen=True, slots=True)
class Started:
    """The printer has just been reset."""


@dataclass(frozen=True, slots=True)
class Failure:
    """The printer reports an error; `fatal` if it prints no more."""

    text: str
    fatal: bool
    about_line: bool = False
    """only that a line did not arrive as it was sent; a `Resend` follows"""


@dataclass(frozen=True, slots=True)
class Action:
    """The printer asks the host for something: pause, resume, cancel."""

    name: str
    text: str = ""
    """what is to be shown to a person"""


@dataclass(frozen=True, slots=True)
class Temperatures:
    """Heaters, by the printer's names: what they have and what they should have, °C."""

    heaters: dict[str, tuple[float, float | None]]


@dataclass(frozen=True, slots=True)
class Text:
    """Anything else in letters."""

    text: str


@dataclass(frozen=True, slots=True)
class Garbage:
    """Bytes that are no text: noise, or the wrong baud rate."""


Reply = (
    Ok
    | Resend
    | Skipped
    | Busy
    | Waiting
    | Started
    | Failure
    | Action
    | Temperatures
    | Text
    | Garbage
)

HEATER = re.compile(
    r"\b([TBC]\d*)\s*:\s*(-?\d{1,5}(?!\d)(?:\.\d+)?)(?:\s*/\s*(-?\d{1,5}(?:\.\d+)?))?"
)
GLUED = re.compile(
    r"(?<=[\dk])(?=ok(?:$|[ \dok])|Resend:|rs \d|Error:|echo:|busy:|//|!!|wait$|start$)"
)
"""Where a reply begins in the middle of a line, because a newline was lost before it."""

ABOUT_LINES = ("checksum", "line number", "last line", "format error", "expected line")
"""Words of errors about how a line arrived. A request to send it again follows by itself."""
HARMLESS = ("unknown command", "cold extrusion", "sd", "volume.init", "openroot", "workdir", "file")
"""Beginnings of errors after which a printer goes on (`language.h` of Marlin)."""


def parse(line: str) -> list[Reply]:
    """The replies in one line; more than one where a newline between them was lost."""
    if not line.startswith(("ok", "Resend:", "rs ")):
        return [_parsed(line)]
    return [_parsed(part) for part in GLUED.split(line)]


def _parsed(line: str) -> Reply:
    text = line.strip()
    lower = text.lower()
    if any(not (" " <= letter <= "~" or letter in "\t°") for letter in text):
        return Garbage()
    if re.match(r"ok\b", text):
        return _ok(text)
    found = re.match(r"(?:resend|rs\b)\s*:?\s*N?(\d+)", text, re.I)
    if found:
        return Resend(int(found[1]))
    found = re.match(r"skip\s*:?\s*(\d+)", text)
    if found:
        return Skipped(int(found[1]))
    found = re.match(r"(?:echo:\s*)?busy:\s*(.*)", text)
    if found:
        return Busy(found[1])
    if lower == "wait":
        return Waiting()
    if lower == "start":
        return Started()
    if lower.startswith("error:"):
        return _failure(text[6:].strip())
    if lower.startswith("fatal:"):
        return Failure(text[6:].strip(), fatal=True)
    if text.startswith("!!"):
        return Failure(text[2:].strip(), fatal=True)
    found = re.match(r"//\s*action:\s*(\w+)\s*(.*)", text)
    if found:
        return Action(found[1], found[2])
    heaters = _heaters(text)
    return Temperatures(heaters) if heaters and re.match(r"\s*[TBC]\d*\s*:", text) else Text(text)


def _ok(text: str) -> Ok:
    number = re.search(r"\bN(\d+)", text)
    room = re.search(r"\bB(\d+)(?!\S)", text)
    return Ok(
        number=int(number[1]) if number else None,
        room=int(room[1]) if room else None,
        temperatures=_heaters(text),
    )


def _heaters(text: str) -> dict[str, tuple[float, float | None]]:
    return {
        name: (float(has), float(wants) if wants else None)
        for name, has, wants in HEATER.findall(text)
    }


def _failure(text: str) -> Failure:
    lower = text.lower()
    about_line = any(word in lower for word in ABOUT_LINES)
    return Failure(text, not about_line and not lower.startswith(HARMLESS), about_line)


class LineSplitter:
    """Bytes in, lines out. A line ends with LF, CR or both; never more than `LONGEST` is kept."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> list[str]:
        """The lines that these bytes complete."""
        *lines, rest = re.split(rb"[\r\n]+", self._rest + data)
        self._rest = rest if len(rest) <= LONGEST else b"\xff"
        return [line.decode("latin-1") for line in lines if line]

    def flush(self) -> list[str]:
        """What has come of a line whose end seems lost."""
        rest, self._rest = self._rest, b""
        return [rest.decode("latin-1")] if rest else []
