"""What of the beads hangs: by shapely, by places along them, and on parts whose spans are known."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
import shapely
from diagrams import layer, scattered

from v3dcad.errors import GeometryError
from v3dcad.geometry.loops.segments import Segments
from v3dcad.geometry.section_area import section_area
from v3dcad.model import (
    BRIDGE,
    CELLS,
    EXTRUDE,
    INNER_PERIMETER,
    PERIMETER,
    SKIRT,
    SOLID,
    TRAVEL,
    Floats,
    Layer,
    Section,
    Toolpath,
)
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.certificate import PrintedOverhang, printed_overhang
from v3dcad.toolpath.overhang import hanging
from v3dcad.toolpath.report import LayerReport, findings
from v3dcad.toolpath.trace import trace

W, H = 0.4, 0.2
BEGINS, ENDS = slice(None, -1), slice(1, None)
NOWHERE = shapely.Polygon()
GROUPS = {
    "perimeters": (PERIMETER, INNER_PERIMETER),
    "skins": (SOLID,),
    "bridges": (BRIDGE,),
    "walls": (CELLS,),
}


def box(left: float, right: float, half: float = 10.0) -> Floats:
    return np.array([[left, -half], [right, -half], [right, half], [left, half]])


def path(*lines: Floats, feature: int = PERIMETER) -> Toolpath:
    """Beads of W × H along some lines, with travels between."""
    points = np.concatenate(lines)
    kind = np.full(len(points), EXTRUDE, np.int8)
    kind[np.cumsum([0, *map(len, lines[:-1])])] = TRAVEL
    flat = np.vstack([points[:1], points])
    length = np.where(kind == EXTRUDE, np.hypot(*np.diff(flat, axis=0).T), 0.0)
    return Toolpath(
        np.column_stack([points, np.full(len(points), 0.4)]),
        kind,
        length * W * H,
        np.full(len(points), 50.0),
        np.zeros(len(points), np.int64),
        np.where(kind == EXTRUDE, feature, 0).astype(np.int8),
        np.full(points.shape, np.nan),
    )


def beads(*lines: Floats) -> Segments:
    """Lines of the layer below."""
    starts, stops = (np.concatenate([line[part] for line in lines]) for part in (BEGINS, ENDS))
    return Segments.of(starts, stops, W)


def wander(random: np.random.Generator, count: int, step: float) -> Floats:
    return np.cumsum(random.uniform(-step, step, (count, 2)), axis=0)


@pytest.mark.parametrize("seed", range(4))
def test_what_hangs_is_what_shapely_leaves(seed: int) -> None:
    random = np.random.default_rng(seed)
    lines = [wander(random, 60, 3.0) for _ in range(3)]
    under = [wander(random, 60, 3.0) for _ in range(4)]
    (found,) = hanging(path(*lines), np.zeros(3), beads(*under), NOWHERE, W, H)
    around = shapely.union_all([shapely.LineString(u).buffer(W / 2, quad_segs=64) for u in under])
    left = sum(shapely.LineString(line).difference(around).length for line in lines)
    assert found.length == pytest.approx(left, rel=1e-3)
    assert found.area == pytest.approx(found.length * W)
    assert found.what == "perimeters"
    assert found.over == "air"


def by_places(lines: list[Floats], under: Segments, width: float) -> float:
    """The longest span, from places every 0.01 mm along each line."""
    near = shapely.union_all(shapely.linestrings(under.ends.reshape(-1, 2, 2)))
    shapely.prepare(near)
    longest = 0.0
    for line in lines:
        whole = shapely.LineString(line)
        at = np.linspace(0, whole.length, int(whole.length / 0.01) + 2)
        places = shapely.line_interpolate_point(whole, at)
        apart = shapely.distance(places, near)
        free, hangs = apart > width, apart > width / 2
        for start, stop in runs(free):
            low, high = start, stop
            while low > 0 and hangs[low - 1] and at[start] - at[low - 1] <= width:
                low -= 1
            while high < len(at) - 1 and hangs[high + 1] and at[high + 1] - at[stop] <= width:
                high += 1
            xy = shapely.get_coordinates(places[low : high + 1])
            longest = max(longest, float(np.hypot(*(xy[:, None] - xy).transpose(2, 0, 1)).max()))
    return longest


def runs(flags: np.ndarray) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    return [(int(a), int(b) - 1) for a, b in edges.reshape(-1, 2)]


@pytest.mark.parametrize("seed", range(6))
def test_the_longest_span_is_that_of_places_along_the_beads(seed: int) -> None:
    random = np.random.default_rng(seed)
    lines = [wander(random, 6, 2.0) for _ in range(4)]
    under = beads(*[wander(random, 40, 2.0) for _ in range(8)])
    (found,) = hanging(path(*lines), np.zeros(3), under, NOWHERE, W, H)
    assert found.span == pytest.approx(by_places(lines, under, W), abs=0.05)


def test_kinds_are_told_apart_and_what_is_no_part_of_the_part_is_left_out() -> None:
    under = beads(np.array([[0.0, -50], [1, -50]]))
    for what, features in GROUPS.items():
        for feature in features:
            line = path(np.array([[0.0, 0], [7, 0]]), feature=feature)
            (found,) = hanging(line, np.zeros(3), under, NOWHERE, W, H)
            assert (found.what, found.span) == (what, pytest.approx(7.0))
    assert hanging(path(np.array([[0.0, 0], [7, 0]]), feature=SKIRT), np.zeros(3), under, NOWHERE,
                   W, H) == ()  # fmt: skip


def test_a_stop_ends_a_span_and_a_seam_does_not() -> None:
    under = beads(np.array([[-5.0, -5], [-5, 5]]), np.array([[5.0, -5], [5, 5]]))
    halves = [np.array([[-6.0, 0], [0, 0]]), np.array([[0.5, 0], [6, 0]])]
    (found,) = hanging(path(*halves), np.zeros(3), under, NOWHERE, W, H)
    assert found.span == pytest.approx(4.8)
    loop = np.array([[0.0, 0], [6, 0], [6, 1], [-6, 1], [-6, 0], [0, 0]])
    (found,) = hanging(path(loop), np.zeros(3), under, NOWHERE, W, H)
    assert found.span == pytest.approx(9.6)
    assert found.length == pytest.approx(2 * 9.6 + 4 * 0.8 + 2 * 1)


def test_a_bead_that_only_leans_out_hangs_and_spans_nothing() -> None:
    line = np.array([[0.0, 0], [20, 0]])
    for aside, hangs in ((0.19, False), (0.21, True), (0.39, True)):
        found = hanging(path(line + np.array([0, aside])), np.zeros(3), beads(line), NOWHERE, W, H)
        assert bool(found) == hangs
        assert not any(one.span for one in found)
    (found,) = hanging(path(line + np.array([0, 0.41])), np.zeros(3), beads(line), NOWHERE, W, H)
    assert found.span == pytest.approx(20.0)


def slab(k: int, *rings: Floats) -> Layer:
    low, high = (np.concatenate(rings).min(), np.concatenate(rings).max())
    return layer(scattered(36, float(max(-low, high)), 3), Section(0.2 * k, rings), k)


def traced(layers: list[Layer], **options: Any) -> tuple[list[Toolpath], list[LayerReport]]:
    reports: list[LayerReport] = []
    usual = {"skirt_loops": 0, "brim_width": 0.0, "minimum_layer_time": 0.0}
    return list(trace(layers, PrintSettings(**{**usual, **options}), reports.append)), reports


def certificate(layers: list[Layer], **options: Any) -> PrintedOverhang:
    return printed_overhang(traced(layers, **options)[1])


def towers() -> list[Layer]:
    """Two towers, 10 mm apart along x, and a roof over both."""
    pair = box(-15, -5), box(5, 15)
    return [slab(k, *(pair if k < 8 else (box(-15, 15),))) for k in range(14)]


def table() -> list[Layer]:
    """A foot 10 mm wide under a top that is 6 mm wider on both sides."""
    return [slab(k, box(-5, 5) if k < 8 else box(-11, 11)) for k in range(14)]


@pytest.mark.parametrize(("wall_beads", "seam"), [(2, "aligned"), (2, "scattered"), (1, "aligned")])
def test_what_crosses_from_tower_to_tower_spans_the_gap(wall_beads: int, seam: str) -> None:
    found = certificate(towers(), wall_beads=wall_beads, seam=seam)
    roof = found.layer == 8
    perimeters, bridges = (
        found.span[roof, found.kinds.index(k)] for k in ("perimeters", "bridges")
    )
    assert perimeters == pytest.approx(10.0, abs=0.02)
    assert bridges == pytest.approx(10.0, abs=0.02)
    assert not found.over_cells[roof, 0]
    assert np.abs(found.place[roof, 0, 0]) == pytest.approx(0.0, abs=0.1)
    assert 0.96 * 10 * 20 < found.area[roof].sum() < 1.25 * 10 * 20  # some more over cells
    assert found.span[found.layer < 8].max() == 0


def test_the_edge_of_a_table_hangs_all_around() -> None:
    """The outermost bead runs out 6 mm, along 20 and back: its corners are farthest apart."""
    found = certificate(table())
    top = found.layer == 8
    edge = PrintSettings().bead_width / 2
    diagonal = np.hypot(6 - edge, 20 - 2 * edge)
    assert found.span[top, 0] == pytest.approx(diagonal, abs=0.05)
    assert 0.96 * 2 * 6 * 20 < found.area[top].sum() < 1.25 * 2 * 6 * 20
    assert found.level[top] == pytest.approx(8 * 0.2 + 0.2)


def arch() -> list[Layer]:
    """A half-round opening of 10 mm along y, through a block."""
    layers = []
    for k in range(40):
        half = np.sqrt(max(25.0 - (0.2 * k + 0.1) ** 2, 0.0))
        rings = (box(-15, -half), box(half, 15)) if half else (box(-15, 15),)
        layers.append(slab(k, *rings))
    return layers


def test_an_arch_closes_by_itself_until_its_crown() -> None:
    found = certificate(arch())
    spans = found.span[:, 0]
    crown = int(np.argmax(found.layer == 25))
    # A side that moves in by less than half a bead a layer rests on the last.
    half = np.sqrt(np.maximum(25 - (0.2 * found.layer + 0.1) ** 2, 0))
    steps = np.concatenate([[0], -np.diff(half)])
    rests = steps < PrintSettings().bead_width / 2
    assert found.length[rests, 0].max() < 4  # of 160 mm: links
    assert found.length[~rests & (found.layer < 25), 0].min() > 30
    assert spans[crown - 1] > 19  # the last beads along the sides have nothing under them
    assert spans[crown] == pytest.approx(2 * half[crown - 1], abs=0.05)


def test_over_a_layer_without_beads_all_hangs_and_on_the_bed_nothing() -> None:
    layers = [slab(k, *(() if k == 2 else (box(-6, 6, 6),)), box(20, 26, 6)) for k in range(4)]
    reports = traced(layers)[1]
    assert reports[0].hanging == ()
    assert not any(found.span for found in reports[1].hanging)
    (perimeters, *_) = reports[3].hanging
    assert perimeters.span == pytest.approx(np.hypot(11.55, 11.55), abs=0.01)


def test_a_roof_over_cells_is_told_as_such() -> None:
    layers = [slab(k, box(-15, 15, 15)) for k in range(10)]
    found = certificate(layers, bottom_layers=0, top_layers=2)
    bridges = found.kinds.index("bridges")
    assert found.over_cells[8, bridges]
    assert 2 < found.span[8, bridges] < 8
    assert section_area(layers[8].section).covers(shapely.Point(found.place[8, bridges]))
    told = [line for line in found.findings() if line.startswith("bridges at z 1.8 span")]
    assert bool(told) == (found.span[8, bridges] > 5)


def test_long_spans_are_told_with_place_and_help() -> None:
    reports = traced(towers())[1]
    (perimeters, bridges) = printed_overhang(reports).findings()[:2]
    assert perimeters.startswith("perimeters at z 1.8 span 10.0 mm over air (x ")
    assert " on layer 8: turn the part (--up, --rotate), or give it a slope" in perimeters
    assert bridges.startswith("bridges at z 1.8 span 10.0 mm over air")
    assert perimeters in findings(reports)
    line = printed_overhang(reports).line()
    assert line.startswith("at most 10.0 mm of perimeters over air at z 1.8, 10.0 mm of bridges")
    assert line.endswith(" mm² hang by more than half a bead")


def test_where_all_rests_that_is_said() -> None:
    """Walls that lean by more than half a bead a layer hang, but touch what lies below."""
    found = certificate([slab(k, box(-6 - 0.3 * k, 6, 6)) for k in range(5)], open=True)
    assert found.line().startswith("none: every bead touches the last; ")
    assert printed_overhang([]).line() == "none: every bead touches the last"
    assert found.findings() == []
    assert found.span.shape == found.length.shape == (5, 4)
    assert np.isnan(found.place).all()


def test_a_longer_span_than_is_allowed_ends_the_trace_on_its_layer() -> None:
    assert len(traced(towers(), fail_over=10.5)[0]) == 14
    told = r"layer 8: (perimeters|bridges) at z 1.8 span 10.0 mm over air .*, more than --fail-over"
    with pytest.raises(GeometryError) as caught:
        traced(towers(), fail_over=9.5)
    assert re.match(told, caught.value.message)
    assert caught.value.layer == 8
    with pytest.raises(GeometryError):
        list(trace(towers(), PrintSettings(fail_over=9.5)))  # without a report, too
