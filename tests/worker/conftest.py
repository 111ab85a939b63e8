"""A worker that has said hello, for all tests of a file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from OCP.BRepTools import BRepTools
from worker.worker_process import Worker

from v3dcad.parts import part_from


@pytest.fixture(scope="module")
def worker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Worker]:
    running = Worker(tmp_path_factory.mktemp("worker ü"))
    running.get("hello")
    yield running
    running.close()


@pytest.fixture(scope="session")
def cone(samples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The cone as text BREP, as FreeCAD writes it."""
    file = tmp_path_factory.mktemp("parts") / "cone.brep"
    BRepTools.Write_s(part_from(samples / "cone.step").shape, str(file))  # type: ignore[attr-defined]
    return file
