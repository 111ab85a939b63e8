"""How a print under way is shown: live on a terminal, as lines in a pipe, as JSON for a program."""

from __future__ import annotations

import json
import os
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import typer

if TYPE_CHECKING:
    from rich.table import Table

    from v3dcad.printer.progress import Snapshot

EVERY = 1.0
"""Seconds between two looks at a print, live or in JSON."""
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


class JsonView:
    """One JSON object a line on standard output; docs/printing.md lists them.

    Where nobody reads any more, as when the program that started the print has crashed, the print
    goes on untold.
    """

    def __enter__(self) -> JsonView:
        return self

    def __exit__(self, *_: object) -> None: ...

    def say(self, event: str, **values: Any) -> None:
        """One event."""
        try:
            typer.echo(json.dumps({"event": event, **values}))
        except BrokenPipeError:
            sys.stdout = open(os.devnull, "w")  # noqa: SIM115, lives as long as the process

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
        typer.echo(f"{event:<12}  {told(values)}")

    def show(self, sight: Sight) -> None:
        """Progress, when layer or phase have changed."""
        now = sight.snapshot
        if (now.phase, now.layer) != self._last:
            self._last = (now.phase, now.layer)
            typer.echo(f"{now.phase:<12}  {summary(sight)}")


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
