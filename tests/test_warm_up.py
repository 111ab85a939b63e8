"""Compiling: all of it by `warm_up`, and announced."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace

import pytest
from terminals import open_terminal

from v3dcad import warm_up
from v3dcad.commands.compiling import MOST_HELPERS, NOTICE
from v3dcad.warm_up import ALL, CELLS, PRINT

pytestmark = pytest.mark.slow

PACKAGE = Path(__file__).resolve().parent.parent / "v3dcad"


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)


def with_compiled_functions() -> set[str]:
    return {
        module_of(path)
        for path in PACKAGE.rglob("*.py")
        if path.stem != "make_tile"  # the program that made the shipped sites
        for function in ast.parse(path.read_text("utf-8")).body
        if isinstance(function, ast.FunctionDef)
        for decorator in function.decorator_list
        if ast.unparse(decorator).startswith(("compiled(", "linked("))
    }


def test_all_modules_with_compiled_functions_are_listed_once() -> None:
    assert sorted(ALL) == sorted(with_compiled_functions())


def test_after_warm_up_nothing_is_left_to_be_compiled(samples: Path, tmp_path: Path) -> None:
    """A graded foam with all outputs finds everything in numba's cache."""
    show = f"""
from numba.core import event
from v3dcad.warm_up import warm_up
warm_up()
compiled = []
class Heard(event.Listener):
    def on_start(self, started): compiled.append(started.data["dispatcher"].py_func)
    def on_end(self, _): ...
event.register("numba:compile", Heard())
import sys
from v3dcad.cli import main
part = {str(samples / "islands.step")!r}
sys.argv = ["v3dcad", "fill", part, "--cell-size", "4 + z / 20", "--out", "."]
try:
    main()
except SystemExit as end:
    print(end.code, compiled)
"""
    done = subprocess.run(
        [sys.executable, "-c", show], capture_output=True, encoding="utf-8", check=True,
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(PACKAGE.parent)},
    )  # fmt: skip
    assert done.stdout.splitlines()[-1] == "None []"


def said_on_a_terminal(cache: Path, *words: str) -> str:
    """What a command says on stderr, a terminal, until it tells of compiling into a folder."""
    ours, theirs = open_terminal()
    code = "from v3dcad.cli import main; main()"
    child = subprocess.Popen(
        [sys.executable, "-c", code, *words], stdout=subprocess.DEVNULL, stderr=theirs,
        env={**os.environ, "PYTHONPATH": str(PACKAGE.parent), "NUMBA_CACHE_DIR": str(cache)},
    )  # fmt: skip
    os.close(theirs)
    said = ""
    try:
        while f"{NOTICE}\r\n" not in said:
            said += os.read(ours, 1000).decode()
    except OSError:  # the child has ended
        pass
    finally:
        child.kill()
        child.wait()
        os.close(ours)
    return said


@pytest.mark.parametrize("command", ["warm-up", "fill"])
def test_compiling_is_announced_on_a_terminal(command: str, samples: Path, tmp_path: Path) -> None:
    files = [samples / "pyramid.stl", "--ont", tmp_path / "a.ont"] if command == "fill" else []
    said = said_on_a_terminal(tmp_path, command, *map(str, files))
    assert f"{NOTICE}\r\n" in said
    if command == "fill":
        assert said.index("loading the engine") < said.index(NOTICE), "a bar from the first moment"


Started = list[tuple[list[str], int]]
"""The processes that were started: their words, and what their stdin is."""


@pytest.fixture
def listener(monkeypatch: pytest.MonkeyPatch) -> tuple[object, Started]:
    """What listens for compilations on a terminal, and the processes that it starts."""
    from numba.core import event

    from v3dcad.commands import compiling

    listeners: list[event.Listener] = []
    started: Started = []

    def start(words: list[str], *, stdin: int, **_: object) -> SimpleNamespace:
        started.append((words, os.dup(stdin)))
        return SimpleNamespace(terminate=lambda: None)

    fake = SimpleNamespace(Popen=start, DEVNULL=subprocess.DEVNULL)
    monkeypatch.setattr(compiling, "subprocess", fake)
    monkeypatch.setattr(compiling.os, "cpu_count", lambda: 3)
    with monkeypatch.context() as patch:
        patch.setattr(event, "register", lambda kind, listener: listeners.append(listener))
        patch.setattr(compiling, "import_module", lambda _: None)
        compiling.load_engine(CELLS)
    return listeners[0], started


def test_the_first_compilation_is_told_of_and_shared(
    listener: tuple[object, Started], capsys: pytest.CaptureFixture[str]
) -> None:
    heard, started = listener
    assert not started
    for told in (1, 0, 0):
        heard.on_start(None)
        heard.on_end(None)
        assert capsys.readouterr().err.count("\n") == told
    assert len(started) == 2, "a process for each other processor, for all compilations"


@pytest.mark.parametrize(("processors", "helpers"), [(1, 0), (2, 1), (64, MOST_HELPERS)])
def test_as_many_help_as_there_are_processors(
    processors: int, helpers: int, listener: tuple[object, Started], monkeypatch: pytest.MonkeyPatch
) -> None:
    heard, started = listener
    monkeypatch.setattr(os, "cpu_count", lambda: processors)
    heard.on_start(None)
    assert len(started) == helpers


def test_helpers_load_each_module_once_the_last_first(listener: tuple[object, Started]) -> None:
    heard, started = listener
    heard.on_start(None)
    (python, queue), (_, same_queue) = started
    code = f"import v3dcad.warm_up as w; w.warm_up = lambda names: print(*names); {python[2]}"
    alone = subprocess.run(
        [*python[:2], code], stdin=queue, capture_output=True, encoding="utf-8", check=True,
        cwd=PACKAGE.parent,
    )  # fmt: skip
    assert alone.stdout.split() == [*reversed(CELLS)]
    assert os.read(same_queue, 1) == b"", "nothing is left for the others"
    subprocess.run(python, stdin=same_queue, cwd="/", check=True)  # finds the package anywhere


def test_a_helper_ends_with_its_parent(monkeypatch: pytest.MonkeyPatch) -> None:
    loaded: list[Sequence[str]] = []
    parents = iter([1, 1, 1, 0])
    monkeypatch.setattr(warm_up, "warm_up", loaded.append)
    monkeypatch.setattr(os, "getppid", lambda: next(parents))
    monkeypatch.setattr(os, "read", lambda *_: b"0")
    warm_up.warm_up_shared(CELLS)
    assert loaded == [[CELLS[0]]] * 2


def test_what_a_fill_compiles_first_is_first_in_the_list(samples: Path, tmp_path: Path) -> None:
    """Functions that Python calls, in the order in which a fill calls them, are of PRINT only."""
    show = f"""
from v3dcad.geometry.compiled import options
asked, compile_now = [], options.compile_now
def compile_noted(function):
    asked.append(function.py_func.__module__)
    compile_now(function)
options.compile_now = compile_noted
import sys
from v3dcad.cli import main
part = {str(samples / "bracket.step")!r}
sys.argv = ["v3dcad", "fill", part, "--gcode", "a.gcode", "--report", "a.json"]
try:
    main()
except SystemExit:
    print(*dict.fromkeys(asked))
"""
    done = subprocess.run(
        [sys.executable, "-c", show], capture_output=True, encoding="utf-8", check=True,
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(PACKAGE.parent)},
    )  # fmt: skip
    asked = done.stdout.splitlines()[-1].split()
    assert set(asked) <= set(PRINT)
    places = [PRINT.index(name) for name in asked]
    halves = places[: len(places) // 2], places[len(places) // 2 :]
    assert max(map(len, halves)) > 5
    assert sum(halves[0]) / len(halves[0]) < sum(halves[1]) / len(halves[1])
