"""What lies on the bed: the first bead, whatever the part stands on, and what is told of it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely
from diagrams import disc, layer, scattered, square, stack

import v3dcad
from v3dcad.errors import GeometryError
from v3dcad.geometry.section_area import section_area
from v3dcad.model import BRIM, EXTRUDE, Layer, Section, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.division import divided
from v3dcad.toolpath.first_layer import (
    RESOLUTION,
    brim_width,
    cuts,
    stand_width,
    stands_badly,
)
from v3dcad.toolpath.report import LayerReport, findings
from v3dcad.toolpath.trace import trace


def traced(layers: list[Layer], **options: Any) -> tuple[list[Toolpath], list[LayerReport]]:
    reports: list[LayerReport] = []
    return list(trace(layers, PrintSettings(**options), reports.append)), reports


def cone(radii: list[float], first: float = 0.0) -> list[Layer]:
    """Layers 0.2 mm apart from `first` on, discs of these radii (0: nothing)."""
    made = []
    for k, radius in enumerate(radii):
        z = first + 0.2 * k
        section = replace(disc(max(radius, 0.1)), z=z)
        whole = layer(scattered(9, max(radius, 0.1), 3), section, k)
        made.append(whole if radius else replace(whole, section=Section(z, ())))
    return made


@pytest.mark.parametrize("first", [0.0, 0.1, 1.7])
@pytest.mark.parametrize("radii", [[0, 0, 5, 6], [0.1, 5, 6], [0.2, 0.1, 3, 3], [5, 5]])
def test_the_first_bead_lies_on_the_bed(radii: list[float], first: float) -> None:
    paths, reports = traced(
        cone(radii, first), first_layer_height=0.3, first_layer_speed=7.0, minimum_layer_time=0.0
    )
    assert len(paths) == len(radii)
    extruding = [path.kind == EXTRUDE for path in paths]
    printed = [k for k, some in enumerate(extruding) if some.any()]
    assert printed == list(range(radii.index(max(r for r in radii if r < 6)), len(radii)))
    for above, k in enumerate(printed):
        heights = paths[k].points[extruding[k], 2]
        assert heights == pytest.approx(0.3 + 0.2 * above)
        assert reports[k].level == pytest.approx(heights[0])
    assert (paths[printed[0]].speed[extruding[printed[0]]] == 7).all()
    assert all(report.level == 0 for report in reports[: printed[0]])


def test_the_lowest_bead_of_a_sphere_lies_on_the_bed() -> None:
    from build123d import Sphere

    structure = v3dcad.fill(Sphere(8), cell_size=6.0, layer_height=0.2)
    paths, _ = traced(list(structure.layers), first_layer_height=0.2)
    heights = np.concatenate([path.points[path.kind == EXTRUDE, 2] for path in paths])
    assert heights.min() == pytest.approx(0.2)
    assert heights.max() == pytest.approx(16.0)


@pytest.mark.parametrize(
    ("height", "first_layer", "begins"),
    [(0.1, 0.2, 1), (0.1, 0.3, 2), (0.05, 0.2, 3), (0.12, 0.2, 1), (0.15, 0.2, 0), (0.3, 0.2, 0)],
)
@pytest.mark.parametrize("empty", [0, 2])
def test_a_high_first_layer_takes_in_others_so_that_the_part_keeps_its_height(
    height: float, first_layer: float, begins: int, empty: int
) -> None:
    count = 9
    sections = [Section(0.02 + height * k, ()) for k in range(empty)]
    ring = square(6).rings
    sections += [Section(0.02 + height * (empty + k), ring) for k in range(count)]
    found = [*divided(enumerate(sections), PrintSettings(first_layer_height=first_layer))]
    assert [one.printed for one in found] == [k >= empty + begins for k in range(len(sections))]
    assert found[empty + begins].level == pytest.approx(first_layer)
    # Whole layers let no other choice come nearer.
    assert abs(found[-1].level - count * height) <= max(height / 2, height - first_layer) + 1e-9


def test_a_part_thinner_than_the_first_layer_is_printed_once() -> None:
    sections = [Section(0.05 + 0.1 * k, square(6).rings) for k in range(2)]
    found = list(divided(enumerate(sections), PrintSettings(first_layer_height=0.35)))
    assert [one.printed for one in found] == [False, True]


def test_sections_that_the_first_layer_takes_in_do_not_stay_empty() -> None:
    layers = [layer(scattered(9, 6, 1), replace(square(6), z=0.1 * k), k) for k in range(8)]
    paths, reports = traced(layers, first_layer_height=0.3)
    assert [len(path.points) > 0 for path in paths] == [False, False, *6 * [True]]
    assert not [found for found in findings(reports) if "stay empty" in found]
    empty = [report.narrow_area for report in reports]
    assert empty[:2] == pytest.approx([0, 0], abs=1e-6)


def test_a_brim_goes_round_what_stands_on_little() -> None:
    auto, none = PrintSettings(), PrintSettings(brim_width=0.0)
    large, small, thin = (
        shapely.box(0, 0, 20, 20),
        shapely.box(0, 0, 9, 9),
        shapely.box(0, 0, 60, 3),
    )
    assert [brim_width(area, auto) for area in (large, small, thin)] == [0, 5, 5]
    assert brim_width(small, none) == 0
    assert brim_width(large, PrintSettings(brim_width=2.0)) == 2
    paths, _ = traced(cone([2, 3]))
    assert (paths[0].feature == BRIM).any()
    assert not (paths[1].feature == BRIM).any()
    (path,), _ = traced([layer(scattered(9, 10, 3), square(10))])
    assert not (path.feature == BRIM).any()


@pytest.mark.parametrize("angle", [0, 20, 45, 70])
def test_the_width_of_a_stand_is_the_least_in_any_direction(angle: float) -> None:
    from shapely.affinity import rotate

    feet = shapely.union(shapely.box(0, 0, 4, 2), shapely.box(26, 1, 30, 7))
    turned = rotate(feet, angle)
    directions = np.radians(np.linspace(0, 180, 1801))
    points = shapely.get_coordinates(turned)
    widths = np.ptp(points @ np.array([np.cos(directions), np.sin(directions)]), axis=0)
    assert stand_width(turned) == pytest.approx(widths.min(), rel=1e-3)
    assert stand_width(turned) <= widths.min() + 1e-9


def test_what_stands_on_a_point_is_told_and_what_would_help() -> None:
    ball = [float(np.sqrt(20**2 - (20 - 0.1 - 0.2 * k) ** 2)) for k in range(60)]
    _, reports = traced(cone(ball))
    (told,) = [text for text in findings(reports) if "stands on" in text]
    for help in ("--up", "raft", "--brim-width", "12.5 mm²", "4 mm wide", "12 mm high"):
        assert help in told
    _, reports = traced(stack(5))
    assert not any("stands on" in text for text in findings(reports))
    assert stands_badly(400, 20, 101, 400), "too slender"
    assert not stands_badly(400, 20, 99, 400)
    assert stands_badly(400, 20, 99, 8001), "too small a foot"


def test_layers_that_do_not_ascend_are_refused() -> None:
    made = cone([5, 5])
    with pytest.raises(GeometryError, match="ascending"):
        traced([made[1], made[0]])


def test_areas_have_no_corners_that_gcode_cannot_tell_from_a_line() -> None:
    angle = 2 * np.pi * np.arange(6000) / 6000
    disc_ring = 15 * np.column_stack([np.cos(angle), np.sin(angle)])
    (cut,) = cuts([Section(0.0, (disc_ring,))], PrintSettings())
    given = shapely.polygons(disc_ring)
    assert shapely.get_num_coordinates(cut.area) < 1000
    assert shapely.hausdorff_distance(cut.area, given) <= RESOLUTION
    (same,) = cuts([Section(0.0, (np.array([[0.0, 0], [5, 0], [5, 5], [0, 5]]),))], PrintSettings())
    assert shapely.get_num_coordinates(same.area) == 5


def test_sections_that_come_again_are_cut_as_if_they_were_the_only_ones() -> None:
    """But for what lies below: no bead fits into a needle, but one does over a square."""
    needle, box, other = square(0.1).rings, square(5).rings, square(6).rings
    order = [(), needle, needle, box, box, other, needle, box, ()]
    found = list(cuts([Section(0.2 * k, rings) for k, rings in enumerate(order)], PrintSettings()))
    assert [cut.printed for cut in found] == [k >= 3 for k in range(len(order))]
    for rings, (area, _) in zip(order, found, strict=True):
        assert area.area == pytest.approx(section_area(Section(0.0, rings)).area)
