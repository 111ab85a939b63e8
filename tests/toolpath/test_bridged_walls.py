"""Walls that hang are bridges: lines over gaps that are known, and printed foam place by place."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from diagrams import layer, scattered, square

from v3dcad.geometry.loops.reach import Stretches, far_from
from v3dcad.geometry.loops.segments import Segments
from v3dcad.model import BRIDGE, CELLS, EXTRUDE, INNER_PERIMETER, PERIMETER, Floats, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.bridged_walls import LEAST, Bridged, with_bridged_walls
from v3dcad.toolpath.overhang import hanging
from v3dcad.toolpath.report import LayerReport
from v3dcad.toolpath.stroke import Stroke, lines_of
from v3dcad.toolpath.trace import trace

W = 0.45
SHORTEST = 0.1


def stroke(points: Floats, *features: int) -> Stroke:
    steps = np.diff(points, axis=0)
    feature = np.resize(np.array(features, np.int8), len(steps))
    return Stroke(points, feature, np.hypot(*steps.T), np.full(steps.shape, np.nan))


def bridged(strokes: list[Stroke], below: Segments) -> Bridged:
    hang = far_from(lines_of(strokes, W).segments.ends, below, W / 2)
    return with_bridged_walls(strokes, hang, W, SHORTEST)


def hung(strokes: list[Stroke], hang: Stretches) -> list[float]:
    """Mm that hang of each step of some strokes."""
    length = np.concatenate([np.hypot(*np.diff(one.points, axis=0).T) for one in strokes])
    long = (hang.high - hang.low) * length[hang.segment]
    return np.bincount(hang.segment, long, len(length)).tolist()


def bars(*places: float) -> Segments:
    """Lines along y at some x."""
    ends = np.array([[[x, -5.0], [x, 5.0]] for x in places])
    return Segments.of(ends[:, 0], ends[:, 1], W)


@pytest.mark.parametrize("feature", [CELLS, INNER_PERIMETER, PERIMETER])
@pytest.mark.parametrize("gap", [0.9, 1.1, 4.0])
def test_a_line_from_bar_to_bar_is_a_bridge_where_the_gap_is_wide(gap: float, feature: int) -> None:
    line = stroke(np.array([[0.0, 0.3], [1.0 + (1 + gap) * W, 0.3]]), feature)
    line = line._replace(laid=line.laid * 0.8)
    over = bars(0.0, 0.5, 1.0, 1.0 + (1 + gap) * W)
    (found,), hang, length = bridged([line], over)
    assert found.laid.sum() == pytest.approx(line.laid.sum(), rel=1e-12)
    far = far_from(np.hstack([found.points[:-1], found.points[1:]]), over, W / 2)
    assert hung([found], hang) == pytest.approx(hung([found], far), abs=1e-9)
    spans = found.points[np.flatnonzero(found.feature == BRIDGE)[:, None] + [0, 1], 0]
    if gap < LEAST or feature == PERIMETER:
        assert found is line
        assert length == 0
        return
    assert spans == pytest.approx(np.array([[1 + W / 2, 1 + W / 2 + gap * W]]))
    assert length == pytest.approx(gap * W)
    assert found.laid[found.feature == BRIDGE].sum() == pytest.approx(0.8 * length)
    assert found.feature.tolist() == [feature, BRIDGE, feature]


def test_a_bridge_begins_at_a_corner_that_is_near() -> None:
    """So that no step is shorter than the corner is away."""
    corner = 1.0 + W / 2 + 0.5 * SHORTEST
    line = stroke(np.array([[1.0, 0], [corner, 0], [corner + 4, 0.0], [9.0, 0]]), CELLS)
    (found,), _, _ = bridged([line], bars(1.0, corner + 4 + 2 * SHORTEST))
    assert found.feature.tolist()[:2] == [CELLS, BRIDGE]
    assert np.hypot(*np.diff(found.points, axis=0).T).min() > 0.5 * SHORTEST


def test_steps_without_a_length_may_end_a_bridge() -> None:
    """As where the nozzle is asked to go where it is."""
    points = np.array([[0.0, 0], [3.0, 0], [3.0, 0], [6.0, 0], [6.0, 0]])
    line = stroke(points, CELLS)
    whole = Stretches(np.arange(4), np.zeros(4), np.ones(4))
    (found,), hang, length = with_bridged_walls([line], whole, W, SHORTEST)
    assert length == pytest.approx(6)
    assert (found.feature[:-1] == BRIDGE).all()
    assert hang.segment.max() < len(found.feature)
    assert sum(hung([found], hang)) == pytest.approx(6)


def test_where_all_rests_nothing_changes() -> None:
    line = stroke(np.array([[0.0, 0], [3.0, 0], [3.0, 2.0]]), CELLS)
    below = Segments.of(line.points[:-1], line.points[1:], W)
    (found,), hang, length = bridged([line], below)
    assert found is line
    assert not len(hang.segment)
    assert length == 0


def test_a_layer_without_strokes() -> None:
    found, hang, length = bridged([], bars(0.0))
    assert found == []
    assert not len(hang.segment)
    assert length == 0


def printed() -> tuple[list[Toolpath], list[LayerReport], PrintSettings]:
    """Ten layers of foam, each with a section that is smaller all around by 0.3 mm."""
    reports: list[LayerReport] = []
    options = PrintSettings(skirt_loops=0, brim_width=0.0, open=True, bridge_speed=13.0)
    sites = scattered(30, 12, 5)
    made = [layer(sites, square(12 - 0.3 * k, z=0.1 + 0.2 * k), k) for k in range(10)]
    return list(trace(made, options, reports.append)), reports, options


def test_no_wall_hangs_for_longer_than_a_bead_is_wide() -> None:
    """Looked at place by place, a hundredth of a mm apart."""
    paths, reports, options = printed()
    below = None
    for path, report in zip(paths, reports, strict=True):
        ends = np.stack([path.points[:-1], path.points[1:]], axis=1)[..., :2]
        extruded = path.kind[1:] == EXTRUDE
        if below is not None:
            chosen = extruded & (path.feature[1:] == CELLS)
            walls = shapely.line_merge(shapely.multilinestrings(ends[chosen]))
            for wall in shapely.get_parts(walls):
                places = shapely.line_interpolate_point(wall, np.arange(0, wall.length, 0.01))
                free = shapely.distance(places, below) > W / 2 + 1e-6
                turns = np.flatnonzero(np.diff(np.concatenate([[0], free, [0]])))
                assert (np.diff(turns)[::2] * 0.01 <= LEAST * W + SHORTEST).all()
        bridges = extruded & (path.feature[1:] == BRIDGE)
        assert (path.speed[1:][bridges] == options.bridge_speed).all()
        lengths = np.hypot(*np.diff(ends[bridges], axis=1)[:, 0].T)
        assert lengths.sum() == pytest.approx(report.bridged)
        below = shapely.multilinestrings(ends[extruded])
        shapely.prepare(below)
    assert sum(report.bridged for report in reports) > 50


def test_what_hangs_need_not_be_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """The certificate is the same where it is told nothing of what lies on the layer below."""
    told = [one for report in printed()[1] for one in report.hanging]
    monkeypatch.setattr(
        "v3dcad.toolpath.trace.hanging",
        lambda *arguments: hanging(*arguments[:-1]),
    )
    asked = [one for report in printed()[1] for one in report.hanging]
    assert len(told) > 10
    for one, again in zip(told, asked, strict=True):
        assert (one.what, one.over) == (again.what, again.over)
        numbers = [(hang.length, hang.area, hang.span, *hang.place) for hang in (one, again)]
        assert numbers[0] == pytest.approx(numbers[1], abs=1e-6)
