# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""The page of FreeCAD's preferences."""

from __future__ import annotations

from .features import SHAPE_UP_TO
from .places import PREFERENCES
from .qt import QtWidgets, run_dialog, tr


class PreferencePage:
    """Which Python runs v3dcad, and up to how many edges a fill is a shape."""

    def __init__(self, parent: object = None) -> None:
        self.form = QtWidgets.QWidget()
        self.form.setWindowTitle(tr("Voronoi 3D"))
        layout = QtWidgets.QFormLayout(self.form)
        self.python = QtWidgets.QLineEdit()
        self.python.setPlaceholderText(tr("the environment that the set-up makes"))
        self.limit = QtWidgets.QSpinBox()
        self.limit.setRange(0, 200_000)
        self.limit.setSingleStep(1000)
        self.limit.setToolTip(
            tr("Above it a fill is shown as lines: quicker, without edges that can be chosen.")
        )
        button = QtWidgets.QPushButton(tr("Set up, repair, reset…"))
        button.clicked.connect(lambda: self._set_up())
        layout.addRow(tr("Python with v3dcad"), self.python)
        layout.addRow(tr("Edges up to which a fill is a shape"), self.limit)
        layout.addRow(button)

    def _set_up(self) -> None:
        from .setup_dialog import SetupDialog

        run_dialog(SetupDialog(self.form))
        self.python.setText(PREFERENCES.GetString("Python", ""))

    def loadSettings(self) -> None:  # noqa: N802, FreeCAD's name
        """Show what is set."""
        self.python.setText(PREFERENCES.GetString("Python", ""))
        self.limit.setValue(PREFERENCES.GetInt("ShapeUpTo", SHAPE_UP_TO))

    def saveSettings(self) -> None:  # noqa: N802
        """Keep what was set."""
        PREFERENCES.SetString("Python", self.python.text().strip())
        PREFERENCES.SetInt("ShapeUpTo", self.limit.value())
