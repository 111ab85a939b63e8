"""Foams whose cells differ in size: gradients, distances, walls, sizes, and what is kept."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import KDTree

from tests.geometry.voronoi import oracle
from v3dcad.errors import SettingError
from v3dcad.model import Floats
from v3dcad.settings import FillSettings
from v3dcad.structure.foam.darts import graded_disk
from v3dcad.structure.foam.graded import graded_sites, graded_stretch
from v3dcad.structure.foam.size_grid import SizeGrid

pytestmark = pytest.mark.slow

LOW, HIGH = np.zeros(3), np.array([12.0, 12, 16])


def test_darts_keep_their_distances() -> None:
    sizes = np.linspace(0.6, 1.8, 13)[:, None, None] * np.ones((13, 9, 9))
    grid = SizeGrid(np.full(3, -2.0), 1.0, sizes)
    inside = np.array([[1.0, 1, 1], [7, 4, 4]])
    places, radii = graded_disk(grid, inside, 1.0, 5)
    assert len(places) > 100
    assert radii == pytest.approx(0.6 + 0.1 * (places[:, 0] + 2))
    for i, j in KDTree(places).query_pairs(2.0):
        assert np.linalg.norm(places[i] - places[j]) >= (radii[i] + radii[j]) / 2
    outside = np.maximum(inside[0] - places, places - inside[1])
    assert (outside <= radii[:, None]).all()


def made(field: object, **chosen: object) -> object:
    return graded_sites(field, LOW, HIGH, FillSettings(**chosen))  # type: ignore[arg-type]


@given(st.integers(0, 1 << 20), st.floats(0.0, 6.28), st.sampled_from([1.41, 1.67, 2.5]))
@settings(max_examples=5)
def test_no_wall_leans_more_than_it_may(seed: int, turn: float, stretch: float) -> None:
    """By scipy's diagram of the sites, heights divided by the stretch."""

    def field(at: Floats) -> Floats:
        return 2.6 + 0.9 * np.sin(at @ np.array([np.cos(turn), np.sin(turn), 0.4]) * 0.25)

    graded = made(field, random_seed=seed, stretch=stretch)
    squeezed = np.array([1, 1, 1 / stretch])
    worst = oracle.steepest(graded.sites * squeezed, LOW * squeezed, HIGH * squeezed)
    assert np.sqrt(worst) <= stretch * (1 + 1e-9)


def test_the_same_bytes_twice_and_others_from_another_seed() -> None:
    def field(at: Floats) -> Floats:
        return 3 + 0.1 * at[:, 0]

    one, two, other = made(field), made(field), made(field, random_seed=1)
    assert one.sites.tobytes() == two.sites.tobytes()
    assert one.sites.tobytes() != other.sites.tobytes()


@pytest.mark.parametrize(
    ("chosen", "told"),
    [
        ({"stretch": "columns"}, "need a number, or auto"),
        ({"stretch": 1.2}, "at least 1.41"),
    ],
)
def test_a_stretch_that_does_not_do_is_refused(chosen: dict[str, object], told: str) -> None:
    with pytest.raises(SettingError, match=told):
        graded_stretch(FillSettings(**chosen))  # type: ignore[arg-type]


def test_the_usual_stretch() -> None:
    assert graded_stretch(FillSettings()) == 1.67
    assert graded_stretch(FillSettings(max_overhang=60)) == 1
    assert graded_stretch(FillSettings(max_overhang=90)) == 1


@pytest.mark.parametrize(
    ("size", "chosen", "told"),
    [
        (lambda at: np.where(at[:, 0] < 6, 1.0, 8.0), {"strict": True}, "too steeply"),
        (lambda at: np.full(len(at), 0.001), {}, "more than 10,000,000; sizes .* times"),
        (lambda at: np.full(len(at), 50.0), {}, "larger than the part"),
    ],
)
def test_a_field_that_cannot_be_met_is_refused(
    size: object, chosen: dict[str, object], told: str
) -> None:
    with pytest.raises(SettingError, match=told):
        made(size, **chosen)


def test_a_steep_field_is_made_finer_and_told() -> None:
    graded = made(lambda at: np.where(at[:, 0] < 6, 1.8, 6.0))
    assert graded.asked == pytest.approx((1.8, 6))
    assert graded.made[0] == pytest.approx(1.8)
    assert graded.made[1] < 1.8 + 0.3 * 6.5
    assert 0.4 < graded.finer < 0.6
