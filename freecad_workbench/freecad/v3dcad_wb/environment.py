# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Which Python runs v3dcad, and how an environment for it is made.

Nothing here opens a window or starts by itself: `setup_dialog.py` asks first.
"""

from __future__ import annotations

import os
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

from .places import PINS, PREFERENCES, source_beside, user_folder
from .qt import tr

STRIPPED = ("PYTHONHOME", "PYTHONPATH", "LD_LIBRARY_PATH", "QT_PLUGIN_PATH", "PYTHONSTARTUP")
"""What FreeCAD's own Python and libraries need, and another Python must not see."""
LOAD = 0.3
ON_DISK = 1.0
"""GB to load and on disk."""
OLDEST, NEWEST = (3, 11), (3, 14)
CHECK = "import v3dcad.worker"


@dataclass(frozen=True)
class Step:
    """One command of a set-up."""

    title: str
    program: str
    arguments: list[str]


def child_environment() -> dict[str, str]:
    """The environment variables that a child process gets."""
    kept = {name: value for name, value in os.environ.items() if name not in STRIPPED}
    return {**kept, "PYTHONUTF8": "1", "PYTHONUNBUFFERED": "1"}


def folder() -> Path:
    """The environment that the workbench makes itself."""
    return user_folder() / "environment"


def python_in(environment: Path) -> Path:
    """The Python of an environment."""
    windows = sys.platform == "win32"
    return environment / ("Scripts/python.exe" if windows else "bin/python")


def python() -> str | None:
    """The Python that runs v3dcad; None before the set-up.

    `V3DCAD_PYTHON` goes before the preference, which goes before the environment made here.
    """
    named = os.environ.get("V3DCAD_PYTHON") or PREFERENCES.GetString("Python", "")
    if named:
        return named
    return str(python_in(folder())) if finished_mark().is_file() else None


def finished_mark() -> Path:
    """A file that is there once a set-up has ended well."""
    return folder() / "v3dcad-is-ready"


def missing() -> str | None:
    """Why v3dcad cannot be started, in words; None if it can."""
    found = python()
    if found is None:
        return tr("v3dcad is not set up yet: choose Voronoi 3D → Set up")
    if shutil.which(found) is None:
        return tr("{python} is not there: choose Voronoi 3D → Set up").format(python=found)
    return None


def base_pythons() -> list[str]:
    """Interpreters that an environment can be based on, best first; FreeCAD's own only as a file.

    `sys.executable` is FreeCAD itself. The Python of an AppImage is left out: its path changes.
    """
    names = [f"python3.{minor}" for minor in (13, 12, 11, 14)] + ["python3", "python"]
    found = [shutil.which(name) for name in names]
    if "APPIMAGE" not in os.environ:
        own = Path(sys.prefix) / ("python.exe" if sys.platform == "win32" else "bin/python3")
        found.append(str(own) if own.is_file() else None)
    return list(dict.fromkeys(path for path in found if path))


def check_base(program: str) -> Step:
    """Whether a Python is new enough and can make environments."""
    code = (
        "import sys\n"
        f"if not {OLDEST} <= sys.version_info[:2] <= {NEWEST}: sys.exit('wrong version')\n"
        "import venv, ensurepip"
    )
    return Step(tr("Looking for Python"), program, ["-c", code])


def steps(base: str) -> list[Step]:
    """What makes the environment from nothing, or anew."""
    own = str(python_in(folder()))
    pip = ["-m", "pip", "--disable-pip-version-check", "install"]
    return [
        Step(tr("Making the environment"), base, ["-m", "venv", "--clear", str(folder())]),
        Step(
            tr("Loading and installing v3dcad"),
            own,
            [*pip, "--constraint", str(PINS), f"{source_beside() or 'v3dcad'}[occt]"],
        ),
        Step(tr("Compiling the engine"), own, ["-m", "v3dcad", "warm-up"]),
    ]


def reset() -> None:
    """Remove the environment that was made here, and forget the preference."""
    shutil.rmtree(folder(), ignore_errors=True)
    PREFERENCES.SetString("Python", "")


def in_words(output: str, *, killed: bool) -> str:
    """What went wrong in a set-up, from what the command said last."""
    causes = {
        ("No space left", "Errno 28", "not enough space"): tr(
            "The disk is full. Make room for {size} GB and choose Repair."
        ).format(size=ON_DISK),
        ("ensurepip", "python3-venv", "No module named venv"): tr(
            "Python cannot make environments. On Debian and Ubuntu: sudo apt install python3-venv"
        ),
        ("wrong version",): tr("v3dcad needs Python {oldest} to {newest}. Install one.").format(
            oldest="3.11", newest="3.14"
        ),
        (
            "Temporary failure in name resolution",
            "Name or service not known",
            "NewConnectionError",
            "Network is unreachable",
            "ConnectTimeout",
            "ProxyError",
            "Connection refused",
            "getaddrinfo failed",
            "(from versions: none)",
        ): tr("The package index cannot be reached. Is there a network? Then choose Repair."),
        ("Permission denied", "Errno 13"): tr("The folder may not be written to: {folder}").format(
            folder=folder()
        ),
    }
    for signs, words in causes.items():
        if any(sign in output for sign in signs):
            return words
    if killed:
        return tr("The set-up was ended from outside; perhaps memory ran out. Choose Repair.")
    lines = [line for line in output.splitlines() if line.strip()]
    lines = [line for line in lines if line.startswith("ERROR")] or lines
    return lines[-1].strip() if lines else tr("The command ended without a word.")
