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
from v3dcad.toolpath.certificate import printed_overhang
from v3dcad.toolpath.division import divided
from v3dcad.toolpath.report import LayerReport
from v3dcad.toolpath.ribs import LATE, Ribs, reach
from v3dcad.toolpath.trace import trace

W = 0.45
HALF = 15.0
PLAIN: dict[str, Any] = {"skirt_loops": 0, "brim_width": 0.0, "minimum_layer_time": 0.0}


def block(
    count: int, seed: int = 1, half: float = HALF, top: float = HALF, without: int = 0
) -> list[Layer]:
    """Layers of a square block with 6 upright cells, or fewer; half as wide as `top` above."""
    sites = scattered(6, half, seed)[: 6 - without]
    made, small = layer(sites, square(half)), layer(sites, square(top))
    return [
        replace(which, index=k, section=Section(0.2 * k + 0.1, which.section.rings))
        for k in range(count)
        for which in (made if k < count / 2 else small,)
    ]


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


def test_layers_wait_for_what_is_above_them() -> None:
    layers = iter(block(200))
    next(trace(layers, PrintSettings()))
    wide = reach((2 * HALF) ** 2 / 6)
    taken = 200 - len(list(layers))
    assert taken == pytest.approx(wide / 0.2 + 5, abs=2)


def test_a_cell_that_opens_late_under_a_skin_is_left_out() -> None:
    """So no wall is printed that ribs could not hold; where no skin is near, it opens as ever."""
    few, many = block(100, without=1), block(100)
    opened = 100 - round((LATE * 2 * HALF / math.sqrt(6) - 1.5) / 0.2)
    same, more, late = (
        traced(layers)[0]
        for layers in (few, [*few[:20], *many[20:]], [*few[:opened], *many[opened:]])
    )
    for k in range(opened, 96):
        assert beads(late[k], CELLS).symmetric_difference(beads(same[k], CELLS)).area < 1e-6
    assert beads(more[40], CELLS).symmetric_difference(beads(same[40], CELLS)).area > 1.0


def test_bands_hold_the_area() -> None:
    ring = shapely.Point(0.3, 0.7).buffer(14) - shapely.Point(0.3, 0.7).buffer(11)
    found = bands(ring, 5.0)
    assert found.area().buffer(1e-9).covers(ring)
    assert np.unique(found.band).tolist() == [-3, -2, -1, 0, 1, 2]
    inside = np.random.default_rng(1).uniform(-16, 16, (500, 2))
    assert np.array_equal(found.hold(inside), shapely.contains_xy(found.area(), *inside.T))
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
