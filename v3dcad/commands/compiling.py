"""The first start: two processes compile what a command needs, and it is told."""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
from collections.abc import Sequence
from importlib import import_module

OURS = (
    "v3dcad.geometry.power_diagram.kinetic_triangulation",
    "v3dcad.structure.sweep.layer_loop",
    "v3dcad.structure.fill",
    "v3dcad.structure.wall_distance",
)
"""Modules of the engine in the order in which this process loads them, and so compiles what
numba's cache has not; and"""
THEIRS = (
    "v3dcad.geometry.clipping.ring_validity",
    "v3dcad.geometry.clipping.update",
    "v3dcad.geometry.clipping.planar_graph",
    "v3dcad.structure.wall_distance",
)
"""those that meanwhile a second process compiles: needed last, and as much work."""

NOTICE = "compiling the engine: half a minute, once"

SLICING = ("v3dcad.geometry.surface.section", "v3dcad.geometry.surface.gaps")
"""What it then compiles: for the sections of a STEP part, which come after the engine is loaded."""


def load_engine() -> None:
    """Load the engine; where that means to compile it, by two processes."""
    tell_of_compiling(*THEIRS, *SLICING)
    for module in OURS:
        import_module(module)


def tell_of_compiling(*beside: str) -> None:
    """From now on say on stderr, once, should something be compiled: it takes a while.

    Then, too, have a second process load some modules `beside`, and so compile them. To be called
    before anything is loaded that is compiled.
    """
    from numba.core import event

    class FirstCompilation(event.Listener):
        begun = False

        def on_start(self, _: object) -> None:
            if not self.begun:
                self.begun = True
                print(NOTICE, file=sys.stderr, flush=True)
                if beside and (os.cpu_count() or 1) > 1:
                    _load_beside(beside)

        def on_end(self, _: object) -> None: ...

    event.register("numba:compile", FirstCompilation())  # type: ignore[no-untyped-call]


def _load_beside(modules: Sequence[str]) -> None:
    """Have another process load modules, which fills numba's cache; it ends with this one."""
    code = f"import sys; sys.path = {sys.path!r}; import {', '.join(modules)}"
    silent = subprocess.DEVNULL
    helper = subprocess.Popen(
        [sys.executable, "-c", code], stdin=silent, stdout=silent, stderr=silent
    )
    atexit.register(helper.terminate)
