"""Parallel lines across areas and walls, against shapely's own intersections."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as some

from v3dcad.toolpath.scan_lines import ScanLines, gaps

ANGLES = some.floats(0, 180)


def drawn(lines: ScanLines) -> list[shapely.LineString]:
    """Each line in the plane."""
    ends = [lines.left, lines.left + lines.length]
    return [
        shapely.LineString([(x, lines.first + number * lines.step) @ lines.turn.T for x in ends])
        for number in range(lines.count)
    ]


def blobs(seed: int) -> shapely.Geometry:
    """Some discs, with holes."""
    random = np.random.default_rng(seed)
    discs = [shapely.Point(random.uniform(0, 20, 2)).buffer(random.uniform(1, 6)) for _ in range(6)]
    return shapely.union_all(discs[:4]).difference(shapely.union_all(discs[4:]).buffer(-0.5))


@given(some.integers(0, 1000), ANGLES)
@settings(max_examples=40, deadline=None)
def test_what_lies_in_an_area(seed: int, angle: float) -> None:
    area = blobs(seed)
    lines = ScanLines.across(area, angle, 0.5, 100)
    inside = lines.inside(area)
    expected = [line.intersection(area).length for line in drawn(lines)]
    of_line = np.floor(inside.mean(axis=1) / lines.length).astype(int)
    made = np.bincount(of_line, np.diff(inside)[:, 0], lines.count)
    np.testing.assert_allclose(made, expected, atol=1e-6)


@given(some.integers(0, 1000), ANGLES)
@settings(max_examples=40, deadline=None)
def test_what_is_free_of_solid_parts_and_walls(seed: int, angle: float) -> None:
    area, solid, reach = blobs(seed), blobs(seed + 1), 0.3
    random = np.random.default_rng(seed)
    # Walls so long that no line passes beside the end of one.
    turns = np.radians(angle + random.uniform(20, 160, 4))
    way = 100 * np.column_stack([np.cos(turns), np.sin(turns)])
    middles = random.uniform(0, 20, (4, 2))
    ends = np.stack([middles - way, middles + way], axis=1)
    lines = ScanLines.across(area, angle, 0.5, 100)
    lengths, _ = gaps(
        lines.inside(area), np.concatenate([lines.inside(solid), lines.over(ends, reach)])
    )
    walls = shapely.union_all(shapely.buffer(shapely.linestrings(ends), reach, quad_segs=1))
    held = shapely.union(solid, walls)
    free = [line.intersection(area).difference(held).length for line in drawn(lines)]
    assert lengths.sum() == pytest.approx(sum(free), abs=1e-6)


def test_a_gap_has_a_free_end_where_nothing_holds_it() -> None:
    inside = np.array([[0.0, 10.0], [20.0, 30.0]])
    held = np.array([[-1.0, 2.0], [5.0, 6.0], [19.0, 21.0], [28.0, 31.0], [29.0, 32.0]])
    lengths, loose = gaps(inside, held)
    np.testing.assert_allclose(lengths, [3, 4, 7])
    assert loose.tolist() == [False, True, False]


def test_no_more_lines_than_asked_for() -> None:
    lines = ScanLines.across(shapely.box(0, 0, 10, 30), 0, 0.4, 60)
    assert (lines.count, lines.step) == (60, pytest.approx(0.5))
    assert len(lines.inside(shapely.Polygon())) == 0
