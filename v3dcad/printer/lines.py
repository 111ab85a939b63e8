"""G-code lines as they go over the wire: numbered, with a checksum.

A line `G1 X1` with number 5 is sent as `N5 G1 X1*` and a checksum, which is all bytes before the
`*` combined by exclusive or. Marlin reads it in `Marlin/src/gcode/queue.cpp`
(`get_serial_commands`), RepRapFirmware in `src/GCodes/GCodeBuffer/StringParser.cpp`, Repetier in
`gcode.cpp` (`parseAscii`); Klipper skips both (`klippy/gcode.py`, `_process_commands`).
"""

from __future__ import annotations

import re
from functools import reduce
from operator import xor

NUMBERED = re.compile(r"^N\d+\s*", re.I)
CHECKSUM = re.compile(r"\s*\*\d+\s*$")
UNSAFE = re.compile(r"[^ -\[\]-~]")
LONGEST = 95
"""Characters of a line that every firmware can read whole: Marlin's MAX_CMD_SIZE is 96."""

SLOW = """
    G4 G28 G29 G30 G32 G33 G34 G76 G425
    M0 M1 M25 M48 M109 M116 M190 M191 M226 M303 M400 M600 M701 M702
"""
"""Commands that may take minutes: homing, probing, heating, waiting for a person."""
_SLOW = frozenset(SLOW.split())


def command_of(line: str) -> str:
    """What a line of a file asks for: without comment, number and checksum; "" if nothing."""
    command = line.partition(";")[0].strip()
    if NUMBERED.match(command):
        command = CHECKSUM.sub("", NUMBERED.sub("", command))
    return command


def name_of(command: str) -> str:
    """The command's name, such as G1 of `g01X5`; of a macro, its first word."""
    found = re.match(r"([GMT])0*(\d+(?:\.\d+)?)", command, re.I)
    if found is None:
        return command.partition(" ")[0].upper()
    return found[1].upper() + found[2]


def is_slow(command: str) -> bool:
    """Whether a command may take minutes, or is a macro, which may do anything."""
    name = name_of(command)
    return name in _SLOW or not name[1:2].isdigit()


def checksum(text: bytes) -> int:
    """All bytes combined by exclusive or."""
    return reduce(xor, text, 0)


def numbered(number: int, command: str) -> bytes:
    """A command as the bytes of a numbered line with its checksum.

    Letters outside ASCII, which may stand in a message for the display, become question marks; so
    do control characters and the backslash, which Marlin leaves out before it adds up the checksum.
    """
    text = UNSAFE.sub("?", f"N{number} {command}").encode()
    return b"%b*%d\n" % (text, checksum(text))
