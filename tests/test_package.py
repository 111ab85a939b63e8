"""What `pip wheel .` makes: it holds all that the package is, and runs outside the checkout."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "v3dcad"


def files_in(package: Path) -> set[str]:
    """Every file of the package, by its path beside it."""
    files = (path.relative_to(package.parent) for path in package.rglob("*") if path.is_file())
    return {path.as_posix() for path in files if "__pycache__" not in path.parts}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from a copy, so that nothing is left beside the sources."""
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "source"
    shutil.copytree(PACKAGE, source / "v3dcad", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    words = ["pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(folder), str(source)]
    subprocess.run([sys.executable, "-m", *words], check=True, capture_output=True)
    (made,) = folder.glob("*.whl")
    return made


def test_the_wheel_holds_every_file_of_the_package(wheel: Path) -> None:
    held = {name for name in zipfile.ZipFile(wheel).namelist() if name.startswith("v3dcad/")}
    assert held == files_in(PACKAGE)
    assert {"v3dcad/profiles/ender3v2.toml", "v3dcad/structure/foam/tiles.npz"} <= held


def test_the_wheel_fills_a_part_outside_the_checkout(
    wheel: Path, samples: Path, tmp_path: Path
) -> None:
    installed = tmp_path / "site"
    zipfile.ZipFile(wheel).extractall(installed)
    # The sources are the same to the byte, so what numba has compiled of them holds: it compares
    # their times. Compiling anew would take most of a minute, and is not what is tested.
    for path in PACKAGE.rglob("*.py"):
        shutil.copystat(path, installed / path.relative_to(ROOT))
    for caches in PACKAGE.rglob("__pycache__"):
        shutil.copytree(caches, installed / caches.relative_to(ROOT))
    outside = {"cwd": tmp_path, "env": {**os.environ, "PYTHONPATH": str(installed)}}
    words = ["fill", str(samples / "pyramid.stl"), "--out", "out", "--layer-height", "0.4"]
    done = subprocess.run(
        [sys.executable, "-m", "v3dcad", *words, "--profile", "prusa-mk4"],
        capture_output=True, encoding="utf-8", **outside,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    made = {path.suffix for path in (tmp_path / "out").iterdir()}
    assert made == {".ont", ".gcode", ".step", ".png", ".json"}
    show = [sys.executable, "-c", "import v3dcad; print(v3dcad.__file__)"]
    where = subprocess.run(show, capture_output=True, encoding="utf-8", check=True, **outside)
    assert Path(where.stdout.strip()).is_relative_to(installed)
