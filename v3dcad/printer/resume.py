"""Where a print that was broken off goes on, and what has to be given back before. No I/O.

A printer that was not reset, and checks line numbers, says itself which line it wants. It goes on
from there, and each line arrives once. A printer that was reset has forgotten where it stands and
what it heated; the layer that it was in is printed again from its start, after its state is
restored. The same holds for one that does not check numbers, since it cannot tell what it has.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

from v3dcad.errors import LocalPrinterError
from v3dcad.printer.handshake import Greeting
from v3dcad.printer.journal import Record
from v3dcad.printer.lines import name_of
from v3dcad.printer.machine_state import MOVES, MachineState
from v3dcad.printer.progress import Line

AHEAD = 24
"""Lines that a printer acknowledges before it has moved: Marlin plans 16 moves and holds 4 to 8
lines more."""


@dataclass(frozen=True, slots=True)
class Continuation:
    """How a print goes on."""

    lines_done: int
    """commands of the file that are left out"""
    offset: int
    """bytes of the file up to there"""
    before: list[str]
    """lines that restore the printer's state"""
    state: MachineState
    exact: bool
    """whether the printer goes on with the very line it wants, and was not reset"""


@dataclass(slots=True)
class _Mark:
    lines: int
    offset: int
    state: MachineState


def continuation(lines: Iterable[Line], record: Record, greeting: Greeting) -> Continuation:
    """How to go on with a file of these lines, after what the journal and the printer say.

    Raises `LocalPrinterError` where nothing was printed yet, or the file does not say how hot the
    nozzle has to be.
    """
    alive = greeting.checks_numbers and not greeting.was_reset and greeting.last > 0
    wanted = record.line_of(greeting.last) if alive else None
    layer, here, heights = _replay(lines, record.line if wanted is None else wanted)
    if wanted is not None:
        # Lines of ours may have been on the way when the host failed: parked, or half-way back.
        before = here.state.come_back(record.retraction)
        return Continuation(here.lines, here.offset, before, here.state, exact=True)
    if layer is None:
        raise LocalPrinterError("--resume: no layer was begun; print the file from its start")
    if not layer.state.nozzle:
        raise LocalPrinterError(
            "--resume: the printer was reset, and the file does not say how hot the nozzle has to "
            "be (M104, M109); nothing can be resumed"
        )
    # The nozzle may lie some lines behind. Taken too low, the rest is printed a layer too high;
    # taken too high, the nozzle would run into the part.
    before = layer.state.after_reset(min(heights) + record.lift, record.retraction)
    return Continuation(layer.lines, layer.offset, before, layer.state, exact=False)


def _replay(lines: Iterable[Line], count: int) -> tuple[_Mark | None, _Mark, list[float]]:
    """The start of the layer that a printer is in after `count` lines, the state then, and the
    heights (mm) at which its nozzle may stand.
    """
    here = _Mark(0, 0, MachineState())
    candidate: _Mark | None = None
    starts: deque[tuple[int, _Mark]] = deque()
    heights: deque[float] = deque(maxlen=AHEAD + 1)
    for line in lines:
        if line.number > count:
            break
        if name_of(line.command) in MOVES and "Z" in line.command.upper():
            candidate = _Mark(here.lines, here.offset, here.state.copy())
        before = here.state.layer
        here.state.follow(line.command)
        here.lines, here.offset = line.number, line.offset
        if here.state.layer != before:
            starts.append((line.number, candidate or _Mark(0, 0, MachineState())))
            while len(starts) > 1 and starts[1][0] <= count - AHEAD:
                starts.popleft()
        heights.append(here.state.place.get("Z", 0.0))
    return (starts[0][1] if starts else None), here, list(heights)
