"""Hours of five parts filled by v3dcad, and by PrusaSlicer with gyroid of the same mass.

Run `python -m benchmarks.gyroid`, where `prusa-slicer` is installed. Both print the same shells
(two perimeters, four solid layers) with the same beads, speeds, retraction, cooling and one
acceleration. PrusaSlicer's density is changed until both files take the same filament. The times
of both files are told by `v3dcad.formats.gcode.reader`, which knows neither slicer.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import v3dcad
from benchmarks.print import LAYER_HEIGHT, parts
from v3dcad.formats.gcode.reader import Summary, read_gcode
from v3dcad.formats.mesh.stl import binary_stl
from v3dcad.settings import PrintSettings

SLICER = "prusa-slicer"
ACCELERATIONS = (1500.0, 500.0)
SAME_MASS = 0.003
"""How far apart the masses may be."""
MOST_TRIALS = 8
USED = re.compile(r"; filament used \[mm\] = ([\d.]+)")


def slicer_settings(printing: PrintSettings) -> dict[str, Any]:
    """The same print, in PrusaSlicer's words; what ours lacks is as in its profiles for Prusas."""
    width, depth = printing.bed_size()
    widths = ("", "perimeter", "external-perimeter", "infill", "solid-infill", "top-infill")
    return {
        **{f"{name}-extrusion-width".lstrip("-"): printing.bead_width for name in widths},
        "first-layer-extrusion-width": printing.bead_width,
        "layer-height": LAYER_HEIGHT,
        "first-layer-height": printing.first_layer_height,
        "perimeters": printing.perimeters,
        "bottom-solid-layers": printing.bottom_layers,
        "top-solid-layers": printing.top_layers,
        "fill-pattern": "gyroid",
        "infill-anchor": 2.5,
        "infill-anchor-max": 12,
        "solid-infill-below-area": 0,
        "skirts": 0,
        "perimeter-speed": printing.print_speed,
        "small-perimeter-speed": printing.perimeter_speed,
        "external-perimeter-speed": printing.perimeter_speed,
        "infill-speed": printing.print_speed,
        "solid-infill-speed": printing.solid_speed,
        "top-solid-infill-speed": printing.solid_speed,
        "gap-fill-speed": printing.solid_speed,
        "bridge-speed": printing.bridge_speed,
        "first-layer-speed": printing.first_layer_speed,
        "travel-speed": printing.travel_speed,
        "travel-speed-z": printing.z_speed,
        "max-volumetric-speed": printing.most_flow,
        "slowdown-below-layer-time": printing.minimum_layer_time,
        "min-print-speed": printing.slowest_speed,
        "default-acceleration": printing.acceleration,
        "retract-length": printing.retraction,
        "retract-speed": printing.retraction_speed,
        "retract-before-travel": printing.retraction_travel,
        "filament-diameter": printing.filament_diameter,
        "filament-density": printing.filament_density,
        "nozzle-diameter": 0.4,
        "gcode-flavor": "marlin2",
        "bed-shape": f"0x0,{width}x0,{width}x{depth},0x{depth}",
        "max-print-height": printing.build_height,
        "center": f"{width / 2},{depth / 2}",
    }


def sliced(mesh: Path, density: float, printing: PrintSettings) -> Path:
    """G-code of a mesh, filled by gyroid of a density (%); raises where the slicer fails."""
    file = mesh.with_suffix(".gyroid.gcode")
    options = [f"--{name}={value}" for name, value in slicer_settings(printing).items()]
    subprocess.run(
        [SLICER, "--export-gcode", "--ensure-vertical-shell-thickness", "--no-extra-perimeters",
         "--loglevel=0", f"--fill-density={density:.4f}%", *options, f"--output={file}", mesh],
        check=True,
        capture_output=True,
    )  # fmt: skip
    return file


def of_same_mass(mesh: Path, filament: float, printing: PrintSettings) -> tuple[float, Summary]:
    """The density (%) at which gyroid takes as much filament (mm), and what the print takes.

    By false position: filament rises with density, nearly in a straight line.
    """
    low, high = 0.0, 90.0
    taken = {density: _filament(sliced(mesh, density, printing)) for density in (low, high)}
    for _ in range(MOST_TRIALS):
        share = (filament - taken[low]) / (taken[high] - taken[low])
        density = low + share * (high - low)
        file = sliced(mesh, density, printing)
        taken[density] = _filament(file)
        if abs(taken[density] / filament - 1) < SAME_MASS:
            break
        low, high = (density, high) if taken[density] < filament else (low, density)
    return density, read_gcode(file, printing)


def _filament(file: Path) -> float:
    found = USED.search(file.read_text(encoding="utf-8"))
    assert found is not None
    return float(found[1])


def row(name: str, part: Any, acceleration: float, folder: Path) -> str:
    """One part's figures at one acceleration, mm/s²."""
    printing = PrintSettings(acceleration=acceleration, skirt_loops=0, prime_line=0, brim_width=0)
    structure = v3dcad.fill(part, layer_height=LAYER_HEIGHT)
    file, mesh = folder / f"{name}.gcode", folder / f"{name}.stl"
    structure.write_gcode(file, printing)
    ours = read_gcode(file, printing)
    mesh.write_bytes(binary_stl(structure.part.mesh()))
    density, gyroid = of_same_mass(mesh, ours.filament_mm, printing)
    grams = printing.filament_area() * printing.filament_density / 1000
    cells = (
        name,
        f"{acceleration:g}",
        f"{ours.filament_mm * grams:.1f}",
        f"{gyroid.filament_mm * grams:.1f}",
        f"{density:.1f}",
        f"{ours.time_s / 3600:.2f}",
        f"{gyroid.time_s / 3600:.2f}",
        f"{ours.time_s / gyroid.time_s:.2f}",
    )
    return " ".join(f"{cell:>10}" for cell in cells)


def main() -> None:
    """Print the table."""
    if shutil.which(SLICER) is None:
        print(f"{SLICER} is not installed: nothing to compare with (apt-get install {SLICER})")
        return
    columns = "part mm/s² g gyroid_g density_% hours gyroid_h ratio"
    print(" ".join(f"{name:>10}" for name in columns.split()))
    with tempfile.TemporaryDirectory() as folder:
        for name, part in parts().items():
            for acceleration in ACCELERATIONS:
                print(row(name, part, acceleration, Path(folder)), flush=True)


if __name__ == "__main__":
    main()
