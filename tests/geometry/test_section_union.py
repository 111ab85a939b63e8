"""The union of contours by non-zero winding, against shapely's own and against OCCT's booleans."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
from OCP.TopoDS import TopoDS_Shape

from tests.kernel import shapes
from tests.kernel.exact import exact_area
from tests.parts import ring_area
from v3dcad.geometry.section_union import faulty, meeting, union, united
from v3dcad.kernel.part import SolidPart, solid_part
from v3dcad.kernel.shapes import area, compound
from v3dcad.model import Floats, Section

SQUARE = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])


def total(section: Section) -> float:
    return sum(map(ring_area, section.rings))


def polygon(ring: Floats) -> shapely.Geometry:
    return shapely.make_valid(shapely.Polygon(ring))


@given(st.integers(0, 10**9), st.integers(1, 6))
def test_unions_of_polygons_are_those_of_shapely(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    angle = np.linspace(0, 2 * np.pi, 9, endpoint=False)
    star = random.uniform(1, 3, (count, 9, 1)) * np.column_stack([np.cos(angle), np.sin(angle)])
    rings = star + random.integers(-3, 4, (count, 1, 2))
    section = Section(0.0, tuple(rings))
    found = union(section, 0.0)
    expected = shapely.union_all([polygon(ring) for ring in rings])
    assert total(found) == pytest.approx(expected.area, abs=1e-6)
    assert not faulty([found])
    assert union(found, 0.0) is found
    ours = shapely.union_all([polygon(ring) for ring in found.rings if ring_area(ring) > 0])
    holes = [polygon(ring) for ring in found.rings if ring_area(ring) < 0]
    assert ours.difference(shapely.union_all(holes)).symmetric_difference(
        expected
    ).area == pytest.approx(0, abs=1e-6)


@given(st.integers(0, 10**9))
def test_rings_that_lie_apart_are_united_apart(seed: int) -> None:
    """Copies of crossing squares far from each other, in any order, beside a sound ring."""
    random = np.random.default_rng(seed)
    pair = [SQUARE, SQUARE + random.uniform(1, 3, 2)]
    copies = [np.add(ring, [20.0 * k, 7.0 * k]) for k in range(3) for ring in pair]
    lone = SQUARE - 50
    rings = [copies[k] for k in random.permutation(6)]
    rings.insert(int(random.integers(7)), lone)
    found = union(Section(1.0, tuple(rings)), 0.0)
    assert found.z == 1.0
    assert total(found) == pytest.approx(3 * total(union(Section(0.0, tuple(pair)), 0.0)) + 16)
    assert any(np.array_equal(ring, lone) for ring in found.rings)
    assert len(found.rings) == 4


def test_rings_that_touch_are_united_where_it_is_asked_for() -> None:
    section = Section(0.0, (SQUARE, np.add(SQUARE, [4.0, 0.0])))
    assert union(section, 0.0, touching=False) is section
    (ring,) = union(section, 0.0).rings
    assert ring_area(ring) == pytest.approx(32)


@given(st.integers(0, 10**9), st.integers(5, 30))
def test_a_ring_through_itself_is_what_it_winds_around(seed: int, count: int) -> None:
    """Pieces between a ring's own crossings count where its winding number, by angles, is not 0."""
    ring = np.random.default_rng(seed).uniform(-5, 5, (count, 2))
    found = union(Section(0.0, (ring,)), 0.0)
    assert not faulty([found])
    lines = shapely.union_all(shapely.LinearRing(ring))
    expected = 0.0
    for face in shapely.get_parts(shapely.polygonize([lines])):
        arms = ring - shapely.get_coordinates(shapely.point_on_surface(face))
        turns = np.diff(np.unwrap(np.arctan2(*np.vstack([arms, arms[:1]]).T[::-1])))
        expected += face.area * (round(float(turns.sum()) / (2 * np.pi)) != 0)
    assert total(found) == pytest.approx(expected, abs=1e-6)


def test_contours_that_do_not_cross_stay_as_they_are() -> None:
    hole = (SQUARE / 4 + 1)[::-1]
    apart = Section(1.0, (SQUARE, hole, SQUARE + 10))
    assert united([apart], 0.005, bodies_meet=True)[0] is apart
    beside = Section(1.0, (SQUARE, SQUARE + np.array([4, 0])))
    assert united([beside], 0.005, bodies_meet=False)[0] is beside
    (one,) = united([beside], 0.005, bodies_meet=True)[0].rings
    assert ring_area(one) == pytest.approx(32)


def test_those_that_cross_are_found_among_others() -> None:
    sound, crossing = (SQUARE,), (SQUARE, SQUARE + 1)
    stack = [sound, crossing, crossing, sound, (), crossing, sound]
    sections = [Section(float(z), rings) for z, rings in enumerate(stack)]
    assert faulty(sections) == [1, 2, 5]
    found = united(sections, 0.005, bodies_meet=False)
    assert [len(section.rings) for section in found] == [1, 1, 1, 1, 0, 1, 1]
    assert faulty(found) == []


def test_sides_that_touch_in_part_or_but_for_rounding() -> None:
    for off in (0.0, 1e-13, -1e-10, 5e-7):
        both = Section(0.0, (SQUARE, SQUARE / 2 + [4 + off, 1]))
        (ring,) = union(both, 0.0).rings
        assert ring_area(ring) == pytest.approx(20, abs=1e-5)


def test_corners_keep_their_coordinates_and_work_far_from_the_origin() -> None:
    random = np.random.default_rng(3)
    for far in (0.0, 1e3, 1e5):
        rings = tuple(SQUARE + random.uniform(0, 3, 2) + far for _ in range(3))
        found = union(Section(0.0, rings), 0.0)
        assert total(found) == pytest.approx(
            shapely.union_all([polygon(ring - far) for ring in rings]).area, abs=1e-6
        )
        given_corners = {tuple(corner) for ring in rings for corner in ring.tolist()}
        kept = [tuple(corner) in given_corners for ring in found.rings for corner in ring.tolist()]
        assert 0 < sum(kept) < len(kept)


def test_boxes_that_meet_are_those_that_touch() -> None:
    random = np.random.default_rng(5)
    low = random.integers(0, 12, (40, 3)).astype(float)
    high = low + random.integers(1, 4, (40, 3))
    expected = [
        [i, j]
        for i in range(40)
        for j in range(i + 1, 40)
        if np.all((low[i] <= high[j]) & (low[j] <= high[i]))
    ]
    assert meeting(low, high).tolist() == expected
    assert meeting(low[:0], high[:0]).tolist() == []


def tilted(angle: float) -> tuple[float, float, float]:
    return (np.sin(angle), 0.1, np.cos(angle))


BODIES = {
    "pin in a hole": lambda: [
        shapes.cut(shapes.box((0, 0, 0), (20, 20, 6)), shapes.cylinder(5, 6, (10, 10, 0))),
        shapes.cylinder(5, 14, (10, 10, -2), (0, 0, 1)),
    ],
    "pin in a tilted hole": lambda: [
        shapes.cut(
            shapes.box((0, 0, 0), (30, 30, 6)), shapes.cylinder(5, 40, (12, 15, -15), tilted(0.3))
        ),
        shapes.cylinder(5, 40, (12, 15, -15), tilted(0.3)),
    ],
    "box and cylinder": lambda: [
        shapes.box((0, 0, 0), (20, 20, 8)),
        shapes.cylinder(6, 16, (20, 10, -4)),
    ],
    "three balls": lambda: [
        shapes.sphere(8, (0, 0, 4)),
        shapes.sphere(7, (9, 0, 3), (1, 1, 0)),
        shapes.sphere(6, (4, 8, 5), (0, 1, 0)),
    ],
    "leaning cylinders": lambda: [
        shapes.cylinder(5, 40, (-8, 0, -12), tilted(0.5)),
        shapes.cylinder(4, 40, (12, 0, -12), tilted(-0.6)),
    ],
    "cone through a ring": lambda: [
        shapes.torus(12, 4, (0, 0, 4)),
        shapes.cone(9, 3, 20, (6, 0, -4), tilted(0.2)),
    ],
    "one in the other": lambda: [
        shapes.box((0, 0, 0), (20, 20, 8)),
        shapes.cylinder(3, 4, (9, 9, 1)),
    ],
    "the same twice": lambda: [shapes.cylinder(7, 8), shapes.cylinder(7, 8)],
    "side by side": lambda: [
        shapes.box((0, 0, 0), (20, 20, 8)),
        shapes.box((20, 5, 0), (30, 12, 8)),
    ],
}


def level_area(solid: TopoDS_Shape, z: float) -> float:
    """OCCT's area of a solid's section, mm²."""
    plane = BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1)), -99, 99, -99, 99)
    return area(shapes.common(plane.Face(), solid))


def part(bodies: list[TopoDS_Shape]) -> SolidPart:
    return solid_part(compound(bodies), "part", "part")


@pytest.mark.parametrize("name", BODIES)
def test_sections_of_bodies_that_meet_are_those_of_occts_union(name: str) -> None:
    bodies = BODIES[name]()
    whole = bodies[0]
    for body in bodies[1:]:
        whole = shapes.fuse(whole, body)
    for section in part(bodies).sections(np.array([1.7, 3.0, 4.4])):
        assert not faulty([section])
        assert {run.ring for run in section.runs} == set(range(len(section.rings)))
        exact = all(run.curve != "points" for run in section.runs)
        expected = level_area(whole, section.z)
        assert exact_area(section) == pytest.approx(expected, rel=1e-6 if exact else 1e-3)


def test_rings_of_one_spline_face_in_two_bodies_cancel_out() -> None:
    """Halves of a loft, cut apart by a face of no known curve."""
    loft = shapes.loft()
    tube = shapes.cut(shapes.box((-40, -40, 5), (40, 40, 12)), loft)
    (section,) = part([tube, loft]).sections(np.array([8.0]))
    (ring,) = section.rings
    assert ring_area(ring) == pytest.approx(80 * 80)
