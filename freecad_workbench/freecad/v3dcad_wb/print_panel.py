# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Print or send: which file, which printer, and what becomes of it."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Any

import FreeCADGui as Gui

from . import exchange, printing
from .backend import WorkerError
from .forms import main_window
from .places import PREFERENCES
from .qt import QtCore, QtWidgets, number_of, tr

EVERY = 500
"""Milliseconds between two looks at a print."""
WISHES = ("pause", "resume", "cancel", "stop")


class PrintPanel:
    """The task panel; closing it, or FreeCAD, ends no print."""

    def __init__(self, fill: Any = None) -> None:
        self.fill = fill
        self.print: printing.Print | None = None
        self.form = QtWidgets.QWidget()
        self.form.setWindowTitle(tr("Print or send"))
        layout = QtWidgets.QVBoxLayout(self.form)
        rows = QtWidgets.QFormLayout()
        layout.addLayout(rows)
        self.what = QtWidgets.QComboBox()
        if fill is not None:
            self.what.addItem(tr("G-code of {label}").format(label=fill.Label), "fill")
        self.what.addItem(tr("A G-code file…"), "file")
        self.file = QtWidgets.QLineEdit()
        self.file.setPlaceholderText(tr("the file to print"))
        choose = QtWidgets.QPushButton("…")
        choose.clicked.connect(lambda: self._choose())
        row = QtWidgets.QHBoxLayout()
        row.addWidget(self.file)
        row.addWidget(choose)
        self.printer = QtWidgets.QComboBox()
        self.printer.setObjectName("printer")
        self.printer.setEditable(True)
        self.printer.setToolTip(tr("A printer or a port of the list; other ports can be typed."))
        again = QtWidgets.QPushButton(tr("Look again"))
        again.clicked.connect(lambda: self.find_printers())
        self.profile = QtWidgets.QLineEdit(PREFERENCES.GetString("Profile", ""))
        self.profile.setPlaceholderText("generic-marlin")
        self.nozzle, self.bed = self._degrees(200, 500), self._degrees(60, 200)
        self.begin = QtWidgets.QCheckBox(tr("Start the print when the file is there"))
        self.begin.setToolTip(tr("For print servers; otherwise the file is only sent."))
        rows.addRow(tr("What"), self.what)
        rows.addRow(tr("File"), row)
        rows.addRow(tr("Printer"), self.printer)
        rows.addRow("", again)
        rows.addRow(tr("Machine profile"), self.profile)
        rows.addRow(tr("Nozzle"), self.nozzle)
        rows.addRow(tr("Bed"), self.bed)
        rows.addRow(self.begin)
        self.go = QtWidgets.QPushButton(tr("Print or send"))
        self.go.setObjectName("go")
        self.go.clicked.connect(lambda: self.press())
        layout.addWidget(self.go)
        self.bar = QtWidgets.QProgressBar()
        self.bar.setRange(0, 1000)
        self.said = QtWidgets.QLabel()
        self.said.setObjectName("said")
        self.said.setWordWrap(True)
        layout.addWidget(self.bar)
        layout.addWidget(self.said)
        wishes = QtWidgets.QHBoxLayout()
        self.wishes = {}
        texts = (tr("Pause"), tr("Resume"), tr("Cancel"), tr("STOP NOW"))
        for name, text in zip(WISHES, texts, strict=True):
            button = QtWidgets.QPushButton(text)
            button.clicked.connect(lambda _=False, do=name: self.wish(do))
            wishes.addWidget(button)
            self.wishes[name] = button
        layout.addLayout(wishes)
        layout.addStretch(1)
        self.what.currentIndexChanged.connect(lambda _: self._show())
        self.printer.currentIndexChanged.connect(lambda _: self._show())
        self.printer.editTextChanged.connect(lambda _: self._show())
        self.timer = QtCore.QTimer(self.form)
        self.timer.timeout.connect(self.look)
        self.timer.start(EVERY)
        self.find_printers()
        going_on = printing.running()
        if going_on:
            self.print = going_on[0]
        self._show()

    @staticmethod
    def _degrees(value: float, most: float) -> Any:
        box = QtWidgets.QDoubleSpinBox()
        box.setRange(0, most)
        box.setDecimals(0)
        box.setSuffix(" °C")
        box.setValue(value)
        return box

    def find_printers(self) -> None:
        """List named printers and ports; none is chosen for the user."""
        self.printer.clear()
        self.printer.addItem(tr("choose…"), None)
        self.asked = [
            printing.ask(["printer", "list"], self._offer_printers, self._refused),
            printing.ask(["ports"], self._offer_ports, self._refused),
        ]

    def _offer_printers(self, printers: list[dict[str, Any]]) -> None:
        for one in printers:
            self.printer.addItem(f"{one['name']} ({one['kind']})", ("send", one["name"]))

    def _offer_ports(self, ports: list[dict[str, Any]]) -> None:
        for one in ports:
            self.printer.addItem(f"{one['port']}  {one['name']}".strip(), ("print", one["port"]))

    def chosen(self) -> tuple[str, str] | None:
        """`print` and a port, or `send` and a printer's name; None while none is chosen."""
        text = self.printer.currentText().strip()
        index = self.printer.findText(text)
        if index >= 0:
            found: tuple[str, str] | None = self.printer.itemData(index)
            return found
        return ("print", text) if text else None

    def _choose(self) -> None:
        path, _ = QtWidgets.QFileDialog.getOpenFileName(
            main_window(), tr("The file to print"), "", "G-code (*.gcode *.gco *.g *.nc)"
        )
        if path:
            self.file.setText(path)
            self.what.setCurrentIndex(self.what.findData("file"))

    def _show(self) -> None:
        """Grey what does not go now."""
        of_fill = self.what.currentData() == "fill"
        self.file.setEnabled(not of_fill)
        for box in (self.nozzle, self.bed):
            box.setEnabled(of_fill)
        chosen = self.chosen()
        self.begin.setEnabled(bool(chosen) and chosen[0] == "send")
        under_way = self.print is not None
        self.go.setEnabled(bool(chosen) and not under_way)
        self.go.setToolTip("" if chosen else tr("Choose a printer first."))
        phase = self.print.last.get("phase", "") if self.print is not None else ""
        for name, button in self.wishes.items():
            button.setEnabled(under_way and (name != "resume" or phase == "paused"))
        if phase in ("pausing", "paused"):
            self.wishes["pause"].setEnabled(False)

    def press(self) -> None:
        """Ask once more, since heat and motion follow; then make the file and start."""
        chosen = self.chosen()
        if chosen is None:
            return
        verb, name = chosen
        question = {
            "print": tr("Print on {printer} now? It heats and moves."),
            "send": tr("Send to {printer}?"),
        }[verb].format(printer=name)
        box = QtWidgets.QMessageBox
        if box.question(main_window(), "Voronoi 3D", question) != box.Yes:
            return
        PREFERENCES.SetString("Profile", self.profile.text().strip())
        try:
            folder = printing.new_folder()
        except WorkerError as error:
            self.said.setText(str(error))
            return
        if self.what.currentData() == "file":
            self._start(folder, Path(self.file.text()), verb, name)
            return
        path = folder / f"{self.fill.Label}.gcode"
        temperatures = {
            "nozzle_temperature": self.nozzle.value(),
            "bed_temperature": self.bed.value(),
        }
        options = {"print": temperatures, "profile": self.profile.text().strip() or None}
        self.go.setEnabled(False)
        self.said.setText(tr("Writing the G-code"))
        exchange.export_fill(
            self.fill,
            str(path),
            options,
            lambda _: self._start(folder, path, verb, name),
            self._refused,
        )

    def _start(self, folder: Path, path: Path, verb: str, name: str) -> None:
        arguments = [verb, str(path), "--port" if verb == "print" else "--to", name]
        if profile := self.profile.text().strip():
            arguments += ["--profile", profile]
        if verb == "send" and self.begin.isChecked():
            arguments.append("--start")
        try:
            self.print = printing.start(folder, arguments, str(path), name)
        except WorkerError as error:
            self._refused(error)
        self.look()

    def _refused(self, error: WorkerError) -> None:
        self.said.setText(str(error))
        self._show()

    def look(self) -> None:
        """Show how far the print is."""
        now = self.print
        if now is None:
            return
        alive = now.is_running()
        now.events()
        if now.last:
            self.bar.setValue(round(10 * now.last["percent"]))
            self.said.setText(summary(now.last))
        else:
            self.said.setText(tr("Connecting to {printer}").format(printer=now.about["to"]))
        if not alive:
            self.said.setText(ending(now))
            now.forget()
            self.print = None
        self._show()

    def wish(self, do: str) -> None:
        """Pause, resume, cancel or stop."""
        if self.print is None:
            return
        try:
            self.print.wish(do)
        except WorkerError as error:
            self.said.setText(str(error))

    def getStandardButtons(self) -> int:  # noqa: N802, FreeCAD's name
        """Close alone."""
        return number_of(QtWidgets.QDialogButtonBox.Close)

    def reject(self) -> bool:
        """Close the panel; the print goes on."""
        self.timer.stop()
        for process in self.asked:
            process.blockSignals(True)
            process.kill()
            process.waitForFinished(1000)
        with contextlib.suppress(RuntimeError):
            Gui.Control.closeDialog()
        return True


def summary(progress: dict[str, Any]) -> str:
    """How far, in one line."""
    minutes = round(progress["left_s"] / 60)
    words = [
        tr(progress["phase"]),
        f"{progress['percent']:.0f} %",
        tr("layer {layer} of {layers}").format(**progress),
        tr("{hours} h {minutes} min left").format(hours=minutes // 60, minutes=minutes % 60),
    ]
    for name, heat in progress["temperatures"].items():
        wanted = "" if heat["wanted"] is None else f" / {heat['wanted']:.0f}"
        words.append(f"{name} {heat['is']:.0f}{wanted} °C")
    return ", ".join(words)


def ending(one: printing.Print) -> str:
    """How it ended, in words."""
    end = one.end or {}
    if "file" in end:
        started = tr("printing") if end["started"] else tr("not started")
        return tr("sent to {printer} as {file}; {state}").format(
            printer=end["printer"], file=end["file"], state=started
        )
    words = [tr(str(end["end"]))] if "end" in end else []
    words += [str(end["message"])] if "message" in end else []
    return ": ".join(words) or one.complaint() or tr("The print ended without a word.")
