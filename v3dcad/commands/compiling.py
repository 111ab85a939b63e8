"""What a terminal is told while numba compiles."""

from __future__ import annotations

import sys


def announce_compiling() -> None:
    """From now on say on a terminal, once, that something is being compiled: it takes a while.

    To be called before the engine is loaded, which compiles it where numba's cache has it not.
    """
    if not sys.stderr.isatty():
        return
    from numba.core import event

    class Announcer(event.Listener):
        said = False

        def on_start(self, _: object) -> None:
            if not self.said:
                print("compiling the engine: a minute or more, once", file=sys.stderr, flush=True)
            self.said = True

        def on_end(self, _: object) -> None: ...

    event.register("numba:compile", Announcer())  # type: ignore[no-untyped-call]
