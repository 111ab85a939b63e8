"""What each extra installs: `python -m benchmarks.installing [EXTRAS …]`.

Makes fresh environments with pip, with `pip --no-compile`, and with uv where it is on the path,
installs this checkout with each set of extras, and prints a table: seconds by the clock and of the
processor, MB on disk without pip and setuptools, and what can be imported. Nothing is taken from a
cache. Extras that are joined by a comma, as `build123d,cadquery`, are one set.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parent.parent
SETS = ("", "occt", "build123d", "cadquery", "build123d,cadquery", "test")
IMPORTED = ("v3dcad", "OCP.gp", "build123d", "cadquery")
INSTALLER = {"pip", "setuptools", "pkg_resources", "_distutils_hack"}
"""What is in a new environment before anything is installed."""
MANAGERS = {
    "pip": "{python} -m pip install --quiet --no-cache-dir",
    "pip --no-compile": "{python} -m pip install --quiet --no-cache-dir --no-compile",
    "uv": "uv pip install --quiet --no-cache --python {python}",
}


def install(manager: str, python: Path, target: str) -> tuple[float, float]:
    """Install into the environment of a Python; seconds by the clock, and of the processor."""
    command = [word.format(python=python) for word in MANAGERS[manager].split()]
    begun, before = time.perf_counter(), os.times()
    subprocess.run([*command, target], cwd=ROOT, check=True, stderr=subprocess.DEVNULL)
    after = os.times()
    used = sum(after[2:4]) - sum(before[2:4])  # of children, in the system's name too
    return time.perf_counter() - begun, used


def size(packages: Path) -> float:
    """MB (2²⁰ bytes) on disk of what was installed."""
    blocks = 0
    for path in packages.rglob("*"):
        if path.relative_to(packages).parts[0].split("-")[0] not in INSTALLER:
            blocks += path.lstat().st_blocks
    return blocks * 512 / 2**20


def can_import(python: Path, module: str) -> bool:
    """Whether a fresh process imports a module without an error."""
    words = [str(python), "-W", "ignore", "-c", f"import {module}"]
    return not subprocess.run(words, cwd="/", capture_output=True).returncode


def main() -> None:
    """Print the table, a row as soon as it is measured."""
    print(
        "| extras | with | s | processor, s | MB |", *(f" `{name}` |" for name in IMPORTED), sep=""
    )
    print("|---|---|---|---|---|", "---|" * len(IMPORTED), sep="")
    for extras in sys.argv[1:] or SETS:
        for manager in MANAGERS:
            if manager == "uv" and not shutil.which("uv"):
                continue
            with TemporaryDirectory() as folder:
                subprocess.run([sys.executable, "-m", "venv", folder], check=True)
                python = Path(folder, "Scripts" if os.name == "nt" else "bin", "python")
                clock, used = install(manager, python, f".[{extras}]" if extras else ".")
                (packages,) = Path(folder).rglob("site-packages")
                cells = [f"`[{extras}]`" if extras else "none", manager]
                cells += [f"{clock:.0f}", f"{used:.0f}", f"{size(packages):.0f}"]
                cells += ["yes" if can_import(python, module) else "no" for module in IMPORTED]
                print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
