from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from v3dcad.geometry.loops.power_cells import PowerCells
from v3dcad.model import Floats

LOW, HIGH = np.array([-10.0, -10]), np.array([10.0, 10])


def cells_of(sites: Floats, weights: Floats, distance: float) -> list[shapely.Geometry]:
    points, first = PowerCells(sites, weights, LOW, HIGH).drawn_in(distance)
    rings = [points[a:b] for a, b in pairwise(first)]
    assert all(shapely.LinearRing(ring).is_ccw for ring in rings if len(ring))
    return [shapely.Polygon(ring) for ring in rings]


def by_half_planes(sites: Floats, weights: Floats, distance: float, one: int) -> shapely.Geometry:
    """A cell drawn in: what all half-planes have in common, those of distant sites, too."""
    cell = shapely.box(*LOW, *HIGH)
    for other in np.delete(np.arange(len(sites)), one):
        away = sites[other] - sites[one]
        apart = np.hypot(*away)
        across = away / apart
        reach = (apart**2 + weights[one] - weights[other]) / (2 * apart) - distance
        foot, along = sites[one] + reach * across, np.array([-across[1], across[0]])
        corners = [foot + 99 * along, foot - 99 * along]
        cell &= shapely.Polygon([*corners, corners[1] - 99 * across, corners[0] - 99 * across])
    return cell


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.floats(0, 2), st.floats(0, 6))
def test_a_cell_is_what_half_planes_have_in_common(
    seed: int, distance: float, heaviest: float
) -> None:
    random = np.random.default_rng(seed)
    sites, weights = random.uniform(-11, 11, (25, 2)), 1e4 + random.uniform(0, heaviest, 25)
    for one, found in enumerate(cells_of(sites, weights, distance)):
        wanted = by_half_planes(sites, weights, distance, one)
        assert found.is_empty or found.is_valid
        assert found.symmetric_difference(wanted).area < 1e-4


def test_cells_on_a_lattice_tile_the_box_and_hidden_sites_have_none() -> None:
    lattice = np.stack(np.meshgrid(*[np.arange(-9.0, 10, 2)] * 2), axis=-1).reshape(-1, 2)
    sites = np.vstack([lattice, [[0.1, 0.2]]])
    weights = np.append(np.zeros(len(lattice)), -50.0)
    *cells, hidden = cells_of(sites, weights, 0.0)
    assert hidden.is_empty
    assert [cell.area for cell in cells] == pytest.approx([4.0] * len(cells), rel=1e-5)
    assert [cell.area for cell in cells_of(lattice, weights[:-1], 0.4)][55] == pytest.approx(1.44)
    assert cells_of(sites[:1], weights[:1], 0.7)[0].area == pytest.approx(400)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.floats(0, 1), st.floats(0, 1))
def test_without_sites_that_are_absent_all_is_as_if_there_were_none(
    seed: int, distance: float, share: float
) -> None:
    random = np.random.default_rng(seed)
    sites, weights = random.uniform(-11, 11, (40, 2)), random.uniform(0, 4, 40)
    cells = PowerCells(sites, weights, LOW, HIGH)
    visible = np.diff(cells.drawn_in(0.0)[1]) > 0
    present = visible & (random.uniform(0, 1, 40) >= share)
    points, first = cells.drawn_in(distance, present)
    for one in range(40):
        found = shapely.Polygon(points[first[one] : first[one + 1]])
        if not present[one]:
            assert found.is_empty
            continue
        left = present | (np.arange(40) == one)
        wanted = by_half_planes(sites[left], weights[left], distance, int(left[:one].sum()))
        assert found.symmetric_difference(wanted).area < 1e-4
