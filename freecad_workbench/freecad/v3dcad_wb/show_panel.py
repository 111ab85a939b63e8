# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""The panel of the thesis's preview (§3.3): a layer, a cell, its neighbours, the tree, a cut."""

from __future__ import annotations

from typing import Any

import FreeCADGui as Gui

from .backend import Answer, WorkerError, worker
from .features import request_of
from .preview import Preview
from .qt import QtCore, QtWidgets, number_of, tr

TARGETS = (
    "full", "layer", "cell", "neighbours", "neighbour", "tree", "cut", "sizes", "overhang",
    "toolpath",
)  # fmt: skip


class ShowPanel:
    """Shows a target of a fill; changes nothing of the document."""

    def __init__(self, obj: Any, target: str) -> None:
        self.obj = obj
        self.form = QtWidgets.QWidget()
        self.form.setWindowTitle(tr("Show {label}").format(label=obj.Label))
        layout = QtWidgets.QFormLayout(self.form)
        self.target = QtWidgets.QComboBox()
        for name in TARGETS:
            self.target.addItem(tr(name), name)
        self.target.setCurrentIndex(TARGETS.index(target))
        self.slider = QtWidgets.QSlider(QtCore.Qt.Horizontal)
        self.slider.setObjectName("layer")
        self.slider.setRange(0, max(obj.Layers - 1, 0))
        self.slider.setValue(obj.Layers // 2)
        self.layer_label = QtWidgets.QLabel()
        row = QtWidgets.QHBoxLayout()
        row.addWidget(self.slider, 1)
        row.addWidget(self.layer_label)
        self.cell, self.neighbour = QtWidgets.QComboBox(), QtWidgets.QComboBox()
        self.said = QtWidgets.QLabel()
        self.said.setObjectName("said")
        self.said.setWordWrap(True)
        self.legend = QtWidgets.QLabel()
        self.legend.setWordWrap(True)
        layout.addRow(tr("Show"), self.target)
        layout.addRow(tr("Layer"), row)
        layout.addRow(tr("Cell"), self.cell)
        layout.addRow(tr("Neighbour"), self.neighbour)
        layout.addRow(self.said)
        layout.addRow(self.legend)
        self.preview = Preview(obj, self.form)
        for box in (self.target, self.cell, self.neighbour):
            box.currentIndexChanged.connect(lambda _: self.ask())
        self.slider.valueChanged.connect(lambda _: self.ask())
        self.request: dict[str, Any] = {}
        worker.hello(self._begin, self._refused)

    def _begin(self) -> None:
        try:
            _, self.request = request_of(self.obj)
        except WorkerError as error:
            return self._refused(error)
        return self.ask()

    def ask(self) -> None:
        """Ask for what is chosen; only the newest request is kept."""
        target = self.target.currentData()
        self.cell.setEnabled(target in ("cell", "neighbours", "neighbour"))
        self.neighbour.setEnabled(target == "neighbour")
        request = {**self.request, "layer": self.slider.value(), "target": target}
        for name, box in (("cell", self.cell), ("neighbour", self.neighbour)):
            if box.isEnabled() and box.count():
                request[name] = int(box.currentText())
            elif box.isEnabled():  # the layer first, which says what cells there are
                request["target"] = "layer"
        self.preview.ask(request, self._shown, self._refused)

    def _shown(self, answer: Answer) -> None:
        self.slider.blockSignals(True)
        self.slider.setMaximum(answer["layers"] - 1)
        self.slider.blockSignals(False)
        self.layer_label.setText(f"{self.slider.value() + 1} / {answer['layers']}")
        first = not self.cell.count()
        for box in (self.cell, self.neighbour):
            _offer(box, [str(cell) for cell in answer["cells"]])
        if first and self.cell.isEnabled():
            self.ask()
        self.said.setText(answer["title"])
        self.legend.setText(legend_text(answer))

    def _refused(self, error: WorkerError) -> None:
        self.said.setText(str(error))

    def getStandardButtons(self) -> int:  # noqa: N802, FreeCAD's name
        """Close alone."""
        return number_of(QtWidgets.QDialogButtonBox.Close)

    def reject(self) -> bool:
        """Close; the fill is shown again."""
        self.preview.close()
        Gui.Control.closeDialog()
        return True


def legend_text(answer: Answer) -> str:
    """The names of the parts, each beside its colour."""
    rows = [
        f'<span style="color:{part["colour"]}">■</span> {part["name"]}' for part in answer["parts"]
    ]
    return "<br>".join(rows)


def _offer(box: Any, texts: list[str]) -> None:
    """Offer other cells, the chosen one kept where it is among them."""
    if [box.itemText(k) for k in range(box.count())] == texts:
        return
    chosen = box.currentText()
    box.blockSignals(True)
    box.clear()
    box.addItems(texts)
    box.setCurrentIndex(texts.index(chosen) if chosen in texts else len(texts) // 2)
    box.blockSignals(False)
