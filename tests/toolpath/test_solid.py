from __future__ import annotations

import numpy as np
import pytest
import shapely

from v3dcad.toolpath.solid import hatch


@pytest.mark.parametrize("angle", [0.0, 45.0, -45.0])
def test_lines_cover_the_area_and_stay_inside(angle: float) -> None:
    area = shapely.Point(0, 0).buffer(10).difference(shapely.Point(2, 1).buffer(4))
    lines = shapely.multilinestrings([shapely.LineString(line) for line in hatch(area, 0.8, angle)])
    assert area.buffer(1e-6).covers(lines)
    assert area.difference(lines.buffer(0.8)).area < 0.01 * area.area


def test_steps_between_lines_are_short() -> None:
    # Along the slope each line ends 4 mm before the one below.
    lines = hatch(shapely.Polygon([(0, 0), (40, 0), (0, 8)]), 0.8, 0.0)
    steps = np.concatenate([np.diff(line, axis=0)[1::2] for line in lines])
    assert len(lines) > 3
    assert np.hypot(*steps.T).max() <= 3.2


def test_an_area_with_bays_takes_a_line_for_each() -> None:
    """A comb of three teeth around a hole: to and fro in each part, not once a row."""
    teeth = [shapely.box(x, 0, x + 6, 30) for x in (0, 12, 24)]
    comb = shapely.union_all([shapely.box(0, 0, 30, 10), *teeth])
    area = comb.difference(shapely.box(8, 3, 22, 7))
    assert len(hatch(area, 0.5, 0.0)) <= 3 + 2


def test_a_step_may_leave_the_area_as_far_as_the_room_goes() -> None:
    ring = shapely.Point(0, 0).buffer(10).difference(shapely.Point(0, 0).buffer(5))
    inner = ring.buffer(-0.2)
    assert len(hatch(inner, 0.4, 0.0, ring)) < len(hatch(inner, 0.4, 0.0))
    for line in hatch(inner, 0.4, 0.0, ring):
        assert ring.buffer(1e-5).covers(shapely.LineString(line))


def test_nothing_to_cover() -> None:
    assert hatch(shapely.Polygon(), 0.8, 45.0) == []
