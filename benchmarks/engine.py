"""The engine against qhull and GEOS, in one run: `python -m benchmarks.engine [--quick]`.

Ratios count; milliseconds depend on the machine. The slow side is tests/oracle.py, given the
engine's own sites and weights: lifted qhull, edges, cells and contours cut by prepared shapely.
Both sides get the sites that may have a cell on the layer. Processor time is compared, so that a
busy machine does not blur it. Where there are many layers, the slow side is extrapolated from some
20 of them.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import shapely
from scipy.spatial import ConvexHull

from tests import oracle
from v3dcad.geometry.power_diagram.grid import Grid, curve_order
from v3dcad.geometry.power_diagram.regular_triangulation import triangulation
from v3dcad.model import Layer, Section
from v3dcad.settings import FillSettings
from v3dcad.structure.fill import Filling, fill_sections
from v3dcad.structure.foam.tile import stretch_for

SLOW_LAYERS = 20
CELL = 5.0
"""mm: the cells' size."""

STEEP = 25
"""Layers to the height of a cell."""

CASES = [
    # name, cells in the base square, layers, outline
    ("pole", 40, 250, "square"),
    ("frustum", 40, 150, "frustum"),
    ("block", 300, 150, "square"),
    ("pyramid", 300, 150, "pyramid"),
    ("plate", 4000, 20, "square"),
    ("tower", 4000, 1000, "square"),
]


SETTINGS = FillSettings(cell_size=CELL)
HEIGHT = CELL * stretch_for(SETTINGS.max_overhang) / STEEP
"""mm: of a layer."""


def seconds(work: Callable[[], object], repeats: int = 3) -> float:
    """The best processor time of some runs."""
    best = np.inf
    for _ in range(repeats):
        began = time.process_time()
        work()
        best = min(best, time.process_time() - began)
    return best


def sections(outline: str, size: float, layers: int) -> list[Section]:
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]) * size
    turn = np.linspace(0, 2 * np.pi, 128, endpoint=False)
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    made = []
    for layer in range(layers):
        share = layer / layers
        ring = {
            "square": square,
            "frustum": size / 2 + circle * size / 2 * (1 - share / 4),
            "pyramid": size / 2 + (square - size / 2) * (1 - 0.999 * share),
        }[outline]
        made.append(Section(HEIGHT * layer, (ring,)))
    return made


def one_diagram(sizes: list[int]) -> None:
    print("\none diagram (sites snapped, sorted, triangulated)  against  qhull, lifted")
    print(f"{'sites':>9} {'engine ms':>10} {'qhull ms':>10} {'ratio':>6}")
    rng = np.random.default_rng(1)
    ours = []
    for n in sizes:
        sites, weights = rng.random((n, 2)), rng.random(n) * 0.3 / n
        grid = Grid(np.zeros(2), 1.0)

        def engine(sites=sites, weights=weights, grid=grid):
            places = grid.snap(sites)
            order = curve_order(places)
            return triangulation(places[order], grid.snap_weights(weights)[order])

        lifted = np.column_stack([sites, (sites**2).sum(axis=1) - weights])
        repeats = max(2, min(30, 30_000 // n))
        fast = seconds(engine, repeats)
        slow = seconds(lambda lifted=lifted: ConvexHull(lifted), 1 if n > 10**5 else repeats)
        ours.append(fast)
        print(f"{n:9} {fast * 1e3:10.3f} {slow * 1e3:10.2f} {slow / fast:6.1f}")
    print(f"exponent from {sizes[0]} to {sizes[-1]} sites: {_exponent(sizes, ours):.2f}")


def _exponent(sizes: list[int], times: list[float]) -> float:
    return float(np.polyfit(np.log(sizes), np.log(times), 1)[0])


def filled(outline: str, cells: int, layers: int) -> Filling:
    """A stack of sections with some cells in the base square, filled."""
    filling = fill_sections(sections(outline, CELL * np.sqrt(cells), layers), None, SETTINGS)
    assert isinstance(filling, Filling)
    return filling


def slowly(layer: Layer) -> object:
    """The layer's diagram by qhull and GEOS."""
    present = layer.state.present()
    sites, weights = layer.state.sites[present, :2], layer.state.weights[present]
    area = oracle.area_of(layer.section)
    shapely.prepare(area)
    corners, vertices, across = oracle.power_diagram(sites, weights)
    pairs, edges = oracle.power_edges(len(sites), corners, vertices, across)
    cut = oracle.cut_edges(area, pairs, edges)
    return cut, oracle.cut_cells(area, oracle.power_cells(len(sites), corners, vertices))


def loop_times(outline: str, cells: int, layers: int) -> tuple[float, float]:
    """Seconds for all layers by the engine, and by scipy and shapely."""
    filling = filled(outline, cells, layers)
    some = max(1, layers // SLOW_LAYERS)
    chosen = [layer for layer in filling.layers if layer.index % some == 0]
    # By turns, since the machine's speed wanders.
    turns = [
        (
            seconds(lambda: [x.index for x in filling.layers], 1),
            seconds(lambda: [*map(slowly, chosen)], 1),
        )
        for _ in range(3 if cells > 1000 else 5)
    ]
    fast, slow = np.min(turns, axis=0)
    return float(fast), float(slow) * layers / len(chosen)


def layer_loop(quick: bool) -> None:
    print("\nlayer loop, sites given  against  scipy + shapely")
    print(f"{'case':>8} {'cells':>6} {'layers':>6} {'engine ms':>10} {'slow ms':>10} {'ratio':>6}")
    for name, cells, layers, outline in CASES:
        layers = min(layers, 100) if quick else layers
        fast, slow = loop_times(outline, cells, layers)
        print(
            f"{name:>8} {cells:6} {layers:6} {fast * 1e3:10.2f} {slow * 1e3:10.0f} "
            f"{slow / fast:6.0f}",
            flush=True,
        )


def peak_memory(cells: int, layers: int) -> float:
    """The peak memory, MB, of going through some layers, in a process of its own."""
    code = (
        "import resource; from benchmarks.engine import filled; "
        f"print(sum(1 for _ in filled('square', {cells}, {layers}).layers), "
        "resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return float(out.stdout.split()[1])


def exponents(quick: bool) -> None:
    print("\nexecution time, 20 layers (thesis, section 3.5.5: exponent 2)")
    sizes = list(range(500, 7001, 2000 if quick else 500))
    times = []
    for cells in sizes:
        filling = filled("square", cells, 20)
        times.append(seconds(lambda filling=filling: [x.index for x in filling.layers]))
        print(f"{cells:9} {times[-1] * 1e3:10.2f} ms")
    print(f"exponent in the number of cells: {_exponent(sizes, times):.2f}")
    counts, times = [250, 500, 1000, 2000], []
    for layers in counts:
        filling = filled("square", 300, layers)
        times.append(seconds(lambda filling=filling: [x.index for x in filling.layers]))
    print(f"exponent in the number of layers: {_exponent(counts, times):.2f}")


def start() -> None:
    print("\nstart")
    with tempfile.TemporaryDirectory() as cache:
        code = "import time; t = time.perf_counter(); import numba; n = time.perf_counter();"
        code += "from v3dcad.commands.compiling import load_engine; load_engine();"
        code += "import v3dcad.structure.overhang; print(n - t, time.perf_counter() - n)"
        for what in ("compiling", "cached"):
            out = subprocess.run(
                [sys.executable, "-c", code],
                capture_output=True,
                text=True,
                check=True,
                env={"NUMBA_CACHE_DIR": cache, "PYTHONPATH": str(Path(__file__).parents[1])},
            ).stdout.split()
            print(f"{what:>10}: {float(out[1]):.2f} s beyond import numba ({float(out[0]):.2f} s)")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="leave out what takes minutes")
    quick = parser.parse_args().quick
    layer_loop(quick)
    one_diagram([50, 300, 1000, 4000, 7000, 50_000] + ([] if quick else [1_000_000]))
    exponents(quick)
    if not quick:
        print(f"\npeak memory, 4,000 cells × 5,000 layers: {peak_memory(4000, 5000):.0f} MB")
    start()


if __name__ == "__main__":
    main()
