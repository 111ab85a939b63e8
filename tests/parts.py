"""The test parts, and small tools to look at sections."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from v3dcad.model import Floats, Mesh

PARTS = Path(__file__).resolve().parents[2] / "shared" / "data" / "parts"


def part_file(name: str) -> Path:
    """The path of a test part; skips the test where the parts are not there."""
    path = PARTS / name
    if not path.exists():
        pytest.skip(f"{path} is not there")
    return path


def read_stl(name: str) -> Mesh:
    """A binary STL with exactly equal vertices welded and degenerate triangles dropped."""
    data = part_file(name).read_bytes()[80:]
    count = int(np.frombuffer(data[:4], "<u4")[0])
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.frombuffer(data[4:], record, count)["corners"].reshape(-1, 3)
    nodes, inverse = np.unique(corners.astype(np.float64), axis=0, return_inverse=True)
    triangles = inverse.reshape(-1, 3)
    distinct = np.all(triangles != np.roll(triangles, 1, axis=1), axis=1)
    return Mesh(nodes, triangles[distinct].astype(np.int64))


def ring_area(ring: Floats) -> float:
    """Signed area of an open ring (k, 2), mm²."""
    x, y = (ring - ring[0]).T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
