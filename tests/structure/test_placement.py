from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from v3dcad.errors import SettingError
from v3dcad.model import Placement
from v3dcad.structure.placement import layer_heights, on_bed

numbers = st.floats(-1e4, 1e4, allow_subnormal=False)


@given(st.lists(st.tuples(numbers, numbers, numbers), min_size=2, max_size=9))
def test_placing_again_moves_nothing(points: list[tuple[float, float, float]]) -> None:
    cloud = np.array(points)
    bounds = np.stack([cloud.min(axis=0), cloud.max(axis=0)])
    placed = on_bed(bounds).to_bed(cloud)
    again = on_bed(np.stack([placed.min(axis=0), placed.max(axis=0)]))
    assert not again.translation.any()
    assert placed[:, 2].min() == pytest.approx(0, abs=1e-9)
    assert np.abs(placed[:, :2].min(axis=0) + placed[:, :2].max(axis=0)).max() < 1e-8


def test_to_source_undoes_to_bed() -> None:
    quarter = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    placement = Placement(quarter, np.array([1.0, 2, 3]))
    points = np.random.default_rng(0).normal(size=(7, 3))
    assert placement.to_bed(np.array([[1.0, 0, 0]])).tolist() == [[1, 3, 3]]
    assert placement.to_source(placement.to_bed(points)) == pytest.approx(points)


@pytest.mark.parametrize(
    ("top", "height", "count"),
    [
        (30, 0.2, 150),
        (30.05, 0.2, 151),
        (0.6, 0.2, 3),
        (1, 1, 1),
        (1.0 + 1e-8, 1, 1),
        (50, 0.3, 167),
    ],
)
def test_heights_start_at_the_base_and_stay_below_the_top(
    top: float, height: float, count: int
) -> None:
    heights = layer_heights(top, height)
    assert len(heights) == count
    assert heights[0] == 0
    assert heights[-1] < top
    assert np.array_equal(heights, np.arange(count) * height)


def test_a_layer_higher_than_the_part_is_refused() -> None:
    with pytest.raises(SettingError, match=r"only 3 mm high"):
        layer_heights(3.0, 3.5)


@pytest.mark.parametrize(("top", "height", "count"), [(30, 0.2, 150), (30.05, 0.2, 150), (1, 1, 1)])
def test_sections_in_the_middle_of_layers_fill_the_part_but_for_half_a_layer(
    top: float, height: float, count: int
) -> None:
    heights = layer_heights(top, height, height / 2)
    assert len(heights) == count
    assert heights[0] == height / 2
    assert np.diff(heights) == pytest.approx(height)
    assert abs(top - count * height) <= height / 2
