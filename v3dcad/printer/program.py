"""The file that is printed: checked before the first byte goes out, then read a line at a time.

However long the file is, one block of it is in memory. Whoever changes it after it was checked is
found out: its size and time are looked at with every line, its content is compared at the end.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from v3dcad.errors import FormatError
from v3dcad.printer.ends import End, PrintError
from v3dcad.printer.fit import Needs
from v3dcad.printer.lines import LONGEST, command_of, name_of
from v3dcad.printer.machine_state import temperature
from v3dcad.printer.progress import Line

MOST_LINE = 4096
NOZZLE = re.compile(rb";\s*nozzle_diameter\s*=\s*(\d+(?:\.\d+)?)")
"""How slicers of the PrusaSlicer family name the nozzle."""
HEATS = {"M104": "T", "M109": "T", "M140": "B", "M190": "B"}
"""Commands that heat nozzle or bed. What macros do is not known."""
NOT_TO_PRINT = {
    "M28": "writes to the printer's card",
    "M29": "writes to the printer's card",
    "M110": "renumbers lines",
    "M112": "stops the printer",
    "M997": "updates the firmware",
    "M999": "restarts the printer",
}


@dataclass(frozen=True, slots=True)
class Program:
    """A file that has been looked through."""

    path: Path
    sha256: str
    size: int
    """bytes"""
    commands: int
    longest: int
    """characters of the longest command"""
    longest_at: int
    """its line in the file"""
    needs: Needs
    stamp: tuple[int, ...]
    """which file it was, its size and when it was last changed"""

    def check_length(self) -> None:
        """Raise `FormatError` if a command is longer than a small board's buffer for lines.

        The number and checksum that go with it are counted in.
        """
        around = len(f"N{self.commands} *255")
        if self.longest + around > LONGEST:
            raise FormatError(
                f"a command of {self.longest} characters; this printer takes {LONGEST - around}: "
                "shorten it",
                path=str(self.path),
                line=self.longest_at,
            )

    def lines(self) -> Iterator[Line]:
        """All commands in order.

        Raises `PrintError` (file changed) as soon as that shows.
        """
        digest = hashlib.sha256()
        number = offset = 0
        try:
            with self.path.open("rb") as stream:
                for raw in stream:
                    if _stamp(stream) != self.stamp:
                        raise self._changed(number)
                    digest.update(raw)
                    offset += len(raw)
                    command = command_of(raw.decode("latin-1"))
                    if command:
                        number += 1
                        yield Line(number, command, offset)
        except OSError as error:
            message = f"{self.path} cannot be read any more ({error.strerror}), at {number}"
            raise PrintError(End.FILE, message) from error
        if digest.hexdigest() != self.sha256:
            raise self._changed(number)

    def _changed(self, number: int) -> PrintError:
        message = f"{self.path} was changed after it was checked; it stopped at command {number}"
        return PrintError(End.FILE, message)


def read_program(path: Path) -> Program:
    """Look through a file once.

    Raises `FormatError` for one that cannot be read, is no text, has nothing to print, or has a
    command that belongs in no print.
    """
    digest = hashlib.sha256()
    size = commands = longest = longest_at = 0
    hottest = {"T": 0.0, "B": 0.0}
    nozzle: float | None = None
    try:
        with path.open("rb") as stream:
            stamp = _stamp(stream)
            number = 0
            while raw := stream.readline(MOST_LINE):
                number += 1
                if b"\0" in raw or (len(raw) == MOST_LINE and not raw.endswith(b"\n")):
                    message = "this is no G-code; name a text file"
                    raise FormatError(message, path=str(path), line=number)
                digest.update(raw)
                size += len(raw)
                command = command_of(raw.decode("latin-1"))
                if not command:
                    if named := NOZZLE.match(raw):
                        nozzle = float(named[1])
                    continue
                if "\r" in command:
                    message = "lines end with CR alone; save the file with LF"
                    raise FormatError(message, path=str(path), line=number)
                commands += 1
                if len(command) > longest:
                    longest, longest_at = len(command), number
                if command[0] not in "Mm":
                    continue
                name = name_of(command)
                if heater := HEATS.get(name):
                    hottest[heater] = max(hottest[heater], temperature(command) or 0.0)
                if why := NOT_TO_PRINT.get(name):
                    message = f"{command} {why}; take it out"
                    raise FormatError(message, path=str(path), line=number)
    except OSError as error:
        raise FormatError(f"cannot be read ({error.strerror})", path=str(path)) from error
    if not commands:
        raise FormatError("no commands in it; name a G-code file", path=str(path))
    needs = Needs(nozzle, hottest["T"], hottest["B"])
    return Program(path, digest.hexdigest(), size, commands, longest, longest_at, needs, stamp)


def _stamp(stream: BinaryIO) -> tuple[int, ...]:
    found = os.fstat(stream.fileno())
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns
