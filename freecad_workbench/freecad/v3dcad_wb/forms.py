# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Fields for declared settings: what v3dcad's `hello` names, a user can set."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import FreeCADGui as Gui

from .properties import GIVEN, Declared, help_of, label_of, limits_of, words_of
from .qt import QtWidgets, tr

LONG_TEXT = 60
"""A text with more characters, or lines, is left to profiles."""


class Number(QtWidgets.QDoubleSpinBox):
    """A number without trailing zeros, in a box that may be narrow."""

    def __init__(self) -> None:
        super().__init__()
        self.setDecimals(4)
        self.setMinimumWidth(70)

    def textFromValue(self, value: float) -> str:  # noqa: N802, Qt's name
        """As short as it can be."""
        return str(self.locale().toString(float(value), "g", 7))


class Field:
    """One setting: a number, a word in its place, a choice, a switch or a text."""

    def __init__(self, declared: Declared, changed: Callable[[], None]) -> None:
        self.declared = declared
        self.words: Any = None
        self.widget = self._value_widget(changed)
        self.whole = self.widget
        if declared["words"]:
            self.words = QtWidgets.QComboBox()
            self.words.setMinimumWidth(70)
            for word in (*words_of(declared), GIVEN):
                self.words.addItem(tr(word), word)
            self.whole = QtWidgets.QWidget()
            row = QtWidgets.QHBoxLayout(self.whole)
            row.setContentsMargins(0, 0, 0, 0)
            row.addWidget(self.words)
            row.addWidget(self.widget, 1)
            self.words.currentIndexChanged.connect(lambda _: self._word_chosen(changed))
        self.whole.setToolTip(help_of(declared))
        self.set(declared["default"])

    def _value_widget(self, changed: Callable[[], None]) -> Any:
        kind = self.declared["type"]
        if self.declared["choices"]:
            box = QtWidgets.QComboBox()
            for choice in self.declared["choices"]:
                box.addItem(tr(choice), choice)
            box.currentIndexChanged.connect(lambda _: changed())
            return box
        if kind == "bool":
            box = QtWidgets.QCheckBox()
            box.toggled.connect(lambda _: changed())
            return box
        if kind in ("int", "float"):
            least, most = limits_of(self.declared)
            if kind == "int":
                box = QtWidgets.QSpinBox()
                box.setMinimumWidth(70)
                box.setRange(int(least), int(most))
            else:
                box = Number()
                box.setRange(least, most)
                share = most <= 1
                box.setSingleStep(0.01 if share else 0.1 if self.declared["unit"] == "mm" else 1)
            unit = self.declared["unit"]
            box.setSuffix(f" {unit}" if unit else "")
            box.valueChanged.connect(lambda _: changed())
            return box
        box = QtWidgets.QLineEdit()
        box.textChanged.connect(lambda _: changed())
        return box

    def _word_chosen(self, changed: Callable[[], None]) -> None:
        self.widget.setEnabled(self.words.currentData() == GIVEN)
        changed()

    def value(self) -> Any:
        """What is set, as v3dcad takes it."""
        if self.words is not None and self.words.currentData() != GIVEN:
            return self.words.currentData()
        if self.declared["choices"]:
            return self.widget.currentData()
        if isinstance(self.widget, QtWidgets.QCheckBox):
            return self.widget.isChecked()
        if isinstance(self.widget, QtWidgets.QLineEdit):
            return self.widget.text()
        return self.widget.value()

    def set(self, value: Any) -> None:
        """Show a value."""
        if self.words is not None:
            word = value if value in words_of(self.declared) else GIVEN
            self.words.setCurrentIndex(self.words.findData(word))
            self.widget.setEnabled(word == GIVEN)
            if word != GIVEN:
                return
        if self.declared["choices"]:
            self.widget.setCurrentIndex(self.widget.findData(value))
        elif isinstance(self.widget, QtWidgets.QCheckBox):
            self.widget.setChecked(bool(value))
        elif isinstance(self.widget, QtWidgets.QLineEdit):
            self.widget.setText(str(value))
        else:
            self.widget.setValue(value)


class SettingsForm(QtWidgets.QWidget):
    """Fields one below the other; those of another method than the chosen one are hidden."""

    def __init__(
        self, settings: list[Declared], changed: Callable[[], None] = lambda: None
    ) -> None:
        super().__init__()
        self._changed = changed
        self.fields: dict[str, Field] = {}
        self._layout = layout = QtWidgets.QFormLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        told, self._changed = self._changed, lambda: None
        for one in settings:
            if one["type"] == "str" and len(str(one["default"])) > LONG_TEXT:
                continue
            field = Field(one, self._on_change)
            field.whole.setObjectName(one["name"])
            self.fields[one["name"]] = field
            layout.addRow(label_of(one["name"]), field.whole)
        self._changed = told
        self._show_method()

    def _on_change(self) -> None:
        if "method" in self.fields:
            self._show_method()
        self._changed()

    def _show_method(self) -> None:
        if "method" not in self.fields:
            return
        method = self.fields["method"].value()
        for field in self.fields.values():
            shown = field.declared["method"] in (None, method)
            label = self._layout.labelForField(field.whole)
            if label is not None:
                field.whole.setVisible(shown)
                label.setVisible(shown)

    def values(self) -> dict[str, Any]:
        """All settings of the chosen method."""
        method = self.fields["method"].value() if "method" in self.fields else None
        return {
            name: field.value()
            for name, field in self.fields.items()
            if field.declared["method"] in (None, method)
        }

    def changed_values(self) -> dict[str, Any]:
        """The settings that are not as declared: what a profile says holds for the others."""
        return {
            name: value
            for name, value in self.values().items()
            if value != self.fields[name].declared["default"]
        }

    def set(self, values: dict[str, Any]) -> None:
        """Show values, without a word to who watches."""
        told, self._changed = self._changed, lambda: None
        for name, value in values.items():
            if name in self.fields:
                self.fields[name].set(value)
        self._show_method()
        self._changed = told


def main_window() -> Any:
    """FreeCAD's window."""
    return Gui.getMainWindow()
