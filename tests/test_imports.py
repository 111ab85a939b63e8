"""The house's import rules, read from the source; and what start-up loads."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parent.parent / "v3dcad"

RIM = {"kernel", "formats", "printer", "view"}
INSIDE = {"geometry", "model", "settings", "errors"}
MAY_IMPORT = {
    "errors": set(),
    "settings": {"errors"},
    "model": {"errors", "settings"},
    "files": {"errors"},
    "geometry": INSIDE,
    "structure": INSIDE | {"structure"},
    "toolpath": INSIDE | {"toolpath"},
    **{folder: INSIDE | {folder} for folder in RIM},
    "parts": INSIDE | {"formats", "kernel"},
    "slicing": INSIDE | {"files", "formats", "kernel", "parts", "structure"},
    "recipes": INSIDE | {"formats", "kernel", "parts"},
    "ont": INSIDE | {"pipeline", "recipes"},
    "version": set(),
    "forms": INSIDE | RIM | {"files"},
    "adapters": INSIDE | {"adapters", "forms", "kernel", "pipeline"},
    "report": INSIDE | {"formats", "structure", "toolpath"},
    "pipeline": INSIDE
    | RIM
    | {"files", "forms", "parts", "recipes", "report", "structure", "toolpath", "version"},
    "options": {"settings"},
    "commands": INSIDE
    | {
        "commands",
        "files",
        "formats",
        "ont",
        "options",
        "parts",
        "pipeline",
        "printer",
        "recipes",
        "report",
        "slicing",
        "structure",
        "warm_up",
    },
    "warm_up": {"formats", "kernel", "parts", "pipeline"},
    "cli": {"commands", "errors"},
    "__init__": INSIDE | {"parts", "pipeline", "recipes", "slicing", "structure"},
}

HOSTS = {"build123d", "cadquery"}

MODULES = sorted(PACKAGE.rglob("*.py"))


def imported(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names.add(node.module or "")
    return names


def room(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_run_downward(path: Path) -> None:
    for name in imported(path):
        words = name.split(".")
        if words[0] == "v3dcad":
            assert words[1] in MAY_IMPORT[room(path)], f"{room(path)} imports {name}"
        elif words[0] == "OCP":
            assert room(path) == "kernel", f"{path} imports OCP outside the kernel folder"
        else:
            assert room(path) == "adapters" or words[0] not in HOSTS, f"{path} imports {name}"


def loaded_by(code: str) -> set[str]:
    show = "import sys; print(' '.join({name.split('.')[0] for name in sys.modules}))"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\n{show}"], capture_output=True, encoding="utf-8", check=True
    )
    return set(done.stdout.splitlines()[-1].split())


HEAVY = {"OCP", "numba", "matplotlib", "scipy", "shapely", "build123d", "cadquery"}


def test_import_loads_nothing_heavy() -> None:
    assert not loaded_by("import v3dcad") & HEAVY


def test_help_loads_nothing_heavy_not_even_numpy() -> None:
    code = """
import sys
from v3dcad.cli import app
for words in (["--help"], ["fill", "--help"], ["slice", "--help"]):
    try:
        app(words)
    except SystemExit as stop:
        assert not stop.code
"""
    assert not loaded_by(code) & (HEAVY | {"numpy"})


def test_stl_needs_no_kernel(samples: Path, tmp_path: Path) -> None:
    loaded = loaded_by(
        "import v3dcad\n"
        f"structure = v3dcad.fill({str(samples / 'pyramid.stl')!r}, layer_height=5, sites=9)\n"
        f"structure.write_ont({str(tmp_path / 'a.ont')!r})\n"
        f"structure.write_gcode({str(tmp_path / 'a.gcode')!r})"
    )
    assert "OCP" not in loaded


def test_every_public_name_is_there() -> None:
    import v3dcad

    assert sorted(v3dcad.__all__) == sorted(v3dcad._HOME)
    for name in v3dcad.__all__:
        assert getattr(v3dcad, name).__doc__
    with pytest.raises(AttributeError, match="fil_"):
        v3dcad.fil_  # noqa: B018
