# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""The dialog that makes, repairs or resets the environment that v3dcad runs in."""

from __future__ import annotations

import subprocess
from typing import Any

from . import environment
from .backend import worker
from .environment import Step
from .places import PREFERENCES, source_beside
from .qt import QtCore, QtWidgets, tr


class SetupDialog(QtWidgets.QDialog):
    """Says what is loaded and where to, and does it when it is told to."""

    def __init__(self, parent: Any = None) -> None:
        super().__init__(parent)
        self.setObjectName("v3dcad-setup")
        self.setWindowTitle(tr("Set up Voronoi 3D"))
        self.resize(680, 460)
        self.process: QtCore.QProcess | None = None
        self.steps: list[Step] = []
        self.bases: list[str] = []
        self.base = self.output = ""
        text = tr(
            "Voronoi 3D runs the engine v3dcad in a Python environment of its own. "
            "It loads about {load} GB from the package index and takes {disk} GB in\n{folder}.\n"
            "v3dcad itself comes from: {source}. Nothing is loaded before you press Set up."
        ).format(
            load=environment.LOAD,
            disk=environment.ON_DISK,
            folder=environment.folder(),
            source=source_beside() or "pypi.org",
        )
        about = QtWidgets.QLabel(text)
        about.setWordWrap(True)
        about.setTextInteractionFlags(QtCore.Qt.TextSelectableByMouse)
        self.log = QtWidgets.QPlainTextEdit()
        self.log.setReadOnly(True)
        self.said = QtWidgets.QLabel(environment.missing() or tr("v3dcad is set up."))
        self.said.setObjectName("said")
        self.said.setWordWrap(True)
        self.bar = QtWidgets.QProgressBar()
        self.bar.setVisible(False)
        layout = QtWidgets.QVBoxLayout(self)
        for widget in (about, self.log, self.bar, self.said):
            layout.addWidget(widget)
        row = QtWidgets.QHBoxLayout()
        self.buttons = {
            "setup": self._button(row, tr("Set up or repair"), self.set_up),
            "existing": self._button(row, tr("Use an existing Python…"), self.choose),
            "reset": self._button(row, tr("Reset"), self.reset),
            "cancel": self._button(row, tr("Cancel"), self.cancel),
            "close": self._button(row, tr("Close"), self.reject),
        }
        self.buttons["cancel"].setEnabled(False)
        layout.addLayout(row)

    def _button(self, row: Any, text: str, pressed: Any) -> Any:
        button = QtWidgets.QPushButton(text)
        button.clicked.connect(lambda: pressed())
        button.setAutoDefault(False)
        row.addWidget(button)
        return button

    def set_up(self) -> None:
        """Make the environment anew, step by step."""
        worker.close()
        environment.finished_mark().unlink(missing_ok=True)
        PREFERENCES.SetString("Python", "")
        self.bases = environment.base_pythons()
        self.output = ""
        self.log.clear()
        self.bar.setVisible(True)
        self._busy(True)
        if not self.bases:
            return self._failed("wrong version", killed=False)
        return self._try_base()

    def _try_base(self) -> None:
        self.base = self.bases.pop(0)
        self.steps = []
        self._run(environment.check_base(self.base))

    def _run(self, step: Step) -> None:
        self.said.setText(step.title)
        self.log.appendPlainText(f"$ {step.program} {' '.join(step.arguments[:6])}")
        variables = QtCore.QProcessEnvironment()
        for name, value in environment.child_environment().items():
            variables.insert(name, value)
        process = self.process = QtCore.QProcess(self)
        process.setProcessEnvironment(variables)
        process.setProcessChannelMode(QtCore.QProcess.MergedChannels)
        process.readyReadStandardOutput.connect(self._read)
        process.finished.connect(lambda *_: self._ended(process))
        self.step = step
        process.start(step.program, step.arguments)
        if not process.waitForStarted(10_000):
            self._failed(process.errorString(), killed=False)

    def _read(self) -> None:
        if self.process is not None:
            text = bytes(self.process.readAllStandardOutput()).decode(errors="replace")
            self.output = (self.output + text)[-8000:]
            self.log.appendPlainText(text.rstrip())

    def _ended(self, process: QtCore.QProcess) -> None:
        if process is not self.process:
            return
        self._read()
        self.process = None
        killed = process.exitStatus() != QtCore.QProcess.NormalExit or process.exitCode() > 128
        checking = self.step.arguments[0] == "-c"
        if process.exitCode() or killed:
            if checking and self.bases:
                self._try_base()
            else:
                self._failed(self.output, killed=killed)
            return
        if checking:
            self.steps = environment.steps(self.base)
            self.bar.setRange(0, len(self.steps))
        else:
            self.steps.pop(0)
        self.bar.setValue(self.bar.maximum() - len(self.steps))
        if self.steps:
            self._run(self.steps[0])
        else:
            environment.finished_mark().write_text("", encoding="utf-8")
            self._good(tr("v3dcad is set up."))

    def _good(self, text: str) -> None:
        self._busy(False)
        self.bar.setVisible(False)
        self.said.setText(text)
        worker.hello(lambda: None, lambda error: self.said.setText(str(error)))

    def _failed(self, output: str, *, killed: bool) -> None:
        self.process = None
        self._busy(False)
        self.bar.setVisible(False)
        self.said.setText(environment.in_words(output, killed=killed))

    def _busy(self, busy: bool) -> None:
        for name, button in self.buttons.items():
            button.setEnabled(busy == (name == "cancel"))

    def choose(self) -> None:
        """Take a Python that has v3dcad already."""
        path, _ = QtWidgets.QFileDialog.getOpenFileName(self, tr("Python that has v3dcad"))
        if path:
            self.use(path)

    def use(self, path: str) -> None:
        """Take a Python, if v3dcad can be imported there."""
        try:
            done = subprocess.run(
                [path, "-c", environment.CHECK],
                env=environment.child_environment(),
                capture_output=True,
                text=True,
                timeout=60,
                check=False,
            )
            problem = done.stderr.strip().splitlines()[-1:] if done.returncode else []
        except (OSError, subprocess.TimeoutExpired) as error:
            problem = [str(error)]
        if problem:
            self.said.setText(
                tr("{python} has no v3dcad: {why}").format(python=path, why=problem[0])
            )
            return
        worker.close()
        PREFERENCES.SetString("Python", path)
        self._good(tr("{python} runs v3dcad.").format(python=path))

    def reset(self) -> None:
        """Remove the environment."""
        worker.close()
        environment.reset()
        self.said.setText(environment.missing() or tr("v3dcad is set up."))

    def cancel(self) -> None:
        """End the step that is under way; what was made so far is removed."""
        process, self.process = self.process, None
        if process is not None:
            process.terminate()
            if not process.waitForFinished(1500):
                process.kill()
                process.waitForFinished(1500)
        environment.reset()
        self._busy(False)
        self.bar.setVisible(False)
        self.said.setText(tr("cancelled"))

    def reject(self) -> None:
        """Closing the window cancels what is under way."""
        if self.process is not None:
            self.cancel()
        super().reject()
