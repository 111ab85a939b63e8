"""A page as a test sees it: what it draws, what its state is, what it complains of."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

READY = "#app[data-ready]"
DIFFERENT = 24
"""By how much one of a pixel's colours differs in two pictures that do not look alike."""


class Shown:
    """A page in a tab of its own, cut off from every network."""

    def __init__(self, browser: Any, address: str | Path, **options: Any) -> None:
        options = {"viewport": {"width": 900, "height": 620}, "offline": True} | options
        self.context = browser.new_context(**options)
        self.tab = self.context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.tab.on("console", self._heard)
        self.tab.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.tab.on("request", lambda request: self.requests.append(request.url))
        self.tab.goto(address.as_uri() if isinstance(address, Path) else address)
        self.tab.wait_for_selector(READY, timeout=60_000)
        self.settle()

    def _heard(self, message: Any) -> None:
        if message.type in ("error", "warning") and "GPU stall" not in message.text:
            self.complaints.append(message.text)

    def run(self, script: str, argument: Any = None) -> Any:
        """What a function in JavaScript gives."""
        return self.tab.evaluate(script, argument)

    def set(self, **values: Any) -> None:
        """Change the state as a control does."""
        self.run("values => v3dcad.state.set(values)", values)
        self.settle()

    def state(self, name: str) -> Any:
        """A value of the state."""
        return self.run("name => v3dcad.state.values[name]", name)

    def settle(self) -> None:
        """Wait until what was asked for is drawn."""
        self.run("() => new Promise(done => requestAnimationFrame(() => setTimeout(done, 50)))")

    def picture(self) -> NDArray[np.int16]:
        """The canvas as rows of pixels, red, green and blue."""
        image = Image.open(io.BytesIO(self.tab.locator("#canvas").screenshot()))
        return np.asarray(image.convert("RGB"), np.int16)

    def calls(self) -> int:
        """How many draw calls a frame takes."""
        return int(self.run("() => (v3dcad.stage.draw(), v3dcad.stage.renderer.info.render.calls)"))

    def on_screen(self, point: tuple[float, float, float]) -> tuple[float, float]:
        """Where on the tab a point in space is drawn."""
        x, y, left, top, width, height = self.run(
            """point => {
                const { camera, box } = v3dcad.stage;
                const at = box.min.clone().set(...point).project(camera);
                const { left, top, width, height } = document
                    .getElementById("canvas").getBoundingClientRect();
                return [at.x, at.y, left, top, width, height];
            }""",
            list(point),
        )
        return left + (x + 1) / 2 * width, top + (1 - y) / 2 * height

    def close(self) -> None:
        """Close the tab; it must have had nothing to complain of."""
        self.context.close()
        assert self.complaints == []


def changed(one: NDArray[np.int16], other: NDArray[np.int16]) -> float:
    """The share of pixels that look different; controls may have taken rows at the bottom."""
    rows = min(len(one), len(other))
    one, other = one[:rows], other[:rows]
    return float((np.abs(one - other).max(axis=2) > DIFFERENT).mean())
