"""Skins on every face that looks up or down, by areas worked out without v3dcad; and bridges."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from diagrams import layer, scattered
from numpy.typing import NDArray

from v3dcad.geometry.section_area import section_area
from v3dcad.model import BRIDGE, CELLS, EXTRUDE, NO_FEATURE, SOLID, Floats, Layer, Section, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.bridging import Held, direction
from v3dcad.toolpath.report import LayerReport
from v3dcad.toolpath.skins import Cut, parted, shells
from v3dcad.toolpath.trace import trace

SIDE = 12.0
W = 0.45


def box(low: float, high: float) -> Floats:
    return np.array([[low, -SIDE], [high, -SIDE], [high, SIDE], [low, SIDE]])


def slab(k: int, *rings: Floats) -> Layer:
    made = layer(scattered(25, SIDE, 3), Section(0.2 * k, rings), k)
    return replace(made, section=Section(0.2 * k, rings))


def stairs() -> list[Layer]:
    """12 whole layers, and 12 of the left half on them."""
    return [slab(k, box(-SIDE, SIDE if k < 12 else 0.0)) for k in range(24)]


def tunnel() -> list[Layer]:
    """24 layers with a slot 8 mm wide, along y, in the middle third."""
    left, right = box(-SIDE, -4.0), box(4.0, SIDE)
    return [slab(k, *((left, right) if 8 <= k < 16 else (box(-SIDE, SIDE),))) for k in range(24)]


def skins_of(layers: list[Layer], bottom: int, top: int) -> list[shapely.Geometry]:
    cuts = [Cut(section_area(made.section), True) for made in layers]
    return [skin for _, skin in shells(cuts, bottom, top)]


def traced(layers: list[Layer], **options: Any) -> tuple[list[Toolpath], list[LayerReport]]:
    reports: list[LayerReport] = []
    usual = {"skirt_loops": 0, "brim_width": 0.0, "minimum_layer_time": 0.0}
    return list(trace(layers, PrintSettings(**{**usual, **options}), reports.append)), reports


def of_skins(path: Toolpath) -> NDArray[np.bool_]:
    """(p,) whether a step belongs to a stroke of solid lines and bridges alone: walls may hang."""
    stroke = np.cumsum(path.kind != EXTRUDE)
    others = (path.kind == EXTRUDE) & ~np.isin(path.feature, (SOLID, BRIDGE))
    return (path.kind == EXTRUDE) & (np.bincount(stroke, others)[stroke] == 0)


def laid(path: Toolpath, *features: int) -> Floats:
    """(k, 2, 2) segments extruded for some features, or for any."""
    ends = np.stack([path.points[:-1], path.points[1:]], axis=1)[..., :2]
    chosen = path.kind[1:] == EXTRUDE
    return ends[chosen & np.isin(path.feature[1:], features) if features else chosen]


def skin(path: Toolpath, *features: int) -> Floats:
    """The same of skins alone: walls may be bridges, too."""
    return laid(
        replace(path, feature=np.where(of_skins(path), path.feature, NO_FEATURE)), *features
    )


@pytest.mark.parametrize(("bottom", "top"), [(0, 3), (2, 0), (3, 4), (30, 30)])
@pytest.mark.parametrize("part", [stairs, tunnel])
def test_a_point_is_in_a_skin_if_the_part_ends_near_above_or_below(
    part: Any, bottom: int, top: int
) -> None:
    """Point by point: the sections over and under it are asked whether they hold it."""
    layers = part()
    skins = skins_of(layers, bottom, top)
    assert len(skins) == len(layers)
    areas = [section_area(made.section) for made in layers]
    points = np.random.default_rng(1).uniform(-SIDE, SIDE, (200, 2))
    holds = np.array([shapely.contains_xy(area, *points.T) for area in areas])
    beyond = np.zeros((30, len(points)), bool)
    padded = np.vstack([beyond, holds, beyond])
    for k, skin in enumerate(skins):
        here = k + 30
        above = padded[here + 1 : here + top + 1].all(axis=0)
        below = padded[here - bottom : here].all(axis=0)
        expected = holds[k] & ~(above & below)
        assert np.array_equal(shapely.contains_xy(skin, *points.T), expected)


def test_layers_below_the_first_are_air() -> None:
    layers = stairs()[:8]
    cuts = [Cut(section_area(made.section), k >= 3) for k, made in enumerate(layers)]
    solid = [not skin.is_empty for _, skin in shells(cuts, 2, 0)]
    assert solid == [False] * 3 + [True] * 2 + [False] * 3


def test_slivers_of_rounding_are_no_skins() -> None:
    layers = [slab(k, box(-SIDE, SIDE) * (1 + 1e-12 * (-1) ** k)) for k in range(6)]
    assert all(skin.is_empty for skin in skins_of(layers, 1, 1)[1:-1])


def test_a_skin_is_an_area_where_the_part_also_touches_what_it_ends_beside() -> None:
    """A ledge ends over one post and a second post begins: of what lay bare, the layer above shares
    an area and touches another along a line.
    """
    post, ledge, second = (shapely.box(*x, 10) for x in ((0, 0, 10), (10, 0, 12), (20, 0, 22)))
    cuts = [Cut(area, True) for area in (post, post | ledge | second, post | second)]
    skin = list(shells(cuts, 2, 0))[2].skin
    assert (skin.geom_type, skin.area) == ("MultiPolygon", 20)
    assert parted(shapely.Polygon(), skin, W)[1].is_empty


def test_foam_and_skin_share_the_area_and_the_skin_reaches_into_the_foam() -> None:
    inner = shapely.box(0, 0, 30, 20).difference(shapely.box(20, 5, 25, 8))
    wanted = shapely.box(12, -5, 40, 30)
    foam, skin = parted(inner, wanted, W)
    assert foam.intersection(skin).area == pytest.approx(0, abs=1e-9)
    assert skin.buffer(1e-6).covers(inner.intersection(wanted))
    assert skin.bounds[0] == pytest.approx(12 - 2 * W)
    assert foam.union(skin).symmetric_difference(inner).area < 0.01
    foam, skin = parted(inner, shapely.box(12, -5, 12 + 1.9 * W, 30), W)
    assert skin.is_empty
    assert foam is inner


@pytest.mark.parametrize("wall_beads", [2, 1])
@pytest.mark.parametrize("contour", ["inset", "centre"])
@pytest.mark.parametrize("perimeters", [1, 2])
def test_each_step_of_stairs_is_closed(wall_beads: int, contour: str, perimeters: int) -> None:
    """On the layers below a tread all of it is covered, and cells go on under the other half."""
    options: Any = {"wall_beads": wall_beads, "contour": contour, "perimeters": perimeters}
    paths, _ = traced(stairs(), bottom_layers=2, top_layers=3, **options)
    solid = [k for k, path in enumerate(paths) if len(skin(path, SOLID, BRIDGE))]
    assert solid == [0, 1, 9, 10, 11, 21, 22, 23]
    tread = shapely.box(1, -SIDE + 1, SIDE - 1, SIDE - 1)
    for k in (9, 10, 11):
        beads = shapely.union_all(shapely.buffer(shapely.linestrings(laid(paths[k])), 0.55 * W))
        assert tread.difference(beads).area < 0.02 * tread.area
        assert len(laid(paths[k], CELLS))
        assert laid(paths[k], CELLS)[..., 0].max() < 0
    assert not len(laid(paths[0], CELLS))


@pytest.mark.parametrize("hole", [0.0, 5.0])
def test_a_solid_layer_takes_the_plastic_that_it_has_room_for(hole: float) -> None:
    rings = [box(-SIDE, SIDE), *([box(-hole, hole)[::-1] * [1, hole / SIDE]] if hole else [])]
    (path,), _ = traced([slab(0, *rings)])
    room = section_area(Section(0.0, tuple(rings))).area * 0.2
    assert path.volume.sum() == pytest.approx(room, rel=0.02)


def test_open_is_without_skins() -> None:
    for path in traced(tunnel(), open=True)[0]:
        assert not len(skin(path, SOLID, BRIDGE))


def test_what_is_laid_on_cells_is_a_bridge_and_what_is_on_it_is_not() -> None:
    """A bridge is laid in full; the lines on it lose what they have no room for where they turn."""
    paths, _ = traced(stairs(), bridge_speed=13.0, solid_speed=31.0, bridge_flow=80.0)
    bridged = [k for k, path in enumerate(paths) if len(skin(path, BRIDGE))]
    assert bridged == [8, 20]
    for path in (paths[8], paths[9]):
        for feature, speed, flow, lost in ((BRIDGE, 13.0, 0.8, 1e-9), (SOLID, 31.0, 1.0, 0.01)):
            chosen = (path.feature == feature) & of_skins(path)
            assert (path.speed[chosen] == speed).all()
            if chosen.any():
                length = np.hypot(*np.diff(skin(path, feature), axis=1)[:, 0].T).sum()
                area = 0.2 * (W - 0.2 * (1 - np.pi / 4)) * flow
                assert 1 - lost <= path.volume[chosen].sum() / (length * area) <= 1 + 1e-9


def test_a_roof_over_a_tunnel_is_laid_across_it() -> None:
    paths, _ = traced(tunnel())
    steps = np.diff(skin(paths[16], BRIDGE), axis=1)[:, 0]
    length = np.hypot(*steps.T)
    along = np.abs(steps[:, 0]) / length
    assert length[along > 0.999].sum() > 0.9 * length.sum()
    # Each reaches from side to side.
    assert np.median(length[along > 0.999]) > 8 + 2 * W


@pytest.mark.parametrize("turned", [0, 30, 75, 120])
def test_the_direction_is_that_of_the_shortest_span(turned: int) -> None:
    from shapely.affinity import rotate

    area = rotate(shapely.box(-10, -4, 10, 4), turned, origin=(0, 0))
    banks = rotate(shapely.MultiPolygon([shapely.box(-10, 3, 10, 8), shapely.box(-10, -8, 10, -3)]),
                   turned, origin=(0, 0))  # fmt: skip
    none = np.zeros((0, 2, 2))
    assert direction(area, Held(banks, none), W) == (turned + 90) % 180
    # Over air on three sides: along the one that holds there is nothing, so out from it.
    ledge = rotate(shapely.box(-10, -8, 10, -3), turned, origin=(0, 0))
    assert direction(area, Held(ledge, none), W) == (turned + 90) % 180


@pytest.mark.parametrize("turned", [0, 30, 75, 120])
def test_bridges_are_laid_across_walls(turned: int) -> None:
    """Walls 2 mm apart along one direction, on air: a line across them spans no more than that."""
    from shapely.affinity import rotate

    area = rotate(shapely.box(-10, -10, 10, 10), turned, origin=(0, 0))
    walls = [rotate(shapely.LineString([(-11, y), (11, y)]), turned, origin=(0, 0))
             for y in range(-11, 12, 2)]  # fmt: skip
    ends = np.array([shapely.get_coordinates(wall) for wall in walls])
    assert direction(area, Held(shapely.Polygon(), ends, 0.4), W) == (turned + 90) % 180


@pytest.mark.parametrize("turned", [0, 30, 105])
def test_what_lies_far_from_a_bridge_does_not_turn_it(turned: int) -> None:
    from shapely.affinity import rotate

    def placed(shape: shapely.Geometry) -> shapely.Geometry:
        return rotate(shape, turned, origin=(0, 0))

    area = placed(shapely.box(-12, -3, 12, 3))
    banks = placed(shapely.box(-13, 2, 13, 4)).union(placed(shapely.box(-13, -4, 13, -2)))
    far = shapely.union_all([shapely.box(x, 20, x + 1, 90) for x in range(-60, 60, 2)])
    wall = np.array([[[-40.0, 30], [40, 35]], [[-2.0, 0], [2, 0]]])
    near = Held(banks, wall[1:], 0.4)
    expected = direction(area, near, W)
    assert direction(area, Held(banks.union(far), wall, 0.4), W) == expected
    assert shapely.get_num_coordinates(Held(banks.union(far), wall, 0.4).near(area, W).solid) < 30
