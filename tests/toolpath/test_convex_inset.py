from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely
from diagrams import layer, scattered, square
from hypothesis import given, settings
from hypothesis import strategies as st

from v3dcad.model import Floats
from v3dcad.toolpath.convex_inset import inset_cells


def insets(rings: list[Floats], distance: float) -> list[Floats]:
    first = np.cumsum([0, *map(len, rings)])
    points, begins = inset_cells(np.concatenate(rings), first, distance)
    return [points[a:b] for a, b in pairwise(begins)]


def moved_half_planes(ring: Floats, distance: float) -> shapely.Geometry:
    """Their intersection by shapely. Its buffers are no oracle: GEOS is up to 0.01 mm off."""
    after = np.roll(ring, -1, axis=0)
    along = (after - ring) / np.hypot(*(after - ring).T)[:, None]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    left, right = ring + distance * across - 99 * along, ring + distance * across + 99 * along
    corners = np.stack([left, right, right + 99 * across, left + 99 * across], axis=1)
    return shapely.intersection_all(shapely.polygons(corners))


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.floats(0.01, 4.0))
def test_an_inset_is_what_half_planes_have_in_common(seed: int, distance: float) -> None:
    cells = layer(scattered(25, 10, seed), square(10)).diagram.cells()
    rings = [rings[0] for rings in cells.values()]
    for ring, found in zip(rings, insets(rings, distance), strict=True):
        wanted = moved_half_planes(ring, distance)
        assert (len(found) == 0) == wanted.is_empty or wanted.area < 1e-6
        if len(found):
            made = shapely.Polygon(found)
            assert made.exterior.is_ccw
            assert made.symmetric_difference(wanted).area < 1e-6


def test_a_square_too_small_leaves_nothing_and_its_neighbours_stay() -> None:
    ring = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    small, large = insets([0.5 * ring, 4 * ring], 0.3)
    assert len(small) == 0
    assert shapely.Polygon(large).area == pytest.approx(3.4**2)
