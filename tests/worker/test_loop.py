"""Garbage, faults and ends: every line is answered in words, and nothing outlives its parent."""

from __future__ import annotations

import io
import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, cast

import numpy as np
import pytest
from worker.worker_process import ROOT, Worker

from v3dcad.errors import SettingError
from v3dcad.worker import loop
from v3dcad.worker.__main__ import preparing
from v3dcad.worker.parent import requests_of

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("line", "says"),
    [
        (b"no json", "the request is not JSON"),
        (b"", "the request is not JSON"),
        (b"\xff\xfe\x00", "the request is not JSON"),
        (b"[" * 100_000, "the request is not JSON"),
        (b'{"id": NaN}', "NaN is no finite number"),
        (b'{"id": 1e999}', "1e999 is no finite number"),
        (b'{"height": -Infinity}', "-Infinity is no finite number"),
        (b'{"settings": {"cell_size": 1' + b"0" * 400 + b"}}", "00 is no finite number"),
        (b"[1, 2]", "the request is no object"),
        (b'{"id": 3}', "the request has no 'do'"),
        (b'{"id": 3, "do": 4}', "'do' of the request is 4, no str"),
        (b'{"id": 3, "do": "dance"}', "cannot do 'dance': ask for hello, fill"),
        (b'{"id": 3, "do": "fill", "source": "a"}', "the request has no 'shape_up_to'"),
        (b'{"id": 3, "do": "fill", "shape_up_to": true}', "'shape_up_to' of the request is True"),
        (b'{"id": 3, "do": "fill", "shape_up_to": 1}', "the request has no 'settings'"),
        (b'{"id": 3, "do": "fill", "shape_up_to": 1, "settings": {}}', "has no 'source'"),
        (b'{"id": 3, "do": "open_ont", "path": "/n/a.ont"}', "/n/a.ont: cannot be read"),
    ],
)
def test_what_is_no_request_is_answered_in_words(worker: Worker, line: bytes, says: str) -> None:
    said = worker.send(line)
    assert says in said["error"]
    assert said["setting"] is None
    assert said["id"] == (3 if b'"id": 3' in line else None)


@pytest.mark.parametrize(
    ("settings", "asks", "says", "setting"),
    [
        ({"cell_size": 900}, {}, "larger than the part", "cell_size"),
        ({"cell_size": -1}, {}, "give a number above 0 mm", "cell_size"),
        ({"cell_size": "big"}, {}, "give a number, auto, or an expression", "cell_size"),
        ({"cell_size": True}, {}, "give a number or auto", "cell_size"),
        ({"layer_height": "thin"}, {}, "give a number", "layer_height"),
        ({"random_seed": 1.5}, {}, "give a whole number", "random_seed"),
        ({"cells": 5}, {}, "there is no setting 'cells'", "cells"),
        ({"offset": 1}, {}, "is a setting of --method thesis", "offset"),
        ({}, {"target": "moon"}, "target moon: give full, layer", "target"),
        ({}, {"layer": 5000}, "layer 5000: the layers are 0 to 149", "layer"),
        ({}, {"target": "cell", "cell": 10**6}, "the cells of layer 3 are", "cell"),
        ({}, {"do": "brep", "form": "foam"}, "form 'foam': give wires", "form"),
        ({}, {"do": "brep", "form": "solid", "thickness": 0}, "above 0 mm", "thickness"),
        ({}, {"do": "export", "to": "a.doc"}, "not a kind of file that is written", "to"),
        ({}, {"do": "export", "to": "a.svg", "svg_layer": 150}, "are 0 to 149", "svg_layer"),
        ({}, {"do": "export", "to": "a.gcode", "print": {"fan": 900}}, "at most 100 %", "fan"),
        ({}, {"do": "export", "to": "/dev/null/a.ont"}, "cannot be written", None),
        ({}, {"source": "/nowhere.brep"}, "/nowhere.brep: cannot be read", None),
        ({}, {"sites": "/nowhere.npy"}, "cannot be read as an array", None),
    ],
)
def test_errors_name_their_setting(
    worker: Worker, cone: Path, settings: Any, asks: dict[str, Any], says: str, setting: str | None
) -> None:
    usual = {"do": "layer", "source": str(cone), "target": "layer", "layer": 3}
    error, named = worker.refused(**{**usual, **asks}, settings=settings)
    assert says in error
    assert named == setting


def test_a_part_that_is_none(worker: Worker, tmp_path: Path) -> None:
    for name in ("a.brep", "a.stl", "a.txt"):
        (tmp_path / name).write_text("this is no part")
        error, _ = worker.refused("fill", source=str(tmp_path / name), settings={}, shape_up_to=1)
        assert str(tmp_path / name) in error
    assert worker.stderr() == ""


@pytest.mark.parametrize(
    ("fault", "says", "told"),
    [
        (SettingError("fan", "two\nlines"), "two lines", False),
        (MemoryError(), "not enough memory", False),
        (OSError(28, "No space left on device", "/f/1.npz"), "/f/1.npz: No space left", False),
        (ZeroDivisionError("by nought"), "please report it: ZeroDivisionError: by nought", True),
        (RecursionError("deep"), "please report it: RecursionError: deep", True),
    ],
)
def test_whatever_goes_wrong_is_answered(
    fault: Exception, says: str, told: bool, monkeypatch: pytest.MonkeyPatch, capsys: Any,
    tmp_path: Path,
) -> None:  # fmt: skip
    def fail(_: object) -> dict[str, Any]:
        raise fault

    monkeypatch.setattr(loop.Work, "result", fail)
    stream = io.BytesIO()
    loop.serve([b'{"id": "x", "do": "fill"}\n'] * 2, stream, tmp_path)
    for line in stream.getvalue().splitlines():
        said = json.loads(line)
        assert said["id"] == "x"
        assert says in said["error"]
        assert said["setting"] == ("fan" if isinstance(fault, SettingError) else None)
    assert ("Traceback" in capsys.readouterr().err) == told


def test_notes_are_what_v3dcad_warns_of_once_each(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    class LibraryWarning(UserWarning):
        pass

    def warn(_: object) -> dict[str, Any]:
        for _ in range(2):
            warnings.warn("walls close up", UserWarning, stacklevel=1)
        warnings.warn("a library's own", LibraryWarning, stacklevel=1)
        return {"edges": 3}

    monkeypatch.setattr(loop.Work, "result", warn)
    stream = io.BytesIO()
    loop.serve([b"{}"], stream, tmp_path)
    said = json.loads(stream.getvalue())
    assert said == {"id": None, "result": {"edges": 3, "notes": ["walls close up"]}}


@pytest.mark.parametrize("number", [0, -7, 1.5, "ü", "\ud800", [1, {"a": None}], None, True])
def test_an_id_comes_back_as_it_was(number: Any, tmp_path: Path) -> None:
    stream = io.BytesIO()
    loop.serve([json.dumps({"id": number}).encode()], stream, tmp_path)
    said = json.loads(stream.getvalue())
    assert said["id"] == number
    assert type(said["id"]) is type(number)


def test_nobody_left_to_answer(tmp_path: Path) -> None:
    class Closed(io.BytesIO):
        def flush(self) -> None:
            raise BrokenPipeError

    loop.serve([b"{}\n"] * 3, Closed(), tmp_path)


def test_what_libraries_print_does_not_come_between_answers(tmp_path: Path, cone: Path) -> None:
    code = (
        "import os, sys, runpy; import v3dcad.pipeline as p\n"
        "cut = p.sectioned\n"
        "def noisy(*a):\n"
        "    print('from Python'); os.write(1, b'from C\\n'); return cut(*a)\n"
        "p.sectioned = noisy\n"
        f"sys.argv = ['x', {str(tmp_path)!r}]\n"
        "from v3dcad.worker.__main__ import main; main()"
    )
    ask = {"id": 1, "do": "fill", "source": str(cone), "settings": {"layer_height": 5},
           "shape_up_to": 0}  # fmt: skip
    done = subprocess.run(
        [sys.executable, "-c", code], input=json.dumps(ask), cwd=ROOT, capture_output=True,
        encoding="utf-8", check=True,
    )  # fmt: skip
    assert "result" in [json.loads(line) for line in done.stdout.splitlines()][-1]
    assert "from Python" in done.stderr
    assert "from C" in done.stderr


def test_the_end_of_its_input_ends_it(tmp_path: Path) -> None:
    running = Worker(tmp_path)
    assert "error" in running.send(b"?")
    assert running.close() == 0
    assert running.stderr() == ""


def test_without_a_folder_it_says_so(tmp_path: Path) -> None:
    for words in ([], [str(tmp_path / "none")]):
        done = subprocess.run(
            [sys.executable, "-m", "v3dcad.worker", *words], cwd=ROOT, capture_output=True,
            stdin=subprocess.DEVNULL, encoding="utf-8",
        )  # fmt: skip
        assert done.returncode == 1
        assert done.stderr == "v3dcad.worker: give one folder, for the files that answers name\n"
        assert done.stdout == ""


PARENT = """
import subprocess, sys, json, time
worker = subprocess.Popen([sys.executable, "-m", "v3dcad.worker", sys.argv[1]],
                          stdin=subprocess.PIPE, stdout=subprocess.PIPE)
worker.stdin.write((json.dumps({"id": 1, "do": "brep", "form": "solid", "thickness": 0.4,
    "source": sys.argv[2], "settings": {"cell_size": 2.0}}) + "\\n").encode())
worker.stdin.flush()
while b"making solid" not in worker.stdout.readline():
    pass
print(worker.pid, flush=True)
time.sleep(600)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="PR_SET_PDEATHSIG is Linux's")
def test_a_killed_parent_takes_it_along_even_while_it_computes(tmp_path: Path, cone: Path) -> None:
    parent = subprocess.Popen(
        [sys.executable, "-c", PARENT, str(tmp_path), str(cone)],
        cwd=ROOT, stdout=subprocess.PIPE, encoding="utf-8",
    )  # fmt: skip
    assert parent.stdout is not None
    worker = int(parent.stdout.readline())
    assert running(worker)
    parent.send_signal(signal.SIGKILL)
    parent.wait(10)
    parent.stdout.close()
    deadline = time.monotonic() + 5  # the kernel kills it at once; a solid of 2 mm takes minutes
    while running(worker) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not running(worker)


def running(process: int) -> bool:
    try:
        status = Path(f"/proc/{process}/stat").read_text()
    except FileNotFoundError:
        return False
    return status.rpartition(")")[2].split()[0] not in "ZX"


def test_elsewhere_a_thread_sees_the_end_of_the_input(monkeypatch: pytest.MonkeyPatch) -> None:
    ended: list[int] = []
    monkeypatch.setattr(sys, "platform", "darwin")
    monkeypatch.setattr(os, "_exit", ended.append)
    lines = requests_of(io.BytesIO(b"a\nb\n"), iter(()))
    assert list(lines) == [b"a\n", b"b\n"]
    assert ended == [0]


class Typed:
    """An input whose lines come when the test says so."""

    def __init__(self) -> None:
        self.lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self.asked = threading.Semaphore(0)

    def readline(self) -> bytes:
        self.asked.release()
        return self.lines.get()

    def give(self, line: bytes) -> None:
        """Give a line, and wait until it was taken and the next one is asked for."""
        while self.asked.acquire(blocking=False):
            pass
        self.lines.put(line)
        self.asked.acquire()


def test_a_request_goes_before_the_next_step_of_other_work() -> None:
    stream, told = Typed(), []

    def steps() -> Iterator[str]:
        for step in ("one", "two", "three"):
            if step == "two":
                stream.give(b"second")
            told.append(step)
            yield step
        stream.lines.put(b"")

    stream.lines.put(b"first")
    for line in requests_of(cast(BinaryIO, stream), steps()):
        told += [line.decode()]
    assert told == ["first", "one", "two", "second", "three"]


def test_what_cannot_be_loaded_is_no_reason_to_end(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "v3dcad.kernel.load", None)
    assert list(preparing()) == ["v3dcad.pipeline"]
    assert "ModuleNotFoundError" in capsys.readouterr().err


def test_it_ends_quietly_when_nobody_reads_its_answers(tmp_path: Path) -> None:
    running = Worker(tmp_path)
    assert running.process.stdout is not None
    running.process.stdout.close()
    assert running.process.stdin is not None
    running.process.stdin.write(b"?\n")
    running.process.stdin.flush()
    assert running.process.wait(60) == 0
    assert running.stderr() == ""
    running.process.stdin.close()


def test_arrays_are_never_objects(worker: Worker, cone: Path, tmp_path: Path) -> None:
    np.save(tmp_path / "evil.npy", np.array([{}], object), allow_pickle=True)
    error, _ = worker.refused("fill", source=str(cone), settings={}, shape_up_to=0,
                              sites=str(tmp_path / "evil.npy"))  # fmt: skip
    assert "cannot be read as an array" in error
