# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""The parametric object: a part filled with a Voronoi foam.

The result is computed by the worker. With a window `execute` only asks for it: the result comes
later, in one transaction, if source and settings are still the same. Without a window it waits.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import FreeCAD as App
import Part

from . import grading, properties
from .backend import Answer, Job, WorkerError, worker
from .places import PREFERENCES
from .qt import tr
from .source import write_source

VERSION = 1
"""of the object's layout; `restore.py` brings older ones up to it"""
SHAPE_UP_TO = 20_000
"""Edges that are held as a Part shape; more are shown as one node of lines."""
FRESH = "up to date"

SETTINGS = "Voronoi fill"
OFF = {"off", None}
"""What settings say that ask for nothing; None where the method has them not."""


class VoronoiFill:
    """The proxy of a fill."""

    def __init__(self, obj: Any, source: Any) -> None:
        self.start()
        obj.addProperty("App::PropertyLink", "Source", SETTINGS, tr("What is filled."))
        add_fixed(obj)
        obj.Source = source
        obj.Proxy = self
        obj.Status = tr("not computed yet")

    def start(self) -> None:
        """What is never saved."""
        self.job: Job | None = None
        self.asked = ""
        self.reports: dict[str, Answer] = {}
        self.quiet = False

    def execute(self, obj: Any) -> None:
        """Ask the worker for the result, unless the one that is there belongs to the settings."""
        if obj.Document.Restoring:
            return
        worker.hello(lambda: self._ask(obj), lambda error: self._fail(obj, error))

    def onChanged(self, obj: Any, name: str) -> None:  # noqa: N802, FreeCAD's name
        """Mark the result stale; a number that is set is a number that is given."""
        if self.quiet or obj.Document.Restoring or obj.Document.Transacting:
            return
        if name == "Checksum":
            self._show_report(obj)
        elif name == "Source" or obj.getGroupOfProperty(name) == SETTINGS:
            with self.unheard():
                if f"{name}From" in obj.PropertiesList:
                    setattr(obj, f"{name}From", properties.GIVEN)
                if way := grading.way_of(name):
                    obj.CellSizeFrom = way
                if name == "Method":
                    properties.show_settings(obj, worker.settings)
                if "CellSizeFrom" in obj.PropertiesList:
                    grading.show(obj)
                if getattr(obj, "Made", ""):
                    obj.Status = tr("stale: recompute")

    @contextmanager
    def unheard(self) -> Iterator[None]:
        """Properties change without a word from `onChanged`."""
        before, self.quiet = self.quiet, True
        try:
            yield
        finally:
            self.quiet = before

    def add_settings(self, obj: Any) -> None:
        """Give the object the settings of this v3dcad that it lacks."""
        with self.unheard():
            properties.add_settings(obj, worker.settings)
            grading.add(obj)

    def _ask(self, obj: Any) -> None:
        if not is_there(obj):
            return
        self.add_settings(obj)
        try:
            made, request = request_of(obj)
        except WorkerError as error:
            return self._fail(obj, error)
        if made == obj.Made:
            return self._say(obj, FRESH)
        if self.job is not None and not self.job.over:
            if self.asked == made:
                return None
            worker.supersede(self.job)
        limit = PREFERENCES.GetInt("ShapeUpTo", SHAPE_UP_TO)
        self._say(obj, tr("stale: computing"))
        self.asked = made
        self.job = Job(
            {"do": "fill", "shape_up_to": limit, **request},
            lambda answer: self._take(obj, answer, made),
            lambda error: self._fail(obj, error),
            tr("Filling {label}").format(label=obj.Source.Label),
        )
        worker.ask(self.job)
        return None

    def _take(self, obj: Any, answer: Answer, made: str) -> None:
        """Take a result over, if it is still what the object asks for."""
        try:
            if not is_there(obj) or request_of(obj)[0] != made:
                return remove_files(answer)
            document = obj.Document
            # What an undo of this result comes back to; nothing is computed then.
            self._say(obj, tr("stale: recompute"))
            document.openTransaction(tr("Compute Voronoi fill"))
            with self.unheard():
                show_result(obj, answer)
                properties.show_resolved(obj, answer["settings"], worker.settings)
                obj.Made, obj.Status = made, FRESH
            obj.Checksum = answer["checksum"]
            document.commitTransaction()
            obj.purgeTouched()
        except WorkerError as error:
            self._fail(obj, error)
        finally:
            remove_files(answer)
        return None

    def _fail(self, obj: Any, error: WorkerError) -> None:
        if is_there(obj):
            self._say(obj, tr("failed: {why}").format(why=error))
            App.Console.PrintError(f"{obj.Label}: {error}\n")

    def _say(self, obj: Any, state: str) -> None:
        if state != obj.Status:
            obj.Status = state
            obj.purgeTouched()

    def _show_report(self, obj: Any) -> None:
        """Set the numbers of the structure with this check sum; asked for once each."""
        checksum = obj.Checksum
        if checksum in self.reports:
            return set_report(obj, self.reports[checksum])
        set_report(obj, {})
        _, request = request_of(obj)

        def take(report: Answer) -> None:
            self.reports[checksum] = report
            if is_there(obj) and obj.Checksum == checksum:
                set_report(obj, report)
                obj.purgeTouched()

        title = tr("Measuring {label}").format(label=obj.Label)
        worker.ask(Job({"do": "report", **request}, take, lambda _: None, title))
        return None

    def onDocumentRestored(self, obj: Any) -> None:  # noqa: N802
        """Nothing is computed when a document is opened."""
        self.start()

    def dumps(self) -> dict[str, int]:
        """The properties hold all there is; only the layout's version is kept."""
        return {"version": VERSION}

    def loads(self, state: Any) -> None:
        """See `dumps`."""
        self.start()

    __getstate__ = dumps
    __setstate__ = loads


def make_voronoi_fill(
    doc: Any, source: Any, settings: dict[str, Any] | None = None, sites_file: str | None = None
) -> Any:
    """Add a fill of `source` to a document and compute it; its property `Status` says how it went.

    With a window the result comes a little later. Settings may be given by v3dcad's names; they are
    properties (`CellSize` …), changed as those of any object and followed by `doc.recompute()`.
    `sites_file` is an array (n, 3) of sites in mm, as `.npy`.
    """
    obj = doc.addObject("Part::FeaturePython", "VoronoiFill")
    obj.Label = tr("Foam in {label}").format(label=source.Label)
    proxy = VoronoiFill(obj, source)
    if sites_file:
        obj.SitesFile = sites_file
    if App.GuiUp:
        from .view_provider import ViewVoronoiFill

        ViewVoronoiFill(obj.ViewObject)

    def begin() -> None:
        if is_there(obj):
            proxy.add_settings(obj)
            with proxy.unheard():
                properties.set_values(obj, settings or {}, worker.settings)
            proxy.execute(obj)

    worker.hello(begin, lambda error: proxy._fail(obj, error))
    obj.purgeTouched()
    return obj


def add_fixed(obj: Any) -> None:
    """Give an object the properties that are no settings, those of them that it lacks."""
    hidden = (
        ("App::PropertyInteger", "FillVersion", "Layout of this object."),
        ("App::PropertyString", "Made", "Source and settings that the result belongs to."),
        ("App::PropertyFileIncluded", "Lines", "The lines, where they are too many for a shape."),
        ("App::PropertyFileIncluded", "SitesFile", "Sites of the user's own, from an .ont file."),
    )
    for kind, name, text in hidden:
        if name not in obj.PropertiesList:
            obj.addProperty(kind, name, "Base", text)
        obj.setEditorMode(name, 2)
    if "SizedFor" not in obj.PropertiesList:
        text = tr("Machine profile that a density or a mass goes by; empty for the default.")
        obj.addProperty("App::PropertyString", "SizedFor", SETTINGS, text)
        obj.SizedFor = PREFERENCES.GetString("Profile", "")
    obj.FillVersion = VERSION
    properties.add_results(obj)


def is_fill(obj: Any) -> bool:
    """Whether an object is one of ours, also where its proxy was lost."""
    return "FillVersion" in getattr(obj, "PropertiesList", ())


def is_there(obj: Any) -> bool:
    """Whether an object, and its document, still are."""
    try:
        return obj.Document is not None and obj.Document.getObject(obj.Name) is obj
    except ReferenceError:
        return False


def request_of(obj: Any) -> tuple[str, dict[str, Any]]:
    """What the worker is asked: as text that tells whether anything changed, and as a request.

    Raises `WorkerError` where there is nothing to fill.
    """
    source = write_source(obj.Source, obj, worker.folder)
    settings = properties.values_of(obj, worker.settings)
    if settings.get("cell_size") in properties.WAYS:
        settings["cell_size"] = grading.expression_of(grading.sizes_of(obj), obj, worker.folder)
    request: dict[str, Any] = {"source": source, "settings": settings}
    sites = ""
    if obj.SitesFile:
        request["sites"] = obj.SitesFile
        sites = str(os.path.getsize(obj.SitesFile))
    request["sized_for"] = obj.SizedFor
    sized = [obj.SizedFor] if {settings.get("density"), settings.get("mass")} - OFF else []
    made = json.dumps([Path(source).name, settings, sites, *sized], sort_keys=True)
    # Files are named after what they hold; their folder is another one in each session.
    return made.replace(json.dumps(f"{worker.folder}{os.sep}")[1:-1], ""), request


def show_result(obj: Any, answer: Answer) -> None:
    """Set shape or lines, and the counts; lines are shown where the shape is null.

    Raises `WorkerError` where the shape cannot be read.
    """
    if answer["shape"]:
        shape = read_shape(answer["shape"])
        obj.Shape = shape
        obj.Edges = shape.countElement("Edge")
    else:
        if not obj.Shape.isNull():  # each of the two that is set shows the lines again
            obj.Shape = Part.Shape()
        obj.Lines = answer["lines"]
        obj.Edges = answer["edges"]
    obj.Layers = answer["layers"]


def read_shape(path: str) -> Any:
    """The shape in a BREP file; `WorkerError` where there is none."""
    shape = Part.Shape()
    shape.importBrep(path)
    if shape.isNull():
        raise WorkerError(tr("FreeCAD could not read the shape that v3dcad wrote"))
    return shape


def set_report(obj: Any, report: Answer) -> None:
    """Set the numbers of a report; 0 and "" where there are none yet."""
    obj.Cells = report.get("cells") or 0
    obj.CellSizeMade = report.get("cell_size") or 0
    obj.SteepestWall = report.get("steepest_wall") or 0
    obj.WallLength = report.get("wall_length") or 0
    obj.MassMade = report.get("mass") or 0
    obj.Certificate = report.get("certificate") or ""
    obj.Findings = list(report.get("findings") or ())


def remove_files(answer: Answer) -> None:
    """Remove the files of an answer that was taken over or is not wanted."""
    for name in ("shape", "lines"):
        if answer.get(name):
            Path(answer[name]).unlink(missing_ok=True)
