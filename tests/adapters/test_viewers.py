"""What v3dcad gives, in the viewers of build123d and CadQuery, seen in pixels.

With V3DCAD_VIEWERS=FOLDER the pictures of docs/scripting.md are kept there.
"""

from __future__ import annotations

import io
import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hosts import cadquery_or_skip
from PIL import Image

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
ORANGE = np.array([232, 176, 36])
"""What both viewers paint solids with, in light and shade."""

BUILD123D = """
import sys
from build123d import Box, Cylinder
from ocp_vscode import set_port, show
from v3dcad.adapters.build123d import VoronoiFill
set_port(int(sys.argv[1]))
part = Box(40, 30, 12) - Cylinder(6, 12)
settings = dict(cell_size=10, layer_height=0.4)
walls = VoronoiFill(part, "faces", **settings)
frame = VoronoiFill(part, "struts", diameter=1.5, cut=True, **settings)
show(walls, frame, names=["walls", "struts"], alphas=[0.3, 1.0])
"""

CADQUERY = """
import sys
import cadquery as cq
import v3dcad.adapters.cadquery
from cadquery.vis import show
plate = cq.Workplane().box(60, 30, 10).edges("|Z").fillet(4)
light = plate.voronoiFill("solid", thickness=1, cell_size=10, layer_height=0.4)
show(light, screenshot=sys.argv[1], interact=False, width=900, height=600, roll=-35, elevation=-50)
"""


def run(command: list[str], *words: str) -> None:
    """Run a Python script, as a user would."""
    done = subprocess.run(
        [*command, *words], cwd=ROOT, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 0, done.stderr


def orange(png: bytes) -> float:
    """The share of a picture that is painted as solids are."""
    pixels = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), float)
    shade = pixels.max(axis=2, keepdims=True)
    hue = pixels / np.maximum(shade, 1)
    near = np.abs(hue - ORANGE / ORANGE.max()).max(axis=2) < 0.2
    return float((near & (shade[:, :, 0] > 60)).mean())


def kept(name: str, png: bytes) -> None:
    """Keep a picture for the documents, where that is asked for."""
    if folder := os.environ.get("V3DCAD_VIEWERS"):
        picture = Image.open(io.BytesIO(png)).convert("RGB").quantize(64)
        picture.save(Path(folder) / f"{name}.png", optimize=True)


@pytest.fixture
def viewer() -> Iterator[int]:
    """The port of a viewer of ocp_vscode without Visual Studio Code."""
    for package in ("ocp_vscode", "ocp_viewer"):
        if find_spec(package) is None:
            pytest.skip(f"needs {package}: .[test]")
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port = one.getsockname()[1]
    command = [sys.executable, "-m", "ocp_viewer", "--port", str(port)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and process.poll() is None:
            with socket.socket() as one:
                if one.connect_ex(("127.0.0.1", port)) == 0:
                    break
            time.sleep(0.2)
        yield port
        process.terminate()


def test_ocp_vscode_shows_walls_and_struts(viewer: int, browser: Any) -> None:
    tab = browser.new_page(viewport={"width": 900, "height": 600})
    with tab.expect_console_message(lambda said: "WebSocket connection" in said.text):
        tab.goto(f"http://127.0.0.1:{viewer}/viewer")
    assert orange(tab.screenshot()) < 0.002
    run([sys.executable, "-c", BUILD123D, str(viewer)])
    deadline = time.monotonic() + 60
    while (found := orange(png := tab.screenshot())) < 0.01 and time.monotonic() < deadline:
        time.sleep(0.5)
    assert found > 0.01
    assert {"walls", "struts"} <= set(tab.locator("body").inner_text().split())
    kept("ocp_vscode", png)
    tab.close()


def test_cadquery_vis_shows_a_fill(tmp_path: Path) -> None:
    cadquery_or_skip()
    screen = shutil.which("xvfb-run")
    if screen is None:
        pytest.skip("needs a screen that nobody sees: apt-get install xvfb")
    file = tmp_path / "vis.png"
    run([screen, "-a", sys.executable, "-c", CADQUERY, str(file)])
    assert orange(file.read_bytes()) > 0.05
    kept("cadquery_vis", file.read_bytes())
