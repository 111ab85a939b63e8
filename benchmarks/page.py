"""How large the page is, how many draw calls a frame takes and how long it takes to draw.

`python benchmarks/page.py [part ...]` from the root of the repository prints the Markdown table of
docs/page.md. Frames are drawn by Chromium without a window, whose renderer is software, on the
processor alone (SwiftShader). A frame counts as drawn when its pixels can be read back. Each figure
is the median of `FRAMES`, the camera turned before each.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from build123d import Plane, Rectangle, extrude
from playwright.sync_api import Page, sync_playwright

import v3dcad

FRAMES = 7
SAMPLES = Path(__file__).resolve().parents[1] / "samples"


def large_pyramid() -> Any:
    """The thesis's, 180 × 180 × 30 mm."""
    return extrude(Plane.XY * Rectangle(180, 180), 30, taper=10)


THESIS = {"method": "thesis", "sites": 300, "offset": 0.2, "layer_height": 0.2}
PARTS: dict[str, tuple[Callable[[], Any], dict[str, Any]]] = {
    "pyramid": (lambda: SAMPLES / "pyramid.step", {}),
    "large pyramid, thesis": (large_pyramid, THESIS),
    "large pyramid": (large_pyramid, {}),
    "large pyramid, cells of 4.3 mm": (large_pyramid, {"cell_size": 4.3}),
}
VIEWS: dict[str, dict[str, Any]] = {
    "walls": {"target": "full", "form": "walls"},
    "lines": {"target": "full", "form": "layers"},
    "one layer": {"target": "layer"},
    "toolpath": {"target": "toolpath"},
}
MEASURE = """frames => {
    const { stage } = v3dcad;
    const gl = stage.renderer.getContext();
    const pixel = new Uint8Array(4);
    const times = [];
    for (let k = 0; k < frames; k++) {
        stage.turn(10, 0);
        const before = performance.now();
        stage.draw();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        times.push(performance.now() - before);
    }
    return [stage.renderer.info.render.calls, times];
}"""


def measure(name: str, file: Path, tab: Page) -> list[str]:
    source, settings = PARTS[name]
    structure = v3dcad.fill(source(), **settings)
    structure.write_html(file)
    edges = sum(len(layer.diagram.edges) for layer in structure.layers)
    before = time.perf_counter()
    tab.goto(file.as_uri())
    tab.wait_for_selector("#app[data-ready]", timeout=180_000)
    opened = time.perf_counter() - before
    steps = tab.evaluate("() => v3dcad.structure.arrays.path_roles.length")
    cells = []
    for values in VIEWS.values():
        tab.evaluate("values => v3dcad.state.set(values)", values)
        calls, times = tab.evaluate(MEASURE, FRAMES)
        cells.append(f"{statistics.median(times):.0f} ms, {calls}")
    size = f"{file.stat().st_size / 1e6:.1f} MB"
    return [name, f"{edges:,}", f"{steps:,}", size, f"{opened:.1f} s", *cells]


def main() -> None:
    """Print the table."""
    names = [name for name in PARTS if not sys.argv[1:] or name in sys.argv[1:]]
    print("| part | edges | steps of toolpath | page | opens in | " + " | ".join(VIEWS) + " |")
    print("|---|" + "---|" * (4 + len(VIEWS)))
    drawing = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        chromium = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=drawing
        )
        for name in names:
            tab = chromium.new_page(viewport={"width": 1280, "height": 800})
            print(f"| {' | '.join(measure(name, Path(folder) / 'page.html', tab))} |", flush=True)
            tab.close()
        chromium.close()


if __name__ == "__main__":
    main()
