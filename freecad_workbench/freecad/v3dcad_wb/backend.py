# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""The worker: v3dcad as a child process, asked in JSON lines.

`worker-protocol.md` of the project says what goes over the pipe. Requests are answered in order;
one is under way at a time, the others wait here, where they can still be dropped. To cancel the one
under way its process is ended and another one is started.
"""

from __future__ import annotations

import atexit
import json
import os
import shutil
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import FreeCAD as App

from . import environment
from .properties import label_of
from .qt import QtCore, tr

PREFIX = "v3dcad-freecad-"
PATIENCE = 1500
"""Milliseconds between asking a process to end and ending it."""

RESTART = 5.0
"""Seconds that starting a process takes, about."""

Answer = dict[str, Any]


class WorkerError(Exception):
    """What a user is told: one line in words."""


@dataclass(eq=False)
class Job:
    """One request and who wants its answer."""

    request: dict[str, Any]
    done: Callable[[Answer], None]
    failed: Callable[[WorkerError], None]
    title: str
    kind: str = ""
    """of jobs of one kind that wait only the newest is kept"""
    progress: tuple[str, int, int] = ("", 0, 0)
    begun: float = 0.0
    number: int = 0
    over: bool = False

    def seconds_left(self) -> float:
        """How much longer it will take, guessed from how far it is."""
        _, done, whole = self.progress
        took = time.monotonic() - self.begun
        return took * (whole - done) / done if done else took


@dataclass(eq=False)
class Worker:
    """The child process and the jobs for it."""

    waiting: list[Job] = field(default_factory=list)
    running: Job | None = None
    settings: list[dict[str, Any]] = field(default_factory=list)
    """as `hello` tells them; empty until it was answered"""
    watchers: list[Callable[[], None]] = field(default_factory=list)
    """called when jobs begin, go on or end"""
    _process: QtCore.QProcess | None = None
    _folder: Path | None = None
    _rest: bytes = b""
    _said: str = ""
    _count: int = 0

    @property
    def folder(self) -> Path:
        """Where files are exchanged; made when first asked for."""
        if self._folder is None:
            _sweep()
            try:
                self._folder = Path(tempfile.mkdtemp(prefix=f"{PREFIX}{os.getpid()}-"))
            except OSError as error:
                message = tr("no temporary folder could be made ({why}); is the disk full?")
                raise WorkerError(message.format(why=error)) from error
        return self._folder

    def ask(self, job: Job) -> None:
        """Put a job in the queue; with a window its answer comes later, without one it is there."""
        if job.kind:
            self.waiting = [one for one in self.waiting if one.kind != job.kind]
        self.waiting.append(job)
        self._go_on()
        if not App.GuiUp:
            self.wait(job)

    def wait(self, job: Job) -> None:
        """Read until a job is over; for FreeCAD without a window, which has no event loop."""
        while not job.over:
            if self._process is None:
                self._go_on()
            elif self._process.waitForReadyRead(-1) or self._process.bytesAvailable():
                self._read()
            else:
                self._process.waitForFinished(PATIENCE)
                self._ended()

    def hello(self, done: Callable[[], None], failed: Callable[[WorkerError], None]) -> None:
        """Have the worker's settings; `done` at once where they are known."""
        if self.settings:
            return done()

        def greeted(answer: Answer) -> None:
            self.settings = answer["settings"]
            done()

        self.ask(Job({"do": "hello"}, greeted, failed, tr("Starting v3dcad")))
        return None

    def cancel(self, job: Job) -> None:
        """Drop a job; if it is under way its process is ended, and the next job starts another."""
        if job in self.waiting:
            self.waiting.remove(job)
            self._finish(job, error=WorkerError(tr("cancelled")))
        elif job is self.running:
            self.running = None
            self._end_process()
            self._finish(job, error=WorkerError(tr("cancelled")))
            self._go_on()

    def supersede(self, job: Job) -> None:
        """Drop a job whose answer nobody wants any more.

        One that soon ends is left to end, since another process has to be started first.
        """
        if job is not self.running or job.seconds_left() > RESTART:
            job.failed = lambda _: None
            self.cancel(job)

    def cancel_all(self) -> None:
        """Drop every job."""
        for job in list(self.waiting):
            self.cancel(job)
        if self.running is not None:
            self.cancel(self.running)

    def close(self) -> None:
        """End the process and remove the folder; jobs are forgotten without a word."""
        self.waiting.clear()
        self.running = None
        self._end_process(at_once=True)
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
            self._folder = None
        self.settings = []

    def _go_on(self) -> None:
        if self.running is None and self.waiting:
            job = self.waiting[0]
            if self._process is None and (why := self._start()):
                self.waiting.remove(job)
                self._finish(job, error=WorkerError(why))
                return self._go_on()
            self.running = self.waiting.pop(0)
            self._count += 1
            job.number, job.begun = self._count, time.monotonic()
            assert self._process is not None
            line = json.dumps({"id": job.number, **job.request}) + "\n"
            self._process.write(line.encode())
        self._tell()
        return None

    def _start(self) -> str | None:
        """Start the process; why not, in words."""
        if why := environment.missing():
            return why
        variables = QtCore.QProcessEnvironment()
        for name, value in environment.child_environment().items():
            variables.insert(name, value)
        process = QtCore.QProcess()
        process.setProcessEnvironment(variables)
        process.readyReadStandardOutput.connect(self._read)
        process.readyReadStandardError.connect(self._listen)
        process.finished.connect(lambda *_: self._ended(process))
        self._rest, self._said = b"", ""
        try:
            folder = str(self.folder)
        except WorkerError as error:
            return str(error)
        process.start(str(environment.python()), ["-m", "v3dcad.worker", folder])
        if not process.waitForStarted(10_000):
            return tr("v3dcad could not be started: {why}").format(why=process.errorString())
        self._process = process
        return None

    def _read(self) -> None:
        if self._process is None:
            return
        self._rest += bytes(self._process.readAllStandardOutput())
        *lines, self._rest = self._rest.split(b"\n")
        for line in lines:
            self._take(json.loads(line))

    def _take(self, answer: Answer) -> None:
        job = self.running
        if job is None or answer.get("id") not in (job.number, None):
            return
        if "stage" in answer:
            job.progress = answer["stage"], answer.get("done", 0), answer.get("of", 0)
            return self._tell()
        self.running = None
        if "error" in answer:
            self._finish(job, error=_error_of(answer))
        else:
            self._finish(job, answer["result"])
        return self._go_on()

    def _listen(self) -> None:
        if self._process is not None:
            text = bytes(self._process.readAllStandardError()).decode(errors="replace")
            self._said = (self._said + text)[-4000:]

    def _ended(self, process: QtCore.QProcess | None = None) -> None:
        """The process is gone although nobody ended it."""
        if self._process is None or process not in (None, self._process):
            return
        self._read()
        self._listen()
        ended, self._process = self._process, None
        job, self.running = self.running, None
        if job is not None:
            why = tr("v3dcad ended in the middle of its work ({code}); it is started again").format(
                code=self._why(ended.exitCode())
            )
            self._finish(job, error=WorkerError(why))
        self._go_on()

    def _why(self, code: int) -> str:
        lines = [line for line in self._said.splitlines() if line.strip()]
        return f"{code}" + (f": {lines[-1].strip()}" if lines else "")

    def _end_process(self, *, at_once: bool = False) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        process.blockSignals(True)
        process.closeWriteChannel()
        process.terminate()
        if App.GuiUp and not at_once:
            _ending.append(process)
            QtCore.QTimer.singleShot(PATIENCE, lambda: _kill(process))
        elif not process.waitForFinished(PATIENCE):
            process.kill()
            process.waitForFinished(PATIENCE)

    def _finish(
        self, job: Job, answer: Answer | None = None, error: WorkerError | None = None
    ) -> None:
        job.over = True
        if error is not None:
            job.failed(error)
        else:
            job.done(answer or {})
        self._tell()

    def _tell(self) -> None:
        for watcher in list(self.watchers):
            watcher()


def _error_of(answer: Answer) -> WorkerError:
    """An answer's error; it names a setting as the panel does, not as the command line."""
    message, setting = answer["error"], answer.get("setting")
    if setting:
        message = message.replace("--" + setting.replace("_", "-"), label_of(setting))
    return WorkerError(message)


_ending: list[QtCore.QProcess] = []
"""Processes that were asked to end; Qt may not lose them before they have."""


def _kill(process: QtCore.QProcess) -> None:
    if process.state() != QtCore.QProcess.NotRunning:
        process.kill()
        process.waitForFinished(PATIENCE)
    _ending.remove(process)


def _sweep() -> None:
    """Remove folders of FreeCADs that were ended before they could do it themselves."""
    for folder in Path(tempfile.gettempdir()).glob(f"{PREFIX}*"):
        number = folder.name[len(PREFIX) :].split("-")[0]
        if number.isdigit() and not is_alive(int(number)):
            shutil.rmtree(folder, ignore_errors=True)


def is_alive(process_id: int) -> bool:
    """Whether there is a process of this number that this user may see."""
    if os.name == "nt":
        import ctypes

        handle = ctypes.windll.kernel32.OpenProcess(0x1000, False, process_id)
        ctypes.windll.kernel32.CloseHandle(handle)
        return bool(handle)
    try:
        os.kill(process_id, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


worker = Worker()
atexit.register(worker.close)
