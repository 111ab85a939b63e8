# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""What is asked before a file or a B-rep is written: the form, its sizes, how it is printed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .backend import worker
from .exchange import ENDINGS
from .forms import Field, SettingsForm
from .places import PREFERENCES
from .properties import label_of
from .qt import QtCore, QtWidgets, run_dialog, tr

SIZES = {
    "solid": ("thickness", "skin"),
    "struts": ("diameter",),
    "beams": ("diameter",),
    "project": ("thickness",),
}
"""By form: the settings that it has to be told."""
FORM_OF = {".step": "step_as", ".3mf": "threemf_as", ".stl": "stl_as"}
"""By the file's ending: the setting that names what it may hold."""


def declared(name: str) -> dict[str, Any]:
    """One setting of export, as v3dcad declares it."""
    return next(one for one in worker.settings if one["group"] == "export" and one["name"] == name)


def _buttons(dialog: Any, layout: Any) -> None:
    box = QtWidgets.QDialogButtonBox(
        QtWidgets.QDialogButtonBox.Ok | QtWidgets.QDialogButtonBox.Cancel
    )
    box.accepted.connect(dialog.accept)
    box.rejected.connect(dialog.reject)
    layout.addWidget(box)


class FormDialog(QtWidgets.QDialog):
    """Which form, and its sizes."""

    def __init__(self, title: str, forms: tuple[str, ...], parent: Any = None) -> None:
        super().__init__(parent)
        self.setObjectName("v3dcad-form")
        self.setWindowTitle(title)
        layout = QtWidgets.QVBoxLayout(self)
        rows = QtWidgets.QFormLayout()
        layout.addLayout(rows)
        self.form = QtWidgets.QComboBox()
        for form in forms:
            self.form.addItem(tr("thick walls" if form == "solid" else form), form)
        rows.addRow(tr("Form"), self.form)
        self.sizes = {}
        for name in ("thickness", "skin", "diameter"):
            self.sizes[name] = Field(declared(name), lambda: None)
            rows.addRow(label_of(name), self.sizes[name].whole)
        self.form.currentIndexChanged.connect(lambda _: self._show())
        self._show()
        _buttons(self, layout)

    def _show(self) -> None:
        wanted = SIZES.get(self.form.currentData(), ())
        for name, size in self.sizes.items():
            size.whole.setEnabled(name in wanted)

    def values(self) -> tuple[str, dict[str, float]]:
        """The form, and its sizes in mm."""
        form = self.form.currentData()
        return form, {name: self.sizes[name].value() for name in SIZES.get(form, ())}


class PrintSettingsDialog(QtWidgets.QDialog):
    """How the fill is printed: a machine profile, and what shall be otherwise."""

    def __init__(self, parent: Any = None) -> None:
        super().__init__(parent)
        self.setObjectName("v3dcad-print-settings")
        self.setWindowTitle(tr("G-code"))
        self.resize(440, 600)
        layout = QtWidgets.QVBoxLayout(self)
        row = QtWidgets.QFormLayout()
        self.profile = QtWidgets.QLineEdit(PREFERENCES.GetString("Profile", ""))
        self.profile.setPlaceholderText(tr("generic-marlin, ender3v2 or a file of yours"))
        row.addRow(tr("Machine profile"), self.profile)
        layout.addLayout(row)
        note = QtWidgets.QLabel(tr("What is changed here goes before the profile."))
        layout.addWidget(note)
        self.fields = SettingsForm([one for one in worker.settings if one["group"] == "print"])
        area = QtWidgets.QScrollArea()
        area.setWidget(self.fields)
        area.setWidgetResizable(True)
        area.setHorizontalScrollBarPolicy(QtCore.Qt.ScrollBarAlwaysOff)
        layout.addWidget(area)
        _buttons(self, layout)

    def options(self) -> dict[str, Any]:
        """Profile and settings for the worker's `export`."""
        profile = self.profile.text().strip()
        PREFERENCES.SetString("Profile", profile)
        return {"print": self.fields.changed_values(), "profile": profile or None}


def ask_export(fill: Any, parent: Any) -> tuple[str, dict[str, Any]] | None:
    """Where to write, and how; None where the user changed their mind."""
    start = str(Path(PREFERENCES.GetString("Folder", "")) / fill.Label)
    path, chosen = QtWidgets.QFileDialog.getSaveFileName(
        parent, tr("Export"), start, ";;".join(ENDINGS.values())
    )
    if not path:
        return None
    ending = Path(path).suffix.lower()
    if ending not in ENDINGS:
        ending = next(end for end, text in ENDINGS.items() if text == chosen)
        path += ending
    PREFERENCES.SetString("Folder", str(Path(path).parent))
    if ending == ".gcode":
        dialog = PrintSettingsDialog(parent)
        return (path, dialog.options()) if run_dialog(dialog) else None
    if ending in FORM_OF:
        forms = tuple(declared(FORM_OF[ending])["choices"])
        choice = FormDialog(tr("Export"), forms, parent)
        if not run_dialog(choice):
            return None
        form, sizes = choice.values()
        return path, {"form": form, **sizes}
    return path, {}
