"""B-rep out: seconds and bytes of each form, beside the plain way of doing it.

python -m benchmarks.brep             40 × 150 and 300 × 150
python -m benchmarks.brep --large     3,000 × 150: faces, cells, and 13 thousand struts as a mesh
python -m benchmarks.brep --beams     100,000 beams to 3MF
"""

from __future__ import annotations

import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from build123d import Box, Cylinder

import v3dcad
from v3dcad import Structure
from v3dcad.formats.mesh.threemf_writer import write_beams
from v3dcad.geometry.solid.bar_meshes import bar_mesh

FOLDER = Path(tempfile.mkdtemp())


def plain_wires(structure: Structure, path: Path) -> None:
    """A loop of MakeEdge over all edges, one compound, STEPControl_Writer."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.gp import gp_Pnt
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
    from OCP.TopoDS import TopoDS_Compound

    builder, everything = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(everything)
    for layer in structure.layers:
        ends = layer.diagram.vertices[layer.diagram.edges[layer.diagram.lengths() > 1e-6]]
        for start, stop in ends.tolist():
            line = BRepBuilderAPI_MakeEdge(gp_Pnt(*start, layer.z), gp_Pnt(*stop, layer.z))
            builder.Add(everything, line.Edge())
    writer = STEPControl_Writer()
    writer.Transfer(everything, STEPControl_AsIs)
    writer.Write(str(path))


def fused_in_pairs(structure: Structure, count: int) -> None:
    """One strut after the other fused to the rest, as a plain loop does it."""
    from v3dcad.kernel.booleans import fused
    from v3dcad.kernel.struts import bars

    facets = structure.facets()
    first, *rest = bars(facets.points, facets.struts()[:count], 0.6)
    for bar in rest:
        first = fused([first], [bar])


def row(what: str, work: Callable[[Path], Any], ending: str = "") -> None:
    """Run once and print a line of the table."""
    path = FOLDER / f"file{ending}"
    start = time.perf_counter()
    work(path)
    seconds = time.perf_counter() - start
    size = f"{path.stat().st_size / 1e6:.2f} MB" if ending else ""
    print(f"| {what} | {seconds:.2f} s | {size} |", flush=True)


def filled(cell_size: float) -> Structure:
    """A drilled block of 50 × 50 × 30 mm in 150 layers."""
    part = Box(50, 50, 30) - Cylinder(8, 30)
    return v3dcad.fill(part, layer_height=0.2, cell_size=cell_size)


def ordinary(cell_size: float) -> None:
    """Every form of one structure."""
    structure = filled(cell_size)
    edges = sum(len(layer.diagram.edges) for layer in structure.layers)
    facets = structure.facets()
    struts = len(facets.struts())
    print(
        f"\n| cells of {cell_size:g} mm × 150 layers: {edges} edges, {len(facets)} walls, ", end=""
    )
    print(f"{struts} struts | | |")
    print("|---|---|---|")
    row("layers computed", lambda _: list(structure.layers))
    row("wires, STEP", structure.write_step, ".step")
    row("plain loop of MakeEdge, STEP", lambda path: plain_wires(structure, path), ".step")
    row("faces", lambda _: structure.faces())
    row("faces, STEP", lambda path: structure.write_step(path, "faces"), ".step")
    row("cells", lambda _: structure.cells())
    row("cells, STEP", lambda path: structure.write_step(path, "cells"), ".step")
    row("thick walls 0.3 mm, solid", lambda _: structure.solid(0.3))
    row(
        "thick walls 0.3 mm, STL",
        lambda path: structure.write_stl(path, "solid", thickness=0.3),
        ".stl",
    )
    row("struts, compound", lambda _: structure.struts(0.6))
    row("struts, mesh", lambda _: structure.strut_mesh(0.6))
    row("struts cut, mesh", lambda _: structure.strut_mesh(0.6, cut=True))
    row("struts cut, compound", lambda _: structure.struts(0.6, cut=True))
    row("60 struts fused in a plain loop", lambda _: fused_in_pairs(structure, 60))
    row(
        "beams, 3MF with fallback",
        lambda path: structure.write_3mf(path, "beams", diameter=0.6),
        ".3mf",
    )
    row(
        "beams, 3MF",
        lambda path: structure.write_3mf(path, "beams", diameter=0.6, fallback=False),
        ".3mf",
    )
    row("walls of zero thickness, STL", structure.write_stl, ".stl")


def large() -> None:
    """What is asked of some 10,000 cells."""
    structure = filled(1.6)
    facets = structure.facets()
    struts = facets.struts()
    print(f"\n| cells of 1.6 mm: {len(facets)} walls, {len(struts)} struts | | |\n|---|---|---|")
    row("faces", lambda _: structure.faces())
    row("cells", lambda _: structure.cells())
    for count in (1000, 10_000):
        row(
            f"{min(count, len(struts))} struts, mesh",
            lambda _, n=count: bar_mesh(facets.points, struts[:n], 0.3),
        )


def beams() -> None:
    """100,000 beams between random points."""
    random = np.random.default_rng(0)
    points = random.uniform(0, 100, (50_000, 3))
    pairs = random.integers(0, 50_000, (100_000, 2))
    pairs[:, 1] += pairs[:, 0] == pairs[:, 1]
    print("\n| 100,000 beams | | |\n|---|---|---|")
    row("3MF", lambda path: write_beams(path, points, pairs % 50_000, 0.2, "beams", None), ".3mf")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    if "--large" in sys.argv:
        large()
    elif "--beams" in sys.argv:
        beams()
    else:
        ordinary(8.0)
        ordinary(3.5)
