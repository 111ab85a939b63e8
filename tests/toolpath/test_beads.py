from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import shapely
from diagrams import WIDE, area_of, disc, layer, scattered, square, stack

from v3dcad.errors import GeometryError
from v3dcad.model import (
    BRIDGE,
    BRIM,
    CELLS,
    EXTRUDE,
    PERIMETER,
    RETRACT,
    SKIRT,
    SOLID,
    TRAVEL,
    UNRETRACT,
    Floats,
    Layer,
    Section,
    Toolpath,
)
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.bead import bead_area
from v3dcad.toolpath.report import LayerReport, findings
from v3dcad.toolpath.stroke import way_back
from v3dcad.toolpath.trace import trace

THESIS = pytest.mark.parametrize("thesis", [False, True])
ORDERS = ["together", "before", "after"]


def steps(toolpath: Toolpath, *features: int) -> Floats:
    """(k, 2, 2) flat segments extruded for these features, or for any."""
    ends = np.stack([toolpath.points[:-1], toolpath.points[1:]], axis=1)[..., :2]
    chosen = toolpath.kind[1:] == EXTRUDE
    if features:
        chosen &= np.isin(toolpath.feature[1:], features)
    return ends[chosen]


def drawn(toolpath: Toolpath, *features: int) -> shapely.Geometry:
    return shapely.multilinestrings(shapely.linestrings(steps(toolpath, *features)))


def traced(
    made: Layer | list[Layer], *, thesis: bool = False, **settings: Any
) -> tuple[list[Toolpath], list[LayerReport]]:
    reports: list[LayerReport] = []
    layers = made if isinstance(made, list) else [made]
    chosen = PrintSettings(**{**WIDE, **settings})
    paths = list(trace(layers, chosen, reports.append, thesis=thesis))
    return paths, reports


def cell_edges(made: Layer) -> shapely.Geometry:
    inner = made.diagram.edges[made.diagram.inner()]
    return shapely.multilinestrings(shapely.linestrings(made.diagram.vertices[inner]))


@THESIS
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("contour", ["inset", "centre"])
def test_every_cell_edge_and_perimeter_is_extruded(thesis: bool, order: str, contour: str) -> None:
    made = layer(scattered(25, 10, 3), square(10, hole=2))
    (path,), (report,) = traced(
        made, thesis=thesis, perimeter_order=order, contour=contour, perimeters=2, minimum_edge=0.0
    )
    outermost = 0.4 if contour == "inset" else 0.0
    area = area_of(made.section)
    outer, inner = (
        area.buffer(-depth, join_style="mitre") for depth in (outermost, outermost + 0.8)
    )
    perimeters = shapely.union(outer.boundary, inner.boundary)
    cells = shapely.intersection(cell_edges(made), inner)
    assert drawn(path).length == pytest.approx(
        perimeters.length + cells.length + report.retraced, rel=1e-9
    )
    assert (report.retraced == 0) == thesis
    for feature, expected in ((PERIMETER, perimeters), (CELLS, cells)):
        found = drawn(path, feature)
        assert shapely.union_all(found).length == pytest.approx(expected.length, rel=1e-6)
        assert found.buffer(1e-6).covers(expected)
        assert expected.buffer(1e-6).covers(found)


@pytest.mark.parametrize("section", [square(10), square(10, hole=3), disc(10)])
@pytest.mark.parametrize("contour", ["inset", "centre"])
def test_nothing_is_extruded_outside(section: Section, contour: str) -> None:
    made = layer(scattered(25, 10, 4), section)
    (path,), _ = traced(made, contour=contour, perimeters=2)
    beads = drawn(path).buffer(0.4, cap_style="flat", join_style="mitre")
    area = area_of(section)
    assert (
        (area if contour == "inset" else area.buffer(0.4, join_style="mitre"))
        .buffer(1e-6)
        .covers(beads)
    )


def test_an_inset_print_has_the_size_of_the_part() -> None:
    (path,), _ = traced(layer(scattered(25, 10, 4), square(10)))
    beads = drawn(path, PERIMETER).buffer(0.4, join_style="mitre", cap_style="square")
    assert beads.bounds == pytest.approx((-10, -10, 10, 10))


def test_volume_is_length_times_area_times_flow() -> None:
    layers = stack(3)
    paths, reports = traced(layers, flow=90.0, first_layer_flow=120.0, first_layer_height=0.3)
    plain, _ = traced(layers)
    for number, path in enumerate(paths):
        height = 0.3 if number == 0 else 0.2
        flow = 1.2 if number == 0 else 0.9
        assert path.volume == pytest.approx(plain[number].volume * flow * height / 0.2, rel=1e-9)
        full = (drawn(path).length - reports[number].retraced) * 0.8 * height * flow
        # Less than the full bead only where walls meet.
        assert 0.9 * full < path.volume.sum() < full
        assert (path.volume[path.kind != EXTRUDE] == 0).all()
        assert path.points[2:, 2] == pytest.approx(0.3 + 0.2 * number)


def test_arcs_are_paid_by_their_length() -> None:
    made = layer(scattered(9, 6, 2), disc(10, points=48))
    (path,), _ = traced(made, arcs=True, perimeters=2)
    # Walls meet the inner perimeter.
    outer = np.abs(np.hypot(*path.points[:, :2].T) - 9.6) < 1e-6
    arc = np.isfinite(path.centre[:, 0]) & (path.kind == EXTRUDE) & outer
    assert path.volume[arc].sum() == pytest.approx(2 * np.pi * 9.6 * 0.8 * 0.2, rel=1e-4)


def test_the_first_layer_has_its_own_speed() -> None:
    paths, _ = traced(stack(2), first_layer_speed=7.0, print_speed=30.0, perimeter_speed=30.0)
    for path, speed in zip(paths, (7.0, 30.0), strict=True):
        assert (path.speed[path.kind == EXTRUDE] == speed).all()


@pytest.mark.parametrize(("width", "height"), [(0.8, 0.2), (0.4, 0.4), (0.3, 0.6)])
def test_bead_areas(width: float, height: float) -> None:
    low = min(width, height)
    line = shapely.LineString([(0, 0), (max(width, height) - low, 0)])
    rounded = line.buffer(low / 2, quad_segs=512).area
    assert bead_area(width, height, "rounded") == pytest.approx(rounded, rel=1e-5)
    assert bead_area(width, height, "rectangle") == width * height


@pytest.mark.parametrize(
    ("wall_beads", "thesis", "half"),
    [(2, False, 1.1), (2, False, 3.5), (2, False, 10.0), (1, False, 10.0), (1, True, 10.0)],
)
def test_the_volume_is_that_of_the_area_covered(wall_beads: int, thesis: bool, half: float) -> None:
    """Shapely lays the beads; where a part is thin, perimeters have little room."""
    made = layer(scattered(25, half, 3), square(half))
    (path,), _ = traced(made, thesis=thesis, wall_beads=wall_beads, perimeters=2, bead_width=0.4)
    covered = drawn(path).buffer(0.2).area * 0.2
    assert path.volume.sum() == pytest.approx(covered, rel=0.02)


def test_one_bead_is_one_wet_stroke() -> None:
    paths, reports = traced(stack(4, 30))
    for path, report in zip(paths, reports, strict=True):
        assert (report.strokes, report.retractions) == (1, 0)
        kinds = path.kind == EXTRUDE
        # Once it extrudes, it does not stop.
        assert kinds[np.argmax(kinds) :].all()
        assert 0.1 < report.retraced / report.extruded < 0.25


def test_what_is_passed_twice_is_laid_by_halves() -> None:
    """Both ways the same, and together what one pass of the thesis lays there."""
    made = layer(scattered(25, 10, 3), square(10))
    laid: list[dict[tuple[float, ...], list[float]]] = []
    for thesis in (False, True):
        (path,), _ = traced(made, thesis=thesis, minimum_edge=0.0)
        amounts: dict[tuple[float, ...], list[float]] = {}
        extruding = path.kind[1:] == EXTRUDE
        for ends, volume in zip(steps(path), path.volume[1:][extruding], strict=True):
            place = tuple(ends.mean(axis=0).round(6).tolist())
            amounts.setdefault(place, []).append(volume)
        laid.append(amounts)
    wet, once = laid
    assert wet.keys() == once.keys()
    assert {len(volumes) for volumes in wet.values()} == {1, 2}
    for place, volumes in wet.items():
        assert np.ptp(volumes) == pytest.approx(0, abs=1e-12)
        # How much room a bead has depends a little on which beads it goes on to.
        assert sum(volumes) == pytest.approx(sum(once[place]), rel=0.25, abs=0.02)


def test_the_thesis_retraces_nothing_and_travels() -> None:
    _, reports = traced(stack(2, 30), thesis=True, retraction=1.0, retraction_travel=0.0)
    for report in reports:
        assert report.retraced == 0
        # Every stroke but the print's first is reached by a travel with a retraction.
        assert report.retractions == report.strokes - (report.layer == 0)


def test_reported_lengths_are_those_of_the_toolpath() -> None:
    (path,), (report,) = traced(layer(scattered(25, 10, 3), square(10, hole=2)))
    assert report.extruded == pytest.approx(drawn(path).length)
    assert report.retraced == pytest.approx(
        drawn(path).length - shapely.union_all(drawn(path)).length, abs=0.01
    )


def test_layers_start_near_the_end_of_the_one_below() -> None:
    paths, _ = traced(stack(6, 30))
    for below, above in pairwise(paths):
        start = above.points[np.argmax(above.kind == EXTRUDE) - 1]
        assert np.hypot(*(start - below.points[-1])[:2]) < 0.5


def test_retraction_and_hop_surround_a_travel() -> None:
    made = layer(scattered(25, 10, 3), square(10))
    (path,), _ = traced(made, thesis=True, retraction=1.0, z_hop=0.5, retraction_travel=2.0)
    kinds = path.kind.tolist()
    pulled = np.nonzero(path.kind == RETRACT)[0]
    assert len(pulled) > 3
    for place in pulled.tolist():
        back = kinds.index(UNRETRACT, place)
        assert set(kinds[place + 1 : back]) == {TRAVEL}
        assert path.points[place + 1 : back - 1, 2] == pytest.approx(0.7)
        assert path.points[back, 2] == pytest.approx(0.2)
        flat = path.points[place:back, :2]
        assert np.hypot(*np.diff(flat, axis=0).T).sum() >= 2.0
    # The first stroke begins with what was pulled back before the layer.
    assert np.count_nonzero(path.kind == UNRETRACT) == len(pulled) + 1
    assert kinds[:3] == [TRAVEL, TRAVEL, UNRETRACT]


def test_a_wipe_goes_back_over_the_bead_before_the_hop() -> None:
    """And prints the same: the beads are those without a wipe."""
    made = stack(2, 25)
    settings = {"thesis": True, "retraction": 1.0, "z_hop": 0.5, "retraction_travel": 2.0}
    paths, plain = (traced(made, **settings, wipe=wipe)[0] for wipe in (1.5, 0.0))
    wiped, before = 0, np.full(3, np.nan)
    for path, other in zip(paths, plain, strict=True):
        extruding, others = (one.kind == EXTRUDE for one in (path, other))
        np.testing.assert_array_equal(path.points[extruding], other.points[others])
        beads = drawn(path).buffer(1e-6)
        points = np.vstack([before, path.points])
        for place in np.nonzero(path.kind == RETRACT)[0].tolist():
            low = points[place + 1, 2]
            rises = place + 1 + int(np.argmax(points[place + 1 :, 2] > low))
            way = points[place + 1 : rises, :2]
            assert np.hypot(*np.diff(way, axis=0).T).sum() == pytest.approx(1.5)
            if low == path.points[-1, 2]:
                assert beads.covers(shapely.linestrings(way))
                wiped += 1
        before = path.points[-1]
    assert wiped > 10


def test_the_way_back_over_a_stroke() -> None:
    stroke = np.array([[0.0, 0], [4, 0], [4, 1], [4, 1], [4, 3]])
    for length, expected in (
        (0.5, [[4, 2.5]]),
        (2.0, [[4, 1]]),
        (2.5, [[4, 1], [4, 1], [4, 0.5]]),
        (99.0, [[4, 1], [4, 1], [4, 0], [0, 0]]),
        (0.0, np.empty((0, 2))),
    ):
        np.testing.assert_allclose(way_back(stroke, length), expected)
    for nothing in (stroke[:0], stroke[:1], stroke[2:4]):
        assert not len(way_back(nothing, 1.0))


def test_short_travels_are_not_retracted() -> None:
    made = layer(scattered(25, 10, 3), square(10))
    assert traced(made, thesis=True, retraction=1.0, retraction_travel=50.0)[1][0].retractions == 0


def test_firmware_retraction_needs_no_length() -> None:
    made = layer(scattered(25, 10, 3), square(10))
    _, (report,) = traced(made, thesis=True, retraction_by="firmware")
    assert report.retractions > 0


def test_travels_stay_inside_where_a_way_exists() -> None:
    made = layer(scattered(25, 10, 3), square(10, hole=5))
    (path,), _ = traced(made, thesis=True)
    ends = np.stack([path.points[:-1], path.points[1:]], axis=1)[2:, :, :2]
    moves = shapely.linestrings(ends[path.kind[3:] == TRAVEL])
    assert shapely.covers(area_of(made.section).buffer(1e-9), moves).all()


def test_skirt_and_brim_go_around_the_first_layer_only() -> None:
    layers = stack(2)
    plain, _ = traced(layers)
    paths, _ = traced(layers, skirt_loops=2, skirt_distance=3.0, brim_width=2.0)
    brim = drawn(paths[0], BRIM).buffer(0.4, join_style="mitre", cap_style="square")
    assert brim.bounds == pytest.approx((-12.4, -12.4, 12.4, 12.4))
    assert brim.difference(area_of(layers[0].section)).area == pytest.approx(24.8**2 - 400)
    skirt = drawn(paths[0], SKIRT)
    assert skirt.length == pytest.approx(8 * (12.4 + 3 + 0.4) + 8 * (12.4 + 3 + 1.2))
    assert not np.isin(paths[1].feature, (SKIRT, BRIM)).any()
    assert drawn(paths[0], CELLS, PERIMETER).length == pytest.approx(drawn(plain[0]).length)


def test_solid_layers_cover_the_section() -> None:
    layers = stack(5)
    paths, _ = traced(layers, open=False, bottom_layers=1, top_layers=3)
    solid = [bool(np.isin(path.feature, (SOLID, BRIDGE)).any()) for path in paths]
    assert solid == [True, False, True, True, True]
    for path in (paths[0], paths[-1]):
        assert not (path.feature == CELLS).any()
        beads = drawn(path).buffer(0.41)
        assert area_of(layers[0].section).difference(beads).area < 0.02 * 400
    turned = [steps(paths[number], SOLID)[0] for number in (3, 4)]
    directions = [end - start for start, end in turned]
    assert np.dot(*directions) == pytest.approx(0, abs=1e-9)


def test_solid_lines_are_joined_by_short_steps_only() -> None:
    made = layer(scattered(25, 10, 3), square(10, hole=4))
    (path,), _ = traced(made, open=False, bottom_layers=1, top_layers=0)
    inside = area_of(made.section).buffer(-0.8, join_style="mitre")
    assert drawn(path, SOLID).length == pytest.approx(inside.area / 0.8, rel=0.1)
    assert inside.buffer(1e-6).covers(drawn(path, SOLID))


def test_layers_are_streamed() -> None:
    layers = iter(stack(6))
    paths = trace(layers, PrintSettings(top_layers=2, skin_span="off"))
    next(paths)
    taken = 6 - len(list(layers))
    assert taken == 5, "two whose skin it may be, one more, and the one that is planned meanwhile"


def test_an_empty_section_gives_an_empty_toolpath() -> None:
    first, last = stack(2)
    empty = layer(scattered(3, 5, 0), square(10, 0.2))
    nothing = Layer(
        1,
        Section(0.2, ()),
        empty.state,
        type(empty.diagram)(np.empty((0, 2)), *(np.empty((0, 2), np.int64) for _ in range(3))),
        0.0,
    )
    paths, reports = traced([first, nothing])
    assert len(paths[1].points) == 0
    assert reports[1].strokes == 0
    assert len(last.diagram.edges)


def test_what_is_too_narrow_is_reported() -> None:
    corners = np.array(
        [[-10.0, -5], [10, -5], [10, 5], [1, 5], [1, 9], [0.5, 9], [0.5, 5], [-10, 5]]
    )
    made = layer(scattered(6, 5, 2), Section(0.0, (corners,)))
    _, (report,) = traced(made)
    assert report.narrow_area == pytest.approx(0.5 * 4, rel=0.05)
    assert findings([report]) == [
        "2.00 mm² on 1 layer stay empty, too narrow for a bead; use a narrower bead, or "
        "--contour centre"
    ]
    assert findings([replace(report, narrow_area=0.004)] * 2) == [], "no finding of 0.00 mm²"
    assert findings([replace(report, narrow_area=0.005)] * 2)


def test_joined_edges_are_a_finding() -> None:
    _, reports = traced(layer(scattered(60, 10, 3), square(10)), minimum_edge=0.5)
    assert reports[0].joined_edges > 0
    assert findings(reports) == [
        f"joined {reports[0].joined_edges} edges shorter than --minimum-edge to the neighbours"
    ]


def test_cells_filled_by_the_bead_are_reported() -> None:
    # The two cells in the middle are strips 0.2 mm wide.
    sites = np.array([[-0.3, 0], [-0.1, 0], [0.1, 0], [0.3, 0]])
    made = layer(sites, square(10))
    assert traced(made, bead_width=0.7)[1][0].narrow_cells == ()
    _, reports = traced(made, bead_width=0.8)
    assert reports[0].narrow_cells == (1, 2)
    assert findings(reports)[0].startswith(
        "the bead is wider than twice the gap of cell 1 (layers 0 to 0), cell 2 (layers 0 to 0):"
    )


def test_each_feature_has_its_speed() -> None:
    speeds = {
        "print_speed": 30.0,
        "perimeter_speed": 20.0,
        "solid_speed": 25.0,
        "bridge_speed": 15.0,
    }
    paths, _ = traced(stack(4), open=False, bottom_layers=0, top_layers=2, **speeds)
    wanted = {CELLS: 30.0, PERIMETER: 20.0, SOLID: 25.0, BRIDGE: 15.0}
    for path in paths[1:]:
        printed = path.kind == EXTRUDE
        for feature in np.unique(path.feature[printed]).tolist():
            assert (path.speed[printed & (path.feature == feature)] == wanted[feature]).all()
    assert {SOLID, PERIMETER} == set(paths[3].feature[paths[3].kind == EXTRUDE].tolist())


def test_no_bead_is_laid_faster_than_its_filament_melts() -> None:
    paths, _ = traced(stack(2), print_speed=100.0, perimeter_speed=20.0, most_flow=15.0)
    extruding = paths[1].kind == EXTRUDE
    speed, feature = paths[1].speed[extruding], paths[1].feature[extruding]
    assert speed[feature == CELLS] == pytest.approx(15 / 0.16)
    assert (speed[feature == PERIMETER] == 20.0).all()


def test_layers_must_ascend() -> None:
    with pytest.raises(GeometryError, match=r"layer 0: .*ascending") as caught:
        traced(stack(2)[::-1])
    assert caught.value.layer == 0


def test_the_same_layers_give_the_same_toolpath() -> None:
    once, twice = (traced(stack(2, 30))[0] for _ in range(2))
    for one, other in zip(once, twice, strict=True):
        assert one.points.tobytes() == other.points.tobytes()
