"""Stretches of segments far from others, against shapely's buffers."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from v3dcad.geometry.loops.reach import Stretches, far_from
from v3dcad.geometry.loops.segments import Segments
from v3dcad.model import Floats


def left(start: Floats, stop: Floats, found: Stretches) -> Floats:
    """(n,) mm of each segment that is far."""
    length = np.hypot(*(stop - start).T)
    return np.bincount(found.segment, (found.high - found.low) * length[found.segment], len(start))


def by_shapely(start: Floats, stop: Floats, others: tuple[Floats, Floats], reach: float) -> Floats:
    lines = shapely.linestrings(np.stack([start, stop], axis=1))
    near = shapely.linestrings(np.stack(others, axis=1))
    around = shapely.union_all(shapely.buffer(near, reach, quad_segs=64))
    return np.asarray(shapely.length(shapely.difference(lines, around)))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(("longest", "reach"), [(1.0, 0.2), (20.0, 0.2), (3.0, 2.0)])
def test_what_is_left_is_what_shapely_leaves(seed: int, longest: float, reach: float) -> None:
    random = np.random.default_rng(seed)
    start, low = random.uniform(-10, 10, (150, 2)), random.uniform(-8, 12, (60, 2))
    stop = start + random.uniform(-longest, longest, (150, 2))
    high = low + random.uniform(-3, 3, (60, 2))
    high[:5] = low[:5]
    stop[-5:] = start[-5:]
    found = far_from(np.hstack([start, stop]), Segments.of(low, high, 0.2), reach)
    assert left(start, stop, found) == pytest.approx(
        by_shapely(start, stop, (low, high), reach), abs=2e-3 * reach
    )


def test_stretches_lie_in_order_and_reach_from_end_to_end_where_nothing_is_near() -> None:
    start, stop = np.zeros((1, 2)), np.array([[100.0, 0]])
    for others in (np.empty((0, 2)), np.array([[0.0, 50]])):
        found = far_from(np.hstack([start, stop]), Segments.of(others, others, 0.25), 0.25)
        assert found.low[0] == 0
        assert found.high[-1] == 1
        assert found.low[1:] == pytest.approx(found.high[:-1])


def test_a_bead_across_a_gap_hangs_from_edge_to_edge_of_what_it_crosses() -> None:
    low = np.array([[0.0, -5], [10.0, -5]])
    found = far_from(
        np.array([[-1.0, 0, 11, 0]]),
        Segments.of(low, low + np.array([0, 10]), 0.5),
        0.5,
    )
    at = 12 * np.stack([found.low, found.high]) - 1
    inside = (at[0] > 0) & (at[1] < 10)
    assert at[0, inside][0] == pytest.approx(0.5)
    assert at[1, inside][-1] == pytest.approx(9.5)
    assert np.diff(at, axis=0).sum() == pytest.approx(9 + 2 * 0.5)


def test_nothing_hangs_over_itself() -> None:
    points = np.random.default_rng(3).uniform(0, 30, (200, 2))
    found = far_from(
        np.hstack([points[:-1], points[1:]]), Segments.of(points[:-1], points[1:], 1.0), 1e-3
    )
    assert not len(found.segment)
