# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Files and shapes: File → Open and Export for .ont and the like, B-rep, exports by the worker."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import FreeCAD as App
import Part

from .backend import Answer, Job, WorkerError, worker
from .features import is_fill, make_voronoi_fill, read_shape, remove_files, request_of
from .qt import tr

BREP_FORMS = ("wires", "faces", "cells", "solid", "struts")
ENDINGS = {
    ".gcode": "G-code (*.gcode)",
    ".ont": "Voronoi foam (*.ont)",
    ".step": "STEP (*.step)",
    ".3mf": "3MF (*.3mf)",
    ".stl": "STL (*.stl)",
}

Done = Callable[[Answer], None]
Failed = Callable[[WorkerError], None]


def open(path: str) -> Any:
    """Open a file as a new document."""
    document = App.newDocument(Path(path).stem)
    insert(path, document.Name)
    return document


def insert(path: str, name: str) -> None:
    """Put part and foam of an .ont file into a document."""
    document = App.getDocument(name)
    title = tr("Opening {name}").format(name=Path(path).name)
    worker.hello(
        lambda: worker.ask(
            Job(
                {"do": "open_ont", "path": str(path)},
                lambda answer: _insert_answer(document, answer),
                lambda error: _complain(error),
                title,
            )
        ),
        _complain,
    )


def export(objects: list[Any], path: str) -> None:
    """Write the first fill among the objects; the ending says what."""
    fills = [obj for obj in objects if is_fill(obj)]
    if not fills:
        _complain(WorkerError(tr("Select a Voronoi fill first.")))
        return
    export_fill(fills[0], path, {}, lambda _: None, _complain)


def export_fill(fill: Any, path: str, options: dict[str, Any], done: Done, failed: Failed) -> None:
    """Have the worker write a file of a fill; `options` are form, sizes, print and profile."""
    title = tr("Writing {name}").format(name=Path(path).name)

    def ask() -> None:
        try:
            _, request = request_of(fill)
        except WorkerError as error:
            return failed(error)
        request = {"do": "export", **request, "to": str(path), "name": fill.Source.Label, **options}
        return worker.ask(Job(request, done, failed, title))

    worker.hello(ask, failed)


def create_brep(
    fill: Any, form: str, sizes: dict[str, float], done: Callable[[Any], None], failed: Failed
) -> None:
    """Add the fill as B-rep to its document; `done` is called with the new object."""
    _, request = request_of(fill)
    document, label = fill.Document, f"{fill.Label} {tr(form)}"

    def take(answer: Answer) -> None:
        try:
            shape = read_shape(answer["shape"])
        except WorkerError as error:
            return failed(error)
        finally:
            remove_files(answer)
        document.openTransaction(tr("Create B-rep"))
        obj = document.addObject("Part::Feature", f"Voronoi{form.capitalize()}")
        obj.Label, obj.Shape = label, shape
        document.commitTransaction()
        return done(obj)

    title = tr("Making {form}").format(form=tr(form))
    worker.ask(Job({"do": "brep", **request, "form": form, **sizes}, take, failed, title))


def _insert_answer(document: Any, answer: Answer) -> None:
    document.openTransaction(tr("Import .ont"))
    try:
        source = _boundary(document, answer)
        fill = make_voronoi_fill(document, source, answer["settings"], answer.get("sites"))
        fill.Label = answer["name"]
    finally:
        document.commitTransaction()
    if App.GuiUp:
        import FreeCADGui as Gui

        source.ViewObject.Transparency = 80
        Gui.SendMsgToActiveView("ViewFit")


def _boundary(document: Any, answer: Answer) -> Any:
    """The part of an .ont file as an object: B-rep, or triangles."""
    path = Path(answer["boundary"])
    if path.suffix.lower() == ".stl":
        import Mesh

        source = document.addObject("Mesh::Feature", "Part")
        source.Mesh = Mesh.Mesh(str(path))
    else:
        source = document.addObject("Part::Feature", "Part")
        shape = Part.Shape()
        shape.importBrep(str(path))
        source.Shape = shape
    source.Label = tr("{name} (part)").format(name=answer["name"])
    source.purgeTouched()
    path.unlink(missing_ok=True)
    return source


def _complain(error: WorkerError) -> None:
    if App.GuiUp:
        from .commands import complain

        complain(str(error))
    else:
        App.Console.PrintError(f"Voronoi 3D: {error}\n")
