"""One print: the file's lines to the printer, and what a person wants meanwhile. No I/O.

A job feeds a `Sender` with the lines of a program, and puts lines of its own in between: parking
for a pause, heaters off for a cancel, overrides. These wait until everything before is
acknowledged, so that lines of the file and lines of ours are never under way together; a journal
that knows the last line acknowledged and the last one sent can then tell them apart.

The end is proven: when every line is acknowledged the printer is asked which line it wants next,
and `finished` is said only if that is the line after the last. (A printer that does not check
numbers cannot be asked; it is on a connection that loses nothing, or the job has ended before.)
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from v3dcad.errors import SettingError
from v3dcad.printer.ends import End, PrintError
from v3dcad.printer.handshake import Greeting
from v3dcad.printer.machine_state import MachineState
from v3dcad.printer.patience import Patience
from v3dcad.printer.progress import Line, Phase, Recorder, Snapshot
from v3dcad.printer.replies import Action, Busy, Failure, Ok, Temperatures, Text
from v3dcad.printer.sender import Acknowledged, Event, Sender
from v3dcad.printer.settings import PortSettings

POLL = 5.0
"""Seconds between two questions for temperatures, of a printer that does not report by itself."""
REPORT = "M155 S2"
"""Have Marlin report temperatures every 2 s (its AUTOREPORT_TEMP)."""

ALL_DONE = "M400"
"""Wait until the last move is made: the port may reset the board when it is closed, and a nozzle is
parked only when it is there."""
MOTORS_STAY_ON = "M84 S0"
"""Marlin and Repetier turn motors off after some minutes without a move; then a part may shift.
Klipper takes this for an M84, and is not told."""
LAST_WORD = 300.0
"""Seconds of silence, after which a printer that says no temperatures at the end is taken to be
done. Repetier says ok to M400 when it has it; only the answer to M105 comes after the last move."""


@dataclass(slots=True)
class _Told:
    """What the printer said that is only shown."""

    temperatures: dict[str, tuple[float, float | None]] = field(default_factory=dict)
    doing: str = ""
    messages: deque[str] = field(default_factory=lambda: deque(maxlen=100))


class Job:
    """A print from its first line to a named end; `end` is None until then.

    `before`: lines given before the program, such as those that restore a state. `state`: the
    state that these lines lead to. `lines_done`: how many commands of the file are printed already.
    """

    def __init__(
        self,
        program: Iterable[Line],
        greeting: Greeting,
        settings: PortSettings,
        *,
        recorder: Recorder | None = None,
        patience: Patience | None = None,
        before: Sequence[str] = (),
        state: MachineState | None = None,
        lines_done: int = 0,
        offset: int = 0,
    ) -> None:
        self.sender = Sender(
            checks_numbers=greeting.checks_numbers, last=greeting.last, patience=patience
        )
        self.greeting = greeting
        self.settings = settings
        self.state = state or MachineState()
        self.phase = Phase.PRINTING
        self.end: End | None = None
        self.speed = self.flow = 100
        self.told = _Told()
        self._program: Iterator[Line] = iter(program)
        self._next = next(self._program, None)
        self._recorder = recorder
        self._own = deque(before)
        if greeting.can("AUTOREPORT_TEMP"):
            self._own.appendleft(REPORT)
        self._under_way: deque[tuple[int, Line]] = deque()
        self._line, self._offset = lines_done, offset
        self._wire = greeting.last
        self._minutes_left: float | None = None
        self._park = self._parked = False
        self._poll_at: float | None = None
        self._all_done_sent = False
        self._last_word_by: float | None = None
        self._unanswered = 0

    def data_to_send(self) -> bytes:
        """The bytes that are due to go out, once."""
        return self.sender.data_to_send()

    def wake_at(self) -> float | None:
        """When `due` wants to be called, if nothing is received before; None if never."""
        if self.sender.idle and self.phase == Phase.PAUSED:
            return self._poll_at
        if self.sender.idle and self.phase == Phase.FINISHING:
            return self._last_word_by
        return self.sender.wake_at()

    def start(self, now: float) -> None:
        """Send the first lines."""
        if self._recorder is not None:
            self._recorder.acknowledged(self._line, self._wire)
        if not self.greeting.can("AUTOREPORT_TEMP"):
            self._poll_at = now
        self._go_on(now)

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the printer and go on. Raises `PrintError` at a bad end."""
        self._heard(self.sender.receive(data, now), now)
        self._go_on(now)

    def due(self, now: float) -> None:
        """Do what the clock asks for. Raises `PrintError` at a bad end."""
        self._heard(self.sender.due(now), now)
        self._go_on(now)

    def pause(self, now: float, *, park: bool = True) -> None:
        """Stop after the lines that the printer has, and park; heat stays on.

        Without `park` for a printer that parks by itself and has said so.
        """
        if self.phase in (Phase.PRINTING, Phase.FINISHING):
            self.phase = Phase.PAUSING
            self._park = park
            self._go_on(now)

    def resume(self, now: float) -> None:
        """Go back to where the pause began, heat up if need be, and print on."""
        if self.phase == Phase.PAUSED:
            self.phase = Phase.RESUMING
            if self._parked:
                self._own.extend(self.state.come_back(self.settings.park_retraction))
                self._note_parked(0.0, 0.0)
            self._parked = False
            self._all_done_sent, self._last_word_by = False, None
            self._go_on(now)

    def cancel(self, now: float) -> None:
        """End the print: lines that the printer has are obeyed, then all heaters go off.

        A printer that is heating is told to wait no longer (M108), if it can hear that.
        """
        if self.phase in (Phase.CANCELLING, Phase.ENDED):
            return
        self.phase = Phase.CANCELLING
        lines = [*self.settings.cancel_lines(), *self.state.cool(), *self._as_before()]
        self._own = deque(dict.fromkeys(lines))
        if self.greeting.can("EMERGENCY_PARSER"):
            self.sender.interrupt(b"M108\n")
        self._go_on(now)

    def stop(self) -> None:
        """Emergency stop, out of turn (M112). Raises `PrintError`: this is the end.

        The bytes are in `data_to_send` and have to go out all the same.
        """
        self.sender.interrupt(b"M112\n")
        self.phase, self.end = Phase.ENDED, End.HALTED
        raise PrintError(End.HALTED, "emergency stop; switch the printer off and on, or reset it")

    def override(self, now: float, *, speed: int | None = None, flow: int | None = None) -> None:
        """Print at another share (%) of the file's speed or flow, from now on.

        Raises `SettingError` outside 10 … 500 % of speed, 50 … 200 % of flow.
        """
        if speed is not None:
            self.speed = _share("speed", speed, 10, 500)
            self._own.append(f"M220 S{speed}")
        if flow is not None:
            self.flow = _share("flow", flow, 50, 200)
            self._own.append(f"M221 S{flow}")
        self._go_on(now)

    def snapshot(self) -> Snapshot:
        """How far the job is."""
        return Snapshot(
            phase=self.phase,
            end=self.end,
            line=self._line,
            offset=self._offset,
            layer=self.state.layer,
            height=self.state.height,
            minutes_left=self._minutes_left,
            temperatures=dict(self.told.temperatures),
            doing=self.told.doing,
            speed=self.speed,
            flow=self.flow,
            resent=self.sender.resent,
        )

    def _heard(self, events: Iterable[Event], now: float) -> None:
        for event in events:
            match event:
                case Acknowledged():
                    self.told.doing = ""
                case Busy(doing):
                    self.told.doing = doing
                    if self._last_word_by is not None:
                        self._last_word_by = now + LAST_WORD
                case Ok(temperatures=heaters) | Temperatures(heaters):
                    self.told.temperatures |= heaters
                    self._unanswered = max(0, self._unanswered - bool(heaters))
                case Text(text) | Failure(text, about_line=False):
                    self.told.messages.append(text)
                case Action(name, text):
                    if text:
                        self.told.messages.append(text)
                    self._asked_for(name, now)

    def _asked_for(self, action: str, now: float) -> None:
        """The printer wants something of the host (Marlin's `feature/host_actions.cpp`)."""
        if action in ("pause", "paused"):
            self.pause(now, park=False)
        elif action in ("resume", "resumed"):
            self.resume(now)
        elif action == "cancel":
            self.cancel(now)

    def _go_on(self, now: float) -> None:
        """Send as much as the printer takes."""
        self._note_progress()
        while self.end is None and self.sender.ready() and self._step(now):
            pass

    def _note_progress(self) -> None:
        """Pass on what is acknowledged by now."""
        if self.sender.acknowledged == self._wire:
            return
        self._wire = self.sender.acknowledged
        while self._under_way and self._under_way[0][0] <= self._wire:
            line = self._under_way.popleft()[1]
            self._line, self._offset = line.number, line.offset
        if self._recorder is not None:
            self._recorder.acknowledged(self._line, self._wire)

    def _step(self, now: float) -> bool:
        """Send one line, or change the phase; whether there may be more to do at once."""
        polling = (
            self._poll_at is not None and now >= self._poll_at and self.phase != Phase.FINISHING
        )
        if self._own or polling or self._next is None or self.phase != Phase.PRINTING:
            return self.sender.idle and self._step_aside(polling, now)
        line = self._next
        self._next = next(self._program, None)
        self._under_way.append((self.sender.newest + 1, line))
        self._send(line.number, line.command, now)
        self.state.follow(line.command)
        if line.command.startswith("M73") and (left := re.search(r"R(\d+)", line.command)):
            self._minutes_left = float(left[1])
        return True

    def _step_aside(self, polling: bool, now: float) -> bool:
        """The same for what is no line of the file; everything before is acknowledged."""
        if self._own:
            self._send(self._line, self._own.popleft(), now)
            return True
        if polling:
            self._poll_at = now + POLL
            self._ask(now)
            return False
        match self.phase:
            case Phase.PRINTING:
                self.phase = Phase.FINISHING
            case Phase.PAUSING if self._park:
                self._own.extend(self._parking())
                self._parked = bool(self._own)
                self._park = False
            case Phase.PAUSING:
                self.phase = Phase.PAUSED
                if self._parked:
                    self._note_parked(self.settings.park_lift, self.settings.park_retraction)
            case Phase.RESUMING:
                self.phase = Phase.PRINTING
            case Phase.FINISHING if not self._done(now):
                return self.sender.ready() and bool(self._own)
            case Phase.FINISHING | Phase.CANCELLING:
                return self._prove(now)
            case _:
                return False
        return True

    def _done(self, now: float) -> bool:
        """Whether the last move is made; sees to it that the printer says so."""
        if not self._all_done_sent:
            self._all_done_sent = True
            self._own.extend([*self._as_before(), ALL_DONE])
        elif self._last_word_by is None:
            self._last_word_by = now + LAST_WORD
            self._ask(now)
        elif self._unanswered == 0 or now >= self._last_word_by:
            return True
        return False

    def _ask(self, now: float) -> None:
        self._unanswered += 1
        self.sender.ask(now)

    def _prove(self, now: float) -> bool:
        """End, if the printer has everything for certain; otherwise ask it."""
        if self.sender.checks_numbers and self.sender.proven != self.sender.newest:
            self.sender.probe(now)
            return False
        self.end = End.CANCELLED if self.phase == Phase.CANCELLING else End.FINISHED
        self.phase = Phase.ENDED
        return False

    def _parking(self) -> list[str]:
        settings = self.settings
        lines = self.state.park(settings.park_place(), settings.park_lift, settings.park_retraction)
        stay = [MOTORS_STAY_ON] if self.greeting.checks_numbers else []
        return [*stay, *lines, ALL_DONE] if lines else []

    def _as_before(self) -> list[str]:
        """Lines that take the overrides back, which would hold for the next print."""
        lines = ["M220 S100"] if self.speed != 100 else []
        return [*lines, "M221 S100"] if self.flow != 100 else lines

    def _note_parked(self, lift: float, retraction: float) -> None:
        if self._recorder is not None:
            self._recorder.parked(lift, retraction if self.state.nozzle else 0.0)

    def _send(self, line: int, command: str, now: float) -> None:
        """Send a command, written down before; `line` is the file's last one up to it."""
        if self._recorder is not None:
            self._recorder.sent(line, self.sender.newest + 1)
        self.sender.send(command, now)


def _share(name: str, value: int, least: int, most: int) -> int:
    if not least <= value <= most:
        raise SettingError(name, f"{name} {value}: give {least} to {most} %")
    return value
