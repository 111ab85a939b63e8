"""Sections and the bed: the public functions, laws of placing, and what the files hold."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import v3dcad
from tests.parts import part_file, ring_area
from v3dcad.structure.placement import turned, upward

ANGLES = st.floats(-400, 400)


def areas(sections) -> list[float]:
    return [sum(map(ring_area, section.rings)) for section in sections]


@given(st.tuples(ANGLES, ANGLES, ANGLES))
def test_a_turn_is_a_rotation_about_x_then_y_then_z(degrees) -> None:
    matrix = turned(degrees).rotation
    assert matrix @ matrix.T == pytest.approx(np.eye(3), abs=1e-14)
    assert np.linalg.det(matrix) == pytest.approx(1)
    from scipy.spatial.transform import Rotation

    other = Rotation.from_euler("xyz", degrees, degrees=True).as_matrix()
    assert matrix == pytest.approx(other, abs=1e-12)


def test_right_angles_are_exact() -> None:
    assert np.array_equal(turned((90, 0, 0)).rotation, [[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    assert np.array_equal(turned((0, -90, 0)).rotation, turned((0, 270, 0)).rotation)
    assert np.array_equal(turned((180, 180, 180)).rotation, np.eye(3))


@given(st.tuples(ANGLES, ANGLES, ANGLES).map(np.array))
def test_upward_points_up(direction) -> None:
    if np.linalg.norm(direction) > 1e-6:
        unit = direction / np.linalg.norm(direction)
        matrix = upward(unit).rotation
        assert matrix @ unit == pytest.approx([0, 0, 1], abs=1e-7)
        assert matrix @ matrix.T == pytest.approx(np.eye(3), abs=1e-7)
    assert np.array_equal(upward(np.array([0, 0, -1.0])).rotation @ [0, 0, -1], [0, 0, 1])


@pytest.mark.parametrize("name", ["bracket.step", "pyramid.stl"])
@pytest.mark.parametrize("options", [{}, {"rotate": (20, 30, 40)}, {"up": "x"}, {"up": 0}])
def test_a_placed_part_is_not_moved_again(name: str, options, samples: Path) -> None:
    placed = v3dcad.place_on_bed(samples / name, **options)
    assert placed.bounds[0, 2] == 0, "the base is exactly at 0"
    assert placed.bounds.mean(axis=0)[:2] == pytest.approx([0, 0], abs=1e-9)
    again = v3dcad.place_on_bed(placed)
    assert again is placed
    assert v3dcad.section(placed, layer_height=5).part is placed


def test_up_names_a_face_or_an_axis(samples: Path) -> None:
    part = v3dcad.part_from(samples / "pyramid.step")
    size = np.ptp(part.bounds, axis=0)
    assert np.ptp(v3dcad.place_on_bed(part, up="y").bounds, axis=0)[2] == pytest.approx(size[1])
    for face in range(6):
        normal = part.normal(face)
        placed = v3dcad.place_on_bed(part, up=face)
        assert placed.placement.rotation @ normal == pytest.approx([0, 0, 1])
        # The face lies on top: the topmost section is as large as it is.
        top = v3dcad.section(placed, layer_height=placed.bounds[1, 2] - 1e-3)[1]
        assert areas([top])[0] > 30
    cone = v3dcad.part_from(samples / "cone.step")
    curved = [face for face in range(3) if not _is_plane(cone, face)]
    assert len(curved) == 1
    for up, says in ((curved[0], "not plane"), (3, "0 to 2"), ("w", "x, y, z or the number")):
        with pytest.raises(v3dcad.SettingError, match=says):
            v3dcad.place_on_bed(cone, up=up)
    with pytest.raises(v3dcad.SettingError, match="0 to 11"):
        v3dcad.place_on_bed(samples / "pyramid.stl", up=12)
    with pytest.raises(v3dcad.SettingError, match="3 numbers"):
        v3dcad.place_on_bed(cone, rotate=(1, 2))


def _is_plane(part, face: int) -> bool:
    try:
        return bool(np.linalg.norm(part.normal(face)) > 0.9)
    except v3dcad.SettingError:
        return False


def test_normals_of_a_solid_point_outward(samples: Path) -> None:
    solid, mesh = (v3dcad.part_from(samples / f"pyramid.{end}") for end in ("step", "stl"))
    ours = np.array([solid.normal(face) for face in range(6)])
    triangles = np.array([mesh.normal(face) for face in range(12)])
    for normal in triangles:
        assert np.abs(ours - normal).max(axis=1).min() < 1e-6


def test_a_turned_part_is_cut_as_its_mesh_is(samples: Path) -> None:
    turn = {"rotate": (25, -40, 10)}
    solid, mesh = (
        v3dcad.place_on_bed(samples / f"pyramid.{end}", **turn) for end in ("step", "stl")
    )
    one, other = v3dcad.section(solid, layer_height=5), v3dcad.section(mesh, layer_height=5)
    assert areas(one) == pytest.approx(areas(other), rel=1e-6, abs=1e-3)


def test_sections_can_be_gone_through_again_and_picked(samples: Path) -> None:
    sections = v3dcad.section(samples / "cone.step", layer_height=0.1)
    assert len(sections) == 300
    first, second = list(sections), list(sections)
    assert [cut.z for cut in first] == pytest.approx(np.arange(300) * 0.1)
    for k in (0, 137, 299, -1):
        assert np.array_equal(sections[k].rings[0], first[k].rings[0])
        assert np.array_equal(second[k].rings[0], first[k].rings[0])
    assert len(sections[10:20]) == 10
    radius = 20 - 5 * np.arange(300) * 0.1 / 30
    assert areas(sections) == pytest.approx(np.pi * radius**2, rel=1e-3)
    finer = v3dcad.section(samples / "cone.step", layer_height=0.1, chord_tolerance=1e-5)
    assert areas(finer[:3]) == pytest.approx(np.pi * radius[:3] ** 2, rel=2e-6)


@pytest.mark.parametrize("name", ["bracket.step", "pyramid.stl"])
def test_an_executor_changes_nothing(name: str, samples: Path) -> None:
    with ThreadPoolExecutor(2) as threads:
        ours = v3dcad.section(samples / name, layer_height=0.3, executor=threads)
        for one, other in zip(ours, v3dcad.section(samples / name, layer_height=0.3), strict=True):
            assert one.z == other.z
            assert one.runs == other.runs
            assert all(map(np.array_equal, one.rings, other.rings))
        filled = v3dcad.fill(samples / name, layer_height=3, cell_size=12, executor=threads)
    plain = v3dcad.fill(samples / name, layer_height=3, cell_size=12)
    for a, b in zip(filled.layers, plain.layers, strict=True):
        assert np.array_equal(a.diagram.vertices, b.diagram.vertices)


def test_the_base_may_lie_below_the_first_plane(samples: Path) -> None:
    sections = v3dcad.section(samples / "cone.step", layer_height=3, base_clearance=0.1)
    assert sections.part.bounds[0, 2] == pytest.approx(-0.1, abs=1e-12)
    assert sections[0].z == 0
    radius = 20 - 5 * 0.1 / 30
    assert sections[0].runs[0].parameters[2] == pytest.approx(radius)
    structure = v3dcad.fill(samples / "cone.step", layer_height=3, base_clearance=0.1)
    assert structure.part.bounds[0, 2] == pytest.approx(-0.1, abs=1e-12)
    again = v3dcad.place_on_bed(structure.part, base_clearance=0.1)
    assert again is structure.part


@pytest.mark.parametrize("tolerance", [0, -1, float("nan"), float("inf")])
def test_a_chord_tolerance_is_above_0(tolerance: float, samples: Path) -> None:
    for call in (v3dcad.section, v3dcad.fill):
        with pytest.raises(v3dcad.SettingError, match="chord_tolerance"):
            call(samples / "cone.step", chord_tolerance=tolerance)


def test_the_chord_tolerance_reaches_the_layers(samples: Path) -> None:
    rough, fine = (
        next(iter(v3dcad.fill(samples / "cone.step", layer_height=10, **chosen).layers))
        for chosen in ({"chord_tolerance": 1.0}, {})
    )
    assert len(rough.section.rings[0]) < 12 < 100 < len(fine.section.rings[0])


def test_structure_and_sections_go_back_to_where_the_source_lies(
    samples: Path, tmp_path: Path
) -> None:
    from OCP.STEPControl import STEPControl_Reader

    from v3dcad.kernel.shapes import bounds

    part = v3dcad.part_from(samples / "bracket.step")
    placed = v3dcad.place_on_bed(part, up="x", rotate=(0, 0, 33))
    structure = v3dcad.fill(placed, layer_height=2, cell_size=10)
    structure.write_step(tmp_path / "walls.step")
    v3dcad.section(placed, layer_height=2).write_step(tmp_path / "sections.step")
    for name, base in (("walls.step", 1.0), ("sections.step", 0.0)):
        reader = STEPControl_Reader()
        reader.ReadFile(str(tmp_path / name))
        reader.TransferRoots()
        box = bounds(reader.OneShape())
        # Planes lie 2 mm apart along the source's x, a structure's in the middle of its layers;
        # along y and z they see the extremes.
        assert box[0, 0] == pytest.approx(part.bounds[0, 0] + base, abs=1e-5)
        assert box[:, 1:] == pytest.approx(part.bounds[:, 1:], abs=1e-4)


def test_svg_has_a_group_for_each_section(samples: Path, tmp_path: Path) -> None:
    sections = v3dcad.section(samples / "islands.step", layer_height=4)
    sections.write_svg(tmp_path / "a.svg")
    tree = ElementTree.parse(tmp_path / "a.svg").getroot()
    assert tree.attrib["width"] == "58mm"
    groups = [
        group for group in tree.iter("{http://www.w3.org/2000/svg}g") if "data-z" in group.attrib
    ]
    assert [float(group.attrib["data-z"]) for group in groups] == [0, 4, 8, 12, 16]
    for group, section in zip(groups, sections, strict=True):
        outline = group[0].attrib["d"].removesuffix("Z").split("Z M")
        for text, ring in zip(outline, section.rings, strict=True):
            pairs = text.removeprefix("M").split("L")
            points = np.array([pair.split() for pair in pairs], float) * [1, -1]
            assert points == pytest.approx(ring, abs=1e-6)


def test_a_real_part_keeps_its_arcs(tmp_path: Path) -> None:
    sections = v3dcad.section(part_file("nist_ctc_01_asme1_rd.stp"), layer_height=15)
    sections.write_step(tmp_path / "a.step")
    text = (tmp_path / "a.step").read_text()
    made = [run.curve for section in sections for run in section.runs]
    assert made.count("circle") > 20
    assert text.count(" = CIRCLE(") == made.count("circle")
