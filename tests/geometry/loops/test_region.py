"""Cells cut by an area, against shapely."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from v3dcad.geometry.loops.power_cells import PowerCells
from v3dcad.geometry.loops.region import Region
from v3dcad.model import Floats
from v3dcad.toolpath.perimeters import rings


def star(points: int, seed: int, x: float = 0.0, y: float = 0.0, size: float = 1.0) -> Floats:
    """A ring with many bays."""
    random = np.random.default_rng(seed)
    angle = np.arange(points) / points * 2 * math.pi
    radius = size * random.uniform(0.4, 1.0, points)
    return np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle)])


def area_of(seed: int) -> shapely.Geometry:
    body = shapely.Polygon(star(40, seed, size=9))
    island = shapely.Polygon(star(7, seed + 2, 8.5, 8.5, 1.4))
    holes = [shapely.Polygon(star(9, seed + 3, 2 * k - 2, 0.4 * k, 0.7)) for k in range(3)]
    return shapely.union_all([body, island]).difference(shapely.union_all(holes))


def pieces(area: shapely.Geometry, corners: Floats, first: Floats) -> list[shapely.Geometry]:
    """What each cell has of the area, as its loops say."""
    loops = Region(area, rings(area)).cut(corners, first, 0.0, 1e-9)
    found = [shapely.Polygon() for _ in first[:-1]]
    for k, cell in enumerate(loops.owner.tolist()):
        found[cell] = found[cell] ^ shapely.Polygon(loops.ring(k))
    return found


def check(area: shapely.Geometry, corners: Floats, first: Floats) -> None:
    for cell, found in enumerate(pieces(area, corners, first)):
        wanted = shapely.Polygon(corners[first[cell] : first[cell + 1]]) & area
        assert found.symmetric_difference(wanted).area < 1e-8


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.integers(1, 60), st.floats(0, 0.5))
def test_a_cell_has_of_an_area_what_shapely_says(seed: int, count: int, distance: float) -> None:
    sites = np.random.default_rng(seed).uniform(-10, 10, (count, 2))
    low, high = np.array([-12.0, -12]), np.array([12.0, 12])
    check(area_of(seed), *PowerCells(sites, np.zeros(count), low, high).drawn_in(distance))


@pytest.mark.parametrize("shift", [0.0, 1e-13, -1e-13, 1e-9, 1e-6])
def test_sides_that_lie_on_contours(shift: float) -> None:
    """Contours along the cells' sides and through their corners."""
    axis = np.arange(-4.0, 5)
    sites = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    cells = PowerCells(sites, np.zeros(len(sites)), np.array([-9.0, -9]), np.array([9.0, 9]))
    area = shapely.box(-2.5 + shift, -2.5, 2.5, 1.5 + shift)
    area = area.difference(shapely.Polygon([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5 + shift)]))
    plate, cell = shapely.box(-3.2, -3.2, 3.2, 3.2), shapely.box(-0.5, -0.5, 0.5, 0.5 + shift)
    inside = shapely.Polygon([(-0.5, 0), (0, -0.5 + shift), (0.5, 0), (0, 0.5)])
    corners, first = cells.drawn_in(0.0)
    for each in (area, cell, plate - cell, inside, plate - inside):
        found = areas_of(each, corners, first)
        wanted = [(shapely.Polygon(corners[a:b]) & each).area for a, b in pairwise(first)]
        assert found == pytest.approx(wanted, abs=1e-4)


def areas_of(area: shapely.Geometry, corners: Floats, first: Floats) -> Floats:
    """What each cell has of the area, mm², by its loops: less where they run clockwise."""
    loops = Region(area, rings(area)).cut(corners, first, 0.0, 1e-9)
    found = np.zeros(len(first) - 1)
    for k, cell in enumerate(loops.owner.tolist()):
        x, y = loops.ring(k).T
        found[cell] += (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2
    return found


def test_loops_too_short_or_too_narrow_are_left_out() -> None:
    area = shapely.box(0, 0, 1, 1)
    cells = np.array(
        [[0.9, 0.9], [2, 0.9], [2, 2], [0.9, 2], [-1, -1], [2, -1], [2, 0.01], [-1, 0.01]]
    )
    first = np.array([0, 4, 8])
    for length, least, kept in (
        (0.0, 0.0, [0, 1]),
        (0.5, 0.0, [1]),
        (0.0, 0.0101, []),
        (9.0, 0.0, []),
    ):
        assert Region(area, rings(area)).cut(cells, first, length, least).owner.tolist() == kept


def test_an_empty_area_or_no_cells_have_no_loops() -> None:
    empty = shapely.Polygon()
    square, first = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]), np.array([0, 4])
    assert not len(Region(empty, []).cut(square, first, 0.0, 0.0).owner)
    area = shapely.box(0, 0, 1, 1)
    assert not len(Region(area, rings(area)).cut(square[:0], first[:1], 0.0, 0.0).owner)
