"""The FreeCAD workbench with a window: seconds from the command to what is shown.

python -m benchmarks.workbench        needs freecad and xvfb-run; V3DCAD_PYTHON, or this Python

Starts FreeCAD under Xvfb with this file as its script, which prints the table.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1] if "__file__" in globals() else Path.cwd()
PARTS = {
    "cone.step, cells of 5 mm, 150 layers": ("cone.step", {"cell_size": 5.0, "layer_height": 0.2}),
    "pyramid.step, cells of 4 mm": ("pyramid.step", {"cell_size": 4.0, "layer_height": 0.2}),
}
STEPS = ("export", "compute", "transfer", "display")


def start() -> None:
    """Run this file in FreeCAD, in folders of its own."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        (home / "Mod").mkdir()
        (home / "Mod" / "v3dcad").symlink_to(ROOT)
        python = home / "python"
        python.write_text(f'#!/bin/sh\nPYTHONPATH="{ROOT}" exec "{sys.executable}" "$@"\n')
        python.chmod(0o755)
        variables = {
            **os.environ,
            "FREECAD_USER_HOME": folder,
            "V3DCAD_PYTHON": os.environ.get("V3DCAD_PYTHON", str(python)),
            "QTWEBENGINE_DISABLE_SANDBOX": "1",
            "LIBGL_ALWAYS_SOFTWARE": "1",
            "QT_QPA_PLATFORM": "xcb",
        }
        screen = ["xvfb-run", "-a", "-s", "-screen 0 1400x900x24 +extension GLX"]
        done = subprocess.run(
            [*screen, "freecad", str(ROOT / "benchmarks" / "workbench.py")],
            env=variables,
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            encoding="utf-8",
            errors="replace",
            check=False,
        )
        rows = [line for line in done.stderr.splitlines() if line.startswith("|")]
        print("\n".join(rows) if not done.returncode else done.stderr)
        sys.exit(done.returncode)


def inside() -> None:
    """What FreeCAD runs."""
    import traceback

    import FreeCADGui as Gui
    from freecad.v3dcad_wb.qt import QtCore

    def run() -> None:
        code = 1
        try:
            Gui.activateWorkbench("VoronoiWorkbench")
            measure()
            code = 0
        except BaseException:
            say(traceback.format_exc())
        from freecad.v3dcad_wb.backend import worker

        worker.close()
        os._exit(code)

    QtCore.QTimer.singleShot(2000, run)


def say(*words: object) -> None:
    """A line for whoever started this."""
    print(*words, file=sys.__stderr__, flush=True)


def pump(until: Any) -> float:
    """Serve the window until something is true; s."""
    from freecad.v3dcad_wb.qt import QtCore, QtWidgets

    begun = time.perf_counter()
    while not until():
        QtWidgets.QApplication.processEvents(QtCore.QEventLoop.AllEvents, 2)
    return time.perf_counter() - begun


def memory() -> float:
    """Memory of FreeCAD, MB."""
    status = Path("/proc/self/status").read_text()
    return (
        int(next(line for line in status.splitlines() if line.startswith("VmRSS")).split()[1]) / 1e3
    )


class Gaps:
    """How long the event loop did not answer: a timer that should fire every 5 ms.

    The processor time of its thread tells what of it other programs took.
    """

    def __init__(self) -> None:
        from freecad.v3dcad_wb.qt import QtCore

        self.longest, self.before = [0.0, 0.0], self._now()
        self.timer = QtCore.QTimer()
        self.timer.timeout.connect(self._tick)
        self.timer.start(5)

    @staticmethod
    def _now() -> tuple[float, float]:
        return time.perf_counter(), time.thread_time()

    def _tick(self) -> None:
        now = self._now()
        gaps = [there - here for there, here in zip(now, self.before, strict=True)]
        self.longest, self.before = [max(*two) for two in zip(self.longest, gaps, strict=True)], now

    def stop(self) -> str:
        """The longest gap, and the most processor time of one, s."""
        self.timer.stop()
        return " / ".join(f"{longest:.2f} s" for longest in self.longest)


def measure() -> None:
    """Print the table."""
    from freecad.v3dcad_wb import features
    from freecad.v3dcad_wb.backend import worker

    spent = dict.fromkeys(STEPS, 0.0)

    def timed(step: str, work: Any) -> Any:
        def run(*args: Any) -> Any:
            begun = time.perf_counter()
            try:
                return work(*args)
            finally:
                spent[step] += time.perf_counter() - begun

        return run

    features.request_of = timed("export", features.request_of)
    features.show_result = timed("transfer", features.show_result)
    began = time.perf_counter()
    pump(lambda: worker.settings)
    say(
        "| what | all | export | compute | transfer | display | window silent / processor | shown |"
    )
    say("|---|---|---|---|---|---|---|---|")
    say(f"| the worker starts, in the background | {time.perf_counter() - began:.2f} s |||||||")
    for name, (file, settings) in PARTS.items():
        for turn in ("first", "again, another seed", "as lines"):
            worker_settings = {**settings, "random_seed": len(turn)}
            say(row(f"{name}: {turn}", file, worker_settings, spent, lines=turn == "as lines"))
    preview()
    many_lines()


def row(what: str, file: str, settings: Any, spent: dict[str, float], *, lines: bool) -> str:
    """Fill a part and tell where the time went."""
    import FreeCAD as App
    import FreeCADGui as Gui
    import Part
    from freecad.v3dcad_wb import features
    from freecad.v3dcad_wb.backend import worker
    from freecad.v3dcad_wb.places import PREFERENCES

    document = App.newDocument("Benchmark")
    source = document.addObject("Part::Feature", "Source")
    source.Shape = Part.read(str(ROOT / "samples" / file))
    document.recompute()
    source.ViewObject.Visibility = False
    Gui.SendMsgToActiveView("ViewFit")
    PREFERENCES.SetInt("ShapeUpTo", 0 if lines else features.SHAPE_UP_TO)
    spent.update(dict.fromkeys(STEPS, 0.0))
    gaps, begun = Gaps(), time.perf_counter()
    fill = features.make_voronoi_fill(document, source, settings)
    pump(lambda: fill.Checksum)
    computed = time.perf_counter() - begun
    spent["compute"] = computed - spent["export"] - spent["transfer"]
    shown = time.perf_counter()
    Gui.updateGui()
    Gui.ActiveDocument.ActiveView.redraw()
    spent["display"] = time.perf_counter() - shown
    whole = time.perf_counter() - begun
    pump(lambda: worker.running is None and not worker.waiting)
    silent = gaps.stop()
    kind = "lines" if fill.Shape.isNull() else "edges of a shape"
    shown_as = f"{fill.Edges:,} {kind}"
    App.closeDocument(document.Name)
    times = " | ".join(f"{spent[step]:.2f}" for step in STEPS)
    return f"| {what} | {whole:.2f} s | {times} | {silent} | {shown_as} |"


def preview() -> None:
    """One layer after another of 50 cells while a value is dragged."""
    import FreeCAD as App
    import Part
    from freecad.v3dcad_wb.backend import worker
    from freecad.v3dcad_wb.features import make_voronoi_fill, request_of
    from freecad.v3dcad_wb.preview import Preview
    from freecad.v3dcad_wb.qt import QtWidgets

    document = App.newDocument("Preview")
    box = document.addObject("Part::Feature", "Box")
    box.Shape = Part.makeBox(50, 50, 30)
    fill = make_voronoi_fill(document, box, {"cell_size": 7.07, "layer_height": 1.0})
    pump(lambda: worker.running is None and not worker.waiting and fill.Checksum)
    form = QtWidgets.QWidget()
    shown = Preview(fill, form)
    _, request = request_of(fill)
    times = []
    for k in range(40):
        answers: list[Any] = []
        settings = {**request["settings"], "cell_size": 7.07 + 0.01 * k}
        wanted = {**request, "settings": settings, "layer": 15, "target": "layer"}
        begun = time.perf_counter()
        shown.ask(wanted, answers.append, answers.append)
        pump(lambda answers=answers: answers)
        times.append(1000 * (time.perf_counter() - begun))
    later = sorted(times[1:])
    text = (
        f"first {times[0]:.0f} ms, then {later[len(later) // 2]:.0f} ms, at most {later[-1]:.0f} ms"
    )
    say(f"| preview of a layer of 50 cells, another cell size each time | {text} |||||||")
    App.closeDocument(document.Name)


def many_lines() -> None:
    """Half a million lines in one node."""
    import FreeCAD as App
    import FreeCADGui as Gui
    import numpy as np
    from freecad.v3dcad_wb.lines import Lines

    App.newDocument("Lines")
    count = 500_000
    random = np.random.default_rng(0)
    starts = 40 * random.random((count, 3))
    ends = starts + random.normal(size=(count, 3)) * [1.5, 1.5, 0]
    points = np.stack([starts, ends], axis=1).reshape(-1, 3).astype(np.float32)
    pairs = np.arange(2 * count, dtype=np.int32).reshape(-1, 2)
    view = Gui.ActiveDocument.ActiveView
    before, begun = memory(), time.perf_counter()
    lines = Lines(width=1.0)
    lines.show(points, pairs)
    view.getSceneGraph().addChild(lines.node)
    view.viewIsometric()
    Gui.SendMsgToActiveView("ViewFit")
    Gui.updateGui()
    view.redraw()
    took = time.perf_counter() - begun
    text = f"{took:.2f} s, {memory() - before:.0f} MB more"
    say(f"| 500,000 lines, set and drawn by the software renderer | {text} |||||||")


if "FreeCAD" in sys.modules and __name__ != "benchmarks.workbench":
    inside()
elif __name__ == "__main__":
    start()
