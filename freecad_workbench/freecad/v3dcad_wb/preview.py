# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Lines of one layer in the 3D view, as the worker answers `layer`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import FreeCADGui as Gui
import numpy as np
from pivy import coin

from .backend import Answer, Job, WorkerError, worker
from .features import is_there
from .lines import Lines, labels_node, rgb
from .qt import tr


class Preview:
    """What a panel shows in the view in place of a fill, until the panel is closed."""

    def __init__(self, fill: Any, form: Any) -> None:
        self.root = coin.SoSeparator()
        self.graph: Any = None
        self.fill = fill
        self.was_visible = fill.ViewObject.Visibility
        fill.ViewObject.Visibility = False
        form.destroyed.connect(lambda *_: self.close())
        view = Gui.getDocument(fill.Document.Name).ActiveView
        if view is not None and hasattr(view, "getSceneGraph"):
            self.graph = view.getSceneGraph()
            self.graph.addChild(self.root)

    def ask(
        self,
        request: dict[str, Any],
        shown: Callable[[Answer], None],
        refused: Callable[[WorkerError], None],
    ) -> None:
        """Show what the request asks for; of several that wait only the newest is answered."""

        def take(answer: Answer) -> None:
            self.show(answer)
            if self.graph is not None:
                shown(answer)

        def say(error: WorkerError) -> None:
            if self.graph is not None:
                refused(error)

        worker.ask(Job({"do": "layer", **request}, take, say, tr("Preview"), kind="preview"))

    def show(self, answer: Answer) -> None:
        """Show the parts of an answer; its files are removed."""
        self.root.removeAllChildren()
        for part in answer["parts"]:
            paths = Path(part["points"]), Path(part["pairs"])
            points, pairs = (np.load(path) for path in paths)
            for path in paths:
                path.unlink(missing_ok=True)
            lines = Lines(rgb(part["colour"]), 3.0)
            lines.show(points, pairs)
            self.root.addChild(lines.node)
        self.root.addChild(labels_node(answer["labels"]))

    def close(self) -> None:
        """Take everything out of the view and show the fill again; a second time does nothing."""
        if self.graph is None:
            return
        self.root.removeAllChildren()
        self.graph.removeChild(self.root)
        self.graph = None
        if is_there(self.fill):
            self.fill.ViewObject.Visibility = self.was_visible
