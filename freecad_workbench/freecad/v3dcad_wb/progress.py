# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""What v3dcad is doing, in FreeCAD's status bar, with a button that ends it."""

from __future__ import annotations

from typing import Any

from .backend import worker
from .qt import QtCore, QtWidgets, tr

QUIET = ("preview",)
"""Kinds of jobs that are too short to be shown."""

INTERVAL = 200
"""Milliseconds from a change to its being shown. Showing it draws the whole window again, which
takes longer than many a job."""


class Progress(QtWidgets.QWidget):
    """Title, bar and Cancel, hidden while nothing is done."""

    def __init__(self, parent: Any) -> None:
        super().__init__(parent)
        self.setObjectName("v3dcad-progress")
        row = QtWidgets.QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        self.title = QtWidgets.QLabel()
        self.bar = QtWidgets.QProgressBar()
        self.bar.setMaximumWidth(160)
        self.bar.setMaximumHeight(16)
        self.button = QtWidgets.QPushButton(tr("Cancel"))
        self.button.clicked.connect(lambda: worker.cancel_all())
        for widget in (self.title, self.bar, self.button):
            row.addWidget(widget)
        policy = self.sizePolicy()
        policy.setRetainSizeWhenHidden(True)  # otherwise the 3D view is laid out and drawn anew
        self.setSizePolicy(policy)
        self.title.setFixedWidth(260)
        self.timer = QtCore.QTimer(self)
        self.timer.setSingleShot(True)
        self.timer.setInterval(INTERVAL)
        self.timer.timeout.connect(self.show_job)
        self.setVisible(False)

    def changed(self) -> None:
        """Show soon what is under way then; of all changes until then only the last is seen."""
        if not self.timer.isActive():
            self.timer.start()

    def show_job(self) -> None:
        """Show the job that is under way."""
        job = worker.running
        shown = job is not None and job.kind not in QUIET
        if shown and job is not None:
            stage, done, whole = job.progress
            self.setUpdatesEnabled(False)  # three changes are drawn once
            self.title.setText(f"{job.title}: {stage}" if stage else job.title)
            self.bar.setRange(0, whole)
            self.bar.setValue(done)
            self.setUpdatesEnabled(True)
        self.setVisible(shown)


def install(window: Any) -> Progress:
    """Put it in the status bar, once."""
    found = window.findChild(QtWidgets.QWidget, "v3dcad-progress")
    if found is not None:
        return found
    progress = Progress(window)
    window.statusBar().addPermanentWidget(progress)
    worker.watchers.append(progress.changed)
    return progress
