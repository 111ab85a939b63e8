"""A section's area is what its rings enclose, by Green's theorem, even where they are faulty."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from v3dcad.geometry.section_area import section_area
from v3dcad.model import Floats, Section


def disc(radius: float, turn: float = 0.0, corners: int = 40) -> Floats:
    angles = np.linspace(0, 2 * np.pi, corners, endpoint=False) + turn
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def tongue(noise: float) -> Floats:
    """A half disc, with a tongue along the other half of its rim: an arc there and back."""
    rim = disc(10.0)
    half, away = rim[:21], rim[20:31]
    back = away[::-1] + noise * np.resize([[1, -1], [-1, 1], [1, 1]], away.shape)
    return np.vstack([half, away[1:], back[1:]])


@pytest.mark.parametrize("noise", [0.0, 1e-15, 1e-12, 1e-9])
def test_a_ring_that_runs_along_itself_keeps_its_area(noise: float) -> None:
    ring = tongue(noise)
    half = shapely.Polygon(disc(10.0)[:21]).area
    assert section_area(Section(0.0, (ring,))).area == pytest.approx(half, rel=1e-6)


def test_holes_and_islands_are_told_apart() -> None:
    outer, hole, island = disc(10.0), disc(6.0)[::-1], disc(2.0, 0.1)
    area = section_area(Section(0.0, (outer, hole, island)))
    expected = sum(shapely.Polygon(disc(r)).area * sign for r, sign in ((10, 1), (6, -1), (2, 1)))
    assert area.area == pytest.approx(expected)
