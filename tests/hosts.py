"""Programs and libraries that v3dcad is at home in, where they are installed and whole."""

from __future__ import annotations

import shutil
import warnings
from types import ModuleType

import pytest


def cadquery_or_skip() -> ModuleType:
    """CadQuery; skips where it cannot be imported, saying why.

    It may be absent, or be there with an OCP that lacks what it needs: build123d's, which was
    installed over its own. That fails with whatever error comes first.
    """
    try:
        with warnings.catch_warnings(action="ignore"):
            import cadquery
    except Exception as error:
        pytest.skip(f"needs the extra [cadquery]: {error!r}", allow_module_level=True)
    return cadquery


def freecad_or_skip(*, window: bool = False) -> str:
    """The command that starts FreeCAD, with a window or without; skips where there is none."""
    names = ("freecad", "FreeCAD") if window else ("freecadcmd", "FreeCADCmd", "freecad.cmd")
    command = next(filter(None, map(shutil.which, names)), None)
    if command is None or (window and shutil.which("xvfb-run") is None):
        pytest.skip("FreeCAD or Xvfb is not installed: apt-get install freecad xvfb")
    return command
