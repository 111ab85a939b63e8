"""The commands that talk to a printer on a cable: print, ports, console."""

from __future__ import annotations

import json
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from v3dcad.commands.controls import Controls, Wish, listening
from v3dcad.commands.print_view import (
    EVERY,
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
    from collections.abc import Callable, Iterator

    from v3dcad.printer.fit import Machine
    from v3dcad.printer.handshake import Greeting
    from v3dcad.printer.job import Job
    from v3dcad.printer.program import Program
    from v3dcad.printer.resume import Continuation
    from v3dcad.printer.serial_link import SerialLink

PortName = Annotated[
    str | None,
    typer.Option(metavar="PORT", help="The printer's port, such as /dev/ttyUSB0; never guessed."),
]
CANCELLED = 130
"""Exit code of a print that was cancelled, as after Ctrl-C."""


def ports(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List the serial ports and what is plugged in; opens none."""
    from v3dcad.printer.serial_link import ports as all_ports

    found = all_ports()
    if as_json:
        rows = [{"port": port.device, "name": port.name, "usb": port.usb} for port in found]
        typer.echo(json.dumps(rows, indent=1))
    elif found:
        width = max(len(port.device) for port in found)
        for port in found:
            typer.echo(f"{port.device:<{width}}  {port.usb:<9}  {port.name}".rstrip())
    else:
        typer.echo("no serial ports; is the printer plugged in and switched on?")


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

    The file is checked before the first byte goes out. While it prints: p pauses, r resumes, c or
    Ctrl-C cancels, s is the emergency stop.
    """
    from v3dcad.commands.gcode_check import checked
    from v3dcad.printer.journal import journal_of, read_journal

    chosen = PortSettings(**given(PortSettings, settings))
    chosen.park_place()
    program, summary = checked(file, _machine(profile))
    extent = Extent(file.name, program.size, program.commands, summary.layers, summary.time_s)
    record = None
    if resume:
        head, record = read_journal(journal_of(file))
        if head.sha256 != program.sha256:
            raise LocalPrinterError(
                f"--resume: {file} is not the file that was printed; it was changed since"
            )
        port = port or head.port
        if chosen.baud == "auto":
            chosen = PortSettings(**{**given(PortSettings, settings), "baud": head.baud})
    if port is None:
        raise SettingError("port", "no port: give --port; v3dcad ports lists them")
    view = _view(as_json)
    with listening(as_json=as_json) as controls, _open(port, chosen, resume) as link, view:
        view.say(
            "file",
            file=str(file),
            bytes=program.size,
            lines=program.commands,
            layers=extent.layers,
            time_s=round(extent.seconds),
        )
        greeting, baud = _greet(link, chosen, controls, fresh=not resume)
        if greeting.checks_numbers:
            program.check_length()
        view.say(
            "printer",
            firmware=greeting.firmware,
            port=port,
            baud=baud,
            checks_numbers=greeting.checks_numbers,
        )
        onward = None
        if record is not None:
            from v3dcad.printer.resume import continuation

            onward = continuation(program.lines(), record, greeting)
            view.say("resume", text=_how(onward, program), exact=onward.exact)
            _confirm(yes, as_json, controls)
        end = _print(program, extent, greeting, chosen, link, baud, onward, controls, view)
    if end == "cancelled":
        raise typer.Exit(CANCELLED)


def console(
    port: PortName = None,
    baud: Annotated[int, typer.Option(help="Baud rate of the port.")] = 115200,
) -> None:
    """Type G-code to a printer and read its answers; Ctrl-D ends it.

    Lines of a file or pipe are sent one at a time, each after the answer to the one before.
    """
    from v3dcad.commands.console import talk
    from v3dcad.printer.serial_link import SerialLink

    if port is None:
        raise SettingError("port", "no port: give --port; v3dcad ports lists them")
    link = SerialLink(port, baud)
    try:
        talk(link, sys.stdin)
    finally:
        link.close()


def _machine(profile: str | None) -> Machine:
    from v3dcad.printer.fit import Machine

    if profile is None:
        return Machine()
    from v3dcad.formats.gcode.machine_profile import read_profile
    from v3dcad.settings import PrintSettings

    return Machine.of(PrintSettings(**read_profile(profile)))


def _view(as_json: bool) -> View:
    if as_json:
        return JsonView()
    return LiveView() if sys.stderr.isatty() and sys.stdout.isatty() else PlainView()


@contextmanager
def _open(port: str, chosen: PortSettings, resume: bool) -> Iterator[SerialLink]:
    from v3dcad.printer.drive import BAUDS
    from v3dcad.printer.serial_link import SerialLink

    baud = BAUDS[0] if chosen.baud == "auto" else int(chosen.baud)
    link = SerialLink(port, baud, reset=chosen.reset and not resume)
    try:
        yield link
    finally:
        link.close()


def _greet(
    link: SerialLink, chosen: PortSettings, controls: Controls, *, fresh: bool
) -> tuple[Greeting, int]:
    """Shake hands, at each rate in turn for `--baud auto`; the rate that it was."""
    from v3dcad.printer.drive import greet, greet_at_any_baud

    def each_turn() -> None:
        if any(wish.do in ("cancel", "stop") for wish in controls.take()):
            raise KeyboardInterrupt

    if chosen.baud == "auto":
        return greet_at_any_baud(link, fresh=fresh, each_turn=each_turn)
    return greet(link, fresh=fresh, each_turn=each_turn), int(chosen.baud)


def _how(onward: Continuation, program: Program) -> str:
    """How a print goes on, in words."""
    part = f"{100 * onward.offset / program.size:.1f} % of the file"
    if onward.exact:
        return f"the printer was not reset; it goes on with line {onward.lines_done + 1} ({part})"
    return (
        f"the printer was reset, or cannot say what it has: layer {onward.state.layer + 1} is "
        f"printed again from its start, line {onward.lines_done + 1} ({part}); bed and nozzle are "
        f"heated, X and Y homed above the part, Z is not homed"
    )


def _confirm(yes: bool, as_json: bool, controls: Controls) -> None:
    """Ask a person, unless answered already; a program has to answer beforehand."""
    if yes:
        return
    if as_json or not sys.stdin.isatty():
        raise LocalPrinterError("--resume asks before it heats and moves; give --yes to agree")
    typer.echo("Go on? y: yes, any other key: no", err=True)
    while True:
        wishes = controls.take()
        if any(wish.do == "yes" for wish in wishes):
            return
        if wishes:
            raise typer.Abort
        time.sleep(0.05)


def _print(
    program: Program,
    extent: Extent,
    greeting: Greeting,
    chosen: PortSettings,
    link: SerialLink,
    baud: int,
    onward: Continuation | None,
    controls: Controls,
    view: View,
) -> str:
    """Run the job to its end, which is told and returned; bad ends raise."""
    from v3dcad.printer.drive import run_job
    from v3dcad.printer.ends import PrintError
    from v3dcad.printer.job import Job
    from v3dcad.printer.journal import Head, Journal, journal_of

    head = Head(str(program.path.resolve()), program.sha256, link.port, baud)
    journal = Journal(journal_of(program.path), head, time.monotonic)
    lines = program.lines()
    job = Job(lines, greeting, chosen, recorder=journal) if onward is None else Job(
        (line for line in lines if line.number > onward.lines_done),
        greeting,
        chosen,
        recorder=journal,
        before=onward.before,
        state=onward.state,
        lines_done=onward.lines_done,
        offset=onward.offset,
    )  # fmt: skip
    done = False
    turn = _turn(job, extent, controls, view)
    try:
        end = run_job(job, link, each_turn=turn)
        done = True
        turn()
    except PrintError as error:
        view.say("end", end=error.end, message=error.message)
        raise
    finally:
        journal.close(done=done)
    view.say("end", end=end)
    return end


def _turn(job: Job, extent: Extent, controls: Controls, view: View) -> Callable[[], None]:
    """What is done some 50 times a second: wishes are obeyed, progress is shown."""
    begun = time.monotonic()
    shown_at = 0.0

    def turn() -> None:
        nonlocal shown_at
        now = time.monotonic()
        for wish in controls.take():
            _obey(wish, job, view, now)
        while job.told.messages:
            view.say("message", text=job.told.messages.popleft())
        if now >= shown_at + EVERY or job.end is not None:
            shown_at = now
            view.show(Sight(job.snapshot(), extent, now - begun))

    return turn


def _obey(wish: Wish, job: Job, view: View, now: float) -> None:
    match wish.do:
        case "pause":
            job.pause(now)
        case "resume":
            job.resume(now)
        case "cancel":
            job.cancel(now)
        case "stop":
            job.stop()
        case "speed" | "flow" as which:
            value = wish.percent + (getattr(job, which) if wish.relative else 0)
            try:
                job.override(now, **{which: value})
            except SettingError as error:
                view.say("mistake", text=str(error))
        case "mistake":
            view.say("mistake", text=wish.text)
