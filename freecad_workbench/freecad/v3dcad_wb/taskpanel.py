# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""The task panel of a fill: settings, a preview of one layer while they change, progress."""

from __future__ import annotations

from typing import Any

import FreeCAD as App
import FreeCADGui as Gui

from . import grading, properties
from .backend import Answer, WorkerError, worker
from .features import is_there, make_voronoi_fill, request_of
from .forms import SettingsForm
from .grading_form import GradingForm
from .preview import Preview
from .qt import QtCore, QtWidgets, number_of, tr

OFTEN = ("cell_size", "stretch", "max_overhang", "layer_height", "random_seed", "method")
"""Settings that are shown first."""

REST = 400
"""ms without a change, after which the preview has narrow cells under roofs."""


class FillPanel:
    """Edits a fill; nothing of the document changes before OK or Apply."""

    def __init__(self, obj: Any) -> None:
        self.obj = obj
        self.form = QtWidgets.QWidget()
        self.form.setWindowTitle(tr("Voronoi fill"))
        layout = QtWidgets.QVBoxLayout(self.form)
        self.fields: SettingsForm | None = None
        self.request: dict[str, Any] = {}
        self.place = QtWidgets.QVBoxLayout()
        layout.addLayout(self.place)
        row = QtWidgets.QHBoxLayout()
        self.slider = QtWidgets.QSlider(QtCore.Qt.Horizontal)
        self.slider.setObjectName("layer")
        self.slider.setRange(0, max(obj.Layers - 1, 0))
        self.slider.setValue(obj.Layers // 2)
        self.layer_label = QtWidgets.QLabel()
        row.addWidget(QtWidgets.QLabel(tr("Layer")))
        row.addWidget(self.slider, 1)
        row.addWidget(self.layer_label)
        layout.addLayout(row)
        self.said = QtWidgets.QLabel(tr("Starting v3dcad"))
        self.said.setObjectName("said")
        self.said.setWordWrap(True)
        layout.addWidget(self.said)
        layout.addStretch(1)
        self.preview = Preview(obj, self.form)
        self.layers = max(obj.Layers, 1)
        self.rest = QtCore.QTimer(self.form, singleShot=True, interval=REST)
        self.rest.timeout.connect(self.ask)
        self.slider.valueChanged.connect(lambda _: self.ask())
        worker.hello(self._begin, self._refused)

    def _begin(self) -> None:
        if not is_there(self.obj):
            return
        self.obj.Proxy.add_settings(self.obj)
        try:
            _, self.request = request_of(self.obj)
        except WorkerError as error:
            return self._refused(error)
        fill = properties.of_fill(worker.settings)
        rank = {name: k for k, name in enumerate(OFTEN)}
        fill.sort(key=lambda one: rank.get(one["name"], len(OFTEN)))
        self.fields = SettingsForm(fill, self._changed)
        self.sizes = GradingForm(self.obj, self.ask)
        self.place.addWidget(self.fields)
        self.place.addWidget(self.sizes)
        self.fields.set(properties.values_of(self.obj, worker.settings))
        self._changed()
        return None

    def _changed(self) -> None:
        settings = self.fields.values()
        self.sizes.show_way(str(settings.get("cell_size")))
        if settings.get("roof_size", "off") == "off":
            self.ask()
        else:  # cells under roofs are made for the part: that takes long while a value is dragged
            self.ask(roof_size="off")
            self.rest.start()

    def ask(self, **changed: Any) -> None:
        """Ask for the layer as the fields would make it, but for what is `changed`; only the newest
        request is kept.
        """
        if self.fields is None:
            return
        settings = {**self.fields.values(), **changed}
        if settings.get("cell_size") in properties.WAYS:
            try:
                sizes = self.sizes.sizes()
                settings["cell_size"] = grading.expression_of(sizes, self.obj, worker.folder)
            except WorkerError as error:
                return self._refused(error)
        wanted = {"settings": settings, "layer": self.slider.value()}
        self.preview.ask({**self.request, **wanted, "target": "layer"}, self._shown, self._refused)
        return None

    def _shown(self, answer: Answer) -> None:
        self.layers = answer["layers"]
        if self.slider.maximum() != self.layers - 1:
            self.slider.blockSignals(True)
            first = self.slider.maximum() == 0
            self.slider.setMaximum(self.layers - 1)
            self.slider.blockSignals(False)
            if first:
                self.slider.setValue(self.layers // 2)
        self.layer_label.setText(f"{self.slider.value() + 1} / {self.layers}")
        self.said.setText(answer["title"])

    def _refused(self, error: WorkerError) -> None:
        self.said.setText(str(error))

    def getStandardButtons(self) -> int:  # noqa: N802, FreeCAD's name
        """OK, Apply and Cancel."""
        buttons = QtWidgets.QDialogButtonBox
        return number_of(buttons.Ok | buttons.Apply | buttons.Cancel)

    def clicked(self, button: int) -> None:
        """Apply keeps the panel open."""
        if number_of(button) == number_of(QtWidgets.QDialogButtonBox.Apply):
            self.apply()

    def apply(self) -> None:
        """Set the properties in one transaction and recompute."""
        if self.fields is None or not is_there(self.obj):
            return
        document = self.obj.Document
        now, wanted = properties.values_of(self.obj, worker.settings), self.fields.values()
        graded = wanted.get("cell_size") in properties.WAYS
        sizes = self.sizes.sizes()
        resized = graded and sizes != grading.sizes_of(self.obj)
        if now != wanted or resized or self.obj.Made == "":
            document.openTransaction(tr("Edit Voronoi fill"))
            properties.set_values(self.obj, wanted, worker.settings)
            grading.set_sizes(self.obj, sizes)
            document.commitTransaction()
            document.recompute()

    def accept(self) -> bool:
        """Apply and close."""
        self.apply()
        return self.reject()

    def reject(self) -> bool:
        """Close; the preview goes."""
        self.preview.close()
        if Gui.ActiveDocument is not None and Gui.ActiveDocument.getInEdit():
            Gui.ActiveDocument.resetEdit()
        Gui.Control.closeDialog()
        return True


def fill_each(document: Any, sources: list[Any]) -> list[Any]:
    """One fill for each source, in one transaction."""
    document.openTransaction(tr("Voronoi fill"))
    try:
        fills = [make_voronoi_fill(document, source) for source in sources]
        for source in sources:
            if App.GuiUp and hasattr(source.ViewObject, "Transparency"):
                source.ViewObject.Transparency = 80
    finally:
        document.commitTransaction()
    return fills
