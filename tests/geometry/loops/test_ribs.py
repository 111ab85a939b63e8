"""Laws of ribs, checked by shapely: what they take of cells, how far they go, what they leave."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely
from diagrams import area_of, disc, layer, scattered, square

from v3dcad.geometry.loops.loops import Loops
from v3dcad.geometry.loops.ribs import Gaps, Needs, Ribbed, with_ribs
from v3dcad.geometry.loops.strips import Strips
from v3dcad.model import Floats, Section
from v3dcad.toolpath.cell_loops import cell_loops

W = 0.45
STRIPS = Strips(pitch=3.0, half=W / 2)
NOTHING = Gaps(np.empty(0, np.int64), np.empty((0, 2)))
NO_NEEDS = Needs(np.empty(0, np.int64), np.empty((0, 2)), np.empty(0))
THIN = Section(0.0, (np.array([[-10.0, -2], [10, -2], [10, 2], [1, 2], [1, 9], [-10, 9]]),))
SECTIONS = [square(10), square(10, hole=3), disc(11), THIN]


def loops(section: Section, seed: int, cells: int = 9) -> Loops:
    made = layer(scattered(cells, 10, seed), section)
    return cell_loops(made, area_of(section).buffer(-W, join_style="mitre"), W)


def needed(above: float = 0.0, low: float = -20.0, high: float = 20.0) -> Needs:
    lines = np.arange(-5, 6)
    return Needs(lines, np.tile([low, high], (11, 1)), np.full(11, above))


def grown(made: Loops, needs: Needs, below: Gaps | None = NOTHING, **options: Any) -> Ribbed:
    return with_ribs(made, STRIPS, needs, below, **{"step": 0.2, "slope": 1.0, **options})


def area(made: Loops) -> shapely.Geometry:
    """What loops enclose: those around holes run clockwise."""
    rings = [shapely.Polygon(made.ring(k)) for k in range(len(made.owner))]
    holes = [ring for ring in rings if not ring.exterior.is_ccw]
    return shapely.union_all([r for r in rings if r.exterior.is_ccw]) - shapely.union_all(holes)


def on_line(made: Loops, line: int, shift: float = 0.0) -> list[tuple[float, float]]:
    """What of a line is open, by shapely."""
    y = line * STRIPS.pitch + shift
    cut = shapely.intersection(area(made), shapely.LineString([(-20, y), (20, y)]))
    pieces = [shapely.get_coordinates(part)[:, 0] for part in shapely.get_parts(cut)]
    return sorted((float(x.min()), float(x.max())) for x in pieces if len(x) > 1)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("section", SECTIONS)
def test_loops_go_round_ribs(section: Section, seed: int) -> None:
    """They lose the ribs as they are wide, cells' walls beside them, and nothing else."""
    made = loops(section, seed)
    found = grown(made, needed())
    assert len(found.ribs) > 4
    assert np.array_equal(found.loops.owner, made.owner)
    for k in range(len(made.owner)):
        ring = shapely.LinearRing(found.loops.ring(k))
        assert ring.is_simple
        assert ring.is_ccw == shapely.LinearRing(made.ring(k)).is_ccw
    root, tip = found.ribs[:, 0], found.ribs[:, 1].copy()
    tip[:, 0] -= np.copysign(STRIPS.half, tip[:, 0] - root[:, 0])
    back = np.where(tip > root, root - 9, root + 9)[:, 0]  # past the wall that it grows from
    half = STRIPS.half
    low, high = np.minimum(back, tip[:, 0]), np.maximum(back, tip[:, 0])
    strips = shapely.union_all(shapely.box(low, tip[:, 1] - half, high, tip[:, 1] + half))
    lost = area(made) - area(found.loops)
    assert (lost - strips).area < 1e-9
    # What is left in the strips is corners of the cells behind the walls.
    left = shapely.intersection(area(found.loops), strips)
    bodies = shapely.box(
        np.minimum(root, tip)[:, 0], tip[:, 1] - half, np.maximum(root, tip)[:, 0], tip[:, 1] + half
    )
    assert shapely.intersection(left, shapely.union_all(bodies)).area < 1e-9


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("section", SECTIONS)
def test_gaps_are_what_is_open_on_lines(section: Section, seed: int) -> None:
    """Ribs and all: a little less, since all of the strip that a rib takes is looked at."""
    found = grown(loops(section, seed), needed())
    assert len(found.gaps.line) > 6
    for line, (begin, end) in zip(found.gaps.line.tolist(), found.gaps.ends, strict=True):
        for shift in (-0.99 * STRIPS.half, 0.0, 0.99 * STRIPS.half):
            pieces = on_line(found.loops, line, shift)
            touched = [(a, b) for a, b in pieces if a <= begin + 1e-9 and b >= end - 1e-9]
            assert len(touched) == 1 or end - begin < 2 * W


@pytest.mark.parametrize("seed", range(6))
def test_on_what_is_solid_ribs_from_both_sides_meet(seed: int) -> None:
    """However narrow a cell is: its walls may move apart above."""
    made = loops(square(10), seed)
    found = grown(made, needed())
    assert np.diff(found.gaps.ends).max() <= 3 * W, "shorter gaps have no room for two tips"


def test_ribs_grow_no_further_than_a_step_into_what_is_open_below() -> None:
    made = loops(square(10), 3)
    gaps: Gaps | None = None
    lengths = []
    for _ in range(30):
        found = grown(made, needed(), gaps)
        if gaps is not None:
            assert np.array_equal(gaps.line, found.gaps.line)
            moved = np.abs(found.gaps.ends - gaps.ends)
            first = np.isclose(moved, STRIPS.half)  # a rib is at least half as long as it is wide
            assert np.all((moved < 0.2 + 1e-12) | first)
        gaps = found.gaps
        lengths.append(float(np.hypot(*np.diff(found.ribs, axis=1)[:, 0].T).sum()))
    assert np.all(np.diff(lengths) >= -1e-9)
    solid = grown(made, needed()).ribs
    assert lengths[-1] == pytest.approx(np.hypot(*np.diff(solid, axis=1)[:, 0].T).sum())
    assert lengths[0] < 0.3 * lengths[-1]


@pytest.mark.parametrize("above", [0.3, 1.1, 2.6])
def test_the_lower_the_shorter(above: float) -> None:
    """So far under what they hold, tips are `slope` times as much short of where they are to be."""
    made = loops(square(10), 5)
    full, low = grown(made, needed()), grown(made, needed(above), slope=0.8)
    there = {tuple(np.round(root, 6)): tip for root, tip in full.ribs}
    short = [np.abs(there[tuple(np.round(root, 6))] - tip)[0] for root, tip in low.ribs]
    # Where what is needed ends before the middle, the tip is full as well: never less than that.
    assert len(short) > 4
    assert max(short) <= 0.8 * above + 1e-9
    assert np.median(short) == pytest.approx(0.8 * above, abs=STRIPS.half)


def test_ribs_go_as_far_as_needed() -> None:
    """What is needed begins at x = 2: nothing grows from walls that are not on its way."""
    made = loops(square(10), 2, 4)
    found = grown(made, needed(low=2.0))
    assert len(found.ribs)
    for line, ends in zip(found.ribs[:, 0, 1] / STRIPS.pitch, found.ribs[..., 0], strict=True):
        open_before = on_line(made, round(float(line)))
        begin, end = next(
            (a, b) for a, b in open_before if a - 0.5 < min(ends) and max(ends) < b + 0.5
        )
        assert end > 2.0, "a gap that lies before needs no rib"
        assert max(ends) >= 2.0 or (begin + end) / 2 < 2.0


@pytest.mark.parametrize("needs", [NO_NEEDS, needed(low=30.0, high=40.0)])
def test_what_nothing_needs_stays(needs: Needs) -> None:
    made = loops(square(10), 1)
    found = grown(made, needs)
    assert not len(found.ribs)
    assert np.array_equal(found.loops.points, made.points)
    assert np.array_equal(found.loops.first, made.first)


def test_a_rib_keeps_off_a_loop_in_its_way() -> None:
    """A hole just beside a line pokes into its strip: ribs end before it, none grows out of it."""

    def ring(*corners: tuple[float, float]) -> Floats:
        return np.array(corners)

    outer = ring((-8, -1.4), (8, -1.4), (8, 1.4), (-8, 1.4))
    hole = ring((-1, 0.1), (-1, 0.9), (1, 0.9), (1, 0.1))
    made = Loops.of([outer, hole], [0, 0])
    found = grown(made, needed())
    assert sorted(found.ribs[..., 0].ravel().tolist()) == [-8, -1, 1, 8]
    rings = [shapely.LinearRing(found.loops.ring(k)) for k in range(2)]
    assert rings[0].is_simple
    assert not rings[0].intersects(rings[1])
    away = Loops.of([outer, hole + np.array([0, 0.2])], [0, 0])
    assert len(grown(away, needed()).ribs) == 2


def test_a_rib_goes_on_where_it_met_another_that_is_gone() -> None:
    """What it met is under it: where a hole has come in that one's way, no step is to be made."""
    outer = np.array([[-8, -1.4], [8, -1.4], [8, 1.4], [-8, 1.4]])
    hole = np.array([[3, 0.1], [3, 0.9], [5, 0.9], [5, 0.1]])
    met = Gaps(np.array([0]), np.array([[-2, -2 + 2 * STRIPS.half]]))
    ends = grown(Loops.of([outer, hole], [0, 0]), needed(), met).gaps.ends
    assert ends == pytest.approx(np.array([[3 - STRIPS.half, 3], [5, 5 + STRIPS.half]]))
    wider = Gaps(met.line, met.ends + np.array([0, 0.1]))
    ends = grown(Loops.of([outer, hole], [0, 0]), needed(), wider).gaps.ends
    assert ends[0] == pytest.approx([-1.8, 3]), "a step into what is open"


@pytest.mark.parametrize("beside", [-1e-9, 0.0, 1e-9])
def test_a_loop_along_the_side_of_a_strip_is_none_in_its_way(beside: float) -> None:
    """As around a skin that ends on a line: ribs go on at both of its sides."""
    y = -STRIPS.half + beside
    notched = np.array([[-8, -4], [8, -4], [8, 4], [2, 4], [2, y], [-2, y], [-2, 4], [-8, 4.0]])
    found = grown(Loops.of([notched], [0]), needed())
    on_axis = np.abs(found.ribs[:, 0, 1]) < 1e-9
    assert sorted(found.ribs[on_axis, 0, 0].tolist()) == [-8, -2, 2, 8]
    assert shapely.LinearRing(found.loops.ring(0)).is_simple


def test_ribs_end_before_the_far_side_of_a_gap() -> None:
    """Also where that has moved past the middle of what was open below."""
    box = np.array([[-8, -1], [-5, -1], [-5, 1], [-8, 1.0]])
    below = Gaps(np.array([0]), np.array([[-8.0, 8.0]]))
    found = grown(Loops.of([box], [0]), needed(), below, step=3.9)
    assert found.gaps.ends[0, 0] <= -5 - STRIPS.half
    assert shapely.LinearRing(found.loops.ring(0)).is_simple


def test_a_loop_that_begins_in_a_strip_is_one_like_any_other() -> None:
    made = loops(square(10), 4)
    lengths = []
    for turned in range(5):
        rings = [np.roll(made.ring(k), turned, axis=0) for k in range(len(made.owner))]
        found = grown(Loops.of(rings, made.owner.tolist()), needed())
        lengths.append(float(area(found.loops).area))
    assert lengths == pytest.approx([lengths[0]] * 5)
