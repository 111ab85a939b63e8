# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Fields for cells whose size differs from place to place: those of the chosen way are shown."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import FreeCADGui as Gui

from .forms import Number
from .grading import NAMES, PROPERTIES, Sizes, is_used, results_in, sizes_of
from .qt import QtWidgets, tr

LARGEST = 1e6
"""mm or MPa."""


def label_of(name: str) -> str:
    """What a property is called in the panel."""
    labels = {
        "CellSizeExpression": tr("Expression"),
        "NearFaces": tr("Faces"),
        "CoarseFrom": tr("Coarse from"),
        "StressResult": tr("FEM result"),
        "LowStress": tr("Low stress"),
        "HighStress": tr("High stress"),
        "FineSize": tr("Fine size"),
        "CoarseSize": tr("Coarse size"),
    }
    return labels[name]


class GradingForm(QtWidgets.QWidget):
    """One field for each of the properties of `grading.PROPERTIES`."""

    def __init__(self, obj: Any, changed: Callable[[], None]) -> None:
        super().__init__()
        self._changed, self._way = changed, ""
        self._faces: list[Any] = []
        self._results = results_in(obj.Document)
        self.fields: dict[str, Any] = {}
        self._layout = QtWidgets.QFormLayout(self)
        self._layout.setContentsMargins(0, 0, 0, 0)
        for kind, name, _, _, text in PROPERTIES:
            field = self._field(kind, name)
            field.setObjectName(name)
            field.setToolTip(tr(text))
            self.fields[name] = field
            self._layout.addRow(label_of(name), field)
        self._set(sizes_of(obj))
        self.show_way("")

    def _field(self, kind: str, name: str) -> Any:
        if kind == "String":
            line = QtWidgets.QLineEdit()
            line.setPlaceholderText("3 + 0.1 * z")
            line.textChanged.connect(lambda _: self._changed())
            return line
        if kind == "LinkSubList":
            button = QtWidgets.QPushButton(tr("Take the selected faces"))
            button.clicked.connect(lambda *_: self.take_selected())
            return button
        if kind == "Link":
            box = QtWidgets.QComboBox()
            for result in self._results:
                box.addItem(result.Label)
            box.currentIndexChanged.connect(lambda _: self._changed())
            return box
        number = Number()
        number.setRange(0, LARGEST)
        number.setSuffix(" mm" if kind == "Length" else " MPa")
        number.valueChanged.connect(lambda _: self._changed())
        return number

    def take_selected(self) -> None:
        """Take the faces that are selected in the view."""
        chosen = [
            (one.Object, tuple(name for name in one.SubElementNames if "Face" in name))
            for one in Gui.Selection.getSelectionEx()
        ]
        self._faces = [(obj, names) for obj, names in chosen if names]
        self._tell_faces()
        self._changed()

    def _tell_faces(self) -> None:
        names = [f"{obj.Label} {name}" for obj, some in self._faces for name in some]
        self.fields["NearFaces"].setText(", ".join(names) or tr("Take the selected faces"))

    def _set(self, sizes: Sizes) -> None:
        told, self._changed = self._changed, lambda: None
        for name, value in sizes.values.items():
            field = self.fields[name]
            if name == "NearFaces":
                self._faces = list(value)
                self._tell_faces()
            elif name == "StressResult":
                if value in self._results:
                    field.setCurrentIndex(self._results.index(value))
            elif name == "CellSizeExpression":
                field.setText(value)
            else:
                field.setValue(value)
        self._changed = told

    def sizes(self) -> Sizes:
        """What the fields say."""
        values: dict[str, Any] = {}
        for name in NAMES:
            field = self.fields[name]
            if name == "NearFaces":
                values[name] = list(self._faces)
            elif name == "StressResult":
                index = field.currentIndex()
                values[name] = self._results[index] if index >= 0 else None
            elif name == "CellSizeExpression":
                values[name] = field.text()
            else:
                values[name] = field.value()
        return Sizes(self._way, values)

    def show_way(self, way: str) -> None:
        """Show the fields that count for a way of setting the cell size."""
        self._way = way
        for _, name, _, own, _ in PROPERTIES:
            shown = is_used(own, way)
            self.fields[name].setVisible(shown)
            self._layout.labelForField(self.fields[name]).setVisible(shown)
