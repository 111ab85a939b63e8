"""Commands about serial ports: which there are, and a console to one."""

from __future__ import annotations

import json
import queue
import sys
import threading
import time
from typing import TYPE_CHECKING, Annotated, TextIO

import typer

from v3dcad.errors import SettingError

if TYPE_CHECKING:
    from v3dcad.printer.drive import Link

PortName = Annotated[
    str | None,
    typer.Option(metavar="PORT", help="The printer's port, such as /dev/ttyUSB0; never guessed."),
]
LONGEST_WAIT = 1800.0
"""Seconds that a line from a file or pipe is given to be answered; heating takes its time."""


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


def console(
    port: PortName = None,
    baud: Annotated[int, typer.Option(help="Baud rate of the port.")] = 115200,
) -> None:
    """Type G-code to a printer and read its answers; Ctrl-D ends it.

    Lines of a file or pipe are sent one at a time, each after the answer to the one before.
    """
    from v3dcad.printer.serial_link import SerialLink

    link = SerialLink(named(port), baud)
    try:
        _talk(link, sys.stdin)
    finally:
        link.close()


def named(port: str | None) -> str:
    """The port; `SettingError` where none was given, since none is chosen silently."""
    if port is None:
        raise SettingError("port", "no port: give --port; v3dcad ports lists them")
    return port


def _talk(link: Link, stream: TextIO) -> None:
    """Send each line of a stream and print what the printer says, to the stream's end.

    At a terminal lines are sent as they are typed. Otherwise each waits for the `ok` to the one
    before; raises `PrintError` (no answer) where none comes.
    """
    from v3dcad.printer.ends import End, PrintError
    from v3dcad.printer.replies import LineSplitter, Ok, parse

    typed: queue.SimpleQueue[str | None] = queue.SimpleQueue()

    def listen() -> None:
        # Not through `stream`: Python cannot end while a thread waits inside it.
        with open(stream.fileno(), "rb", buffering=0, closefd=False) as raw:
            for line in raw:
                typed.put(line.decode("latin-1"))
        typed.put(None)

    threading.Thread(target=listen, daemon=True).start()
    splitter = LineSplitter()
    waits = not stream.isatty()
    asked_at: float | None = None
    while True:
        for line in splitter.feed(link.read()):
            typer.echo("".join(one if one.isprintable() or one == "\t" else "?" for one in line))
            if any(isinstance(reply, Ok) for reply in parse(line)):
                asked_at = None
        if waits and asked_at is not None:
            if time.monotonic() > asked_at + LONGEST_WAIT:
                raise PrintError(End.NO_ANSWER, f"no ok came for {LONGEST_WAIT:.0f} s")
            continue
        try:
            command = typed.get_nowait()
        except queue.Empty:
            continue
        if command is None:
            return
        if command.strip():
            link.write(command.strip().encode("ascii", "replace") + b"\n")
            asked_at = time.monotonic()
