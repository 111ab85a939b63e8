"""Walks through a diagram: where they end, and who has a point on a wall."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from v3dcad.geometry.clipping.ring_walk import INTO, cell_at, walk_segment
from v3dcad.geometry.compiled.arrays import FloatArray, Int32Rows
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.geometry.power_diagram.grid import STEPS
from v3dcad.geometry.power_diagram.predicates import NUMBER, WEIGHT
from v3dcad.geometry.power_diagram.regular_triangulation import triangulation
from v3dcad.geometry.power_diagram.triangle_mesh import ABSENT, SENTINELS, Triangulation


@compiled({**ENTRY, "cache": False})
def found(mesh: Triangulation, cell: int, x: float, y: float) -> int:
    """`cell_at`, which only compiled code calls."""
    return cell_at(mesh, cell, x, y)


@compiled({**ENTRY, "cache": False})
def walked(
    mesh: Triangulation,
    crossings: Int32Rows,
    at: FloatArray,
    cell: int,
    ax: float,
    ay: float,
    bx: float,
    by: float,
) -> int:
    """`walk_segment`, with room from the first crossing on."""
    return walk_segment(mesh, crossings, at, 0, cell, ax, ay, bx, by, 0)


UNIT = STEPS // 8
GRID = np.stack(np.meshgrid(*[np.arange(1, 8)] * 2), axis=-1).reshape(-1, 2) * UNIT


def nearest(mesh: Triangulation, x: float, y: float) -> int:
    """The cell of a place whose powers are whole: of equal ones that of the lowest number."""
    points = mesh.points[SENTINELS:]
    powers = (points[:, 0] - x) ** 2 + (points[:, 1] - y) ** 2 - points[:, WEIGHT]
    return SENTINELS + int(np.lexsort([points[:, NUMBER], powers])[0])


@given(st.integers(0, 10**6), st.integers(2, 49))
def test_a_place_belongs_to_the_nearest_site_or_to_the_first_of_several(
    seed: int, count: int
) -> None:
    """Wherever the search begins, and wherever a walk comes from: on half a grid's step most
    places lie on a wall or in a corner of cells.
    """
    random = np.random.default_rng(seed)
    sites = random.permutation(GRID)[:count]
    mesh = triangulation(sites, np.zeros(count, np.int64), random.permutation(count))
    shown = np.flatnonzero(mesh.triangle_of != ABSENT)
    shown = shown[shown >= SENTINELS]
    assert len(shown) == count
    crossings, at = np.empty((200, 4), np.int32), np.empty(200)
    for _ in range(10):
        a, b = random.integers(0, 17, (2, 2)) * (UNIT / 2)
        begin, end = nearest(mesh, *a), nearest(mesh, *b)
        for start in random.permutation(shown)[:3]:
            assert found(mesh, int(start), *b) == end
        passed = walked(mesh, crossings, at, begin, *a, *b)
        assert (crossings[passed - 1, INTO] if passed else begin) == end
        assert (np.diff(at[:passed]) >= 0).all()


@pytest.mark.parametrize("numbers", [(0, 1), (1, 0), (7, 3)])
def test_a_walk_that_ends_on_a_wall_ends_in_the_first_cell(numbers: tuple[int, int]) -> None:
    sites = np.array([[2, 4], [6, 4]]) * UNIT
    mesh = triangulation(sites, np.zeros(2, np.int64), np.array(numbers))
    first = SENTINELS + int(np.argmin(numbers))
    crossings, at = np.empty((9, 4), np.int32), np.empty(9)
    wall, height = 4.0 * UNIT, 4.0 * UNIT
    for cell, x in ((SENTINELS, 3.0), (SENTINELS + 1, 5.0)):
        passed = walked(mesh, crossings, at, cell, x * UNIT, height, wall, height)
        assert passed == (cell != first)
        if passed:
            assert crossings[0, INTO] == first
            assert at[0] == 1.0
