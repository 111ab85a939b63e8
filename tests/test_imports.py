"""The house's import rules, read from the source; and what start-up loads."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parent.parent / "v3dcad"

RIM = {"kernel", "formats", "printer", "view"}
INSIDE = {"geometry", "model", "settings", "arguments", "errors", "words"}
MAY_IMPORT = {
    "errors": set(),
    "words": set(),
    "settings": {"errors"},
    "svg": set(),
    "model": {"errors", "settings", "svg", "words"},
    "signatures": {"errors", "settings"},
    "arguments": {"errors", "model"},
    "files": {"errors"},
    "geometry": INSIDE,
    "structure": INSIDE | {"structure"},
    "toolpath": INSIDE | {"toolpath"},
    "fields": INSIDE | {"fields"},
    **{folder: INSIDE | {folder} for folder in RIM},
    "sources": INSIDE,
    "parts": INSIDE | {"formats", "kernel", "sources"},
    "nearness": INSIDE | {"fields", "kernel"},
    "slicing": INSIDE | {"files", "kernel", "parts", "structure", "svg"},
    "recipes": INSIDE | {"formats", "kernel", "parts"},
    "cell_size": INSIDE | {"structure", "toolpath"},
    "limits": INSIDE | {"toolpath"},
    "ont": INSIDE | {"pipeline", "recipes"},
    "version": set(),
    "forms": INSIDE | RIM | {"files", "sources"},
    "pages": INSIDE | {"files", "view"},
    "views": INSIDE | {"files", "report", "view"},
    "adapters": INSIDE | {"adapters", "forms", "kernel", "pipeline", "sources"},
    "report": INSIDE | {"formats", "structure", "toolpath"},
    "pipeline": INSIDE
    | RIM
    | {
        "cell_size",
        "fields",
        "files",
        "forms",
        "limits",
        "parts",
        "recipes",
        "report",
        "signatures",
        "structure",
        "toolpath",
        "version",
        "pages",
        "views",
    },
    "watched": set(),
    "notes": set(),
    "exports": INSIDE | {"files", "pipeline", "report"},
    "worker": INSIDE
    | {
        "exports",
        "formats",
        "forms",
        "kernel",
        "notes",
        "parts",
        "pipeline",
        "recipes",
        "report",
        "version",
        "view",
        "warm_up",
        "watched",
        "worker",
    },
    "options": {"errors", "settings"},
    "commands": INSIDE
    | {
        "commands",
        "exports",
        "files",
        "formats",
        "limits",
        "notes",
        "ont",
        "options",
        "parts",
        "pipeline",
        "printer",
        "recipes",
        "report",
        "slicing",
        "structure",
        "view",
        "warm_up",
        "watched",
        "toolpath",
    },
    "warm_up": {"geometry"},
    "cli": {"commands", "errors", "version"},
    "__main__": {"cli"},
    "__init__": INSIDE
    | {"formats", "nearness", "parts", "pipeline", "recipes", "slicing", "structure", "version"},
}

GEOMETRY_MAY_IMPORT = {
    "compiled": set(),
    "arcs": set(),
    "drawing": set(),
    "graphs": set(),
    "loops": {"compiled", "power_diagram"},
    "section_area": set(),
    "print_time": {"arcs", "compiled"},
    "power_diagram": {"compiled"},
    "clipping": {"compiled", "power_diagram"},
    "voronoi": {"compiled"},
    "section_union": {"clipping"},
    "mesh": {"compiled"},
    "mesh_overlap": {"mesh", "section_union"},
    "surface": {"compiled", "mesh"},
    "solid": {"mesh"},
    "__init__": {"compiled"},
}
"""The rooms within geometry/: which others each may know."""

ONLY_IN = {
    "OCP": {"kernel"},
    "numba": {"geometry/compiled", "commands/compiling.py"},
    "llvmlite": {"geometry/compiled"},
    "build123d": {"adapters"},
    "cadquery": {"adapters"},
    "meshio": {"fields/table.py"},
    "PIL": {"fields/image.py"},
    "serial": {"printer/serial_link.py"},
    "aiohttp": {"printer/http_link.py"},
}
"""Libraries that only some places may import."""

MODULES = sorted(PACKAGE.rglob("*.py"))


def imported(source: str) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add("." * node.level + (node.module or ""))
    return names


def wrong_imports(module: str, source: str) -> list[str]:
    """What a module, by its path below v3dcad/, imports although it may not."""
    rooms = [part.removesuffix(".py") for part in module.split("/")]
    wrong = []
    for name in sorted(imported(source)):
        words = name.split(".")
        if words[0] == "v3dcad":
            allowed = words[1] in MAY_IMPORT[rooms[0]]
            if rooms[0] == words[1] == "geometry" and len(words) > 2:
                allowed = words[2] in GEOMETRY_MAY_IMPORT[rooms[1]] | {rooms[1]}
        else:
            places = ONLY_IN.get(words[0], {""})
            allowed = words[0] != "" and any(module.startswith(place) for place in places)
        if not allowed:
            wrong.append(name)
    return wrong


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_run_downward(path: Path) -> None:
    module = path.relative_to(PACKAGE).as_posix()
    assert not wrong_imports(module, path.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    ("module", "name"),
    [
        ("geometry/power_diagram/grid.py", "v3dcad.geometry.clipping.interior"),
        ("geometry/compiled/arrays.py", "v3dcad.geometry.power_diagram.grid"),
        ("geometry/arcs.py", "v3dcad.structure.fill"),
        ("structure/fill.py", "v3dcad.formats.mesh.stl"),
        ("formats/mesh/stl.py", "v3dcad.kernel.step"),
        ("toolpath/graph.py", "numba"),
        ("structure/fill.py", "OCP.gp"),
        ("pipeline.py", "build123d"),
        ("structure/fill.py", ".walls"),
    ],
)
def test_a_wrong_arrow_is_found(module: str, name: str) -> None:
    level = len(name) - len(name.lstrip("."))
    code = f"from {name} import anything" if level else f"import {name}"
    assert wrong_imports(module, f"import math\n{code}\n") == [name]


def test_rooms_in_geometry_have_no_circle() -> None:
    placed: set[str] = set()
    while len(placed) < len(GEOMETRY_MAY_IMPORT):
        ready = {room for room, known in GEOMETRY_MAY_IMPORT.items() if known <= placed} - placed
        assert ready, f"a circle among {GEOMETRY_MAY_IMPORT.keys() - placed}"
        placed |= ready


def test_tests_mirror_the_package() -> None:
    tests = PACKAGE.parent / "tests"
    own = {"fuzz", "workbench"}
    for folder in (path.parent for path in tests.rglob("test_*.py")):
        name = folder.relative_to(tests)
        assert set(name.parts[:1]) & own or (PACKAGE / name).is_dir(), f"tests/{name}"


def loaded_by(code: str) -> set[str]:
    show = "import sys; print(' '.join({name.split('.')[0] for name in sys.modules}))"
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\n{show}"], capture_output=True, encoding="utf-8", check=True
    )
    return set(done.stdout.splitlines()[-1].split())


HEAVY = {
    "OCP", "numba", "matplotlib", "scipy", "shapely", "build123d", "cadquery", "meshio", "PIL"
}  # fmt: skip


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


def test_triangles_need_no_kernel_and_the_default_route_no_matching(
    samples: Path, tmp_path: Path
) -> None:
    loaded = loaded_by(
        "import v3dcad\n"
        f"structure = v3dcad.fill({str(samples / 'pyramid.stl')!r}, layer_height=0.4)\n"
        f"structure.write_ont({str(tmp_path / 'a.ont')!r})\n"
        f"structure.write_gcode({str(tmp_path / 'a.gcode')!r})"
    )
    assert not loaded & {"OCP", "pymatching", "networkx"}


@pytest.mark.parametrize(
    "words",
    [
        ("info", "bracket.step"),
        ("fill", "bracket.step", "--gcode"),
        ("fill", "pyramid.stl", "--out"),
    ],
)
def test_without_the_kernel_step_is_refused_with_the_line_that_brings_it(
    words: tuple[str, ...], samples: Path, tmp_path: Path
) -> None:
    command, part, *more = words
    more += [str(tmp_path / "out")] if more else []
    code = (
        "import sys; sys.modules['OCP'] = None\n"
        "from v3dcad.cli import main\n"
        f"sys.argv = ['v3dcad', {command!r}, {str(samples / part)!r}, *{more!r}]; main()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, encoding="utf-8")
    assert done.returncode == 2
    assert not list(tmp_path.iterdir())
    assert done.stderr.count("\n") == 1
    assert "run `pip install 'v3dcad[occt]'`" in done.stderr


def test_every_public_name_is_there() -> None:
    import v3dcad

    assert sorted(v3dcad.__all__) == sorted(v3dcad._HOME)
    for name in v3dcad.__all__:
        assert getattr(v3dcad, name).__doc__
    with pytest.raises(AttributeError, match="fil_"):
        v3dcad.fil_  # noqa: B018
