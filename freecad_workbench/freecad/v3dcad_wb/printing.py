# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Prints in processes of their own, which go on when FreeCAD is closed or crashes.

Each print has a folder: what it is (`print.json`), what it says (`events.jsonl`, the JSON lines of
`v3dcad print --json`), its complaints (`errors.txt`) and, but on Windows, a pipe with a name for
wishes. So a FreeCAD that is started later finds the print and can pause, cancel or stop it.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from . import environment
from .backend import WorkerError, is_alive
from .places import user_folder
from .qt import QtCore, tr

HAS_PIPES = hasattr(os, "mkfifo")


@dataclass
class Print:
    """One print, or one upload, and its folder."""

    folder: Path
    process: subprocess.Popen[bytes] | None = None
    """None where an earlier FreeCAD has started it"""
    read_to: int = 0
    last: dict[str, Any] = field(default_factory=dict)
    """the last progress"""
    end: dict[str, Any] | None = None

    @property
    def about(self) -> dict[str, Any]:
        """Process, file and where it goes, as noted at the start."""
        found: dict[str, Any] = json.loads((self.folder / "print.json").read_text(encoding="utf-8"))
        return found

    def is_running(self) -> bool:
        """Whether the process still is."""
        if self.process is not None:
            return self.process.poll() is None
        return is_alive(self.about["process"])

    def events(self) -> list[dict[str, Any]]:
        """What it has said since the last call; `last` and `end` are kept."""
        with (self.folder / "events.jsonl").open("rb") as stream:
            stream.seek(self.read_to)
            data = stream.read()
        whole = data.rfind(b"\n") + 1
        self.read_to += whole
        told = [json.loads(line) for line in data[:whole].splitlines() if line.startswith(b"{")]
        for event in told:
            if event.get("event") == "progress":
                self.last = event
            elif event.get("event") == "end" or "event" not in event:
                self.end = event
        return told

    def complaint(self) -> str:
        """What it said on standard error last."""
        text = (self.folder / "errors.txt").read_text(encoding="utf-8", errors="replace")
        lines = [line.strip(" │╭╰─╮╯") for line in text.splitlines()]
        return " ".join(line for line in lines if line)[-500:]

    def wish(self, do: str) -> None:
        """Ask it to pause, resume, cancel or stop; `WorkerError` where it cannot be reached."""
        line = json.dumps({"do": do}).encode() + b"\n"
        try:
            if HAS_PIPES:
                pipe = os.open(self.folder / "wishes", os.O_WRONLY | os.O_NONBLOCK)
                try:
                    os.write(pipe, line)
                finally:
                    os.close(pipe)
            elif self.process is not None and self.process.stdin is not None:
                self.process.stdin.write(line)
                self.process.stdin.flush()
            else:
                raise OSError(tr("it was started by another FreeCAD"))
        except OSError as error:
            message = tr("The print cannot be reached: {why}. Use the printer's own switch.")
            raise WorkerError(message.format(why=error)) from error

    def forget(self) -> None:
        """Remove the folder of a print that has ended."""
        _started.pop(self.folder, None)
        shutil.rmtree(self.folder, ignore_errors=True)


def prints_folder() -> Path:
    """Where the folders of prints lie."""
    folder = user_folder() / "prints"
    folder.mkdir(exist_ok=True)
    return folder


def new_folder() -> Path:
    """A folder for a print, with nothing in it."""
    for number in range(1, 10_000):
        folder = prints_folder() / f"{number:04d}"
        try:
            folder.mkdir()
        except FileExistsError:
            continue
        return folder
    raise WorkerError(tr("Too many prints are kept in {folder}").format(folder=prints_folder()))


def start(folder: Path, arguments: list[str], file: str, to: str) -> Print:
    """Start `python -m v3dcad ARGUMENTS` apart from FreeCAD; `WorkerError` where it cannot be."""
    if why := environment.missing():
        raise WorkerError(why)
    apart: dict[str, Any] = {"start_new_session": True}
    if sys.platform == "win32":
        apart = {"creationflags": 0x00000008 | 0x00000200}  # DETACHED, NEW_PROCESS_GROUP
    wishes: Any = subprocess.PIPE
    if HAS_PIPES:
        os.mkfifo(folder / "wishes")
        # Open both ways, so that the print never sees the end of its wishes.
        wishes = os.open(folder / "wishes", os.O_RDWR)
    try:
        with (folder / "events.jsonl").open("wb") as told, (folder / "errors.txt").open("wb") as no:
            process = subprocess.Popen(
                [str(environment.python()), "-m", "v3dcad", *arguments, "--json"],
                stdin=wishes,
                stdout=told,
                stderr=no,
                env=environment.child_environment(),
                **apart,
            )
    except OSError as error:
        shutil.rmtree(folder, ignore_errors=True)
        message = tr("v3dcad could not be started: {why}").format(why=error)
        raise WorkerError(message) from error
    finally:
        if HAS_PIPES:
            os.close(wishes)
    about = {"process": process.pid, "file": file, "to": to, "started": time.time()}
    (folder / "print.json").write_text(json.dumps(about), encoding="utf-8")
    _started[folder] = process
    return Print(folder, process)


_started: dict[Path, subprocess.Popen[bytes]] = {}
"""The processes of this FreeCAD, by folder: their ends have to be fetched."""


def running() -> list[Print]:
    """Prints that earlier FreeCADs, or this one, have started and that go on."""
    found = [
        Print(folder, _started.get(folder)) for folder in sorted(prints_folder().iterdir())
        if (folder / "print.json").is_file()
    ]  # fmt: skip
    return [one for one in found if one.is_running()]


def ask(
    words: list[str],
    done: Callable[[list[dict[str, Any]]], None],
    failed: Callable[[WorkerError], None],
) -> Any:
    """Have `done` called with what `v3dcad WORDS --json` lists; keep what is returned."""
    process = QtCore.QProcess()
    variables = QtCore.QProcessEnvironment()
    for name, value in environment.child_environment().items():
        variables.insert(name, value)
    process.setProcessEnvironment(variables)

    def ended(*_: object) -> None:
        if process.exitCode():
            words = bytes(process.readAllStandardError()).decode(errors="replace").strip()
            failed(WorkerError(words[-300:]))
        else:
            done(json.loads(bytes(process.readAllStandardOutput())))

    process.finished.connect(ended)
    process.start(str(environment.python()), ["-m", "v3dcad", *words, "--json"])
    return process
