"""The first start: several processes compile what a command needs, and it is told."""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
from collections.abc import Sequence
from importlib import import_module

from v3dcad.warm_up import share

NOTICE = "compiling the engine: half a minute, once"

MOST_HELPERS = 5
"""Processes that help to compile, at most: each takes 200 MB."""


def load_engine(modules: Sequence[str]) -> None:
    """Load the engine; should it have to be compiled, have all processors share these modules."""
    tell_of_compiling(modules)
    import_module("v3dcad.structure.fill")


def tell_of_compiling(modules: Sequence[str] = ()) -> None:
    """From now on say on stderr, once, should something be compiled: it takes a while.

    Then, too, other processes compile modules, the last of them first, until all are done: this
    one needs the first of them first. To be called before anything is loaded that is compiled.
    """
    from numba.core import event

    class FirstCompilation(event.Listener):
        begun = False

        def on_start(self, _: object) -> None:
            if not self.begun:
                self.begun = True
                print(NOTICE, file=sys.stderr, flush=True)
                if modules:
                    _start_helpers(modules)

        def on_end(self, _: object) -> None: ...

    event.register("numba:compile", FirstCompilation())  # type: ignore[no-untyped-call]


def _start_helpers(modules: Sequence[str]) -> None:
    """Have other processes compile modules, which fills numba's cache; they end with this one."""
    count = min((os.cpu_count() or 1) - 1, MOST_HELPERS)
    if not count:
        return
    queue = share(modules)
    code = (
        f"import sys; sys.path = {sys.path!r}; from v3dcad.warm_up import warm_up_shared; "
        f"warm_up_shared({tuple(modules)!r})"
    )
    for _ in range(count):
        helper = subprocess.Popen(
            [sys.executable, "-c", code],
            stdin=queue, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        atexit.register(helper.terminate)
    os.close(queue)
