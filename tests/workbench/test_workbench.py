"""The FreeCAD workbench in real FreeCAD, without and with a window.

Pictures go to V3DCAD_PICTURES where that is set. A run that is broken on purpose has to fail.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time

import pytest
from printer.fake_prusalink import FakePrusaLink, Serving
from printer.firmware import Firmware
from printer.pty_printer import PtyPrinter
from workbench.conftest import ADDON, ROOT, FreeCAD, merged

pytestmark = pytest.mark.slow

HEADLESS = ("-t", "freecad.v3dcad_wb.tests.test_features")
WINDOWED = str(ADDON / "tests" / "windowed.py")
SAMPLE = ROOT / "samples" / "bracket.step"
DOCUMENTS = str(ADDON / "tests" / "documents.py")


def until(what: object, seconds: float = 60) -> None:
    end = time.monotonic() + seconds
    while not what():  # type: ignore[operator]
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.05)


def test_without_a_window(freecad: FreeCAD) -> None:
    said = freecad.run(*HEADLESS)
    assert "Traceback" not in said
    assert "OK" in said
    assert not freecad.workers()
    assert not freecad.left()


def test_with_a_window(freecad: FreeCAD) -> None:
    with PtyPrinter(Firmware(), bytes_per_second=3000) as printer:
        said = freecad.run(WINDOWED, window=True, V3DCAD_PORT=printer.port)
    assert "Traceback" not in said
    assert said.count("passed check_") > 15
    assert "M104 S0" in printer.firmware.obeyed, "heaters off after cancel"
    assert not freecad.workers()
    assert not freecad.left()


def test_broken_runs_fail(freecad: FreeCAD) -> None:
    said = freecad.run(*HEADLESS, code=1, V3DCAD_BREAK="1")
    assert "test_broken_on_purpose" in said
    checks = "commands_are_there broken_on_purpose"
    said = freecad.run(WINDOWED, window=True, code=1, V3DCAD_BREAK="1", V3DCAD_CHECKS=checks)
    assert "FAILED check_broken_on_purpose" in said


def test_one_document_in_several_freecads(freecad: FreeCAD) -> None:
    document = str(freecad.folder / "a ü.FCStd")
    bare = str(freecad.folder / "bare")
    os.mkdir(bare)
    for step, more in (
        ("write", {}),
        ("read", {"V3DCAD_PYTHON": None}),
        ("without", {"FREECAD_USER_HOME": bare}),
        ("mended", {}),
    ):
        said = freecad.run(DOCUMENTS, V3DCAD_STEP=step, V3DCAD_DOCUMENT=document, **more)
        assert "Traceback" not in said.replace("No module named 'freecad'", ""), said
    assert not freecad.left()


def test_a_killed_freecad_leaves_nothing(freecad: FreeCAD) -> None:
    variables = {**freecad.variables(), "V3DCAD_STEP": "sleep", "V3DCAD_DOCUMENT": "none"}
    process = subprocess.Popen(
        freecad.command(DOCUMENTS, window=False), env=merged(variables, {}), **quiet()
    )
    until(freecad.workers)
    time.sleep(1)
    process.send_signal(signal.SIGKILL)
    process.wait()
    until(lambda: not freecad.workers(), 10)
    assert freecad.left()
    document = str(freecad.folder / "next.FCStd")
    freecad.run(DOCUMENTS, V3DCAD_STEP="write", V3DCAD_DOCUMENT=document)
    assert not freecad.left()


def test_a_print_goes_on_without_freecad(freecad: FreeCAD) -> None:
    with PtyPrinter(Firmware(), bytes_per_second=4000) as printer:
        checks = "commands_are_there print_and_leave"
        freecad.run(
            WINDOWED, window=True, V3DCAD_PORT=printer.port, V3DCAD_LEAVE="1", V3DCAD_CHECKS=checks
        )
        (told,) = freecad.folder.glob("home/**/prints/*/events.jsonl")
        until(lambda: '"end"' in told.read_text(encoding="utf-8"), 120)
    end = json.loads(told.read_text(encoding="utf-8").splitlines()[-1])
    assert end["end"] == "finished", end


def test_sending_to_a_print_server(freecad: FreeCAD) -> None:
    handler = type("Handler", (FakePrusaLink,), {"files": {}, "started": []})
    with Serving(handler) as serving:
        words = ["-m", "v3dcad", "printer", "add", "one", "--kind", "prusalink"]
        subprocess.run(
            [freecad.python, *words, "--url", serving.url],
            input=b"key\n",
            env=merged(freecad.variables(), {}),
            check=True,
        )
        checks = "commands_are_there send"
        said = freecad.run(
            WINDOWED, window=True, V3DCAD_SEND_TO="one (prusalink)", V3DCAD_CHECKS=checks
        )
    assert "passed check_send" in said
    assert "Traceback" not in said
    ((name, data),) = handler.files.items()
    assert name.endswith(".gcode")
    assert b";LAYER:1" in data
    assert handler.started == []


def test_double_click_on_a_file(freecad: FreeCAD) -> None:
    document = freecad.folder / "a.FCStd"
    freecad.run(DOCUMENTS, V3DCAD_STEP="write", V3DCAD_DOCUMENT=str(document))
    script = freecad.folder / "look.py"
    ont = freecad.folder / "a ü.ont"
    subprocess.run(
        [
            freecad.python,
            "-m",
            "v3dcad",
            "fill",
            SAMPLE,
            "--ont",
            str(ont),
            "--layer-height",
            "1",
        ],
        check=True,
        capture_output=True,
    )
    script.write_text(
        "import FreeCAD, os, sys\n"
        "fills = [o for d in FreeCAD.listDocuments().values() for o in d.Objects"
        " if o.Name == 'VoronoiFill']\n"
        "from freecad.v3dcad_wb.backend import worker\nworker.close()\n"
        "print('opened', [f.Status for f in fills], file=sys.__stderr__)\n"
        "os._exit(0 if [f.Status for f in fills] == ['up to date'] else 1)\n",
        encoding="utf-8",
    )
    freecad.run(str(ont), str(script))


def quiet() -> dict[str, int]:
    """No input, no output."""
    nothing = subprocess.DEVNULL
    return {"stdin": nothing, "stdout": nothing, "stderr": nothing}
