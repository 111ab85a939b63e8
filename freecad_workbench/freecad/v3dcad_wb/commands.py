# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""The commands of toolbar and menu. Each says by a greyed button, and why, when it cannot go."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import FreeCAD as App
import FreeCADGui as Gui

from . import environment, exchange
from .backend import WorkerError, worker
from .features import is_fill
from .forms import main_window
from .places import icon
from .qt import QAction, QtCore, QtWidgets, run_dialog, tr
from .source import can_be_filled, why_not

MANY_EDGES = 100_000
"""More edges than this make B-rep that FreeCAD is slow with."""


def selected() -> list[Any]:
    """The selected objects, each once."""
    return [one.Object for one in Gui.Selection.getSelectionEx()]


def selected_fill() -> Any:
    """The one selected fill, or the only one of the document; None otherwise."""
    fills = [obj for obj in selected() if is_fill(obj)]
    if not fills and not selected() and App.ActiveDocument is not None:
        fills = [obj for obj in App.ActiveDocument.Objects if is_fill(obj)]
    return fills[0] if len(fills) == 1 else None


def needs_worker() -> str | None:
    """Why nothing can be computed."""
    return environment.missing()


def needs_source() -> str | None:
    """Why nothing can be filled."""
    if why := needs_worker():
        return why
    chosen = [obj for obj in selected() if not is_fill(obj)]
    if not chosen:
        return tr("Select a solid, a body or a closed mesh first.")
    return next(filter(None, map(why_not, chosen)), None)


def needs_fill() -> str | None:
    """Why nothing can be done with a fill."""
    if why := needs_worker():
        return why
    if selected_fill() is None:
        return tr("Select a Voronoi fill first.")
    return None


def needs_result() -> str | None:
    """Why nothing can be done with a fill's result."""
    if why := needs_fill():
        return why
    if not selected_fill().Made:
        return tr("The fill has no result yet: recompute it.")
    return None


def always() -> str | None:
    """Nothing is needed."""
    return None


def complain(message: str) -> None:
    """Tell what went wrong, in the report view and in a box that does not block."""
    App.Console.PrintError(f"Voronoi 3D: {message}\n")
    box = QtWidgets.QMessageBox(main_window())
    box.setObjectName("v3dcad-message")
    box.setIcon(QtWidgets.QMessageBox.Warning)
    box.setWindowTitle("Voronoi 3D")
    box.setText(message)
    box.setModal(False)
    box.show()


@dataclass
class Command:
    """One registered command."""

    text: str
    tip: str
    picture: str
    needs: Callable[[], str | None]
    run: Callable[[], None]
    key: str = ""

    def GetResources(self) -> dict[str, str]:  # noqa: N802, FreeCAD's names
        """Text, help and icon."""
        found = {"MenuText": tr(self.text), "ToolTip": tr(self.tip), "Pixmap": icon(self.picture)}
        return {**found, "Accel": self.key} if self.key else found

    def IsActive(self) -> bool:  # noqa: N802
        """Greyed until the environment is there; what else is missing is said when pressed."""
        return self.needs is always or (
            App.ActiveDocument is not None and environment.missing() is None
        )

    def Activated(self, index: int = 0) -> None:  # noqa: N802
        """Do it, or say why not."""
        if why := self.needs():
            return complain(why)
        try:
            return self.run()
        except WorkerError as error:
            return complain(str(error))


class Group:
    """Several commands behind one button."""

    def __init__(self, text: str, names: list[str]) -> None:
        self.text, self.names = text, names

    def GetCommands(self) -> tuple[str, ...]:  # noqa: N802
        """The commands behind it."""
        return tuple(self.names)

    def GetResources(self) -> dict[str, str]:  # noqa: N802
        """Text and help."""
        return {"MenuText": tr(self.text), "ToolTip": tr(self.text)}

    def IsActive(self) -> bool:  # noqa: N802
        """As its commands."""
        return App.ActiveDocument is not None and environment.missing() is None


def _fill() -> None:
    from .taskpanel import fill_each

    sources = [obj for obj in selected() if can_be_filled(obj) and not is_fill(obj)]
    fills = fill_each(App.ActiveDocument, sources)
    Gui.Selection.clearSelection()
    if len(fills) == 1:
        Gui.ActiveDocument.setEdit(fills[0].Name)


def _edit() -> None:
    Gui.ActiveDocument.setEdit(selected_fill().Name)


def _show(target: str) -> Callable[[], None]:
    def run() -> None:
        from .show_panel import ShowPanel

        if Gui.ActiveDocument.getInEdit():
            Gui.ActiveDocument.resetEdit()
        Gui.Control.closeDialog()
        Gui.Control.showDialog(ShowPanel(selected_fill(), target))

    return run


def _brep() -> None:
    from .export_dialogs import FormDialog

    fill = selected_fill()
    dialog = FormDialog(tr("Create B-rep"), exchange.BREP_FORMS, main_window())
    if not run_dialog(dialog):
        return
    form, sizes = dialog.values()
    if fill.Edges > MANY_EDGES:
        text = tr("{count} edges: FreeCAD may be slow for minutes. Go on?")
        asked = QtWidgets.QMessageBox.question(
            main_window(), "Voronoi 3D", text.format(count=fill.Edges)
        )
        if asked != QtWidgets.QMessageBox.Yes:
            return
    exchange.create_brep(fill, form, sizes, lambda _: None, lambda error: complain(str(error)))


def _export() -> None:
    from .export_dialogs import ask_export

    fill = selected_fill()
    wanted = ask_export(fill, main_window())
    if wanted is not None:
        path, options = wanted
        exchange.export_fill(fill, path, options, _exported, lambda error: complain(str(error)))


def _exported(answer: dict[str, Any]) -> None:
    for line in answer["lines"]:
        App.Console.PrintMessage(f"{line}\n")
    main_window().statusBar().showMessage(tr("written"), 5000)


def _import() -> None:
    path, _ = QtWidgets.QFileDialog.getOpenFileName(
        main_window(), tr("Import .ont"), "", "Voronoi foam (*.ont)"
    )
    if path:
        document = App.ActiveDocument or App.newDocument()
        exchange.insert(path, document.Name)


def _print() -> None:
    from .print_panel import PrintPanel

    Gui.Control.closeDialog()
    Gui.Control.showDialog(PrintPanel(selected_fill()))


def _set_up() -> None:
    from .setup_dialog import SetupDialog

    run_dialog(SetupDialog(main_window()))
    show_reason()


SHOWN = ("layer", "cell", "neighbours", "tree", "cut")

COMMANDS: dict[str, Command | Group] = {
    "V3dcad_Fill": Command(
        "Voronoi fill",
        "Fill the selected solids, bodies or meshes with a foam that prints without support",
        "fill",
        needs_source,
        _fill,
        "V, F",
    ),
    "V3dcad_Edit": Command(
        "Edit", "Change the selected fill, with a preview of one layer", "edit", needs_fill, _edit
    ),
    "V3dcad_Show_layer": Command(
        "Show layer", "Show one layer of the fill", "show-layer", needs_result, _show("layer")
    ),
    "V3dcad_Show_cell": Command(
        "Show cell", "Show one cell of a layer", "show-cell", needs_result, _show("cell")
    ),
    "V3dcad_Show_neighbours": Command(
        "Show neighbours",
        "Show a cell and its neighbours",
        "show-neighbours",
        needs_result,
        _show("neighbours"),
    ),
    "V3dcad_Show_tree": Command(
        "Show tree", "Show the spanning tree of a layer", "show-tree", needs_result, _show("tree")
    ),
    "V3dcad_Show_cut": Command(
        "Show cut", "Show the fill cut upright", "show-cut", needs_result, _show("cut")
    ),
    "V3dcad_Show": Group("Show a layer", [f"V3dcad_Show_{target}" for target in SHOWN]),
    "V3dcad_Brep": Command(
        "Create B-rep",
        "Make wires, faces, cells, thick walls or struts of the fill as a shape",
        "brep",
        needs_result,
        _brep,
    ),
    "V3dcad_Export": Command(
        "Export", "Write G-code, .ont, STEP, 3MF or STL", "export", needs_result, _export
    ),
    "V3dcad_Import": Command(
        "Import .ont", "Open a foam from its .ont file", "import", needs_worker, _import
    ),
    "V3dcad_Print": Command(
        "Print or send…",
        "Print the fill or a file over a cable, or send it to a print server",
        "print",
        needs_worker,
        _print,
    ),
    "V3dcad_Setup": Command(
        "Set up…", "Make, repair or reset the environment that v3dcad runs in", "setup", always,
        _set_up,
    ),
}  # fmt: skip

TOOLBAR = [
    "V3dcad_Fill", "V3dcad_Edit", "V3dcad_Show", "Separator", "V3dcad_Brep", "V3dcad_Import",
    "V3dcad_Export", "V3dcad_Print", "Separator", "V3dcad_Setup",
]  # fmt: skip
MENU = [
    "V3dcad_Fill", "V3dcad_Edit", "Separator", *(f"V3dcad_Show_{one}" for one in SHOWN),
    "Separator", "V3dcad_Brep", "V3dcad_Import", "V3dcad_Export", "V3dcad_Print", "Separator",
    "V3dcad_Setup",
]  # fmt: skip


def register() -> None:
    """Make the commands known to FreeCAD."""
    for name, command in COMMANDS.items():
        Gui.addCommand(name, command)


def show_reason() -> None:
    """Buttons that are greyed for want of an environment say so when pointed at."""
    why = environment.missing()
    for action in main_window().findChildren(QAction):
        command = COMMANDS.get(action.objectName())
        if isinstance(command, Command) and command.needs is not always:
            action.setToolTip(why or tr(command.tip))


def activated() -> None:
    """Start the worker if there is one, and say what is missing otherwise."""
    from .progress import install

    install(main_window())
    QtCore.QTimer.singleShot(0, show_reason)
    if why := environment.missing():
        main_window().statusBar().showMessage(why, 10_000)
    else:
        worker.hello(lambda: None, lambda error: complain(str(error)))
