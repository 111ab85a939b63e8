"""The thesis's tables and figures, its figures beside ours.

    python -m benchmarks.thesis [--bunny ../shared/data/parts/bunny.stl] [--out FOLDER]

prints Table 4.1 (sizes), Table 4.2 (times), and how far walls lie from the layer below, beside a
foam of as many cells; writes Fig. 3.13 (area per cell) and Fig. 3.30 (time over number of sites)
as PNG.
"""

from __future__ import annotations

import argparse
import lzma
import sys
import tempfile
import time
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "samples" / "thesis"))

from recipes import Recipe, cubes, prism_of_300, published, pyramid_of_50  # noqa: E402

from benchmarks.sampling import distances_below  # noqa: E402
from v3dcad import FillSettings, Structure, build  # noqa: E402
from v3dcad.formats.mesh.stl import ascii_stl  # noqa: E402
from v3dcad.model import Layer, Mesh  # noqa: E402
from v3dcad.parts import part_from  # noqa: E402
from v3dcad.structure.thesis.loop import ThesisLayer  # noqa: E402

TABLE_41 = {
    "cone": (26, 2.8, 9893, 1440),
    "truncated pyramid": (4, 0.7, 649, 98),
    "large truncated pyramid": (13, 6.1, 17344, 2622),
    "bunny": (68, 15, 3820, 601),
    "prism": (140, 71, 392000, 70200),
}
"""kB: .ont plain and compressed, ASCII and binary STL."""

TABLE_42 = {"cube": (3100, 18), "fine cube": (6000, 16)}
"""ms: regular and interpolated."""

SPACING = 0.5
"""mm: how far apart points on walls are sampled."""

PARAMETERS = ("part", "layer height", "offset", "sites")


def table(title: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print rows below their head, columns as wide as they need to be."""
    lines = [head, *rows]
    widths = [max(len(line[k]) for line in lines) for k in range(len(head))]
    print(f"\n{title}\n")
    for number, line in enumerate(lines):
        print("  ".join(word.rjust(width) for word, width in zip(line, widths, strict=True)))
        if not number:
            print("  ".join("-" * width for width in widths))
    sys.stdout.flush()


def walls(layer: Layer, height: float) -> Mesh:
    """Every edge of a layer, raised by its height: two triangles each."""
    ends = layer.diagram.vertices[layer.diagram.edges]
    z = np.full((len(ends), 2, 1), layer.z)
    low, high = np.concatenate([ends, z], axis=2), np.concatenate([ends, z + height], axis=2)
    corners = np.concatenate([low, high], axis=1).reshape(-1, 3)
    both = np.array([[0, 1, 3], [0, 3, 2]])
    triangles = 4 * np.arange(len(ends))[:, None, None] + both
    return Mesh(corners, triangles.reshape(-1, 3))


def wall_bytes(structure: Structure) -> tuple[int, int]:
    """Bytes of the walls of all layers as one ASCII and one binary STL."""
    wrapping = len("solid walls\nendsolid walls\n")
    text, binary = wrapping, 84
    for layer in structure.layers:
        mesh = walls(layer, structure.settings.layer_height)
        text += len(ascii_stl(mesh, "walls")) - wrapping
        binary += 50 * len(mesh.triangles)
    return text, binary


def table_41(cases: Sequence[Recipe]) -> None:
    rows = []
    for case in cases:
        structure = case.build()
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "part.ont"
            structure.write_ont(file)
            ont = file.read_bytes()
        plain, packed = len(ont) / 1000, len(lzma.compress(ont, preset=9)) / 1000
        text, binary = (size / 1000 for size in wall_bytes(structure))
        theirs = TABLE_41[case.name]
        pairs = zip((plain, packed, text, binary), theirs, strict=True)
        settings = case.settings
        rows.append(
            [
                case.name,
                *(f"{value:g}" for value in (settings.layer_height, settings.offset)),
                str(settings.sites),
                *(f"{ours:,.1f} / {other:,g}" for ours, other in pairs),
                f"{100 - 100 * plain / text:.2f} / {100 - 100 * theirs[0] / theirs[2]:.2f}",
                f"{100 - 100 * packed / binary:.2f} / {100 - 100 * theirs[1] / theirs[3]:.2f}",
            ]
        )
    table(
        "Table 4.1: sizes in kB, ours / thesis's (compressed: xz / RAR)",
        [*PARAMETERS, ".ont", "compressed", "ASCII STL", "binary STL", "smaller by %", "packed %"],
        rows,
    )


def seconds(structure: Structure) -> float:
    """How long going through the layers takes."""
    start = time.perf_counter()
    for _ in structure.layers:
        pass
    return time.perf_counter() - start


def table_42() -> None:
    rows = []
    for case in cubes():
        part = part_from(case.source())
        lofting = replace(case.settings, interpolate=True)
        taken = []
        for settings in (case.settings, lofting):
            runs = []
            for _ in range(5):
                start = time.perf_counter()
                alone = seconds(build(part, settings))
                runs.append((1000 * (time.perf_counter() - start), 1000 * alone))
            taken.append(min(runs))
        (regular, alone), (lofted, _) = taken
        theirs = TABLE_42[case.name]
        settings = case.settings
        rows.append(
            [
                case.name,
                *(f"{value:g}" for value in (settings.layer_height, settings.offset)),
                str(settings.sites),
                f"{regular:.0f} / {theirs[0]}",
                f"{alone:.0f}",
                f"{lofted:.0f} / {theirs[1]}",
                f"{100 - 100 * lofted / regular:.2f} / {100 - 100 * theirs[1] / theirs[0]:.2f}",
            ]
        )
    table(
        "Table 4.2: time in ms, part to layers, ours / thesis's",
        [*PARAMETERS, "regular", "without sectioning", "interpolated", "shorter by %"],
        rows,
    )


def farthest(layers: Iterable[Layer]) -> tuple[float, float]:
    """How far the walls of a layer lie from walls and contours of the layer below, mm.

    The largest distance of points along the walls, and the largest of each layer's 99th
    percentile. Points outside the section below are the part's own overhang.
    """
    most, most_99 = 0.0, 0.0
    for below, layer in pairwise(layers):
        far = distances_below(layer, below, SPACING)
        if len(far):
            most = max(most, float(far.max()))
            most_99 = max(most_99, float(np.percentile(far, 99)))
    return most, most_99


def overhang(cases: Sequence[Recipe]) -> None:
    rows = []
    for case in cases:
        part = part_from(case.source())
        structure = build(part, case.settings)
        report = structure.report()
        told = [str(len(report[name])) for name in ("births", "layers_without_candidate")]
        rows.append(
            [case.name, "thesis", f"{case.settings.offset:g}", *told, *_farthest(structure)]
        )
        sides = np.ptp(part.bounds, axis=0)[:2]
        foam = FillSettings(
            layer_height=case.settings.layer_height,
            cell_size=float(np.sqrt(sides.prod() / case.settings.sites)),
        )
        rows.append([case.name, "foam", "", "", "", *_farthest(build(part, foam))])
    table(
        "Overhang: largest distance from a layer's walls to the layer below, mm",
        ["part", "method", "offset", "inserted", "unanswered", "largest", "99 % below"],
        rows,
    )


def _farthest(structure: Structure) -> list[str]:
    return [f"{distance:.3f}" for distance in farthest(structure.layers)]


def figure_313(path: Path) -> None:
    """Area per cell over the layers of the pyramid of 50 sites."""
    case = pyramid_of_50()
    part = part_from(case.source())
    random = [np.random.default_rng(seed).uniform(-33.5, 33.5, (50, 2)) for seed in (6, 4)]
    curves = [
        ("even scatter, offset 0.1", build(part, case.settings)),
        ("random scatter, offset 0.1", build(part, case.settings, random[0])),
        ("random scatter, offset 0.5", build(part, replace(case.settings, offset=0.5), random[1])),
    ]
    rows = []
    figure, axes = _axes("layer", "area per cell, mm²", "Fig. 3.13: pyramid of 50 sites")
    for name, structure in curves:
        layers = list(structure.layers)
        areas = np.array([layer.area_per_cell for layer in layers])
        axes.plot(areas, label=name)
        born = [
            layer.index
            for below, layer in pairwise(layers)
            if isinstance(layer, ThesisLayer)
            and isinstance(below, ThesisLayer)
            and len(layer.inserted) > len(below.inserted)
        ]
        axes.plot(born, areas[born], "k.")
        above = np.nonzero(areas > areas[0] * (1 + 1e-9))[0]
        rows.append(
            [
                name,
                " ".join(map(str, born)) or "none",
                f"{above.min()} to {above.max()} ({len(above)})" if len(above) else "none",
            ]
        )
    axes.axhline(67**2 / 50, color="0.7", linewidth=0.8)
    axes.legend()
    figure.savefig(path, dpi=120)
    table(
        f"Fig. 3.13 → {path} (thesis: above the first layer's until layer 8, insertions until 7)",
        ["sites", "insertions in layers", "layers above the first"],
        rows,
    )


def figure_330(path: Path, layers: int = 5) -> None:
    """Time to fill `layers` layers of the prism over the number of sites."""
    case = next(case for case in published() if case.name == "prism")
    part = part_from(case.source())
    counts = np.arange(500, 7001, 500)
    settings = replace(case.settings, layer_height=40 / layers)
    taken = np.array(
        [seconds(build(part, replace(settings, sites=int(count)))) for count in counts]
    )
    exponent = float(np.polyfit(np.log(counts), np.log(taken), 1)[0])
    figure, axes = _axes("sites", "time, s", f"Fig. 3.30: {layers} layers, exponent {exponent:.2f}")
    axes.plot(counts, taken, "o-")
    figure.savefig(path, dpi=120)
    table(
        f"Fig. 3.30 → {path}: time for {layers} layers, s; exponent {exponent:.2f} (thesis: 2)",
        [str(count) for count in counts],
        [[f"{value:.2f}" for value in taken]],
    )


def _axes(x: str, y: str, title: str):  # type: ignore[no-untyped-def]
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 4.5), layout="constrained")
    axes = figure.add_subplot(xlabel=x, ylabel=y, title=title)
    return figure, axes


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--bunny", type=Path, default=ROOT / "../shared/data/parts/bunny.stl")
    parser.add_argument("--out", type=Path, default=Path("benchmark-thesis"))
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    start = time.perf_counter()
    cases = published(given.bunny if given.bunny.exists() else None)
    table_42()
    table_41(cases)
    small = [case for case in cases if case.name in ("cone", "truncated pyramid", "bunny")]
    overhang([*small, prism_of_300()])
    figure_313(given.out / "area_per_cell.png")
    figure_330(given.out / "time.png")
    print(f"\nAll in {time.perf_counter() - start:.0f} s.")


if __name__ == "__main__":
    main()
