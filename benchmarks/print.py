"""What prints of five parts come to: stops, plastic beyond room, times, segments.

Run `python -m benchmarks.print`. The beads of every tenth layer are laid by shapely, which knows
nothing of how they were made: each fills its line, half a bead's spacing to either side. Under each
row stands what the print tells of itself.
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
from v3dcad.model import BRIDGE, CELLS, EXTRUDE, PERIMETER, SOLID, Layer, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.certificate import printed_overhang
from v3dcad.toolpath.report import LayerReport, findings
from v3dcad.toolpath.trace import trace

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


def segments(path: Toolpath, feature: int | None = None) -> np.ndarray:
    """(k, 2, 2) ends of what a layer extrudes, or of one feature of it, mm."""
    ends = np.stack([path.points[:-1], path.points[1:]], axis=1)[..., :2]
    chosen = path.kind[1:] == EXTRUDE
    return ends[chosen if feature is None else chosen & (path.feature[1:] == feature)]


def filled(path: Toolpath, width: float) -> shapely.Geometry:
    """What a layer's beads of some width, mm, cover."""
    lines = shapely.linestrings(segments(path))
    return shapely.union_all(shapely.buffer(lines, width / 2, quad_segs=6), grid_size=1e-5)


def fullness(path: Toolpath, spacing: float) -> float:
    """Plastic laid on a layer ÷ the room that its beads fill."""
    return float(path.volume.sum() / LAYER_HEIGHT / filled(path, spacing).area)


def bare(layer: Layer, path: Toolpath, width: float) -> float:
    """Which share of the centre lines of a layer's walls no bead covers."""
    diagram = layer.diagram
    walls = shapely.linestrings(diagram.vertices[diagram.edges[diagram.inner()]])
    left = shapely.difference(walls, filled(path, width))
    return float(shapely.length(left).sum() / shapely.length(walls).sum())


def beyond(path: Toolpath, width: float) -> int:
    """Strokes of a layer beyond one for each island, hole and region of a skin."""
    extrudes = path.kind == EXTRUDE
    begins = extrudes & ~np.concatenate([[False], extrudes[:-1]])
    outer = extrudes & (path.feature == PERIMETER)
    loops = np.count_nonzero(outer & ~np.concatenate([[False], outer[:-1]]))
    regions = 0
    skins = np.isin(path.feature, (SOLID, BRIDGE))
    walls = np.bincount(np.cumsum(begins), extrudes & ~skins)[np.cumsum(begins)] > 0
    for feature in (SOLID, BRIDGE):
        ends = np.stack([path.points[:-1], path.points[1:]], axis=1)[..., :2]
        lines = shapely.linestrings(ends[(extrudes & ~walls & (path.feature == feature))[1:]])
        covered = shapely.union_all(shapely.buffer(lines, 0.6 * width, quad_segs=2))
        regions += sum(not part.is_empty for part in shapely.get_parts(covered))
    return max(int(np.count_nonzero(begins)) - loops - regions, 0)


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
    some = [path for path in paths[1::10] if len(path.points)]
    uncovered = [
        bare(layer, path, options.bead_width)
        for layer, path in zip(layers[1::10], paths[1::10], strict=True)
        if len(path.points)
    ]
    full = [fullness(path, spacing) for path in some]
    lengths = np.concatenate([np.hypot(*np.diff(segments(path), axis=1)[:, 0].T) for path in paths])
    extruded = sum(report.extruded for report in reports)
    walls = sum(float(np.hypot(*np.diff(segments(p, CELLS), axis=1)[:, 0].T).sum()) for p in paths)
    bridged = sum(report.bridged for report in reports)
    overhang = printed_overhang(reports)
    kinds = dict(zip(overhang.kinds, range(len(overhang.kinds)), strict=True))
    cells = (
        name,
        str(wall_beads),
        f"{next(path for path in paths if len(path.points)).points[1:, 2].min():.2f}",
        f"{np.mean([report.strokes - 1 for report in printed]):.2f}",
        f"{np.mean([beyond(path, options.bead_width) for path in some]):.2f}",
        f"{sum(report.retraced for report in reports) / extruded:.1%}",
        f"{np.mean(full) - 1:.1%}",
        f"{max(full) - 1:.1%}",
        f"{np.mean(uncovered):.1%}",
        f"{overhang.length[:, kinds['walls']].sum() / walls:.2%}",
        f"{bridged / walls:.2%}",
        *(
            f"{overhang.span[:, kinds[kind]].max():.1f}"
            for kind in ("perimeters", "bridges", "walls")
        ),
        f"{(lengths < 0.1).mean():.2%}",
        f"{min(report.seconds for report in printed):.1f}",
        f"{sum(report.hurried for report in printed)}",
        f"{totals.time_s / 3600:.2f}",
        f"{totals.mass_g:.1f}",
        f"{1000 * traced / len(layers):.1f}",
    )
    told = "".join(f"\n    {finding}" for finding in findings(reports))
    return " ".join(f"{cell:>13}" for cell in cells) + told


def main() -> None:
    """Print the table."""
    columns = (
        "part wall_beads first_z stops beyond retrace overfill worst bare hang bridged perimeters "
        "bridges walls under_0.1 least_s told hours g trace_ms"
    )
    print(" ".join(f"{name:>13}" for name in columns.split()))
    for name, part in parts().items():
        for wall_beads in WALLS:
            print(row(name, part, wall_beads), flush=True)


if __name__ == "__main__":
    main()
