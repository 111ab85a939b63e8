"""How a print under way is shown: live on a terminal, as lines in a pipe, as JSON for a program."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from rich.table import Table

    from v3dcad.printer.progress import Snapshot

EVERY = 1.0
"""Seconds between two looks at a print, live or in JSON."""
MOST_UNREAD = 1000
"""Things that wait to be shown where nobody reads; later ones are left out."""
OLD = 10
"""Things that wait to be shown, after which progress is left out until they are."""
LAST_WORD = 2.0
"""Seconds that are given at the end to what still waits to be shown."""
HELP = "p pause   r resume   c cancel   s EMERGENCY STOP   + - speed   < > flow"


@dataclass(frozen=True, slots=True)
class Extent:
    """How much there is to print."""

    name: str
    size: int
    """bytes of the file"""
    commands: int
    layers: int
    seconds: float
    """estimated time without heating"""


@dataclass(frozen=True, slots=True)
class Sight:
    """A snapshot, and what follows from it."""

    snapshot: Snapshot
    extent: Extent
    elapsed: float
    """seconds since the start"""

    @property
    def percent(self) -> float:
        """Share of the file that is acknowledged."""
        return 100 * self.snapshot.offset / self.extent.size

    @property
    def seconds_left(self) -> float:
        """By the file's own M73 where it has them, otherwise by the estimate."""
        if self.snapshot.minutes_left is not None:
            return 60 * self.snapshot.minutes_left
        return self.extent.seconds * (1 - self.percent / 100)


class View(Protocol):
    """Shows a print."""

    def __enter__(self) -> View:
        """Begin to show."""

    def __exit__(self, *_: object) -> None:
        """End it."""

    def say(self, event: str, **values: Any) -> None:
        """Tell of something that happened once."""

    def show(self, sight: Sight) -> None:
        """Show how far the print is; called every `EVERY` seconds and at the end."""


class Aside:
    """Has another view show a print, in a thread of its own.

    Writing waits as long as nobody reads: a window that computes, a pager, a terminal stopped with
    Ctrl-S. The print does not wait for it. Where nobody can read any more, as when the program that
    started the print has crashed, it goes on untold.
    """

    def __init__(self, view: View) -> None:
        self._view = view
        self._todo: queue.Queue[Callable[[], None] | None] = queue.Queue(MOST_UNREAD)
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> Aside:
        self._view.__enter__()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(queue.Full):
            self._todo.put(None, timeout=LAST_WORD)
        self._thread.join(LAST_WORD)

    def say(self, event: str, **values: Any) -> None:
        """One event."""
        with contextlib.suppress(queue.Full):
            self._todo.put_nowait(lambda: self._view.say(event, **values))

    def show(self, sight: Sight) -> None:
        """Progress; left out while what was told before is not read, since it grows old."""
        if self._todo.qsize() < OLD or sight.snapshot.end is not None:
            with contextlib.suppress(queue.Full):
                self._todo.put_nowait(lambda: self._view.show(sight))

    def _run(self) -> None:
        with contextlib.suppress(OSError):
            while todo := self._todo.get():
                todo()
            self._view.__exit__()


class JsonView:
    """One JSON object a line on standard output; docs/printing.md lists them."""

    def __enter__(self) -> JsonView:
        return self

    def __exit__(self, *_: object) -> None: ...

    def say(self, event: str, **values: Any) -> None:
        """One event."""
        _write(json.dumps({"event": event, **values}))

    def show(self, sight: Sight) -> None:
        """Progress."""
        now = sight.snapshot
        self.say(
            "progress",
            phase=now.phase,
            percent=round(sight.percent, 2),
            line=now.line,
            lines=sight.extent.commands,
            layer=now.layer,
            layers=sight.extent.layers,
            height_mm=now.height,
            elapsed_s=round(sight.elapsed, 1),
            left_s=round(sight.seconds_left),
            temperatures={
                name: {"is": has, "wanted": wants}
                for name, (has, wants) in sorted(now.temperatures.items())
            },
            doing=now.doing,
            speed=now.speed,
            flow=now.flow,
            resent=now.resent,
        )


class PlainView:
    """A line for each layer, phase and event, for logs."""

    def __init__(self) -> None:
        self._last: tuple[object, ...] = ()

    def __enter__(self) -> PlainView:
        return self

    def __exit__(self, *_: object) -> None: ...

    def say(self, event: str, **values: Any) -> None:
        """One event."""
        _write(f"{event:<12}  {told(values)}")

    def show(self, sight: Sight) -> None:
        """Progress, when layer or phase have changed."""
        now = sight.snapshot
        if (now.phase, now.layer) != self._last:
            self._last = (now.phase, now.layer)
            _write(f"{now.phase:<12}  {summary(sight)}")


class LiveView:
    """A small table that is kept up to date, with the keys below."""

    def __enter__(self) -> LiveView:
        from rich.console import Console
        from rich.live import Live

        self._live = Live(console=Console(stderr=True), auto_refresh=False, transient=True)
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def say(self, event: str, **values: Any) -> None:
        """One event, above the table."""
        self._live.console.print(f"{event:<12}  {told(values)}", markup=False, highlight=False)

    def show(self, sight: Sight) -> None:
        """Progress."""
        self._live.update(self._table(sight), refresh=True)

    def _table(self, sight: Sight) -> Table:
        from rich.progress_bar import ProgressBar
        from rich.table import Table

        now = sight.snapshot
        table = Table.grid(padding=(0, 2))
        table.add_row(str(now.phase) + (f" ({now.doing})" if now.doing else ""), sight.extent.name)
        table.add_row(f"{sight.percent:5.1f} %", ProgressBar(completed=sight.percent, width=40))
        table.add_row("", summary(sight))
        overrides = f"speed {now.speed} %, flow {now.flow} %, lines sent again {now.resent}"
        table.add_row("", overrides)
        table.add_row("", HELP)
        return table


def _write(text: str) -> None:
    """A line on standard output.

    Without `print`, whose buffer has a lock: Python cannot end while a thread that waits has it.
    """
    data = (text + "\n").encode(sys.stdout.encoding, "backslashreplace")
    while data:
        data = data[os.write(sys.stdout.fileno(), data) :]


def told(values: dict[str, Any]) -> str:
    """An event's values in words: a text as it is, of others name and value."""
    return ", ".join(
        f"{value}" if name in ("text", "end") else f"{name} {value}"
        for name, value in values.items()
        if value not in ("", None)
    )


def summary(sight: Sight) -> str:
    """Layer, percent, time left and temperatures in one line."""
    now = sight.snapshot
    words = [
        f"layer {now.layer}/{sight.extent.layers}",
        f"{sight.percent:.1f} %",
        f"{span(sight.seconds_left)} left",
    ]
    for name, (has, wants) in sorted(now.temperatures.items()):
        words.append(f"{name} {has:.0f}" + ("" if wants is None else f"/{wants:.0f}") + " °C")
    return ", ".join(words)


def span(seconds: float) -> str:
    """A duration as hours and minutes."""
    hours, minutes = divmod(max(0, round(seconds / 60)), 60)
    return f"{hours} h {minutes:02d} min"
