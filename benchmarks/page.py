"""How large the page is, how many draw calls a frame takes and how long it takes to draw.

`python benchmarks/page.py [part ...]` from the root of the repository prints the Markdown table of
docs/page.md. Frames are drawn by Chromium without a window, whose renderer is software, on the
processor alone (SwiftShader). A frame counts as drawn when its pixels can be read back, and takes
the processor time of all of Chromium, over all cores: that is the same on a busy machine. Each
figure is the mean of `FRAMES`, the camera turned before each.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from build123d import Plane, Rectangle, extrude
from playwright.sync_api import Browser, Page, sync_playwright

import v3dcad

FRAMES = 5
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
SEGMENTS = 500_000
EXACTLY = """([kind, count]) => {
    const { drawing, state } = v3dcad;
    state.set({ target: "full", form: "walls" });
    for (const one of ["strips", "walls", "contours", "struts", "ridges"]) {
        drawing[one].show(one === kind);
    }
    drawing[kind].rows(0, count);
}"""
MOVE = "() => { v3dcad.stage.move(); for (let k = 0; k < 4; k++) v3dcad.stage.paced(1000); }"
DRAW = """frames => {
    const { stage } = v3dcad;
    const gl = stage.renderer.getContext();
    const pixel = new Uint8Array(4);
    for (let k = 0; k < frames; k++) {
        stage.turn(10, 0);
        stage.draw();
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    }
    return stage.renderer.info.render.calls;
}"""


def processor_time(chromium: Browser) -> float:
    """Seconds that all processes of the browser have taken so far."""
    session = chromium.new_browser_cdp_session()
    told = session.send("SystemInfo.getProcessInfo")["processInfo"]
    session.detach()
    return float(sum(process["cpuTime"] for process in told))


def measure(name: str, file: Path, chromium: Browser) -> list[str]:
    """A row of the table."""
    source, settings = PARTS[name]
    structure = v3dcad.fill(source(), **settings)
    structure.write_html(file)
    edges = sum(len(layer.diagram.edges) for layer in structure.layers)
    tab = chromium.new_page(viewport={"width": 1280, "height": 800})
    before = processor_time(chromium)
    tab.goto(file.as_uri())
    tab.wait_for_selector("#app[data-ready]", timeout=180_000)
    opened = processor_time(chromium) - before
    steps = tab.evaluate("() => v3dcad.structure.arrays.path_roles.length")
    cells = []
    for values in VIEWS.values():
        tab.evaluate("values => v3dcad.state.set(values)", values)
        cells.append(frame(tab, chromium))
    if edges > SEGMENTS:
        for kind in ("strips", "walls"):
            tab.evaluate(EXACTLY, [kind, SEGMENTS])
            print(f"{SEGMENTS:,} {kind}: {frame(tab, chromium)}", end="; ")
            tab.evaluate(MOVE)
            print(f"in motion: {frame(tab, chromium)}")
            tab.evaluate("() => v3dcad.stage.rest()")
            tab.wait_for_timeout(1000)
    tab.close()
    size = f"{file.stat().st_size / 1e6:.1f} MB"
    return [name, f"{edges:,}", f"{steps:,}", size, f"{opened:.1f} s", *cells]


def frame(tab: Page, chromium: Browser) -> str:
    """The processor time of a frame, and its draw calls."""
    tab.evaluate(DRAW, 1)
    before = processor_time(chromium)
    calls = tab.evaluate(DRAW, FRAMES)
    taken = (processor_time(chromium) - before) / FRAMES
    return f"{1000 * taken:.0f} ms, {calls}"


def main() -> None:
    """Print the table."""
    names = [name for name in PARTS if not sys.argv[1:] or name in sys.argv[1:]]
    print("| part | edges | steps of toolpath | page | opens in | " + " | ".join(VIEWS) + " |")
    print("|---|" + "---|" * (4 + len(VIEWS)))
    drawing = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        for name in names:
            # Each has a browser of its own, from which no process goes while it is measured.
            chromium = playwright.chromium.launch(
                executable_path=shutil.which("chromium"), args=drawing
            )
            row = measure(name, Path(folder) / "page.html", chromium)
            print(f"| {' | '.join(row)} |", flush=True)
            chromium.close()


if __name__ == "__main__":
    main()
