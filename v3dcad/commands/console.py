"""The console: lines to a printer, answers from it."""

from __future__ import annotations

import queue
import threading
import time
from typing import TextIO

import typer

from v3dcad.printer.drive import Link
from v3dcad.printer.ends import End, PrintError
from v3dcad.printer.replies import LineSplitter, Ok, parse

LONGEST_WAIT = 1800.0
"""Seconds that a line from a file or pipe is given to be answered; heating takes its time."""


def talk(link: Link, stream: TextIO) -> None:
    """Send each line of a stream and print what the printer says, to the stream's end.

    At a terminal lines are sent as they are typed. Otherwise each waits for the `ok` to the one
    before; raises `PrintError` (no answer) where none comes.
    """
    typed: queue.SimpleQueue[str | None] = queue.SimpleQueue()

    def listen() -> None:
        for line in stream:
            typed.put(line)
        typed.put(None)

    threading.Thread(target=listen, daemon=True).start()
    splitter = LineSplitter()
    waits = not stream.isatty()
    waiting_since: float | None = None
    while True:
        for line in splitter.feed(link.read()):
            typer.echo(line)
            if any(isinstance(reply, Ok) for reply in parse(line)):
                waiting_since = None
        if waits and waiting_since is not None:
            if time.monotonic() > waiting_since + LONGEST_WAIT:
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
            waiting_since = time.monotonic()
