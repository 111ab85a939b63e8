"""Compiling made quicker: what surrounds numba while it compiles a function of ours."""

from __future__ import annotations

import gc
from typing import Any

from numba.core import config as _config
from numba.core import event

LEVEL = 1
"""LLVM's level of optimisation: quicker than its third by a tenth of all compiling, and what it
makes of the engine runs as fast."""

config: Any = _config


class _Hastener(event.Listener):
    """Sets numba's level, and lets the garbage collector rest, which would go through millions of
    lasting objects again and again, a fifth of the time.
    """

    def __init__(self, package: str) -> None:
        self._prefix = package + "."
        self._running: list[bool] = []
        self._collects, self._level = False, config.OPT

    def on_start(self, started: Any) -> None:
        ours = started.data["dispatcher"].py_func.__module__.startswith(self._prefix)
        if ours and not any(self._running):
            self._collects, self._level = gc.isenabled(), config.OPT
            gc.disable()
            config.OPT = type(config.OPT)(LEVEL)
        self._running.append(ours)

    def on_end(self, _: object) -> None:
        if self._running.pop() and not any(self._running):
            config.OPT = self._level
            if self._collects:
                gc.enable()


def hasten_compiling(package: str) -> None:
    """From now on have numba compile the functions of a package quickly; no others."""
    event.register("numba:compile", _Hastener(package))
