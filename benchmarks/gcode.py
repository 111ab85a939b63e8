"""Routing and writing G-code: seconds, bytes, peak memory, and a plain loop beside it.

python -m benchmarks.gcode            the two structures, and 10 million moves
python -m benchmarks.gcode --thesis   estimated times beside the thesis's printed ones

What routes is imported where it is used: it would count in the writer's peak memory.
"""

from __future__ import annotations

import io
import resource
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from v3dcad.formats.gcode.machine_profile import read_profile
from v3dcad.formats.gcode.writer import write_gcode
from v3dcad.model import EXTRUDE, Layer, Toolpath
from v3dcad.settings import PrintSettings


class Sink(io.TextIOBase):
    """Counts what is written and forgets it."""

    size = 0

    def write(self, text: str) -> int:
        """Take the text's length alone."""
        self.size += len(text)
        return len(text)


def plain_loop(
    stream: io.TextIOBase, toolpaths: Iterable[Toolpath], options: PrintSettings
) -> None:
    """The same moves, a line at a time."""
    laid = 0.0
    for path in toolpaths:
        e = (laid + np.cumsum(path.volume)) / options.filament_area()
        laid += float(path.volume.sum())
        rows = zip(
            path.kind.tolist(),
            (path.points + 110).tolist(),
            e.tolist(),
            (path.speed * 60).tolist(),
            strict=True,
        )
        for kind, (x, y, _), e_, feed in rows:
            if kind == EXTRUDE:
                stream.write(f"G1 X{x:.3f} Y{y:.3f} E{e_:.5f} F{feed:.0f}\n")
            else:
                stream.write(f"G0 X{x:.3f} Y{y:.3f} F{feed:.0f}\n")


def many_moves(count: int) -> Iterator[Toolpath]:
    """Toolpaths of 10,000 steps that wander over the bed."""
    random = np.random.default_rng(0)
    size = 10_000
    for number in range(count // size):
        points = np.cumsum(random.uniform(-0.5, 0.5, (size, 3)), axis=0) % 100
        points[:, 2] = 0.2 + 0.01 * number
        yield Toolpath(
            points,
            np.full(size, EXTRUDE, np.int8),
            np.full(size, 0.05),
            np.full(size, 50.0),
            np.full(size, number),
            np.full(size, 2, np.int8),
            np.full((size, 2), np.nan),
        )


def peak_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def inset_seconds(layer: Layer) -> float:
    """What GEOS takes to move the walls of a layer's cells inwards by half a bead: a yardstick.

    Where the musts for tracing come from, it took 1.7 ms for 300 cells.
    """
    import shapely

    cells = [shapely.Polygon(rings[0]) for rings in layer.diagram.cells().values()]
    times = []
    for _ in range(9):
        began = time.perf_counter()
        shapely.buffer(cells, -PrintSettings().bead_width / 2, join_style="mitre")
        times.append(time.perf_counter() - began)
    return float(np.median(times))


def table() -> None:
    from benchmarks.engine import filled
    from v3dcad.toolpath.trace import trace

    columns = (
        "structure walls trace_s clock_s layer/inset write_s loop_s loop/write MB moves retraced "
        "strokes hours"
    )
    print(" ".join(f"{name:>13}" for name in columns.split()))
    for cells, count in ((300, 150), (4000, 20)):
        source = list(filled("square", cells, count).layers)
        for walls, beads in (("two-bead", 2), ("one-bead", 1), ("thesis", 1)):
            options = PrintSettings(wall_beads=beads, bed="800x800")
            reports = []
            inset = inset_seconds(source[count // 2])
            began, clock = time.process_time(), time.perf_counter()
            paths = list(trace(source, options, reports.append, thesis=walls == "thesis"))
            traced, clock = time.process_time(), time.perf_counter() - clock
            inset = (inset + inset_seconds(source[count // 2])) / 2
            sink = Sink()
            totals = write_gcode(sink, paths, options)
            wrote = time.process_time()
            plain_loop(Sink(), paths, options)
            looped = time.process_time()
            moves = sum(len(path.points) for path in paths)
            share = sum(r.retraced for r in reports) / sum(r.extruded for r in reports)
            row = (
                f"{cells}x{count}",
                walls,
                f"{traced - began:.2f}",
                f"{clock:.2f}",
                f"{clock / count / inset:.1f}",
                f"{wrote - traced:.2f}",
                f"{looped - wrote:.2f}",
                f"{(looped - wrote) / (wrote - traced):.1f}",
                f"{sink.size / 1e6:.1f}",
                moves,
                f"{share:.1%}",
                sum(r.strokes for r in reports),
                f"{totals.time_s / 3600:.1f}",
            )
            print(" ".join(f"{cell:>13}" for cell in row))


def memory() -> None:
    write_gcode(Sink(), many_moves(10_000), PrintSettings())
    before = peak_mb()
    began = time.process_time()
    sink = Sink()
    write_gcode(sink, many_moves(10_000_000), PrintSettings(build_height=1000))
    wrote = time.process_time()
    print(
        f"10 million moves: {wrote - began:.1f} s, {sink.size / 1e6:.0f} MB written; "
        f"peak memory {peak_mb():.0f} MB, of it {before:.0f} MB before the first move"
    )
    plain_loop(Sink(), many_moves(1_000_000), PrintSettings())
    print(f"a plain loop: {10 * (time.process_time() - wrote):.1f} s (from a tenth of the moves)")


def thesis() -> None:
    """The thesis's parts with its parameters (Table 4.1) and its print settings (Table 3.2)."""
    import tempfile

    from build123d import Cone, Rectangle, export_step, extrude

    import v3dcad

    parts = (
        ("cone", Cone(20, 15, 30), 40, 0.2, 5),
        ("pyramid", extrude(Rectangle(67, 67), 50, taper=10), 10, 0.5, 6),
        ("large pyramid", extrude(Rectangle(180, 180), 30, taper=10), 300, 0.2, 29),
    )
    for name, part, sites, offset, hours in parts:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "part.step"
            export_step(part, str(file))
            structure = v3dcad.fill(file, method="thesis", sites=sites, offset=offset)
            options = PrintSettings(**{**read_profile("thesis"), "contour": "centre"})
            found = structure.write_gcode(Path(folder) / "part.gcode", options).totals
            print(
                f"{name:>14}: {found.time_s / 3600:5.1f} h, the thesis printed {hours} h; "
                f"{found.mass_g:.0f} g"
            )


if __name__ == "__main__":
    if "--thesis" in sys.argv:
        thesis()
    else:
        memory()
        table()
