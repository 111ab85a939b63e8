"""FreeCAD as a user has it: the add-on in a fresh user folder, v3dcad behind V3DCAD_PYTHON."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest
from hosts import freecad_or_skip

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "freecad_workbench" / "freecad" / "v3dcad_wb"
PICTURES = os.environ.get("V3DCAD_PICTURES")


@dataclass
class FreeCAD:
    """Starts FreeCAD in its own folders."""

    folder: Path
    python: Path

    def variables(self) -> dict[str, str]:
        """The environment of a user who has the add-on."""
        temporary = self.folder / "temporary"
        runtime = self.folder / "runtime"
        for one in (temporary, runtime):
            one.mkdir(exist_ok=True, mode=0o700)
        return {
            "HOME": str(self.folder),
            "PATH": os.environ["PATH"],
            "TMPDIR": str(temporary),
            "FREECAD_USER_HOME": str(self.folder / "home"),
            "XDG_RUNTIME_DIR": str(runtime),
            "XDG_CACHE_HOME": str(self.folder / "cache"),
            "NUMBA_CACHE_DIR": os.environ.get("NUMBA_CACHE_DIR", ""),
            "LC_ALL": "C.UTF-8",
            "QTWEBENGINE_DISABLE_SANDBOX": "1",
            "LIBGL_ALWAYS_SOFTWARE": "1",
            "V3DCAD_PYTHON": str(self.python),
            "V3DCAD_OUT": str(self.folder),
            "V3DCAD_SHOTS": str(self.pictures()),
        }

    def pictures(self) -> Path:
        """Where pictures go: V3DCAD_PICTURES, or the test's folder."""
        pictures = Path(PICTURES) if PICTURES else self.folder / "pictures"
        pictures.mkdir(exist_ok=True, parents=True)
        return pictures

    def command(self, *arguments: str, window: bool) -> list[str]:
        """The command line of FreeCAD, with a screen of its own where it has a window."""
        command = freecad_or_skip(window=window)
        if not window:
            return [command, *arguments]
        screen = ["xvfb-run", "-a", "-s", "-screen 0 1400x900x24 +extension GLX"]
        # Xvfb's own files cannot lie in a folder whose name has a space.
        temporary = ["env", f"TMPDIR={self.folder / 'temporary'}"]
        return [*screen, *temporary, command, *arguments]

    def run(self, *arguments: str, window: bool = False, code: int = 0, **extra: str | None) -> str:
        """Run FreeCAD and give what it said; `extra` are more variables, None removes one."""
        variables = {**self.variables(), "QT_QPA_PLATFORM": "xcb" if window else "offscreen"}
        if window:
            del variables["TMPDIR"]
        done = subprocess.run(
            self.command(*arguments, window=window),
            env=merged(variables, extra),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            encoding="utf-8",
            errors="replace",
            timeout=600,
            check=False,
        )
        said = re.sub(r"(\s*Recompute\.+|\s*\(\d+ %\)|\t)+", "", done.stdout)
        assert done.returncode == code, said
        return said

    def workers(self) -> list[str]:
        """Command lines of workers of this test's FreeCADs that are still there."""
        found = []
        for process in Path("/proc").glob("[0-9]*"):
            try:
                line = (process / "cmdline").read_bytes().replace(b"\0", b" ").decode()
            except OSError:
                continue
            if "v3dcad.worker" in line and str(self.folder) in line:
                found.append(line)
        return found

    def left(self) -> list[str]:
        """Temporary folders of the worker that are still there."""
        return [one.name for one in (self.folder / "temporary").glob("v3dcad-freecad-*")]


def merged(variables: Mapping[str, str], extra: Mapping[str, str | None]) -> dict[str, str]:
    """Variables with others on top; None removes one."""
    both = {**variables, **extra}
    return {name: value for name, value in both.items() if value is not None}


@pytest.fixture
def freecad(tmp_path: Path) -> FreeCAD:
    """FreeCAD with the add-on, in a path with a space and an umlaut."""
    folder = tmp_path / "a ü"
    mods = folder / "home" / "Mod"
    mods.mkdir(parents=True)
    (mods / "v3dcad").symlink_to(ROOT)
    python = folder / "python"
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    python.write_text(
        f'#!/bin/sh\nPYTHONPATH="{path}" exec "{sys.executable}" "$@"\n', encoding="utf-8"
    )
    python.chmod(0o755)
    return FreeCAD(folder, python)
