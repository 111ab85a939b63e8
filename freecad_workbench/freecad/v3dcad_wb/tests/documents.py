# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""One document in several FreeCADs, each a process of its own; V3DCAD_STEP names the step.

It imports nothing of the add-on before it has to: one step runs where there is none.
"""

import os
import sys
import traceback

import FreeCAD as App

PATH = os.environ["V3DCAD_DOCUMENT"]


def write() -> None:
    """With the add-on: make it."""
    from freecad.v3dcad_wb.backend import worker
    from freecad.v3dcad_wb.features import make_voronoi_fill

    document = App.newDocument("a")
    document.addObject("Part::Box", "Box")
    document.recompute()
    fill = make_voronoi_fill(document, document.Box, {"layer_height": 0.5, "cell_size": 4.0})
    assert fill.Status == "up to date", fill.Status
    document.saveAs(PATH)
    worker.close()


def look(proxy: bool) -> None:
    document = App.openDocument(PATH)
    fill = document.VoronoiFill
    assert fill.Shape.countElement("Edge") == fill.Edges > 100
    assert fill.Checksum
    assert "Touched" not in fill.State, fill.State
    assert (fill.Proxy is not None) == proxy
    document.save()


def read() -> None:
    """With the add-on, but without v3dcad: the last result is there."""
    look(True)


def without() -> None:
    """Without the add-on: the result is there; saving loses the proxy."""
    look(False)


def mended() -> None:
    """With the add-on again: the proxy is back, and the fill follows its source."""
    from freecad.v3dcad_wb.backend import worker

    look(True)
    document = App.ActiveDocument
    edges = document.VoronoiFill.Edges
    document.Box.Height = 5
    document.recompute()
    assert document.VoronoiFill.Status == "up to date", document.VoronoiFill.Status
    assert document.VoronoiFill.Edges < edges
    worker.close()


def sleep() -> None:
    """Fill for a long time; ended from outside."""
    from freecad.v3dcad_wb.features import make_voronoi_fill

    document = App.newDocument("a")
    document.addObject("Part::Box", "Box")
    document.recompute()
    print("begins", file=sys.__stderr__, flush=True)
    make_voronoi_fill(document, document.Box, {"layer_height": 0.0002})


code = 1
try:
    globals()[os.environ["V3DCAD_STEP"]]()
    code = 0
except BaseException:
    traceback.print_exc(file=sys.__stderr__)
os._exit(code)
