"""Segments found by where they are, against all pairs."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from v3dcad.geometry.loops.reach import far_from
from v3dcad.geometry.loops.segments import Segments
from v3dcad.model import Floats


def scattered(seed: int, count: int, longest: float) -> tuple[Floats, Floats]:
    """Segments in a square, some level, some upright, some points."""
    random = np.random.default_rng(seed)
    start = random.uniform(-10, 10, (count, 2))
    steps = random.uniform(-longest, longest, (count, 2))
    steps[::7, 1] = 0
    steps[1::7, 0] = 0
    steps[2::7] = 0
    steps[3::7, 1] *= 1e-5
    return start, start + steps


@pytest.mark.parametrize("longest", [0.3, 3.0, 30.0])
@pytest.mark.parametrize("reach", [0.2, 1.0])
def test_a_segment_is_in_every_bin_that_it_comes_near(longest: float, reach: float) -> None:
    found = Segments.of(*scattered(1, 80, longest), reach)
    x, y, side, _ = found.frame
    lines = shapely.linestrings(found.ends.reshape(-1, 2, 2))
    for row in range(found.shape[1]):
        for column in range(found.shape[0]):
            bin_ = row * found.shape[0] + column
            items = found.items[found.first[bin_] : found.first[bin_ + 1]]
            left, low = x + column * side, y + row * side
            square = shapely.box(left, low, left + side, low + side)
            near = np.flatnonzero(shapely.distance(lines, square) < reach - 1e-9)
            assert np.isin(near, items).all()
            assert len(np.unique(items)) == len(items)


@pytest.mark.parametrize("longest", [0.3, 3.0, 30.0])
@pytest.mark.parametrize("asked", [0.05, 0.5, 4.0])
def test_none_that_is_near_is_missed(longest: float, asked: float) -> None:
    """Asked for what is nearer or farther than the bins were made for."""
    start, stop = scattered(2, 200, longest)
    others = scattered(3, 120, 3.0)
    found = far_from(np.hstack([start, stop]), Segments.of(*others, 0.5), asked)
    lines, near = (shapely.linestrings(np.stack(ends, axis=1)) for ends in ((start, stop), others))
    apart = shapely.distance(lines[:, None], near).min(axis=1)
    whole = np.bincount(found.segment, found.high - found.low, len(start)) > 1 - 1e-9
    assert np.array_equal(
        whole[abs(apart - asked) > 1e-6], (apart > asked)[abs(apart - asked) > 1e-6]
    )


def test_no_segments() -> None:
    none = np.empty((0, 2))
    found = Segments.of(none, none, 0.5)
    assert not len(found.items)
    start, stop = scattered(4, 5, 1.0)
    left = far_from(np.hstack([start, stop]), found, 0.5)
    assert (left.low == 0).all()
    assert (left.high == 1).all()
