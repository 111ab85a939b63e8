"""What prints of five parts come to: stops, plastic beyond room, times, segments.

Run `python -m benchmarks.print`. The beads of every tenth layer are laid by shapely, which knows
nothing of how they were made: each fills its line, half a bead's spacing to either side.
"""

from __future__ import annotations

import io
import math
import time
from pathlib import Path
from typing import Any

import numpy as np
import shapely

import v3dcad
from v3dcad.formats.gcode.writer import write_gcode
from v3dcad.model import EXTRUDE, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.beads import trace
from v3dcad.toolpath.report import LayerReport

LAYER_HEIGHT = 0.2
WALLS: dict[int, dict[str, Any]] = {2: {}, 1: {"perimeters": 1}}
"""Beads to a wall, and print settings with them."""


def parts() -> dict[str, Any]:
    """Cylinder 30 × 60, pyramid 67 × 67 × 50, the bracket, sphere 40, pole 40 × 40 × 160 mm."""
    from build123d import Box, Cylinder, Rectangle, Sphere, extrude

    return {
        "cylinder": Cylinder(15, 60),
        "pyramid": extrude(Rectangle(67, 67), 50, taper=10),
        "bracket": Path(__file__).parents[1] / "samples" / "bracket.step",
        "sphere": Sphere(20),
        "pole": Box(40, 40, 160),
    }


def segments(path: Toolpath) -> np.ndarray:
    """(k, 2, 2) ends of what a layer extrudes, mm."""
    ends = np.stack([path.points[:-1], path.points[1:]], axis=1)[..., :2]
    return ends[path.kind[1:] == EXTRUDE]


def fullness(path: Toolpath, spacing: float) -> float:
    """Plastic laid on a layer ÷ the room that its beads fill."""
    lines = shapely.linestrings(segments(path))
    filled = shapely.union_all(shapely.buffer(lines, spacing / 2, quad_segs=6), grid_size=1e-5)
    return float(path.volume.sum() / LAYER_HEIGHT / filled.area)


def row(name: str, part: Any, wall_beads: int) -> str:
    """One part's figures with so many beads to a wall."""
    layers = list(v3dcad.fill(part, layer_height=LAYER_HEIGHT).layers)
    options = PrintSettings(wall_beads=wall_beads, skirt_loops=0, **WALLS[wall_beads])
    reports: list[LayerReport] = []
    began = time.process_time()
    paths = list(trace(layers, options, reports.append))
    traced = time.process_time() - began
    totals = write_gcode(io.StringIO(), paths, options)
    printed = [report for report in reports if report.strokes]
    spacing = options.bead_width - LAYER_HEIGHT * (1 - math.pi / 4)
    full = [fullness(path, spacing) for path in paths[1::10] if len(path.points)]
    lengths = np.concatenate([np.hypot(*np.diff(segments(path), axis=1)[:, 0].T) for path in paths])
    extruded = sum(report.extruded for report in reports)
    cells = (
        name,
        str(wall_beads),
        f"{np.mean([report.strokes - 1 for report in printed]):.2f}",
        f"{sum(report.retraced for report in reports) / extruded:.1%}",
        f"{np.mean(full) - 1:.1%}",
        f"{max(full) - 1:.1%}",
        f"{(lengths < 0.1).mean():.2%}",
        f"{min(report.seconds for report in printed):.1f}",
        f"{totals.time_s / 3600:.2f}",
        f"{totals.mass_g:.1f}",
        f"{1000 * traced / len(layers):.1f}",
    )
    return " ".join(f"{cell:>13}" for cell in cells)


def main() -> None:
    """Print the table."""
    columns = "part wall_beads stops retrace overfill worst under_0.1 least_s hours g trace_ms"
    print(" ".join(f"{name:>13}" for name in columns.split()))
    for name, part in parts().items():
        for wall_beads in WALLS:
            print(row(name, part, wall_beads), flush=True)


if __name__ == "__main__":
    main()
