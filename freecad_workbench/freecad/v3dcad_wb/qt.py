# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""The one place that knows where Qt's classes lie, and how texts are translated."""

from __future__ import annotations

from typing import Any

import FreeCAD as App
from PySide import QtCore, QtGui

try:
    from PySide import QtWidgets
except ImportError:  # FreeCAD 0.20 has no such module: its QtGui holds the widgets too
    QtWidgets = QtGui

QAction = getattr(QtGui, "QAction", None) or QtWidgets.QAction

__all__ = ["QAction", "QtCore", "QtGui", "QtWidgets", "number_of", "run_dialog", "tr"]


def tr(text: str) -> str:
    """A text in the user's language; `tools/translations.py` collects the arguments."""
    return str(App.Qt.translate("v3dcad", text))


def number_of(flag: Any) -> int:
    """A flag of Qt as FreeCAD's panels take it: Qt 6 has no `int()` for flags, Qt 5 no `value`."""
    return int(getattr(flag, "value", flag))


def run_dialog(dialog: QtWidgets.QDialog) -> bool:
    """Show a dialog until it is closed; whether it was accepted."""
    run = getattr(dialog, "exec", None) or dialog.exec_
    return bool(run())
