"""Ribs in a print: what skins span, what lies under ribs, and which cells are left out."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import shapely
from diagrams import layer, scattered, square

from v3dcad.errors import SettingError
from v3dcad.model import BRIDGE, CELLS, EXTRUDE, Floats, Layer, Section, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.bands import bands
from v3dcad.toolpath.bridging import Below, bridges
from v3dcad.toolpath.certificate import printed_overhang
from v3dcad.toolpath.division import divided
from v3dcad.toolpath.report import LayerReport
from v3dcad.toolpath.ribs import Ribs, reach
from v3dcad.toolpath.trace import OF_THE_PART, trace

W = 0.45
HALF = 15.0
PLAIN: dict[str, Any] = {"skirt_loops": 0, "brim_width": 0.0, "minimum_layer_time": 0.0}


def stacked(made: list[Layer], height: float = 0.2) -> list[Layer]:
    """One layer on the other."""
    return [
        replace(which, index=k, section=Section(height * (k + 0.5), which.section.rings))
        for k, which in enumerate(made)
    ]


def block(
    count: int, seed: int = 1, half: float = HALF, top: float = HALF, height: float = 0.2
) -> list[Layer]:
    """Layers of a square block with 6 upright cells; half as wide as `top` above."""
    sites = scattered(6, half, seed)
    made, small = layer(sites, square(half)), layer(sites, square(top))
    return stacked([made if k < count / 2 else small for k in range(count)], height)


def opening(count: int, opens: int) -> list[Layer]:
    """Layers of a block in which, along a side, a cell opens from so high a layer on."""
    made = []
    for k in range(count):
        wall = HALF - 1.0 - 0.19 * min(k - opens, 20)
        sites = np.array([[0.3, 6.0], [0, 2 * wall - 6.0], [-7, -8], [8, -7]])
        made.append(layer(sites, square(HALF)))
    return stacked(made)


def traced(layers: list[Layer], **options: Any) -> tuple[list[Toolpath], list[LayerReport]]:
    reports: list[LayerReport] = []
    return list(trace(layers, PrintSettings(**{**PLAIN, **options}), reports.append)), reports


def drawn(path: Toolpath, *features: int) -> Floats:
    """(k, 2, 2) segments extruded for some features."""
    ends = np.stack([path.points[:-1], path.points[1:]], axis=1)[..., :2]
    return ends[(path.kind[1:] == EXTRUDE) & np.isin(path.feature[1:], features)]


def beads(path: Toolpath, *features: int, width: float = W) -> shapely.Geometry:
    lines = shapely.linestrings(drawn(path, *features))
    return shapely.union_all(shapely.buffer(lines, width / 2))


def spans(paths: list[Toolpath]) -> float:
    """The longest stretch of a bridge's bead that touches no bead below, mm, by shapely."""
    longest = 0.0
    for below, path in pairwise(paths):
        lines = drawn(path, BRIDGE)
        if len(lines):
            everything = np.stack([below.points[:-1], below.points[1:]], axis=1)[..., :2]
            laid = shapely.linestrings(everything[below.kind[1:] == EXTRUDE])
            held = shapely.union_all(shapely.buffer(laid, W))
            free = shapely.difference(shapely.linestrings(lines), held)
            longest = max(longest, float(shapely.length(shapely.get_parts(free)).max(initial=0.0)))
    return longest


@pytest.mark.parametrize("span", [4.0, 5.0, 7.0])
@pytest.mark.parametrize("seed", [1, 2])
def test_no_skin_spans_more_than_asked(seed: int, span: float) -> None:
    layers = block(60, seed=seed)
    with_ribs, reports = traced(layers, skin_span=span)
    without, _ = traced(layers, skin_span="off")
    assert spans(with_ribs) <= span < spans(without)
    told = printed_overhang(reports).span
    assert told.max() <= span + 2 * W


@pytest.mark.parametrize("height", [0.12, 0.3])
def test_ribs_begin_in_time_at_every_layer_height(height: float) -> None:
    """The higher layers are, the flatter tips may lean, since a bead is to rest on the last."""
    _, reports = traced(block(round(24 / height), height=height))
    assert printed_overhang(reports).span.max() <= 5.0


@pytest.mark.parametrize("opens", [30, 60, 70, 80, 85])
def test_a_cell_opens_along_a_perimeter_without_a_span(opens: int) -> None:
    """Half way up, and later under a skin: ribs go on where its walls were."""
    paths, reports = traced(opening(100, opens))
    told = printed_overhang(reports)
    assert told.span[:90].max() <= 2 * W
    assert told.span.max() <= 5.0
    closed, opened = (beads(paths[k], CELLS) for k in (opens - 5, opens + 10))
    assert opened.difference(closed).area > 10.0, "a wall along the whole side"


def test_a_rim_that_comes_in_at_once_is_held_by_a_skin() -> None:
    """Along its whole side it would lie on air, half a bead away from the rim below."""
    wide = layer(scattered(6, HALF, 1), square(HALF))
    rings = (square(HALF).rings[0] * np.array([1, (HALF - 0.48) / HALF]),)
    narrow = layer(scattered(6, HALF, 1), Section(0.0, rings))
    _, reports = traced(stacked([wide] * 60 + [narrow] * 40))
    assert printed_overhang(reports).span.max() <= 5.0


def test_what_is_said_to_hold_bridges_is_what_lies_below(monkeypatch: pytest.MonkeyPatch) -> None:
    """The foam's rim and ribs as well."""
    told: dict[float, Below] = {}

    def noted(over: shapely.Geometry, below: Below, spacing: float) -> Any:
        told[below.division.level] = below
        return bridges(over, below, spacing)

    monkeypatch.setattr("v3dcad.toolpath.plan.bridges", noted)
    paths, reports = traced(block(120, half=20.0, top=9.0))
    seen = 0
    for path, report in zip(paths, reports, strict=True):
        below = told.get(report.level)
        if below is None or not len(below.ribs):
            continue
        held = below.held()
        walls = shapely.buffer(shapely.linestrings(held.walls), held.width / 2)
        laid = beads(path, *OF_THE_PART)
        missed = laid.difference(shapely.union_all([held.solid, *walls]).buffer(0.05))
        assert missed.area < 0.02 * laid.area
        seen += 1
    assert seen


def test_skins_inside_the_part_are_held_as_well() -> None:
    """Half way up the block gets narrower: the ledge's skin ends on ribs, not in the air."""
    layers = block(120, half=20.0, top=9.0)
    paths, reports = traced(layers)
    off, told = traced(layers, skin_span="off")
    ledge = range(50, 62)
    assert spans(paths[50:62]) <= 5.0 < spans(off[50:62])
    bridges = printed_overhang(reports).span[ledge, 2].max()
    assert bridges <= 5.0 < printed_overhang(told).span[ledge, 2].max()


@pytest.mark.parametrize(("count", "options"), [(60, {}), (22, {"bottom_layers": 0})])
def test_ribs_lie_on_ribs(count: int, options: dict[str, Any]) -> None:
    """A layer's walls lie, but for half a bead and a tip's step, over beads of the one below.

    A low block without a floor has no room for ribs to meet: they grow as fast as they may.
    """
    paths, reports = traced(block(count), **options)
    told = printed_overhang(reports)
    assert told.span[:, 3].max() == 0.0
    hangs = []
    for below, path in pairwise(paths[: count - 5]):
        everything = np.stack([below.points[:-1], below.points[1:]], axis=1)[..., :2]
        lines = shapely.linestrings(everything[below.kind[1:] == EXTRUDE])
        held = shapely.union_all(shapely.buffer(lines, W / 2 + 0.01))
        walls = shapely.linestrings(drawn(path, CELLS, BRIDGE))  # what hangs is a bridge
        free = shapely.difference(walls, held)
        hangs.append(shapely.length(free).sum() / max(shapely.length(walls).sum(), 1.0))
    assert np.mean(hangs) <= 0.002, "links to other walls alone"


def test_a_layer_is_still_one_stroke() -> None:
    _, reports = traced(block(60))
    _, without = traced(block(60), skin_span="off")
    foam = slice(5, 55)
    assert [r.strokes for r in reports[foam]] == [r.strokes for r in without[foam]]
    assert sum(r.extruded for r in reports[foam]) > 1.02 * sum(r.extruded for r in without[foam])


@pytest.mark.parametrize("options", [{"skin_span": "off"}, {"wall_beads": 1}, {"open": True}])
def test_without_ribs_layers_are_what_they_were(options: dict[str, Any]) -> None:
    layers = block(40)
    upright = [path.volume.sum() for path in traced(layers, **options)[0][6:34]]
    assert np.ptp(upright) < 0.03 * max(upright)
    assert not Ribs(PrintSettings(**options)).under(0.0, 100.0)


@pytest.mark.parametrize(
    ("height", "slope"), [(0.2, 1.0), (0.3, (0.45 / 0.3 - 1 + math.pi / 4) / 2)]
)
def test_layers_wait_for_what_is_above_them(height: float, slope: float) -> None:
    count = round(40 / height)
    layers = iter(block(count, height=height))
    next(trace(layers, PrintSettings(first_layer_height=height)))
    wide = reach((2 * HALF) ** 2 / 6, slope)
    taken = count - len(list(layers))
    assert taken == pytest.approx(wide / height + 6, abs=2)


def test_bands_hold_the_area() -> None:
    ring = shapely.Point(0.3, 0.7).buffer(14) - shapely.Point(0.3, 0.7).buffer(11)
    found = bands(ring, 5.0)
    assert found.area().buffer(1e-9).covers(ring)
    assert np.unique(found.band).tolist() == [-3, -2, -1, 0, 1, 2]
    # Of a band that it crosses twice it takes two stretches.
    assert np.count_nonzero(found.band == 0) == 2
    assert not len(bands(shapely.Polygon(), 5.0).band)


def test_sections_are_divided_without_overlap() -> None:
    layers = block(60, half=20.0, top=9.0)
    parts = list(divided(((a.index, a.section) for a in layers), PrintSettings()))
    for part in parts:
        pieces = [part.foam, part.rest, part.over]
        assert sum(p.area for p in pieces) == pytest.approx(shapely.union_all(pieces).area, abs=0.1)
        assert part.area.buffer(1e-6).covers(shapely.union_all(pieces))
    ledge = next(part for part in parts[20:] if len(part.bands.band))
    assert (
        ledge.over.union(ledge.rest)
        .buffer(1e-3)
        .covers(ledge.bands.area() & ledge.area.buffer(-3 * W))
    )


@pytest.mark.parametrize("span", [1.9, "on", 0])
def test_a_span_that_ribs_have_no_room_for_is_refused(span: Any) -> None:
    with pytest.raises(SettingError, match=r"skin_span .*: give a number"):
        PrintSettings(skin_span=span)
