"""The command that prints a file over a cable."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from v3dcad.commands.controls import Controls, Wish, listening
from v3dcad.commands.ports import PortName, named
from v3dcad.commands.print_view import (
    EVERY,
    Aside,
    Extent,
    JsonView,
    LiveView,
    PlainView,
    Sight,
    View,
)
from v3dcad.errors import LocalPrinterError, SettingError
from v3dcad.options import given, with_options
from v3dcad.printer.settings import PortSettings

if TYPE_CHECKING:
    from v3dcad.printer.ends import End
    from v3dcad.printer.handshake import Greeting
    from v3dcad.printer.job import Job
    from v3dcad.printer.journal import Head, Record
    from v3dcad.printer.program import Program
    from v3dcad.printer.resume import Continuation
    from v3dcad.printer.serial_link import SerialLink

CANCELLED = 130
"""Exit code of a print that was cancelled, as after Ctrl-C."""


@with_options(PortSettings)
def print_file(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="G-code of any slicer.")],
    port: PortName = None,
    profile: Annotated[
        str | None,
        typer.Option(metavar="NAME|TOML", help="Machine profile that the file has to fit."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a print of FILE that was broken off.")
    ] = False,
    yes: Annotated[bool, typer.Option("--yes", "-y", help="Do not ask before resuming.")] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Tell in JSON lines, and take wishes in such lines.")
    ] = False,
    **settings: Any,
) -> None:
    """Print FILE over a cable.

    The file is checked before the first byte goes out. While it prints, p pauses, r resumes, c or
    Ctrl-C cancels, and s is the emergency stop.
    """
    from v3dcad.commands.gcode_check import checked, machine_of

    chosen = PortSettings(**given(PortSettings, settings))
    chosen.park_place()
    chosen.cancel_lines()
    program, summary = checked(file, machine_of(profile))
    extent = Extent(file.name, program.size, program.commands, summary.layers, summary.time_s)
    before = None
    if resume:
        before = _broken_off(program, port)
        port = port or before.head.port
        if chosen.baud == "auto":
            chosen = replace(chosen, baud=before.head.baud)
    with (
        listening(as_json=as_json) as controls,
        _open(named(port), chosen, reset=chosen.reset and not resume) as link,
        _view(as_json) as view,
    ):
        printing = _Printing(program, extent, chosen, link, controls, view)
        greeting, baud = printing.greet(fresh=not resume)
        onward = None
        if before is not None:
            onward = printing.onward(before.record, greeting)
            _confirm(yes, as_json, controls)
        end = printing.run(greeting, baud, onward, before.journal if before else None)
    if end == "cancelled":
        raise typer.Exit(CANCELLED)


@dataclass(frozen=True, slots=True)
class _Printing:
    """One print: what, where, and who watches and rules."""

    program: Program
    extent: Extent
    settings: PortSettings
    link: SerialLink
    controls: Controls
    view: View

    def greet(self, *, fresh: bool) -> tuple[Greeting, int]:
        """Shake hands, at each rate in turn for `--baud auto`; with the rate that it was."""
        from v3dcad.printer.drive import greet, greet_at_any_baud

        self.view.say(
            "file",
            file=str(self.program.path),
            bytes=self.program.size,
            lines=self.program.commands,
            layers=self.extent.layers,
            time_s=round(self.extent.seconds),
        )
        if self.settings.baud == "auto":
            found, baud = greet_at_any_baud(self.link, fresh=fresh, each_turn=self._may_break_off)
        else:
            found = greet(self.link, fresh=fresh, each_turn=self._may_break_off)
            baud = int(self.settings.baud)
        if found.checks_numbers:
            self.program.check_length()
        self.view.say(
            "printer",
            firmware=found.firmware,
            port=self.link.port,
            baud=baud,
            checks_numbers=found.checks_numbers,
        )
        return found, baud

    def onward(self, record: Record, greeting: Greeting) -> Continuation:
        """How a print that was broken off goes on; it is told."""
        from v3dcad.printer.resume import continuation

        found = continuation(self.program.lines(), record, greeting)
        part = f"line {found.lines_done + 1} ({100 * found.offset / self.program.size:.1f} %)"
        text = f"the printer was not reset; it goes on with {part}"
        if not found.exact:
            text = (
                f"the printer was reset, or cannot say what it has: layer {found.state.layer + 1} "
                f"is printed again from its start, {part}; bed and nozzle are heated, X and Y "
                "homed above the part, Z is not homed"
            )
        self.view.say("resume", text=text, exact=found.exact)
        return found

    def run(
        self,
        greeting: Greeting,
        baud: int,
        onward: Continuation | None,
        earlier_journal: Path | None,
    ) -> End:
        """Print to the end, which is told and returned; bad ends raise."""
        from v3dcad.printer.drive import run_job
        from v3dcad.printer.ends import PrintError
        from v3dcad.printer.job import Job
        from v3dcad.printer.journal import Head, Journal, Record, journal_of

        path = self.program.path
        head = Head(str(path.resolve()), self.program.sha256, self.link.port, baud)
        done_before = onward.lines_done if onward else 0
        begun = Record(done_before, greeting.last, done_before, greeting.last)
        journal = Journal(
            journal_of(path, self.link.port), head, time.monotonic,
            begun=begun, instead_of=earlier_journal,
        )  # fmt: skip
        done = False
        try:
            job = Job(
                (line for line in self.program.lines() if line.number > done_before),
                greeting,
                self.settings,
                recorder=journal,
                before=onward.before if onward else (),
                state=onward.state if onward else None,
                lines_done=done_before,
                offset=onward.offset if onward else 0,
            )
            turn = _Turn(job, self)
            end = run_job(job, self.link, each_turn=turn)
            done = True
        except PrintError as error:
            self.view.say("end", end=error.end, message=error.reason)
            raise
        finally:
            journal.close(done=done)
        turn()
        self.view.say("end", end=end)
        return end

    def _may_break_off(self) -> None:
        """Ctrl-C while no printer has answered yet."""
        if any(wish.do in ("cancel", "stop") for wish in self.controls.take()):
            raise KeyboardInterrupt


class _Turn:
    """What is done some 50 times a second: wishes are obeyed, progress is shown."""

    def __init__(self, job: Job, printing: _Printing) -> None:
        self.job = job
        self.printing = printing
        self.begun = time.monotonic()
        self.shown_at = 0.0

    def __call__(self) -> None:
        now = time.monotonic()
        job, view = self.job, self.printing.view
        for wish in self.printing.controls.take():
            self._obey(wish, now)
        while job.told.messages:
            view.say("message", text=job.told.messages.popleft())
        if now >= self.shown_at + EVERY or job.end is not None:
            self.shown_at = now
            view.show(Sight(job.snapshot(), self.printing.extent, now - self.begun))

    def _obey(self, wish: Wish, now: float) -> None:
        match wish.do:
            case "pause":
                self.job.pause(now)
            case "resume":
                self.job.resume(now)
            case "cancel":
                self.job.cancel(now)
            case "stop":
                self.job.stop()
            case "speed" | "flow" as which:
                value = wish.percent + (getattr(self.job, which) if wish.relative else 0)
                try:
                    self.job.override(now, **{which: value})
                except SettingError as error:
                    self.printing.view.say("mistake", text=error.message)
            case "mistake":
                self.printing.view.say("mistake", text=wish.text)


@dataclass(frozen=True, slots=True)
class _Before:
    """A print that was broken off."""

    journal: Path
    head: Head
    record: Record


def _broken_off(program: Program, port: str | None) -> _Before:
    """What the journal says of a print; raises if the file has changed since."""
    from v3dcad.printer.journal import broken_off, read_journal

    journal = broken_off(program.path, port)
    head, record = read_journal(journal)
    if head.sha256 != program.sha256:
        raise LocalPrinterError(
            f"--resume: {program.path} is not the file that was printed; it was changed since"
        )
    return _Before(journal, head, record)


def _view(as_json: bool) -> View:
    if as_json:
        return Aside(JsonView())
    return Aside(LiveView() if sys.stderr.isatty() and sys.stdout.isatty() else PlainView())


@contextmanager
def _open(port: str, settings: PortSettings, *, reset: bool) -> Iterator[SerialLink]:
    from v3dcad.printer.drive import BAUDS
    from v3dcad.printer.serial_link import SerialLink

    baud = BAUDS[0] if settings.baud == "auto" else int(settings.baud)
    link = SerialLink(port, baud, reset=reset)
    try:
        yield link
    finally:
        link.close()


def _confirm(yes: bool, as_json: bool, controls: Controls) -> None:
    """Ask a person, unless answered already; a program has to answer beforehand."""
    if yes:
        return
    if as_json or not sys.stdin.isatty():
        raise LocalPrinterError("--resume asks before it heats and moves; give --yes to agree")
    typer.echo("Go on? y: yes, n: no", err=True)
    while not (wishes := controls.take()):
        time.sleep(0.05)
    if not any(wish.do == "yes" for wish in wishes):
        raise typer.Abort
