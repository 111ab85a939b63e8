"""Progress: one bar over all steps of a command on a terminal, one line in a pipe."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, TypeVar

from v3dcad.watched import Watched

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

T = TypeVar("T")


class Progress:
    """What a command is doing, on stderr.

    A terminal gets a bar over all `steps`, with the one under way and the time left as if they took
    equally long. Anything else gets the line `doing`, if there is one, as soon as the first step
    begins.
    """

    def __init__(self, doing: str = "", steps: int = 1) -> None:
        self.doing = doing
        self.steps = steps
        self.begun = 0
        self.current = doing
        self.bar: Bar | None = None

    def __enter__(self) -> Progress:
        if not sys.stderr.isatty():
            return self
        from rich import progress
        from rich.console import Console

        self.bar = progress.Progress(
            progress.TextColumn("{task.description}"),
            progress.BarColumn(),
            progress.TimeElapsedColumn(),
            progress.TimeRemainingColumn(),
            console=Console(stderr=True),
            transient=True,
        )
        self.task = self.bar.add_task(self.doing, total=float(self.steps))
        self.bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self.bar is not None:
            self.bar.stop()

    def start(self, what: str) -> None:
        """Begin the next step of the work."""
        self.begun += 1
        self.current = what
        self.step(what, 0, 1)

    def step(self, what: str, done: int, of: int) -> None:
        """Say what is done in the step under way, and how much of it is."""
        if self.bar is not None:
            share = self.begun - 1 + done / max(of, 1)
            self.bar.update(self.task, description=what, completed=share)
        else:
            self._tell()

    def count(self, what: str, total: int) -> Callable[[int], None]:
        """Begin a step of known length; the function moves the bar by so much."""
        self.start(what)
        done = 0

        def advance(by: int) -> None:
            nonlocal done
            done += by
            self.step(what, done, total)

        return advance

    def pause(self) -> None:
        """Take the bar away, so that something can be asked; `go_on` brings it back."""
        if self.bar is not None:
            self.bar.stop()

    def go_on(self) -> None:
        """Show the bar again."""
        if self.bar is not None:
            self.bar.start()

    def watch(self, layers: Sequence[T]) -> Sequence[T]:
        """The same layers or sections; going through them moves the bar."""

        def passed(done: int) -> None:
            self.step(self.current, done, len(layers))

        return Watched(layers, passed)

    def _tell(self) -> None:
        """The line in a pipe, once."""
        if self.doing:
            print(self.doing, file=sys.stderr, flush=True)
        self.doing = ""
