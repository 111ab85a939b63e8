"""Progress on a terminal, nothing in a pipe."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from v3dcad.watched import Watched

T = TypeVar("T")


class Progress:
    """A bar that shows the step of the work and how far it is."""

    def __enter__(self) -> Progress:
        from rich import progress
        from rich.console import Console

        console = Console(stderr=True)
        self.bar = progress.Progress(
            progress.TextColumn("{task.description}"),
            progress.BarColumn(),
            progress.TimeElapsedColumn(),
            progress.TimeRemainingColumn(),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self.task = self.bar.add_task("", total=None)
        self.bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.bar.stop()

    def start(self, what: str) -> None:
        """Begin a step of the work whose length is not known yet."""
        self.bar.reset(self.task, total=None, description=what)

    def count(self, what: str, total: int) -> Callable[[int], None]:
        """Begin a step of known length; the function moves the bar by so much."""
        self.bar.reset(self.task, total=total, description=what)
        return lambda done: self.bar.advance(self.task, done)

    def step(self, what: str, done: int, of: int) -> None:
        """Show a step of the work, and how much of it is done."""
        self.bar.update(self.task, description=what, completed=done, total=of if of > 1 else None)

    def pause(self) -> None:
        """Take the bar away, so that something can be asked; `go_on` brings it back."""
        self.bar.stop()

    def go_on(self) -> None:
        """Show the bar again."""
        self.bar.start()

    def watch(self, layers: Sequence[T]) -> Sequence[T]:
        """The same layers or sections; going through them moves the bar."""

        def passed(done: int) -> None:
            self.bar.update(self.task, total=len(layers), completed=done)

        return Watched(layers, passed)
