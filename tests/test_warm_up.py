"""Compiling: all of it by `warm_up`, and announced."""

from __future__ import annotations

import ast
import os
import pty
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from v3dcad.commands.compiling import NOTICE

pytestmark = pytest.mark.slow

PACKAGE = Path(__file__).resolve().parent.parent / "v3dcad"


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)


def with_compiled_functions() -> list[str]:
    """The modules that hold compiled functions, which are compiled when the module is loaded."""
    return sorted(
        module_of(path)
        for path in PACKAGE.rglob("*.py")
        if path.stem != "make_tile"  # the program that made the shipped sites
        for function in ast.parse(path.read_text("utf-8")).body
        if isinstance(function, ast.FunctionDef)
        for decorator in function.decorator_list
        if ast.unparse(decorator).startswith(("compiled(", "linked("))
    )


def test_warm_up_compiles_everything() -> None:
    modules = sorted(set(with_compiled_functions()))
    assert len(modules) > 30
    show = f"""
import sys
from v3dcad.warm_up import warm_up
warm_up()
print(*[module for module in {modules!r} if module not in sys.modules])
"""
    done = subprocess.run(
        [sys.executable, "-c", show], capture_output=True, encoding="utf-8", check=True,
        env={**os.environ, "PYTHONPATH": str(PACKAGE.parent)},
    )  # fmt: skip
    assert done.stdout == "\n", "warm_up leaves these to be compiled later"


def said_on_a_terminal(cache: Path, *words: str) -> str:
    """What a command says on stderr, a terminal, until it tells of compiling into a folder."""
    ours, theirs = pty.openpty()
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


@pytest.fixture
def listener(monkeypatch: pytest.MonkeyPatch) -> tuple[object, list[list[str]]]:
    """What listens for compilations on a terminal, and the processes that it starts."""
    from numba.core import event

    from v3dcad.commands import compiling

    listeners: list[event.Listener] = []
    started: list[list[str]] = []

    def start(words: list[str], **_: object) -> SimpleNamespace:
        started.append(words)
        return SimpleNamespace(terminate=lambda: None)

    fake = SimpleNamespace(Popen=start, DEVNULL=subprocess.DEVNULL)
    monkeypatch.setattr(compiling, "subprocess", fake)
    monkeypatch.setattr(compiling.os, "cpu_count", lambda: 2)
    with monkeypatch.context() as patch:
        patch.setattr(event, "register", lambda kind, listener: listeners.append(listener))
        patch.setattr(compiling, "import_module", lambda _: None)
        compiling.load_engine()
    return listeners[0], started


def test_the_first_compilation_is_told_of_and_shared(
    listener: tuple[object, list[list[str]]],
    capsys: pytest.CaptureFixture[str],
) -> None:
    heard, started = listener
    assert not started
    for told in (1, 0, 0):
        heard.on_start(None)
        heard.on_end(None)
        assert capsys.readouterr().err.count("\n") == told
    assert len(started) == 1, "one process for all compilations"


def test_on_one_processor_compiling_is_not_shared(
    listener: tuple[object, list[list[str]]], monkeypatch: pytest.MonkeyPatch
) -> None:
    heard, started = listener
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    heard.on_start(None)
    assert started == []


def test_the_second_process_compiles_what_the_engine_needs(
    listener: tuple[object, list[list[str]]],
) -> None:
    from v3dcad.commands.compiling import OURS, SLICING, THEIRS

    heard, started = listener
    heard.on_start(None)
    ((*python, code),) = started
    assert python == [sys.executable, "-c"]
    loaded = code.rsplit("import ", 1)[1].split(", ")
    assert loaded == [*THEIRS, *SLICING]
    for needed, ours in ((THEIRS, OURS), (SLICING, ("v3dcad.kernel.load", "v3dcad.slicing"))):
        show = f"import sys, {', '.join(ours)}; print(set({needed!r}) - set(sys.modules))"
        done = subprocess.run(
            [sys.executable, "-c", show], capture_output=True, encoding="utf-8", check=True,
            env={**os.environ, "PYTHONPATH": str(PACKAGE.parent)},
        )  # fmt: skip
        assert done.stdout.strip() == "set()", "nothing that would not be loaded anyway"
    subprocess.run([*python, code], cwd="/", check=True)  # finds the package from anywhere
