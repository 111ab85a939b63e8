"""Where the sample parts lie; a browser; how hypothesis runs; which tests are fast."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import hypothesis
import pytest

ROOT = Path(__file__).resolve().parent.parent
SAMPLES = ROOT / "samples"

# The same examples in every run, and no limit on the time of one: numba compiles in the first.
hypothesis.settings.register_profile(
    "v3dcad",
    derandomize=True,
    deadline=None,
    max_examples=40,
    suppress_health_check=[hypothesis.HealthCheck.too_slow],
)
hypothesis.settings.load_profile("v3dcad")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark as fast what nothing else keeps out of a quick run."""
    for item in items:
        if not any(map(item.get_closest_marker, ("slow", "long"))):
            item.add_marker("fast")


@pytest.fixture(scope="session")
def samples() -> Path:
    """The folder of sample parts."""
    return SAMPLES


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Chromium as the system has it, drawing in software."""
    command = shutil.which("chromium") or shutil.which("chromium-browser")
    if command is None:
        pytest.skip("needs chromium: apt-get install chromium")
    sync_api = pytest.importorskip("playwright.sync_api", reason="needs playwright: .[test]")
    with sync_api.sync_playwright() as playwright:
        drawing = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        found = playwright.chromium.launch(executable_path=command, args=drawing)
        yield found
        found.close()
