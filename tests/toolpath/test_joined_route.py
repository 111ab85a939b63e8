"""Laws of the joined route, checked by shapely and by a raster that knows nothing of the code."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import shapely
from diagrams import area_of, disc, layer, scattered, square, stack
from hypothesis import given, settings
from hypothesis import strategies as st

from v3dcad.geometry.loops.corners import corners_cut
from v3dcad.geometry.loops.curves import LINK, Curves
from v3dcad.geometry.loops.joining import WIDE, joined
from v3dcad.geometry.loops.links import LASTS, Linked
from v3dcad.geometry.loops.loops import Loops
from v3dcad.geometry.loops.wall_ends import BEYOND
from v3dcad.model import (
    EXTRUDE,
    INNER_PERIMETER,
    PERIMETER,
    Floats,
    Ints,
    Layer,
    Section,
    Toolpath,
)
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.cell_loops import cell_loops
from v3dcad.toolpath.perimeters import rings
from v3dcad.toolpath.report import LayerReport
from v3dcad.toolpath.trace import trace

pytestmark = pytest.mark.slow

W = 0.45
lean = settings(max_examples=20, deadline=None, derandomize=True)

ISLANDS = Section(0.0, (square(6).rings[0] - [7, 0], square(5).rings[0] + [7, 0]))
THIN = Section(0.0, (np.array([[-10.0, -2], [10, -2], [10, 2], [1, 2], [1, 9], [-10, 9]]),))
SECTIONS = [square(10), square(10, hole=3), disc(11), ISLANDS, THIN]


def loops_of(made: Layer, perimeters: int = 1) -> tuple[Loops, shapely.Geometry]:
    """The cells' loops and joined perimeters of a layer, and the area that the cells share."""
    area = area_of(made.section)
    shared = area.buffer(-(perimeters + 0.5) * W, join_style="mitre")
    lines: list[Floats] = []
    owners: list[int] = []
    for depth in range(perimeters):
        against = (perimeters - depth) % 2 == 1
        for ring in rings(area.buffer(-(depth + 1) * W, join_style="mitre")):
            lines.append(ring[::-1] if against else ring)
            owners.append(-1 - depth)
    return cell_loops(made, shared, W).and_these(Loops.of(lines, owners)), shared


def rings_of(loops: Loops) -> list[Floats]:
    return [loops.ring(k) for k in range(len(loops.owner))]


def lines_of(curves: Curves) -> list[shapely.Geometry]:
    return [
        shapely.LinearRing(curves.points[a:b])
        for a, b in zip(curves.first[:-1], curves.first[1:], strict=True)
    ]


def check_apart(lines: list[shapely.Geometry]) -> None:
    """No curve crosses or touches itself or another."""
    assert all(line.is_simple for line in lines)
    one, other = shapely.STRtree(lines).query(lines, predicate="intersects")
    assert np.array_equal(one, other)


@lean
@given(st.integers(0, 10**6), st.sampled_from(SECTIONS), st.integers(8, 40), st.integers(1, 3))
def test_each_region_is_one_closed_curve(
    seed: int, section: Section, count: int, perimeters: int
) -> None:
    made = layer(scattered(count, 10, seed), section)
    loops, shared = loops_of(made, perimeters)
    lines = lines_of(joined(loops, W, Linked()))
    check_apart(lines)
    # A curve more for each loop that found no neighbour one bead away, as in narrow tips.
    lone = [line for line in lines if line.length < 8 * W]
    assert len(lines) - len(lone) == len(shapely.get_parts(shared))
    assert len(lone) <= 1


@lean
@given(st.integers(0, 10**6), st.sampled_from(SECTIONS[:3]))
def test_links_are_hardly_longer_than_what_they_replace(seed: int, section: Section) -> None:
    """Each is two steps across a gap of one bead, at most as slanting as its wall's end is."""
    loops, _ = loops_of(layer(scattered(20, 10, seed), section))
    curves = joined(loops, W, Linked())
    before = sum(shapely.LinearRing(ring).length for ring in rings_of(loops))
    after = sum(line.length for line in lines_of(curves))
    links = (curves.owner == LINK).sum() / 2
    most = 2 * np.hypot(1, BEYOND) - 2 * WIDE
    assert 0 < after - before < most * W * links


@lean
@given(st.integers(0, 10**6))
def test_loops_lie_half_a_bead_inside_their_cells_and_the_area(seed: int) -> None:
    made = layer(scattered(25, 10, seed), square(10, hole=3))
    area = area_of(made.section).buffer(-W, join_style="mitre")
    loops = cell_loops(made, area, W)
    cells = made.diagram.cells()
    for site in set(loops.owner.tolist()):
        cell = shapely.Polygon()
        for ring in cells[site]:
            cell = cell ^ shapely.Polygon(ring)
        wanted = cell.buffer(-W / 2, join_style="mitre") & area.buffer(-W / 2, join_style="mitre")
        found = shapely.union_all(
            [shapely.Polygon(loops.ring(k)) for k in np.nonzero(loops.owner == site)[0]]
        )
        # GEOS cuts sharp corners off, and draws in to 0.01 mm. Only what is too small for a loop
        # of its own is left out.
        assert found.difference(wanted.buffer(0.01)).area < 0.01
        assert wanted.difference(found).area < 0.05


def test_where_a_cell_opens_walls_move_no_faster_than_the_foams() -> None:
    """All that is new lies at most a bead beside what was there, also along a straight side."""
    below = shapely.GeometryCollection()
    counts = []
    for step in range(100):
        wall = 7.65 - 0.002 * step  # between a site inside and one outside, along the side at y = 8
        sites = np.array([[0.3, 0.0], [0.2, 2 * wall], [-5.0, -7], [5, -6]])
        rings = rings_of(cell_loops(layer(sites, square(8)), area_of(square(8)), W))
        dense = shapely.segmentize([shapely.LinearRing(ring) for ring in rings], 0.1)
        places = shapely.points(shapely.get_coordinates(dense))
        if step:
            assert shapely.distance(places, below).max() < 1.03 * W
        below = shapely.union_all(dense)
        counts.append(len(rings))
    assert (counts[0], counts[-1]) == (3, 4)


def link_places(curves: Curves) -> Floats:
    """(b, 2) middles of the steps from loop to loop."""
    after = np.roll(curves.points, -1, axis=0)
    for a, b in zip(curves.first[:-1], curves.first[1:], strict=True):
        after[b - 1] = curves.points[a]
    return ((curves.points + after) / 2)[curves.owner == LINK]


def test_links_stay_for_some_layers_and_then_wander() -> None:
    """Most lie above one below. None does so for longer: then they are more than W / 2 away."""
    loops, _ = loops_of(layer(scattered(60, 15, 2), square(15)))
    linked = Linked()
    places = [link_places(joined(loops, W, linked)) for _ in range(4 * LASTS)]
    for below, above in pairwise(places):
        assert (nearest(above, below) < 1e-9).mean() > 0.5
    for below, above in zip(places, places[LASTS:], strict=False):
        assert (nearest(above, below) < W / 2).mean() < 0.1


def nearest(places: Floats, others: Floats) -> Floats:
    """(n,) mm from each place to the nearest of some others."""
    return np.asarray(np.hypot(*(places[:, None] - others).transpose(2, 0, 1)).min(axis=1))


def test_rounded_links_stay_beside_those_that_are_not_and_turn_by_half() -> None:
    sharp = joined(loops_of(layer(scattered(40, 15, 4), square(15)))[0], W, Linked())
    curves = corners_cut(sharp, W, 0.1)
    (line,), (round_line,) = lines_of(sharp), lines_of(curves)
    check_apart([round_line])
    assert round_line.hausdorff_distance(line) < W / 3
    assert (turns(sharp.points)[links_and_next(sharp)] > 1.05).mean() > 0.4
    assert (turns(curves.points)[links_and_next(curves)] > 1.05).mean() < 0.15


def test_of_cells_corners_little_is_cut_off_and_nothing_of_perimeters() -> None:
    made = layer(scattered(16, 15, 4), square(15, hole=6))
    sharp = joined(loops_of(made)[0], W, Linked())
    curves = corners_cut(sharp, W, 0.1)
    places = shapely.points(curves.points)
    away = shapely.distance(shapely.points(sharp.points), shapely.MultiPoint(places))
    at_link = np.isin(np.arange(len(away)), links_and_next(sharp))
    gone = (away > 0) & ~at_link
    step = np.hypot(*(np.roll(sharp.points, -1, axis=0) - sharp.points).T)
    assert (sharp.owner[gone] >= 0).all()
    assert (away <= np.minimum(W / 4, np.minimum(step, np.roll(step, 1)) / 50) + 1e-9)[gone].all()
    # Cells turn left all around; where walls are long enough, their corners go.
    long = np.minimum(step, np.roll(step, 1)) > 50 * 0.1
    cells = (sharp.owner >= 0) & ~at_link & long & (turns(sharp.points) > np.radians(20))
    assert cells.sum() > 5
    assert gone[cells & (turns(sharp.points) < np.radians(120))].all()


def links_and_next(curves: Curves) -> Ints:
    """Points at which a link begins or ends."""
    link = np.nonzero(curves.owner == LINK)[0]
    return np.unique(np.concatenate([link, (link + 1) % len(curves.owner)]))


def turns(points: Floats) -> Floats:
    """(n,) radians at each point of a closed line (n, 2)."""
    steps = np.roll(points, -1, axis=0) - points
    angle = np.arctan2(steps[:, 1], steps[:, 0])
    turned = (angle - np.roll(angle, 1) + np.pi) % (2 * np.pi) - np.pi
    return np.asarray(np.abs(turned))


def test_links_lie_at_the_ends_of_walls() -> None:
    """There they take the place of corners: half of all links begin or end with no sharp turn."""
    sharp = joined(loops_of(layer(scattered(40, 15, 4), square(15)))[0], W, Linked())
    link = np.nonzero(sharp.owner == LINK)[0]
    turned = turns(sharp.points)
    least = np.minimum(turned[link], turned[(link + 1) % len(turned)])
    assert (least < np.radians(80)).sum() > 0.8 * len(link) / 2


def traced(made: list[Layer], **options: Any) -> tuple[list[Toolpath], list[LayerReport]]:
    reports: list[LayerReport] = []
    usual = {"perimeters": 2, "skirt_loops": 0, "brim_width": 0.0, "open": True}
    chosen = PrintSettings(**{**usual, **options})
    return list(trace(made, chosen, reports.append)), reports


def extruded(path: Toolpath) -> Floats:
    """(k, 2, 2) ends of what is extruded."""
    ends = np.stack([path.points[:-1], path.points[1:]], axis=1)[..., :2]
    return ends[path.kind[1:] == EXTRUDE]


def test_a_layer_is_one_stroke_without_a_stop() -> None:
    paths, reports = traced(stack(4, 30))
    for path, report in zip(paths, reports, strict=True):
        assert report.strokes == 1
        assert report.retractions == 0
        assert report.retraced == 0
        kinds = path.kind == EXTRUDE
        # Once it extrudes, it does not stop.
        assert kinds[np.argmax(kinds) :].all()


@pytest.mark.parametrize("arcs", [False, True])
def test_outer_perimeters_are_unbroken_and_their_seams_lie_above_each_other(arcs: bool) -> None:
    made = [layer(scattered(20, 10, 3), disc(10, 0.2 * k), k) for k in range(3)]
    paths, _ = traced(made, arcs=arcs)
    seams = []
    for path in paths:
        outer = np.nonzero((path.kind == EXTRUDE) & (path.feature == PERIMETER))[0]
        assert np.array_equal(np.diff(outer), np.ones(len(outer) - 1))
        assert np.array_equal(path.points[outer[0] - 1], path.points[outer[-1]])
        ring = shapely.LinearRing(path.points[outer, :2])
        assert ring.hausdorff_distance(
            area_of(made[0].section).buffer(-W / 2, join_style="mitre").exterior
        ) < (0.02 if arcs else 1e-9)
        assert np.isfinite(path.centre[outer, 0]).all() == arcs
        seams.append(path.points[outer[-1], :2])
    assert np.ptp(seams, axis=0) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("section", SECTIONS)
def test_no_more_plastic_than_room(section: Section) -> None:
    """Beads as a raster of 0.02 mm: what is laid, against the area that it can fill."""
    half = 0.2 * (np.pi / 4 - 1) / 2 + W / 2
    layers = [layer(scattered(16, 10, 5), Section(0.2 * k, section.rings), k) for k in range(2)]
    path = traced(layers)[0][1]
    cell = 0.02
    axis = np.arange(-14, 14, cell) + cell / 2
    filled = np.zeros((len(axis), len(axis)), dtype=bool)
    for (x0, y0), (x1, y1) in extruded(path):
        low = np.searchsorted(axis, np.minimum([x0, y0], [x1, y1]) - half)
        high = np.searchsorted(axis, np.maximum([x0, y0], [x1, y1]) + half)
        x, y = np.meshgrid(axis[low[0] : high[0]], axis[low[1] : high[1]], indexing="ij")
        dx, dy = x1 - x0, y1 - y0
        share = np.clip(((x - x0) * dx + (y - y0) * dy) / max(dx * dx + dy * dy, 1e-18), 0, 1)
        near = (x - x0 - share * dx) ** 2 + (y - y0 - share * dy) ** 2 <= half**2
        filled[low[0] : high[0], low[1] : high[1]] |= near
    room = filled.sum() * cell**2 * 0.2
    assert path.volume.sum() == pytest.approx(room, rel=0.02)


def test_hardly_a_segment_is_shorter_than_a_tenth() -> None:
    paths, _ = traced(stack(3, 100, 30), minimum_edge=0.1)
    steps = np.concatenate([extruded(path) for path in paths])
    assert (np.hypot(*(steps[:, 1] - steps[:, 0]).T) < 0.1).mean() < 0.005


def test_a_curve_is_entered_at_a_corner_where_one_is_near() -> None:
    """The nozzle steps into it anywhere; no shorter step is made there, nor where it closes."""
    made = [layer(scattered(20, 10, 3), replace(disc(10), z=0.2 * k), k) for k in range(20)]
    least = PrintSettings().minimum_edge
    for path in traced(made, seam="scattered")[0]:
        inner = path.feature == INNER_PERIMETER
        lengths = np.hypot(*np.diff(path.points[:, :2], axis=0).T)[inner[1:]]
        assert len(lengths) > 20
        assert lengths.min() > least - 1e-9


def test_what_is_too_thin_for_cells_has_its_perimeters() -> None:
    strip = Section(0.0, (np.array([[-10.0, -0.6], [10, -0.6], [10, 0.6], [-10, 0.6]]),))
    (path,), (report,) = traced([layer(scattered(9, 10, 3), strip)])
    assert report.strokes == 1
    assert len(extruded(path)) >= 4


def test_the_same_layers_give_the_same_toolpath() -> None:
    once, twice = (traced(stack(3, 30))[0] for _ in range(2))
    for one, other in zip(once, twice, strict=True):
        assert one.points.tobytes() == other.points.tobytes()
