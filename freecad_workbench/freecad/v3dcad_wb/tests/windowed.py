# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""FreeCAD with a window: the registered commands are pressed, and pictures taken of what they show.

`freecad windowed.py`, with V3DCAD_SHOTS naming a folder for pictures. Ends with exit code 0 if all
went well. V3DCAD_BREAK=1 makes one check wrong, to show that the run can fail.
"""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
import time
import traceback
from pathlib import Path
from typing import Any

import FreeCAD as App
import FreeCADGui as Gui
from freecad.v3dcad_wb import commands
from freecad.v3dcad_wb.backend import worker
from freecad.v3dcad_wb.features import FRESH
from freecad.v3dcad_wb.forms import Number
from freecad.v3dcad_wb.qt import QAction, QtCore, QtWidgets

SHOTS = Path(os.environ.get("V3DCAD_SHOTS", "."))
LIMIT = 240.0


def say(*words: Any) -> None:
    print(*words, file=sys.__stderr__, flush=True)


def pump(seconds: float) -> None:
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        QtWidgets.QApplication.processEvents(QtCore.QEventLoop.AllEvents, 10)


def until(what: Any, limit: float = LIMIT) -> float:
    """Go on until something is true; how long it took, s."""
    begun = time.perf_counter()
    while not what():
        assert time.perf_counter() - begun < limit, f"waited {limit} s in vain"
        QtWidgets.QApplication.processEvents(QtCore.QEventLoop.AllEvents, 5)
    return time.perf_counter() - begun


def idle() -> bool:
    return worker.running is None and not worker.waiting


def shot(name: str) -> None:
    pump(0.5)
    subprocess.run(["import", "-window", "root", str(SHOTS / f"{name}.png")], check=True)


def press(command: str) -> None:
    """Press the button or menu entry of a registered command."""
    actions = [
        one for one in Gui.getMainWindow().findChildren(QAction) if one.objectName() == command
    ]
    assert actions, f"{command} is not registered"
    assert actions[0].isEnabled(), f"{command} is greyed"
    actions[0].trigger()


def select(*objects: Any) -> None:
    Gui.Selection.clearSelection()
    for one in objects:
        Gui.Selection.addSelection(one.Document.Name, one.Name)
    pump(0.3)


def message() -> str:
    """The text of the message box that is shown; it is closed."""
    pump(0.2)
    boxes = [
        one for one in QtWidgets.QApplication.topLevelWidgets()
        if one.objectName() == "v3dcad-message" and one.isVisible()
    ]  # fmt: skip
    assert len(boxes) == 1, "no message was shown"
    text = str(boxes[0].text())
    boxes[0].close()
    boxes[0].deleteLater()
    pump(0.2)
    return text


def panel_widget(name: str, kind: Any = QtWidgets.QWidget) -> Any:
    found = [one for one in Gui.getMainWindow().findChildren(kind, name) if one.isVisible()]
    assert found, f"no {name} is shown"
    return found[0]


def close_panel() -> None:
    """Press Close, or Cancel where a fill is edited."""
    if Gui.Control.activeDialog():
        press_button("Cancel" if Gui.ActiveDocument.getInEdit() else "Close")


def press_button(text: str) -> None:
    """A button of the task panel."""
    buttons = [
        one for one in Gui.getMainWindow().findChildren(QtWidgets.QPushButton)
        if one.text().replace("&", "") == text and one.isVisible()
    ]  # fmt: skip
    assert buttons, f"no button {text}"
    buttons[0].click()
    pump(0.2)


def new_document(name: str) -> Any:
    document = App.newDocument(name)
    view = Gui.ActiveDocument.ActiveView
    view.setAnimationEnabled(False)
    view.viewIsometric()
    return document


def cone(document: Any) -> Any:
    part = document.addObject("Part::Cone", "Cone")
    part.Radius1, part.Radius2, part.Height = 20, 8, 18
    document.recompute()
    Gui.SendMsgToActiveView("ViewFit")
    return part


def fill_of(document: Any) -> Any:
    return document.getObject("VoronoiFill")


def check_commands_are_there() -> None:
    window = Gui.getMainWindow()
    Gui.activateWorkbench("VoronoiWorkbench")
    pump(0.3)
    bars = [
        bar for bar in window.findChildren(QtWidgets.QToolBar) if bar.windowTitle() == "Voronoi 3D"
    ]
    assert bars, "no toolbar"
    assert bars[0].isVisible(), "the toolbar is hidden"
    window.resizeDocks(
        [one for one in window.findChildren(QtWidgets.QDockWidget) if one.isVisible()][:1],
        [400],
        QtCore.Qt.Horizontal,
    )
    menus = [one.title().replace("&", "") for one in window.menuBar().findChildren(QtWidgets.QMenu)]
    assert "Voronoi 3D" in menus, menus
    until(lambda: bool(worker.settings))


def check_wrong_selections() -> None:
    document = new_document("Wrong")
    for kind, words in (
        ("Sketcher::SketchObject", "encloses no volume"),
        ("Part::Feature", "has no shape"),
        ("Mesh::Feature", "is an open mesh"),
    ):
        thing = document.addObject(kind, "Thing")
        if kind.startswith("Sketcher"):
            import Part

            thing.addGeometry(Part.Circle(), False)
        if kind.startswith("Mesh"):
            import Mesh

            thing.Mesh = Mesh.Mesh([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
        document.recompute()
        select(thing)
        before = len(document.Objects)
        press("V3dcad_Fill")
        text = message()
        assert words in text, text
        assert len(document.Objects) == before
    Gui.Selection.clearSelection()
    press("V3dcad_Fill")
    assert "Select a solid" in message()
    App.closeDocument(document.Name)


def check_fill_by_command() -> None:
    document = new_document("Fill")
    part = cone(document)
    select(part)
    press("V3dcad_Fill")
    assert fill_of(document) is not None
    until(idle)
    fill = fill_of(document)
    assert fill.Status == FRESH, fill.Status
    count = fill.Shape.countElement("Edge")
    assert count == fill.Edges, (count, fill.Edges)
    assert fill.MassMade > 0
    assert fill.Certificate
    assert fill.Checksum
    box, whole = fill.Shape.optimalBoundingBox(False), part.Shape.optimalBoundingBox(False)
    whole.enlarge(1e-3)
    assert whole.isInside(box), (whole, box)
    fit()
    shot("fill")


def fit() -> None:
    Gui.ActiveDocument.ActiveView.viewIsometric()
    Gui.SendMsgToActiveView("ViewFit")
    pump(0.3)


def check_live_preview() -> None:
    fill = fill_of(App.ActiveDocument)
    slider = panel_widget("layer", QtWidgets.QSlider)
    said = panel_widget("said", QtWidgets.QLabel)
    until(idle)
    times = []
    for value in range(10, 40, 3):
        begun = time.perf_counter()
        slider.setValue(value)
        until(idle)
        times.append(time.perf_counter() - begun)
    say("preview ms", [round(1000 * one) for one in times])
    size = panel_widget("cell_size").findChild(Number)
    words = panel_widget("cell_size").findChild(QtWidgets.QComboBox)
    words.setCurrentIndex(words.findData("given"))
    for value in (6.0, 7.0, 8.0, 9.0):
        size.setValue(value)
    assert len(worker.waiting) <= 1, "only the newest request is kept"
    until(idle)
    assert said.text()
    shot("panel")
    press_button("OK")
    until(idle)
    assert fill.CellSize.Value == 9.0
    assert fill.CellSizeFrom == "given"
    assert fill.Status == FRESH


def check_cells_of_many_sizes() -> None:
    """The panel of a fill of its own: an expression, then faces that are chosen in the view."""
    document = new_document("Sizes")
    part = cone(document)
    select(part)
    press("V3dcad_Fill")
    until(idle)
    fill, said = fill_of(document), panel_widget("said", QtWidgets.QLabel)
    words = panel_widget("cell_size").findChild(QtWidgets.QComboBox)
    words.setCurrentIndex(words.findData("expression"))
    assert "Write the cell size" in said.text(), said.text()
    panel_widget("CellSizeExpression", QtWidgets.QLineEdit).setText("3 + q")
    until(idle)
    assert "'q' is not known" in said.text(), said.text()
    panel_widget("CellSizeExpression", QtWidgets.QLineEdit).setText("6 + 0.1 * z")
    until(idle)
    assert "layer" in said.text().lower(), said.text()
    press_button("Apply")
    until(idle)
    assert (fill.Status, fill.CellSizeFrom) == (FRESH, "expression"), fill.Status
    by_expression = fill.Checksum
    words.setCurrentIndex(words.findData("faces"))
    assert "Select faces" in said.text(), said.text()
    Gui.Selection.clearSelection()
    Gui.Selection.addSelection(document.Name, part.Name, "Face1")
    pump(0.2)
    panel_widget("NearFaces", QtWidgets.QPushButton).click()
    until(idle)
    panel_widget("FineSize", Number).setValue(5)
    panel_widget("CoarseFrom", Number).setValue(12)
    until(idle)
    assert panel_widget("NearFaces", QtWidgets.QPushButton).text() == f"{part.Label} Face1"
    shot("sizes")
    press_button("OK")
    until(idle)
    assert (fill.Status, fill.CellSizeFrom) == (FRESH, "faces"), fill.Status
    assert fill.NearFaces == [(part, ("Face1",))]
    assert fill.Checksum != by_expression
    App.closeDocument(document.Name)
    App.setActiveDocument("Fill")
    Gui.ActiveDocument = Gui.getDocument("Fill")


def check_cells_under_roofs() -> None:
    """They come into the preview once no value changes, and not after the panel is shut."""
    document = new_document("Roofs")
    part = document.addObject("Part::Box", "Box")
    part.Length = part.Width = 60
    document.recompute()
    select(part)
    press("V3dcad_Fill")
    until(idle)
    asked, ask = [], worker.ask
    worker.ask = lambda job: (asked.append(job.request["settings"]["roof_size"]), ask(job))
    try:
        roofs = panel_widget("roof_size")
        words = roofs.findChild(QtWidgets.QComboBox)
        words.setCurrentIndex(words.findData("given"))
        roofs.findChild(Number).setValue(5)
        until(lambda: asked and asked[-1] == 5)
        until(idle)
        assert asked[0] == "off", asked
        asked.clear()
        roofs.findChild(Number).setValue(6)
        press_button("Cancel")
        pump(1)
        assert asked == ["off"], asked
    finally:
        worker.ask = ask
    App.closeDocument(document.Name)
    App.setActiveDocument("Fill")
    Gui.ActiveDocument = Gui.getDocument("Fill")


def check_changed_source_and_undo() -> None:
    document = App.ActiveDocument
    fill, part = fill_of(document), document.Cone
    before, checksum = fill.Edges, fill.Checksum
    document.openTransaction("taller")
    part.Height = 15
    document.commitTransaction()
    document.recompute()
    assert fill.Status != FRESH
    until(idle)
    assert fill.Status == FRESH
    assert fill.Edges != before
    assert fill.Shape.BoundBox.ZMax < 15.01
    document.undo()
    document.undo()
    document.recompute()
    until(idle)
    assert (fill.Checksum, fill.Edges) == (checksum, before), "undo"
    assert fill.Status == FRESH
    document.redo()
    document.redo()
    document.recompute()
    until(idle)
    assert fill.Shape.BoundBox.ZMax < 15.01, "redo"
    assert fill.Status == FRESH


def begin_to_fill_long(fill: Any) -> None:
    fill.LayerHeight = 0.0005
    fill.Document.recompute()
    until(lambda: worker.running is not None)


def fill_quickly(fill: Any) -> None:
    fill.LayerHeight = 0.3
    fill.Document.recompute()
    until(idle)
    assert fill.Status == FRESH


def check_cancel() -> None:
    fill = fill_of(App.ActiveDocument)
    made, edges = fill.Made, fill.Edges
    begin_to_fill_long(fill)
    process = worker._process.processId()
    pump(0.7)
    shot("progress")
    button = panel_widget("v3dcad-progress").findChild(QtWidgets.QPushButton)
    button.click()
    assert "cancelled" in fill.Status, fill.Status
    assert fill.Made == made
    assert fill.Edges == edges
    until(lambda: not Path(f"/proc/{process}").exists(), 10)
    fill_quickly(fill)


def check_crash() -> None:
    fill = fill_of(App.ActiveDocument)
    edges = fill.Edges
    begin_to_fill_long(fill)
    pump(0.2)
    os.kill(worker._process.processId(), 11)
    until(idle)
    assert "ended in the middle" in fill.Status, fill.Status
    assert fill.Edges == edges
    fill_quickly(fill)


def check_two_fills_and_closing() -> None:
    document = new_document("Two")
    parts = []
    for k in range(2):
        box = document.addObject("Part::Box", "Box")
        box.Placement.Base.x = 20 * k
        parts.append(box)
    document.recompute()
    select(*parts)
    press("V3dcad_Fill")
    until(idle)
    fills = [obj for obj in document.Objects if obj.Name.startswith("VoronoiFill")]
    assert [fill.Status for fill in fills] == [FRESH, FRESH]
    assert abs(fills[1].Shape.BoundBox.XMin - 20) < 0.01, "lies where its source lies"
    fills[0].LayerHeight = 0.01
    document.recompute()
    App.closeDocument(document.Name)
    until(idle)


def check_out_of_range_and_deleted_source() -> None:
    document = App.getDocument("Fill")
    App.setActiveDocument("Fill")
    fill = fill_of(document)
    edges = fill.Edges
    fill.MaxOverhang = 5
    document.recompute()
    until(idle)
    assert "failed: Max overhang" in fill.Status, fill.Status
    assert fill.Edges == edges
    fill.MaxOverhang = 45
    document.recompute()
    until(idle)
    assert fill.Status == FRESH
    document.openTransaction("delete")
    document.removeObject("Cone")
    document.commitTransaction()
    document.recompute()
    fill.touch()
    document.recompute()
    assert "deleted" in fill.Status, fill.Status
    assert fill.Edges == edges
    document.undo()
    document.recompute()
    until(idle)
    assert fill.Status == FRESH, fill.Status


def check_show() -> None:
    document = App.getDocument("Fill")
    fill = fill_of(document)
    close_panel()
    for target in ("layer", "cell", "neighbours", "tree", "cut"):
        select(fill)
        press(f"V3dcad_Show_{target}")
        until(idle)
        said = panel_widget("said", QtWidgets.QLabel)
        assert said.text(), target
        Gui.ActiveDocument.ActiveView.viewTop() if target != "cut" else fit()
        Gui.SendMsgToActiveView("ViewFit")
        shot(f"show-{target}")
        close_panel()
        assert fill.ViewObject.Visibility
        fit()


def answer_dialog(name: str, act: Any) -> None:
    """Have a modal dialog answered as soon as it is there."""

    def look() -> None:
        for one in QtWidgets.QApplication.topLevelWidgets():
            if one.objectName() == name and one.isVisible():
                return act(one)
        return QtCore.QTimer.singleShot(100, look)

    QtCore.QTimer.singleShot(100, look)


def check_brep() -> None:
    document = App.getDocument("Fill")
    select(fill_of(document))

    def choose(dialog: Any) -> None:
        dialog.form.setCurrentIndex(dialog.form.findData("cells"))
        shot("brep-dialog")
        dialog.accept()

    answer_dialog("v3dcad-form", choose)
    press("V3dcad_Brep")
    until(idle)
    made = document.getObject("VoronoiCells")
    assert made is not None
    assert len(made.Shape.Solids) > 1
    whole = document.Cone.Shape.Volume
    assert abs(sum(cell.Volume for cell in made.Shape.Solids) / whole - 1) < 0.01
    fill_of(document).ViewObject.Visibility = False
    fit()
    shot("cells")
    made.ViewObject.Visibility = False
    fill_of(document).ViewObject.Visibility = True


def check_export_and_import() -> None:
    from freecad.v3dcad_wb import exchange

    document = App.getDocument("Fill")
    fill = fill_of(document)
    folder = Path(os.environ["V3DCAD_OUT"]) / "with space ü"
    folder.mkdir(exist_ok=True)
    for ending in ("gcode", "ont", "step", "3mf", "stl"):
        path = folder / f"a.{ending}"
        told: list[Any] = []
        exchange.export_fill(fill, str(path), {}, told.append, told.append)
        until(idle)
        assert path.is_file(), (ending, told)
        assert path.stat().st_size > 1000, ending
    registered = importlib.import_module(App.getExportType("ont")[0])
    registered.export([fill], str(folder / "b.ont"))
    until(idle)
    assert (folder / "a.ont").read_bytes() == (folder / "b.ont").read_bytes()
    importlib.import_module(App.getImportType("ont")[0]).open(str(folder / "a.ont"))
    until(idle)
    opened = fill_of(App.ActiveDocument)
    assert opened.Status == FRESH, opened.Status
    assert opened.Checksum == fill.Checksum
    shot("imported")
    App.closeDocument(App.ActiveDocument.Name)


def check_many_lines() -> None:
    App.setActiveDocument("Fill")
    document = App.getDocument("Fill")
    fill = fill_of(document)
    fill.LayerHeight = 0.05
    fill.CellSize = 4
    document.recompute()
    until(idle)
    assert fill.Status == FRESH, fill.Status
    assert fill.Edges > 20_000
    assert fill.Shape.isNull()
    fit()
    shot("lines")
    path = Path(os.environ["V3DCAD_OUT"]) / "many ü.FCStd"
    document.saveAs(str(path))
    edges = fill.Edges
    App.closeDocument(document.Name)
    again = App.openDocument(str(path))
    pump(0.5)
    fill = fill_of(again)
    assert fill.Status == FRESH
    assert fill.Edges == edges
    assert "Touched" not in fill.State
    assert worker.running is None, "opening computes nothing"
    assert fill.ViewObject.Proxy.lines._lines.coordIndex.getNum() == 3 * edges
    App.closeDocument(again.Name)


def check_print_panel() -> None:
    new_document("Print")
    press("V3dcad_Print")
    pump(2.5)
    shot("print")
    assert not panel_widget("go", QtWidgets.QPushButton).isEnabled(), "no printer is chosen for you"
    close_panel()
    App.closeDocument("Print")


def say_yes() -> None:
    """Have the next question answered by Yes."""

    def look() -> None:
        for one in QtWidgets.QApplication.topLevelWidgets():
            if isinstance(one, QtWidgets.QMessageBox) and one.isVisible():
                return one.button(QtWidgets.QMessageBox.Yes).click()
        return QtCore.QTimer.singleShot(100, look)

    QtCore.QTimer.singleShot(100, look)


def choose_to_print(name: str, printer: str) -> Any:
    """Fill a box and have it printed on a port, or sent to a printer; the panel's word label."""
    from freecad.v3dcad_wb.features import make_voronoi_fill

    document = new_document(name)
    box = document.addObject("Part::Box", "Box")
    document.recompute()
    settings = {"layer_height": 0.4, "cell_size": 5.0}
    fill = make_voronoi_fill(document, box, settings)
    until(lambda: fill.Status == FRESH and idle())
    fit()
    select(fill)
    press("V3dcad_Print")
    pump(0.3)
    printers = panel_widget("printer", QtWidgets.QComboBox)
    if not printer.startswith("/"):
        until(lambda: printers.findText(printer) >= 0, 60)
    printers.setEditText(printer)
    say_yes()
    panel_widget("go", QtWidgets.QPushButton).click()
    return panel_widget("said", QtWidgets.QLabel)


def start_print(name: str) -> Any:
    """Fill a box and print it on the port that V3DCAD_PORT names; the panel's word label."""
    said = choose_to_print(name, os.environ["V3DCAD_PORT"])
    until(lambda: "layer" in said.text() or fail_on_end(said.text()), 60)
    return said


def fail_on_end(text: str) -> bool:
    assert "ended" not in text, text
    assert "v3dcad:" not in text, text
    return False


def check_print_pause_and_cancel() -> None:
    if "V3DCAD_PORT" not in os.environ:
        return
    said = start_print("Printing")
    press_button("Pause")
    until(lambda: "paused" in said.text(), 60)
    shot("printing")
    press_button("Resume")
    until(lambda: "printing" in said.text(), 60)
    press_button("Close")
    press("V3dcad_Print")
    pump(0.5)
    said = panel_widget("said", QtWidgets.QLabel)
    until(lambda: "layer" in said.text(), 60)
    press_button("Cancel")
    until(lambda: "cancelled" in said.text(), 60)
    from freecad.v3dcad_wb.printing import prints_folder

    assert not list(prints_folder().iterdir()), "the print's folder is gone"
    close_panel()
    App.closeDocument("Printing")


def check_send() -> None:
    """To the printer that V3DCAD_SEND_TO names, as the panel lists it."""
    if "V3DCAD_SEND_TO" not in os.environ:
        return
    said = choose_to_print("Send", os.environ["V3DCAD_SEND_TO"])
    until(lambda: "sent to" in said.text() or fail_on_end(said.text()), 60)
    assert "not started" in said.text(), said.text()
    shot("sent")
    close_panel()
    App.closeDocument("Send")


def check_print_and_leave() -> None:
    """The last check of its own run: FreeCAD ends while the print goes on."""
    if "V3DCAD_LEAVE" in os.environ:
        start_print("Leave")


def check_setup_dialog() -> None:
    def look(dialog: Any) -> None:
        shot("setup")
        dialog.reject()

    answer_dialog("v3dcad-setup", look)
    press("V3dcad_Setup")


def check_setup_failures() -> None:
    """Each cause is told in words; what was begun is removed or can be repaired."""
    from freecad.v3dcad_wb import environment
    from freecad.v3dcad_wb.setup_dialog import SetupDialog

    dialog = SetupDialog(Gui.getMainWindow())
    dialog.show()
    nowhere = {"PIP_INDEX_URL": "http://127.0.0.1:9/", "PIP_RETRIES": "0"}
    nowhere |= {"PIP_CONFIG_FILE": os.devnull, "PIP_EXTRA_INDEX_URL": "", "PIP_FIND_LINKS": ""}
    before = {name: os.environ.get(name) for name in nowhere}
    named, bases = os.environ.pop("V3DCAD_PYTHON"), environment.base_pythons
    fake = Path(os.environ["V3DCAD_OUT"]) / "fake-python"
    fake.write_text("#!/bin/sh\necho No module named ensurepip >&2\nexit 1\n")
    fake.chmod(0o755)
    try:
        environment.base_pythons = lambda: [str(fake)]
        dialog.set_up()
        until(lambda: dialog.process is None)
        assert "python3-venv" in dialog.said.text(), dialog.said.text()
        environment.base_pythons = bases
        dialog.set_up()
        until(lambda: dialog.step.arguments[0] != "-c")
        dialog.buttons["cancel"].click()
        assert dialog.said.text() == "cancelled"
        assert not environment.folder().exists()
        os.environ.update(nowhere)
        dialog.set_up()
        until(lambda: dialog.process is None)
        assert "cannot be reached" in dialog.said.text(), dialog.log.toPlainText()[-2000:]
        shot("setup-failed")
        dialog.set_up()
        until(lambda: "install" in dialog.step.arguments)
        dialog.process.kill()
        until(lambda: dialog.process is None)
        assert "ended from outside" in dialog.said.text(), dialog.said.text()
        dialog.use("/usr/bin/env")
        assert "has no v3dcad" in dialog.said.text(), dialog.said.text()
        dialog.use(named)
        assert "runs v3dcad" in dialog.said.text(), dialog.said.text()
        until(idle)
        dialog.reset()
        assert "not set up" in dialog.said.text()
    finally:
        environment.base_pythons = bases
        os.environ["V3DCAD_PYTHON"] = named
        for name, value in before.items():
            os.environ.pop(name, None)
            if value is not None:
                os.environ[name] = value
    dialog.reject()


def check_setup_for_real() -> None:
    """Loads all of v3dcad from the index: only where V3DCAD_SETUP asks for it."""
    if "V3DCAD_SETUP" not in os.environ:
        return
    from freecad.v3dcad_wb import environment
    from freecad.v3dcad_wb.setup_dialog import SetupDialog

    os.environ.pop("V3DCAD_PYTHON")
    worker.close()
    dialog = SetupDialog(Gui.getMainWindow())
    dialog.show()
    dialog.set_up()
    pump(3)
    shot("setup-running")
    say("set-up s", round(until(lambda: dialog.process is None, 900)), dialog.said.text())
    assert environment.missing() is None, dialog.log.toPlainText()[-3000:]
    until(idle)
    document = new_document("Own")
    part = cone(document)
    select(part)
    press("V3dcad_Fill")
    until(idle)
    assert fill_of(document).Status == FRESH, fill_of(document).Status
    close_panel()


def check_no_environment() -> None:
    named = os.environ.pop("V3DCAD_PYTHON")
    worker.close()
    document = new_document("None")
    part = cone(document)
    select(part)
    Gui.updateGui()
    pump(1.5)
    actions = [
        one for one in Gui.getMainWindow().findChildren(QAction)
        if one.objectName().startswith("V3dcad_")
    ]  # fmt: skip
    commands.show_reason()
    for action in actions:
        if not action.isEnabled() and action.objectName() != "V3dcad_Show":
            assert "not set up" in action.toolTip(), action.objectName()
        assert action.isEnabled() == (action.objectName() == "V3dcad_Setup"), action.objectName()
    from freecad.v3dcad_wb.features import make_voronoi_fill

    fill = make_voronoi_fill(document, part)
    assert "not set up" in fill.Status, fill.Status
    shot("not-set-up")
    os.environ["V3DCAD_PYTHON"] = named
    document.recompute()
    fill.touch()
    document.recompute()
    until(idle)
    assert fill.Status == FRESH, fill.Status
    App.closeDocument(document.Name)


def check_turkish() -> None:
    Gui.setLocale("Turkish")
    document = new_document("Turkish")
    part = cone(document)
    select(part)
    press("V3dcad_Fill")
    until(idle)
    shot("turkish")
    assert fill_of(document).Label == "Cone içinde köpük"
    if Gui.Control.activeDialog():
        Gui.Control.closeDialog()
        Gui.ActiveDocument.resetEdit()
    App.closeDocument(document.Name)
    Gui.setLocale("English")


def check_report_view() -> None:
    views = [
        one for one in Gui.getMainWindow().findChildren(QtWidgets.QTextEdit)
        if "report" in one.objectName().lower()
    ]  # fmt: skip
    assert views, "no report view"
    text = views[0].toPlainText()
    assert "Traceback" not in text, text[-3000:]


def check_broken_on_purpose() -> None:
    if os.environ.get("V3DCAD_BREAK"):
        select(*[])
        assert fill_of(App.newDocument("Broken")) is not None, "broken on purpose"


CHECKS = [
    check_commands_are_there,
    check_broken_on_purpose,
    check_wrong_selections,
    check_fill_by_command,
    check_live_preview,
    check_cells_of_many_sizes,
    check_cells_under_roofs,
    check_changed_source_and_undo,
    check_cancel,
    check_crash,
    check_two_fills_and_closing,
    check_out_of_range_and_deleted_source,
    check_show,
    check_brep,
    check_export_and_import,
    check_many_lines,
    check_print_panel,
    check_setup_dialog,
    check_setup_failures,
    check_setup_for_real,
    check_no_environment,
    check_print_pause_and_cancel,
    check_send,
    check_turkish,
    check_report_view,
    check_print_and_leave,
]


def run() -> None:
    code = 0
    wanted = os.environ.get("V3DCAD_CHECKS", "").split()
    for check in CHECKS:
        if wanted and check.__name__.removeprefix("check_") not in wanted:
            continue
        begun = time.perf_counter()
        try:
            check()
        except BaseException:
            code = 1
            say(f"FAILED {check.__name__}\n{traceback.format_exc()}")
            shot(f"failed-{check.__name__}")
            break
        say(f"passed {check.__name__} {time.perf_counter() - begun:.1f} s")
    worker.close()
    os._exit(code)


QtCore.QTimer.singleShot(2000, run)
