"""Rings as long arrays, against shapely and by hand, and how they are walked."""

from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from v3dcad import Section
from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.structure.sweep.ring_arrays import HAIR, Rings, rings_of

SQUARE = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
HOLE = np.array([[1.0, 1], [1, 2], [2, 2]])


@given(st.lists(st.integers(0, 3), max_size=5), st.integers(0, 1000))
def test_areas_and_successors_are_those_of_each_layer_alone(counts: list[int], seed: int) -> None:
    generator = np.random.default_rng(seed)
    sections = [
        Section(
            float(z), tuple(generator.random((generator.integers(3, 9), 2)) for _ in range(count))
        )
        for z, count in enumerate(counts)
    ]
    found = rings_of(sections, Grid(np.zeros(2), 1.0))
    for layer, section in enumerate(sections):
        rings = range(found.layers[layer], found.layers[layer + 1])
        start = found.starts[rings.start]
        area = 0.0
        for ring, corners in zip(rings, section.rings, strict=True):
            rows = slice(found.starts[ring], found.starts[ring + 1])
            np.testing.assert_array_equal(found.corners[rows], corners)
            following = found.corners[start + found.after[rows]]
            np.testing.assert_array_equal(following, np.roll(corners, -1, axis=0))
            signed = shapely.Polygon(corners)
            area += signed.area if signed.exterior.is_ccw else -signed.area
        if all(shapely.Polygon(ring).is_valid for ring in section.rings):
            assert found.areas[layer] == pytest.approx(area, abs=1e-12)
        alone = rings_of([section], Grid(np.zeros(2), 1.0))
        assert alone.areas[0] == found.areas[layer]  # to the last bit


def test_rings_come_a_hair_to_the_left() -> None:
    grid = Grid(np.array([-1.0, -2.0]), 8.0)
    found = rings_of([Section(0.0, (SQUARE, HOLE))], grid)
    there = (found.corners - grid.origin) / grid.pitch
    left = found.stepped - there
    inside = shapely.Polygon(SQUARE, [HOLE])
    for corner, shift in zip(found.corners, left, strict=True):
        assert inside.contains(shapely.Point(corner + shift / HAIR / 100))
    for begin, end in zip(range(7), found.after, strict=True):
        along = there[end] - there[begin]
        across = np.array([-along[1], along[0]]) / np.hypot(*along)
        for point in (begin, end):
            expected = HAIR * (1 + other(found, begin, point))
            assert left[point] @ across == pytest.approx(expected, abs=HAIR / 20)  # rounding


def other(found: Rings, side: int, point: int) -> float:
    """How far the other side at a point moves it across this one, in hairs."""
    ways: dict[int, Any] = {}
    for begin, end in enumerate(found.after):
        along = found.corners[end] - found.corners[begin]
        ways[begin] = along / np.hypot(*along)
    (beside,) = [
        begin for begin, end in enumerate(found.after) if begin != side and point in (begin, end)
    ]
    return float(ways[side] @ ways[beside])
