"""How small `.ont` is: the thesis's structures of Table 4.1 in every format, as bytes.

`python benchmarks/ont.py [part ...]` from the root of the repository prints two Markdown tables
(docs/ont.md holds them). Every edge of every layer, wall or contour, is a rectangle of two
triangles one layer high in the STL, a wire in STEP, a beam in 3MF. STEP is written for as many
layers as have 20,000 edges and scaled up (marked ~): all of it would be hundreds of megabytes.
"""

from __future__ import annotations

import ctypes
import lzma
import sys
import tempfile
import time
import zlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from build123d import Box, Cone, Plane, Rectangle, extrude

import v3dcad
from v3dcad.formats.mesh.stl import RECORD, normals
from v3dcad.model import Floats

BUNNY = Path(__file__).resolve().parents[2] / "shared" / "data" / "parts" / "bunny.stl"
PARTS: dict[str, tuple[Callable[[], Any], dict[str, Any], float]] = {
    "cone": (lambda: Cone(20, 15, 30), {"layer_height": 0.2, "offset": 0.2, "sites": 40}, 2.8),
    "pyramid": (
        lambda: extrude(Plane.XY * Rectangle(67, 67), 50, taper=10),
        {"layer_height": 0.2, "offset": 0.5, "sites": 10},
        0.7,
    ),
    "large pyramid": (
        lambda: extrude(Plane.XY * Rectangle(180, 180), 30, taper=10),
        {"layer_height": 0.2, "offset": 0.2, "sites": 300},
        6.1,
    ),
    "bunny": (lambda: BUNNY, {"layer_height": 0.25, "offset": 0.4, "sites": 40}, 15.0),
    "prism": (
        lambda: Box(1000, 1000, 40),
        {"layer_height": 2.0, "offset": 0.1, "sites": 4000},
        71.0,
    ),
}
"""Name: the part, its settings, and the thesis's compressed `.ont`, kB (Table 4.1)."""

STEP_EDGES = 20_000


def wall_corners(structure: v3dcad.Structure) -> Iterator[Floats]:
    """Corners (t, 3, 3), mm, of each layer's walls and contours, one layer high."""
    high = np.array([0.0, 0.0, structure.settings.layer_height])
    for layer in structure.layers:
        points = np.column_stack(
            [layer.diagram.vertices, np.full(len(layer.diagram.vertices), layer.z)]
        )
        a, b = np.moveaxis(points[layer.diagram.edges], 1, 0)
        lower, upper = np.stack([a, b, b + high], axis=1), np.stack([a, b + high, a + high], axis=1)
        yield np.stack([lower, upper], axis=1).reshape(-1, 3, 3)


def write_binary_stl(structure: v3dcad.Structure, path: Path) -> None:
    with path.open("wb") as file:
        file.write(bytes(84))
        count = 0
        for corners in wall_corners(structure):
            records = np.zeros(len(corners), RECORD)
            records["normal"], records["corners"] = normals(corners), corners
            file.write(records.tobytes())
            count += len(records)
        file.seek(80)
        file.write(count.to_bytes(4, "little"))


def write_ascii_stl(structure: v3dcad.Structure, path: Path) -> None:
    facet = "facet normal %g %g %g\nouter loop\n" + 3 * "vertex %g %g %g\n" + "endloop\nendfacet\n"
    with path.open("w") as file:
        file.write("solid walls\n")
        for corners in wall_corners(structure):
            rows = np.concatenate([normals(corners), corners.reshape(-1, 9)], axis=1)
            file.writelines(facet % tuple(row) for row in rows.tolist())
        file.write("endsolid walls\n")


def write_beams(structure: v3dcad.Structure, path: Path) -> None:
    """3MF with a beam for each edge, its vertices shared within a layer."""
    import lib3mf

    wrapper = lib3mf.get_wrapper()
    model = wrapper.CreateModel()
    mesh = model.AddMeshObject()
    points, edges, count = [], [], 0
    for layer in structure.layers:
        flat = layer.diagram.vertices
        points.append(np.column_stack([flat, np.full(len(flat), layer.z)]))
        edges.append(layer.diagram.edges + count)
        count += len(flat)
    nodes = np.concatenate(points).astype(np.float32)
    # Beams shorter than the lattice's least length are refused.
    pairs = np.concatenate(edges)
    pairs = pairs[np.linalg.norm(nodes[pairs[:, 0]] - nodes[pairs[:, 1]], axis=1) > 1e-4]
    positions = (lib3mf.Position * len(nodes)).from_buffer_copy(nodes.tobytes())
    mesh.SetGeometry(positions, (lib3mf.Triangle * 0)())
    fields = [("ids", "<u4", 2), ("radii", "<f8", 2), ("caps", "<i4", 2)]
    beams = np.zeros(len(pairs), np.dtype(fields))
    assert beams.itemsize == ctypes.sizeof(lib3mf.Beam)
    beams["ids"], beams["radii"] = pairs, 0.4
    lattice = mesh.BeamLattice()
    lattice.SetMinLength(1e-5)
    lattice.SetBeams((lib3mf.Beam * len(beams)).from_buffer_copy(beams.tobytes()))
    model.AddBuildItem(mesh, wrapper.GetIdentityTransform())
    model.QueryWriter("3mf").WriteToFile(str(path))


def write_step(structure: v3dcad.Structure, path: Path) -> float:
    """Write layers from the middle; returns how many times as many edges there are in all."""
    counts = np.array([len(layer.diagram.edges) for layer in structure.layers])
    some = max(1, min(len(counts), int(STEP_EDGES / counts.mean())))
    first = (len(counts) - some) // 2
    middle = [structure.layers[index] for index in range(first, first + some)]
    replace(structure, layers=middle).write_step(path)
    return float(counts.sum() / counts[first : first + some].sum())


def sizes(path: Path) -> dict[str, int]:
    """Bytes as they are, as zip and as xz compress them, a block in memory at a time."""
    zipped, pressed = zlib.compressobj(9, zlib.DEFLATED, -15), lzma.LZMACompressor(preset=6)
    found = {"plain": path.stat().st_size, "zip": 98 + 2 * len(path.name), "xz": 0}
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            found["zip"] += len(zipped.compress(block))
            found["xz"] += len(pressed.compress(block))
    found["zip"] += len(zipped.flush())
    found["xz"] += len(pressed.flush())
    return found


def measure(name: str, folder: Path) -> dict[str, dict[str, float]]:
    make, settings, _ = PARTS[name]
    structure = v3dcad.fill(make(), method="thesis", **settings)
    found: dict[str, dict[str, float]] = {}
    for boundary in ("exact", "stl"):
        path = folder / f"part.{boundary}.ont"
        structure.write_ont(path, boundary)
        found[f".ont, {boundary}"] = dict(sizes(path))
    writers = {
        "ASCII STL": write_ascii_stl, "binary STL": write_binary_stl, "3MF beams": write_beams,
        "STEP wires": write_step,
    }  # fmt: skip
    for kind, write in writers.items():
        path = folder / kind
        scale = write(structure, path) or 1.0
        found[kind] = {key: value * scale for key, value in sizes(path).items()}
        found[kind]["scaled"] = float(scale > 1)
        path.unlink()
    return found


def shown(value: float, scaled: float = 0.0) -> str:
    return ("~" if scaled else "") + f"{value:,.0f}"


def main() -> None:
    names = sys.argv[1:] or list(PARTS)
    measured = {}
    for name in names:
        start = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            measured[name] = measure(name, Path(folder))
        print(f"{name}: {time.perf_counter() - start:.0f} s", file=sys.stderr)
    print("| bytes | | " + " | ".join(names) + " |")
    print("|---|---|" + "---|" * len(names))
    for kind in measured[names[0]]:
        for how in ("plain", "zip", "xz"):
            row = [measured[name][kind] for name in names]
            cells = [shown(cell[how], cell.get("scaled", 0.0)) for cell in row]
            print(f"| {kind if how == 'plain' else ''} | {how} | " + " | ".join(cells) + " |")
    print("\n| `.ont`, exact, xz | " + " | ".join(names) + " |")
    print("|---|" + "---|" * len(names))
    best = {name: measured[name][".ont, exact"]["xz"] for name in names}
    rows = {
        "thesis's compressed `.ont`, bytes": lambda name: shown(PARTS[name][2] * 1000),
        "ours": lambda name: shown(best[name]),
        "ours ÷ thesis's": lambda name: f"{best[name] / PARTS[name][2] / 1000:.2f}",
        "zipped 3MF is times larger": lambda name: (
            f"{measured[name]['3MF beams']['plain'] / best[name]:.1f}"
        ),
        "below its binary STL": lambda name: (
            f"{100 * (1 - best[name] / measured[name]['binary STL']['plain']):.3f} %"
        ),
    }
    for what, tell in rows.items():
        print(f"| {what} | " + " | ".join(tell(name) for name in names) + " |")


if __name__ == "__main__":
    main()
