"""What a person, or a program, tells a print that is under way."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import signal
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TextIO

KEYS = {"p": "pause", "r": "resume", "c": "cancel", "s": "stop", "y": "yes", "n": "no"}
MORE_KEYS = {"+": ("speed", 5), "-": ("speed", -5), ">": ("flow", 1), "<": ("flow", -1)}
"""Keys that change an override, and by how many %."""
CANCELLING = [
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
]
"""Signals that ask for an end; Windows has no SIGHUP."""
IGNORED = [signal.SIGTSTP] if hasattr(signal, "SIGTSTP") else []
"""What Ctrl-Z sends."""
LONGEST = 4096
"""Bytes of a wish; of a longer line each piece is a mistake."""
DOES = {"pause", "resume", "cancel", "stop"}
SETS = {"speed", "flow"}


@dataclass(frozen=True, slots=True)
class Wish:
    """One thing that is wanted."""

    do: str
    """pause, resume, cancel, stop, speed, flow; yes, no; or `mistake`"""
    percent: int = 0
    relative: bool = False
    text: str = ""
    """what is wrong, of a mistake"""


class Controls:
    """A queue of wishes that other threads and signals fill."""

    def __init__(self) -> None:
        self._wishes: queue.SimpleQueue[Wish] = queue.SimpleQueue()

    def put(self, wish: Wish) -> None:
        """Add a wish."""
        self._wishes.put(wish)

    def take(self) -> list[Wish]:
        """The wishes since the last call."""
        wishes = []
        with contextlib.suppress(queue.Empty):
            while True:
                wishes.append(self._wishes.get_nowait())
        return wishes


def wish_of(line: str) -> Wish:
    """What a line of JSON asks for: {"do": "pause"}, {"do": "speed", "percent": 90}."""
    try:
        asked: Any = json.loads(line)
        do = asked["do"]
        if do in DOES:
            return Wish(do)
        if do in SETS and isinstance(asked["percent"], int):
            return Wish(do, asked["percent"])
    except (ValueError, TypeError, KeyError, RecursionError):
        pass
    known = ", ".join(sorted(DOES | SETS))
    return Wish("mistake", text=f'{line.strip()[:80]}: write {{"do": …}} with one of {known}')


@contextlib.contextmanager
def listening(*, as_json: bool) -> Iterator[Controls]:
    """Controls that hear Ctrl-C, SIGTERM and a closed terminal as cancel, and standard input.

    Ctrl-Z is ignored: a host that stands still leaves a hot nozzle on the part.

    Standard input is JSON lines for a program, single keys at a terminal, and otherwise not read.
    A second Ctrl-C breaks off at once (KeyboardInterrupt).
    """
    controls = Controls()

    def cancel(*_: object) -> None:
        controls.put(Wish("cancel"))
        signal.signal(signal.SIGINT, signal.default_int_handler)

    before = {number: signal.signal(number, cancel) for number in CANCELLING}
    for number in IGNORED:
        before[number] = signal.signal(number, signal.SIG_IGN)
    try:
        with _keys(sys.stdin) if not as_json else contextlib.nullcontext(False) as keys:
            if as_json or keys:
                # Not through `sys.stdin`: Python cannot end while a thread waits inside it.
                words = (sys.stdin.fileno(), controls)
                target = _hear_json if as_json else _hear_keys
                threading.Thread(target=target, args=words, daemon=True).start()
            yield controls
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _hear_json(stdin: int, controls: Controls) -> None:
    with open(stdin, "rb", buffering=0, closefd=False) as stream:
        while line := stream.readline(LONGEST):
            if line.strip():
                controls.put(wish_of(line.decode(errors="replace")))


def _hear_keys(stdin: int, controls: Controls) -> None:
    """Keys as they arrive. What begins with Escape is an arrow or the like, whose last letter may
    be a c or an s.
    """
    with contextlib.suppress(OSError):  # the terminal is gone
        while keys := os.read(stdin, LONGEST).decode(errors="replace"):
            for key in keys if not keys.startswith("\x1b") else "":
                if key in KEYS:
                    controls.put(Wish(KEYS[key]))
                elif key in MORE_KEYS:
                    do, percent = MORE_KEYS[key]
                    controls.put(Wish(do, percent, relative=True))


@contextlib.contextmanager
def _keys(stream: TextIO) -> Iterator[bool]:
    """Have keys arrive one by one and unseen; yields whether there are keys to hear."""
    try:
        import termios
        import tty
    except ImportError:  # Windows: a key counts when Enter follows
        yield stream.isatty()
        return
    if not stream.isatty():
        yield False
        return
    before = termios.tcgetattr(stream)
    try:
        tty.setcbreak(stream)
        yield True
    finally:
        with contextlib.suppress(termios.error):  # the terminal is gone
            termios.tcsetattr(stream, termios.TCSADRAIN, before)
