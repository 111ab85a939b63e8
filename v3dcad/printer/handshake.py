"""The first words with a printer: is one there, which firmware, does it check numbers? No I/O.

1. `M115`, without a number, until the printer says `ok`. A board that was reset by the opening of
   its port first runs its boot loader for some seconds and hears nothing.
2. `M110 N0`: counting starts anew. Left out when a print is to go on.
3. A *probe*: M105 under a number that cannot be right. A printer that checks numbers asks for the
   line that it wants, which also tells how far an earlier print came; one that does not answers.

M115 and its capabilities: Marlin's `gcode/host/M115.cpp`; Klipper's `cmd_M115` in
`klippy/gcode.py`; `FIRMWARE_NAME` in RepRapFirmware's and Repetier's answers alike. M110 and the
probe: see `sender`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from v3dcad.errors import LocalPrinterError
from v3dcad.printer.ends import End, PrintError
from v3dcad.printer.lines import numbered
from v3dcad.printer.replies import (
    Failure,
    Garbage,
    LineSplitter,
    Ok,
    Reply,
    Resend,
    Started,
    parse,
)

PROBE = 1_000_000_000
"""The probe's number: beyond any print's last line, and still 31 bits. Repetier looks at the last
16 bits, which must not be up to 40 below a line that it may have."""
PROBES = (PROBE, PROBE + 1000)
"""So that one of them is no such number, whatever that line is."""
QUIET = 0.2
"""Seconds without a word after which all answers are taken to be here."""
RESETS = 3
"""How often a board may say `start`; more is no boot but a fault."""


@dataclass(frozen=True, slots=True)
class Greeting:
    """What a printer told of itself."""

    firmware: str
    """as it names itself, such as `Marlin 2.1.2`; "" where it does not say"""
    capabilities: dict[str, bool] = field(default_factory=dict)
    checks_numbers: bool = False
    last: int = 0
    """number of the last line that it has"""
    was_reset: bool = False
    """it said `start` meanwhile"""

    def can(self, capability: str) -> bool:
        """Whether the printer has a capability, such as EMERGENCY_PARSER; what is not named, no."""
        return self.capabilities.get(capability, False)


class Handshake:
    """Asks, and listens, until `greeting` is there.

    `again` is how long an answer to M115 is waited for before it is asked again, `tries` how often;
    the last wait raises `PrintError` (no answer).
    """

    def __init__(
        self, now: float, *, fresh: bool = True, again: float = 2.5, tries: int = 6
    ) -> None:
        self.greeting: Greeting | None = None
        self.garbage = self.words = 0
        self._fresh = fresh
        self._again = again
        self._tries = tries
        self._asked = 0
        self._step = "hello"
        self._ok = False
        self._firmware = ""
        self._capabilities: dict[str, bool] = {}
        self._resets = 0
        self._answered_by: float | None = None
        self._last: int | None = None
        self._splitter = LineSplitter()
        self._outgoing = bytearray()
        self._ask(now)

    def data_to_send(self) -> bytes:
        """The bytes that are due to go out, once."""
        data = bytes(self._outgoing)
        self._outgoing.clear()
        return data

    def wake_at(self) -> float:
        """When `due` wants to be called, if nothing is received before."""
        return self._wake

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the printer.

        Raises `PrintError` when it reports a fatal error, `LocalPrinterError` for a Grbl board.
        """
        for line in self._splitter.feed(data):
            self._told(line)
            for reply in parse(line):
                self._one(reply, now)

    def due(self, now: float) -> None:
        """Go on when all answers of a step are here; ask again, or give up, when none came."""
        if now < self._wake:
            return
        if self._ok and self._step == "probe":
            self.greeting = Greeting(
                self._firmware,
                dict(self._capabilities),
                checks_numbers=self._last is not None,
                last=self._last or 0,
                was_reset=self._resets > 0,
            )
        elif self._ok:
            self._step = "count" if self._step == "hello" and self._fresh else "probe"
            self._ok = False
            self._asked = 0
            self._ask(now)
        elif self._asked < self._tries:
            self._ask(now)
        elif self.garbage > self.words:
            raise PrintError(
                End.NO_ANSWER,
                "what the printer says cannot be read; most likely its baud rate is another: give "
                "--baud, or --baud auto",
            )
        else:
            raise PrintError(
                End.NO_ANSWER,
                f"nothing answered for {self._tries * self._again:.0f} s; is the printer on, the "
                "port the right one, the baud rate right (--baud auto tries them)?",
            )

    def _ask(self, now: float) -> None:
        self._asked += 1
        self._wake = now + self._again
        self._answered_by = None
        if self._step == "hello":
            self._outgoing += b"\nM115\n"
        elif self._step == "count":
            self._outgoing += b"\n" + numbered(0, "M110 N0")
        else:
            self._outgoing += b"\n" + numbered(PROBES[self._asked % 2], "M105")

    def _one(self, reply: Reply, now: float) -> None:
        if isinstance(reply, Garbage):
            self.garbage += 1
            return
        self.words += 1
        if self._ok:
            self._settle(now)
        match reply:
            case Started():
                self._resets += 1
                if self._resets > RESETS:
                    raise PrintError(
                        End.HALTED, "the board is reset again and again; check its power supply"
                    )
                self._asked = min(self._asked, self._tries - 1)
                self._wake = now + QUIET
            case Failure(text, fatal=True):
                raise PrintError(End.HALTED, f"the printer reports: {text}")
            case Ok() | Resend():
                self._ok = True
                self._settle(now)
                if isinstance(reply, Resend) and self._step == "probe":
                    self._last = reply.number - 1

    def _settle(self, now: float) -> None:
        """Wait until all answers are here; not for ever, where a printer never stops talking."""
        if self._answered_by is None:
            self._answered_by = now + self._again
        self._wake = min(now + QUIET, self._answered_by)

    def _told(self, line: str) -> None:
        if line.lower().startswith("grbl "):
            name = line.partition("[")[0].strip()
            raise LocalPrinterError(
                f"this is {name}, which has no heaters; v3dcad prints with Marlin, Klipper, "
                "RepRapFirmware and Repetier"
            )
        found = re.search(r"FIRMWARE_NAME:\s*(.*?)(?:\s+[A-Z_]+:|\s*$)", line)
        if found:
            self._firmware = found[1]
        found = re.match(r"Cap:(\w+):([01])", line)
        if found:
            self._capabilities[found[1]] = found[2] == "1"
