"""Numbered lines to a printer, each once and in order, whatever is lost on the way. No I/O.

Line numbers decide what arrived; `ok` only paces. A printer that checks numbers takes a line only
if its number follows the last one's and the checksum holds; otherwise it says which number it
wants (`Resend: 7`), which also tells that it has all lines before. So nothing is ever guessed. (The
checksum has 8 bits: a line spoilt in several places can pass for whole, and no host can tell.)

- One line is under way at a time (ping-pong). Once the printer sends advanced `ok N5 P15 B3`,
  whose numbers leave no doubt which line is done, as many lines are as its buffer holds.
- After `Resend: 7` nothing is under way any more. The sender is quiet for a moment, until answers
  to earlier lines have arrived, and then goes on from line 7. A plain `ok` in that moment (Marlin
  adds one to the request, or not, by version) acknowledges nothing.
- After a long silence a *probe* is sent: M105 under a number that cannot be right. A printer that
  checks numbers refuses it and says what it wants; then the `ok` was lost, or the line was. One
  that does not check numbers answers it, and so at least lives.

Marlin is followed in `Marlin/src/gcode/queue.cpp` (`get_serial_commands`, `gcode_line_error`,
`flush_and_request_resend`), Repetier in `gcode.cpp` (`checkAndPushCommand`, `requestResend`),
RepRapFirmware in `GCodeBuffer/StringParser.cpp` (`LineFinished`: a line with a wrong checksum is
dropped in silence, numbers are not compared), Klipper in `klippy/gcode.py` (neither is looked at).

Every wait is bounded: `Patience` says how long, and how often is asked again. The caller's clock
comes in as `now`, in seconds; `wake_at` says when `due` wants to be called.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from v3dcad.errors import LocalPrinterError
from v3dcad.printer.ends import End, PrintError
from v3dcad.printer.lines import is_slow, numbered
from v3dcad.printer.patience import Patience
from v3dcad.printer.replies import (
    Busy,
    Failure,
    LineSplitter,
    Ok,
    Reply,
    Resend,
    Skipped,
    Started,
    Waiting,
    parse,
)
from v3dcad.words import counted

GOES_BACK = 8
"""By how many lines a request may lie before what is acknowledged. An `ok` too many makes one; a
printer that wants more was reset, and must not be given the file's lines in that state."""
BYTES_UNDER_WAY = 109
"""What fits into the receive buffer of an 8-bit board (RX_BUFFER_SIZE of Marlin is 128, and a
byte stays free) beside the words that turn the heaters off at a bad end."""
MOST_UNDER_WAY = 32
HISTORY = MOST_UNDER_WAY + GOES_BACK
"""Lines kept so that the printer may ask for them again."""
BEYOND = 1000
"""How far a probe's number lies beyond the last line's. Repetier takes up to 40 less as old."""
STILL_SLOW = 8
"""Lines behind a slow command for which the printer is given as much time."""
MOST_SKIPS = 40
"""How often a printer may skip in a row; Repetier does up to 15 times before it asks again."""
HURRY = 0.5
"""Seconds after which a printer that says `wait` cannot have the line that is under way."""


@dataclass(frozen=True, slots=True)
class Acknowledged:
    """The printer has all lines up to this number."""

    number: int


Event = Acknowledged | Reply


class Sender:
    """One side of the talk with a printer: what to send next, and what an answer means.

    `checks_numbers`: whether the printer refuses a line whose number does not follow, which
    `Handshake` finds out. `last`: the number of the last line that the printer has.
    """

    def __init__(
        self, *, checks_numbers: bool, last: int = 0, patience: Patience | None = None
    ) -> None:
        self.checks_numbers = checks_numbers
        self.patience = patience or Patience()
        self.acknowledged = last
        """the printer has, or claimed to have, all lines up to this number"""
        self.proven = last
        """the printer asked for the line after this one, so it has these for certain"""
        self.newest = last
        """number of the newest line given to `send`"""
        self.window = 1
        """how many lines may be under way"""
        self.resent = 0
        """how often lines were sent again"""
        self._sent = last
        self._history: deque[bytes] = deque(maxlen=HISTORY)
        self._slow: set[int] = set()
        self._asking = False
        self._probes = 0
        self._skips = 0
        self._ok_of_a_skip = False
        self._advanced = False
        self._room = 0
        self._one_by_one_to = last
        self._repeated = (last, 0)
        self._settled_at: float | None = None
        self._settle_limit = 0.0
        self._heard = 0.0
        self._splitter = LineSplitter()
        self._outgoing = bytearray()

    def ready(self) -> bool:
        """Whether `send` takes another line now."""
        return self._sent == self.newest and self._may_transmit()

    @property
    def idle(self) -> bool:
        """Whether every line is acknowledged and nothing is asked."""
        return self.acknowledged == self.newest and self.ready()

    def send(self, command: str, now: float) -> int:
        """Number a command and send it; its number. Only when `ready`."""
        if not self.ready():
            raise LocalPrinterError("send: the printer's buffer is full; ask ready() first")
        if "\n" in command or "\r" in command:
            raise LocalPrinterError(f"send: {command!r} is more than one line")
        self.newest += 1
        self._history.append(numbered(self.newest, command))
        if is_slow(command):
            self._slow.add(self.newest)
        self._transmit(now)
        return self.newest

    def ask(self, now: float) -> None:
        """Ask for temperatures (M105), without a number. Only when `idle`."""
        if not self.idle:
            raise LocalPrinterError("ask: lines are under way; wait until idle")
        self._asking = True
        self._heard = now
        self._outgoing += b"M105\n"

    def probe(self, now: float) -> None:
        """Have the printer say which line it wants next; `proven` then tells. Only when `idle`."""
        if not self.idle:
            raise LocalPrinterError("probe: lines are under way; wait until idle")
        self._heard = now
        self._probe()

    def interrupt(self, data: bytes) -> None:
        """Have bytes go out before all others, without a number, such as M112.

        The line feed ends a line that may have gone out in part. The printer may answer with an
        `ok` too many, as to any line; numbers put that right.
        """
        self._outgoing[:0] = b"\n" + data

    def data_to_send(self) -> bytes:
        """The bytes that are due to go out, once."""
        data = bytes(self._outgoing)
        self._outgoing.clear()
        return data

    def receive(self, data: bytes, now: float) -> list[Event]:
        """Take bytes from the printer; what they mean, in order.

        Raises `PrintError` when the printer reports a fatal error, was reset, or wants a line that
        it cannot have.
        """
        return self._take(self._splitter.feed(data), now)

    def wake_at(self) -> float | None:
        """When `due` wants to be called, if nothing is received before; None if never."""
        if self._settled_at is not None:
            return self._settled_at
        if not (self._asking or self._probes or self.acknowledged < self._sent):
            return None
        if self._probes < self.patience.probes:
            return self._heard + (self._probes + 1) * self.patience.answer
        return self._heard + self.patience.most(bool(self._slow))

    def due(self, now: float) -> list[Event]:
        """Do what the clock asks for: go on after a Resend, or probe a silent printer.

        Raises `PrintError` (no answer) when the printer has been asked often enough.
        """
        wake = self.wake_at()
        if wake is None or now < wake:
            return []
        if self._settled_at is not None:
            self._settled_at = None
            if self._sent < self.newest:
                self._count_repeat(self._sent + 1)
            self._go_on(now)
            return []
        late = self._take(self._splitter.flush(), now)
        if late:
            return late
        if self._probes < self.patience.probes:
            self._probe()
            return []
        raise PrintError(
            End.NO_ANSWER,
            f"the printer has said nothing to line {self.acknowledged + 1} for "
            f"{now - self._heard:.0f} s; check cable and power",
        )

    def _may_transmit(self) -> bool:
        if self._asking or self._probes or self._settled_at is not None:
            return False
        under_way = self._sent - self.acknowledged
        return under_way == 0 or (under_way < self.window and self._fits(under_way))

    def _fits(self, under_way: int) -> bool:
        """Whether the lines under way and one more like them fit into a small board's buffer."""
        last = self._sent - self.newest - 1
        lengths = [len(self._history[last - back]) for back in range(under_way)]
        return sum(lengths) + max(lengths) <= BYTES_UNDER_WAY

    def _transmit(self, now: float) -> None:
        self._sent += 1
        self._heard = now
        self._outgoing += self._history[self._sent - self.newest - 1]

    def _probe(self) -> None:
        """The line feed ends a line that may have arrived in part.

        None goes to a printer that does not check numbers: Klipper says ok to a blank line.
        """
        self._probes += 1
        self._outgoing += b"\n" if self.checks_numbers else b""
        self._outgoing += numbered(self.newest + BEYOND, "M105")

    def _go_on(self, now: float) -> None:
        """Send the lines of the past that are to be sent again."""
        while self._sent < self.newest and self._may_transmit():
            self._transmit(now)

    def _take(self, lines: list[str], now: float) -> list[Event]:
        return [event for line in lines for reply in parse(line) for event in self._one(reply, now)]

    def _one(self, reply: Reply, now: float) -> list[Event]:
        events: list[Event] = [reply]
        before = self.acknowledged
        match reply:
            case Ok():
                self._ok(reply, now)
            case Resend(number):
                self._resend(number, now)
            case Skipped():
                self._skip(now)
            case Failure(text, fatal=True):
                raise PrintError(End.HALTED, f"the printer reports: {text}")
            case Started():
                raise PrintError(End.HALTED, f"the printer was reset after line {before}")
            case Waiting():
                self._hurry(now)
            case Busy():
                self._heard = now
                self._probes = 0
        if isinstance(reply, Ok):
            # Repetier says ok to a slow command when it has it, and the lines behind it wait; a
            # request for the next line, too, only says that a slow one has arrived.
            self._slow = {slow for slow in self._slow if slow > self.acknowledged - STILL_SLOW}
        if self.acknowledged != before:
            events.insert(0, Acknowledged(self.acknowledged))
        return events

    def _ok(self, ok: Ok, now: float) -> None:
        if self._ok_of_a_skip:
            self._ok_of_a_skip = False
        elif ok.number is not None:
            self._ok_with_number(ok.number, ok.room or 0, now)
        elif self._asking:
            self._asking = False
            self._probes = 0
        elif self._probes and ok.temperatures and not self.checks_numbers:
            self._probe_answered(now)
        elif self.acknowledged < self._sent and not self._advanced:
            self.acknowledged += 1
            self._heard = now
            if self.checks_numbers:
                self._probes = 0
        self._go_on(now)

    def _ok_with_number(self, number: int, room: int, now: float) -> None:
        """Advanced ok: exact whatever was lost before it, and opens the window."""
        self._advanced = True
        self._room = max(self._room, room)
        if self.acknowledged < number <= self._sent:
            self.acknowledged = number
            self._heard = now
            self._probes = 0
        if self.acknowledged >= self._one_by_one_to:
            # While a line is obeyed it still holds its place, so that all have one more.
            self.window = min(self._room + 1, MOST_UNDER_WAY)

    def _probe_answered(self, now: float) -> None:
        """A printer that does not check numbers has answered the probe, after all before it."""
        self._probes -= 1
        self._heard = now
        if self.acknowledged < self._sent:
            raise PrintError(
                End.NO_ANSWER,
                f"line {self.acknowledged + 1} was not confirmed, and this printer does not say "
                "whether it has it; to go on could repeat or leave out a move",
            )

    def _skip(self, now: float) -> None:
        """A line was not obeyed, and an ok follows that says nothing.

        Repetier skips what it has; after a Resend also what it does not want. So ask what it wants.
        """
        self._ok_of_a_skip = True
        self._skips += 1
        if self._skips > MOST_SKIPS:
            raise PrintError(
                End.NO_ANSWER, f"the printer skips line {self.acknowledged + 1} and all others"
            )
        if self._settled_at is None and (self._probes or self.acknowledged < self._sent):
            self._heard = now
            self._probe()

    def _resend(self, number: int, now: float) -> None:
        """The printer has all lines before `number` and wants this one."""
        oldest = max(self.newest - len(self._history), self.acknowledged - GOES_BACK) + 1
        if not oldest <= number <= self.newest + 1:
            raise PrintError(
                End.HALTED,
                f"the printer asks for line {number} after it had {self.acknowledged}; it was "
                "reset, or another program talks to it",
            )
        if self._settled_at is None:
            self._settle_limit = now + self.patience.answer
        self._settled_at = min(now + self.patience.settle, self._settle_limit)
        self._heard = now
        self._asking = False
        self._probes = self._skips = 0
        if number <= self._sent:
            self.window = 1
            self._one_by_one_to = max(self._one_by_one_to, self._sent)
        self._sent = self.acknowledged = self.proven = number - 1

    def _count_repeat(self, number: int) -> None:
        last, count = self._repeated
        count = count + 1 if number <= last else 1
        self._repeated = (max(number, last), count)
        self.resent += 1
        if count > self.patience.resends:
            raise PrintError(
                End.NO_ANSWER,
                f"the printer refused line {number} {counted(count, 'time')}; check the cable, or "
                "use a lower baud rate",
            )

    def _hurry(self, now: float) -> None:
        """`wait` long after a line went out: it, or its ok, was lost. Ask now."""
        if self.acknowledged < self._sent and not self._probes and now - self._heard >= HURRY:
            self._heard = now - self.patience.answer
