"""The engine against qhull and GEOS, in one run: `python -m benchmarks.engine [--quick]`.

Ratios count; milliseconds depend on the machine. The slow side is tests/oracle.py, given the
engine's own sites and weights: lifted qhull, edges, cells and contours cut by prepared shapely,
scipy's spanning tree. It gives no births, so that ratios are rather too low. Processor time is
compared, so that a busy machine does not blur it. Where there are many layers and sites, the slow
side is extrapolated from some 50 layers. The offsets are beyond what --max-overhang allows by
itself: 90° lifts it.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

from tests import oracle
from v3dcad.geometry.power_diagram.grid import Grid, curve_order
from v3dcad.geometry.power_diagram.regular_triangulation import triangulation
from v3dcad.model import Section
from v3dcad.settings import FillSettings
from v3dcad.structure.fill import fill_sections

SLOW_LAYERS = 50
CASES = [
    # name, sites, layers, size, offset, outline
    ("cube", 8, 250, 50.0, 0.3, "square"),
    ("cube", 8, 500, 50.0, 0.3, "square"),
    ("frustum", 40, 150, 40.0, 0.3, "frustum"),
    ("pyramid", 300, 150, 180.0, 0.3, "pyramid"),
    ("prism", 4000, 20, 1000.0, 3.0, "square"),
    ("stress", 4000, 5000, 1000.0, 0.3, "square"),
]


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
        made.append(Section(0.2 * layer, (ring,)))
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


def layer_loop(quick: bool) -> None:
    print("\nlayer loop, births and tree on  against  scipy + shapely")
    print(f"{'case':>8} {'sites':>6} {'layers':>6} {'engine ms':>10} {'slow ms':>10} {'ratio':>6}")
    for name, n, layers, size, offset, outline in CASES:
        layers = min(layers, 500) if quick else layers
        sites = np.random.default_rng(7).random((n, 2)) * size
        stack = sections(outline, size, layers)
        settings = FillSettings(offset=offset, max_overhang=90.0)

        some = max(1, layers // (SLOW_LAYERS if n * layers > 10**5 else 1))
        chosen = [
            layer
            for layer in fill_sections(stack, sites, settings).layers
            if layer.index % some == 0
        ]

        def engine(stack=stack, sites=sites, settings=settings):
            return [layer.index for layer in fill_sections(stack, sites, settings).layers]

        def plain(chosen=chosen):
            return [
                oracle.layer(layer.state.sites, layer.state.weights, layer.section)
                for layer in chosen
            ]

        # By turns, since the machine's speed wanders.
        turns = [(seconds(engine, 1), seconds(plain, 1)) for _ in range(5)]
        fast, slow = np.min(turns, axis=0) * [1, layers / len(chosen)]
        print(
            f"{name:>8} {n:6} {layers:6} {fast * 1e3:10.2f} {slow * 1e3:10.0f} {slow / fast:6.0f}"
        )
    print(f"peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


def exponents(quick: bool) -> None:
    print("\nexecution time, 20 layers (thesis, section 3.5.5: exponent 2)")
    sizes = list(range(500, 7001, 2000 if quick else 500))
    times = []
    for n in sizes:
        sites = np.random.default_rng(7).random((n, 2)) * 200
        stack, settings = (
            sections("square", 200.0, 20),
            FillSettings(offset=600 / n, max_overhang=90.0),
        )
        run = lambda: [x.index for x in fill_sections(stack, sites, settings).layers]  # noqa: B023, E731
        times.append(seconds(run))
        print(f"{n:9} {times[-1] * 1e3:10.2f} ms")
    print(f"exponent in the number of sites: {_exponent(sizes, times):.2f}")
    if not quick:
        plot(sizes, times)
    counts, times = [250, 500, 1000, 2000, 4000], []
    sites = np.random.default_rng(7).random((300, 2)) * 100
    for layers in counts:
        stack = sections("square", 100.0, layers)
        settings = FillSettings(offset=100 / layers, max_overhang=90.0)  # the same growth in all
        run = lambda: [x.index for x in fill_sections(stack, sites, settings).layers]  # noqa: B023, E731
        times.append(seconds(run))
    print(f"exponent in the number of layers: {_exponent(counts, times):.2f}")


def plot(sizes: list[int], times: list[float]) -> None:
    """Draw the times (s) over the numbers of sites, beside what the thesis's exponent would make
    of the first, as docs/engine-times.svg.
    """
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "v3dcad", "svg.fonttype": "none", "font.size": 9})
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(5, 3.2), layout="constrained")
    n, exponent = np.array(sizes), _exponent(sizes, times)
    scale = np.exp(np.mean(np.log(times) - exponent * np.log(n)))
    axes.loglog(n, times, "o", color="black", markersize=4, label="20 layers, measured")
    axes.loglog(n, scale * n**exponent, color="black", label=f"exponent {exponent:.2f}, fitted")
    axes.loglog(n, times[0] * (n / n[0]) ** 2, ":", color="gray", label="exponent 2 (thesis)")
    axes.set(xlabel="sites", ylabel="execution time, s")
    axes.set_xticks([500, 1000, 2000, 3500, 7000], ["500", "1000", "2000", "3500", "7000"])
    axes.minorticks_off()
    axes.legend(frameon=False)
    file = Path(__file__).parents[1] / "docs" / "engine-times.svg"
    figure.savefig(file, metadata={"Date": None})
    print(f"plotted: {file}")


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
    start()


if __name__ == "__main__":
    main()
