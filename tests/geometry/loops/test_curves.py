"""A closed curve that is opened at a place: the same line, from there and back to it."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from v3dcad.geometry.loops.curves import opened


@pytest.mark.parametrize("step", range(7))
@pytest.mark.parametrize("share", [0.0, 0.02, 0.4, 0.97, 1.0])
def test_an_opened_curve_is_the_same_line_with_the_same_owners(step: int, share: float) -> None:
    angles = np.arange(7) * 2 * np.pi / 7
    ring = np.column_stack([3 * np.cos(angles), np.sin(angles)])
    owner = np.arange(7) * 10
    following = np.roll(ring, -1, axis=0)
    place = ring[step] + share * (following[step] - ring[step])
    shortest = 0.1
    points, whose = np.empty((9, 2)), np.empty(8, np.int64)
    size = opened(ring, owner, step, share, shortest, points, whose)
    points, whose = points[: size + 1], whose[:size]

    assert (points[0] == points[-1]).all()
    line = shapely.LinearRing(ring)
    assert line.hausdorff_distance(shapely.LineString(points)) < 1e-12
    assert shapely.LinearRing(points).is_ccw
    nearest = np.hypot(*(ring - place).T).min()
    assert np.hypot(*(points[0] - place)) == pytest.approx(nearest if nearest < shortest else 0)
    assert np.hypot(*np.diff(points, axis=0).T).min() >= shortest
    middles = (points[1:] + points[:-1]) / 2
    for middle, found in zip(middles, whose, strict=True):
        steps = shapely.linestrings(np.stack([ring, following], axis=1))
        assert owner[np.argmin(shapely.distance(steps, shapely.Point(middle)))] == found
