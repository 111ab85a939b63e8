"""Laws of the exact slicer, against OCCT's volumes, distances and its own section."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.gp import gp_Pnt
from OCP.TopAbs import TopAbs_VERTEX
from OCP.TopoDS import TopoDS, TopoDS_Shell, TopoDS_Solid

from tests.kernel import shapes
from tests.kernel.exact import breaks, exact_area, integrated, volume
from tests.occt_section import section as occt_section
from tests.parts import ring_area
from v3dcad.errors import GeometryError, KernelError, SettingError
from v3dcad.geometry.surface.mesh import turning_points
from v3dcad.kernel import mesh as kernel_mesh
from v3dcad.kernel.load import load_step
from v3dcad.kernel.mesh import surface_mesh
from v3dcad.kernel.section import section_solids
from v3dcad.kernel.shapes import EDGE, FACE, subshapes
from v3dcad.model import Section

pytestmark = pytest.mark.slow

ROOT3 = np.sqrt(3)


def sections(shape, *heights: float, tolerance: float = 0.005) -> list[Section]:
    return list(section_solids(shape, np.array(heights, float), tolerance))


def area_at(shape, height: float) -> float:
    (section,) = sections(shape, height)
    return exact_area(section)


def middles(mesh, count: int):
    low, high = mesh.nodes[:, 2].min(), mesh.nodes[:, 2].max()
    return low + (high - low) * (np.arange(count) + 0.5) / count


def assert_whole(section: Section) -> None:
    """Runs cover every ring without gap, rings have area and the outermost are outer."""
    at = {}
    for run in section.runs:
        assert at.get(run.ring, 0) == run.start < run.stop
        at[run.ring] = run.stop
    assert at == {number: len(ring) for number, ring in enumerate(section.rings)}
    for ring in section.rings:
        assert np.isfinite(ring).all()
        assert np.all(np.any(ring != np.roll(ring, 1, axis=0), axis=1))


def distance_to_face(point, z: float, face) -> float:
    vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*point.tolist(), z)).Vertex()
    return BRepExtrema_DistShapeShape(vertex, face).Value()


def tolerance_of(face) -> float:
    """What OCCT itself does not claim to know better of a face's boundary."""
    stored = [BRep_Tool.Tolerance_s(TopoDS.Edge_s(edge)) for edge in subshapes(face, EDGE)]
    stored += [BRep_Tool.Tolerance_s(TopoDS.Vertex_s(v)) for v in subshapes(face, TopAbs_VERTEX)]
    return max(stored)


LARGEST = "ctc_02_asme1_rc"

PLANES = [
    pytest.param(name, planes, marks=pytest.mark.long if name == LARGEST and planes > 40 else ())
    for name in shapes.NIST
    for planes in ([40, 200] if name == LARGEST else [200])
]


@pytest.mark.parametrize(("name", "planes"), PLANES)
def test_nist_parts(name: str, planes: int, monkeypatch: pytest.MonkeyPatch):
    shape = shapes.nist(name)
    mesh = surface_mesh(shape)
    heights = middles(mesh, planes)
    found = list(section_solids(mesh, heights))
    for section in found:
        assert_whole(section)
        assert section.rings
    # As many loops as with a finer mesh: none is missed.
    monkeypatch.setattr(kernel_mesh, "DEFLECTION", kernel_mesh.DEFLECTION / 4)
    finer = section_solids(shape, heights)
    for coarse, fine in zip(found, finer, strict=True):
        assert len(coarse.rings) == len(fine.rings)
        assert exact_area(coarse) == pytest.approx(exact_area(fine), rel=1e-4)
    faces = list(subshapes(shape, FACE))
    random = np.random.default_rng(0)
    for k in random.choice(len(found), 12, replace=False):
        section = found[k]
        for j in random.choice(len(section.runs), 6):
            run = section.runs[j]
            ring = section.rings[run.ring]
            face = faces[run.face]
            points = ring[np.arange(run.start, run.stop + 1) % len(ring)]
            for point in (points[0], points[len(points) // 2]):
                away = distance_to_face(point, section.z, face)
                assert away <= max(1e-9, tolerance_of(face))


@pytest.mark.parametrize("name", [name for name in shapes.NIST if name != LARGEST])
def test_nist_volumes(name: str):
    shape = shapes.nist(name)
    mesh = surface_mesh(shape)
    found = integrated(
        breaks(shape, mesh),
        lambda heights: np.array(
            [exact_area(section) for section in section_solids(mesh, heights, 2e-4)]
        ),
        8,
    )
    # What holds of CTC-02, whose faces have gaps, is in test_gaps.py.
    assert found == pytest.approx(volume(shape), rel=1e-6)


CURVED = {
    "tilted torus": lambda: shapes.torus(20, 7, along=(0.3, 0.2, 1)),
    "lying torus": lambda: shapes.torus(20, 7, along=(1, 0, 0)),
    "upright torus": lambda: shapes.torus(20, 7),
    "hardly tilted torus": lambda: shapes.torus(20, 7, along=(1e-5, 0, 1)),
    "sphere": lambda: shapes.sphere(20),
    "tilted sphere": lambda: shapes.sphere(20, along=(0.3, 0.5, 0.2)),
    "lying cylinder": lambda: shapes.cylinder(10, 30, along=(1, 0, 0)),
    "leaning cone": lambda: shapes.cone(10, 0, 30, along=(0.5, 0.1, 1)),
    "lying cone": lambda: shapes.cone(10, 0, 30, along=(1, 0, 0)),
    "loft": shapes.loft,
}


@pytest.mark.parametrize("name", CURVED)
def test_curved_solids(name: str):
    shape = CURVED[name]()
    mesh = surface_mesh(shape)
    turns = turning_points(
        mesh.coefficients, mesh.surfaces, mesh.edge_faces, mesh.edge_curves, mesh.edge_spans
    )
    assert not turns.any()
    heights = middles(mesh, 200)
    skin = list(subshapes(shape, FACE))
    for section in section_solids(mesh, heights):
        assert_whole(section)
        assert section.rings
    section = next(section_solids(mesh, heights[[137]]))
    for run in section.runs:
        ring = section.rings[run.ring]
        for k in range(run.start, run.stop, 5):
            assert distance_to_face(ring[k], section.z, skin[run.face]) < 1e-9
        # Chords stay within the tolerance of the true faces.
        for k in range(run.start, run.stop, 3):
            middle = (ring[k] + ring[(k + 1) % len(ring)]) / 2
            if run.curve != "line":
                assert distance_to_face(middle, section.z, skin[run.face]) < 0.0051
    found = integrated(
        breaks(shape, mesh),
        lambda planes: np.array([exact_area(s) for s in section_solids(mesh, planes, 2e-6)]),
        16,
    )
    assert found == pytest.approx(volume(shape), rel=1e-6)


@pytest.mark.parametrize("name", [*CURVED, "cone.step", "bracket.step", "islands.step"])
def test_a_finer_mesh_shows_no_more_loops(
    name: str, samples: Path, monkeypatch: pytest.MonkeyPatch
):
    shape = CURVED[name]() if name in CURVED else load_step(samples / name).shape
    mesh = surface_mesh(shape)
    heights = middles(mesh, 100)
    monkeypatch.setattr(kernel_mesh, "DEFLECTION", kernel_mesh.DEFLECTION / 4)
    monkeypatch.setattr(kernel_mesh, "ANGLE", kernel_mesh.ANGLE / 2)
    finer = surface_mesh(shape)
    assert name not in CURVED or len(finer.nodes) > len(mesh.nodes)
    for coarse, fine in zip(
        section_solids(mesh, heights), section_solids(finer, heights), strict=True
    ):
        assert_whole(coarse)
        assert coarse.rings
        assert len(coarse.rings) == len(fine.rings)
        # Each within the chord tolerance of the true contour.
        around = sum(float(np.hypot(*(r - np.roll(r, 1, axis=0)).T).sum()) for r in fine.rings)
        assert exact_area(coarse) == pytest.approx(exact_area(fine), abs=2 * 0.005 * around)


@pytest.mark.parametrize("away", [1e-2, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("along", [(0, 0, 1), (0.3, 0.2, 1), (1, 0, 0)])
def test_a_crest_is_found_however_thin(along, away: float):
    shape = shapes.torus(20, 7, along=along)
    top = surface_mesh(shape).nodes[:, 2].max()
    tilt = along[2] / np.linalg.norm(along)
    assert top == pytest.approx(7 + 20 * np.sqrt(1 - tilt**2), abs=1e-12)
    (section,) = sections(shape, top - away)
    if along == (0, 0, 1):
        half = np.sqrt(49 - (7 - away) ** 2)
        assert exact_area(section) == pytest.approx(np.pi * 80 * half, rel=1e-6)
        assert len(section.rings) == 2
    else:
        assert len(section.rings) == 1
        assert section.rings[0].shape[0] > 2


def test_degenerate_planes_are_the_limit_from_below_and_at_the_base_from_above():
    cone = shapes.cone(20, 15, 30)
    assert area_at(cone, 0.0) == pytest.approx(400 * np.pi)
    assert area_at(cone, 30.0) == pytest.approx(225 * np.pi)
    assert area_at(cone, 1e-7) == pytest.approx(400 * np.pi)
    assert area_at(cone, -1e-8) == pytest.approx(400 * np.pi)
    assert area_at(cone, -1e-5) == 0
    upright = shapes.torus(20, 7)
    assert area_at(upright, 7.0) == 0
    assert area_at(upright, -7.0) == 0
    assert area_at(upright, 0.0) == pytest.approx(np.pi * (27**2 - 13**2))
    assert area_at(upright, 3.0) == pytest.approx(np.pi * 80 * np.sqrt(40))
    lying = shapes.torus(20, 7, along=(1, 0, 0))
    assert area_at(lying, 27.0) == 0
    (saddle,) = sections(lying, 13.0)
    assert len(saddle.rings) == 2
    assert [len(section.rings) for section in sections(lying, 13 - 1e-3, 13 + 1e-3)] == [2, 1]
    ball = shapes.sphere(20)
    assert area_at(ball, 20.0) == 0
    assert area_at(ball, -20.0) == 0
    assert area_at(ball, 0.0) == pytest.approx(400 * np.pi)
    step = shapes.fuse(
        shapes.box((-20, -20, 0), (20, 20, 10)), shapes.box((-10, -10, 10), (10, 10, 20))
    )
    assert area_at(step, 10.0) == pytest.approx(1600)
    assert area_at(step, 10.0 + 1e-7) == pytest.approx(400)
    log = shapes.cylinder(10, 30, along=(1, 0, 0))
    assert area_at(log, 10.0) == 0
    assert area_at(log, -10.0) == 0
    assert area_at(log, 0.0) == pytest.approx(600)
    assert area_at(log, 10 - 1e-6) == pytest.approx(60 * np.sqrt(2e-5), rel=1e-5)
    shelf = shapes.cut(shapes.box((0, 0, 0), (10, 10, 10)), shapes.box((5, -1, 3), (11, 11, 6)))
    assert area_at(shelf, 3.0) == pytest.approx(100)
    assert area_at(shelf, 6.0) == pytest.approx(50)
    # A lens: at the cylinder's very top only two lines would be left of the chords.
    lens = shapes.common(shapes.cylinder(10, 5), shapes.box((9, -20, 0), (20, 20, 5)))
    half = np.arccos(0.9)
    true = 100 * (half - np.sin(half) * np.cos(half))
    assert [area_at(lens, z) for z in (0.0, 2.5, 5.0)] == pytest.approx([true] * 3)


def test_runs_are_exact_curves():
    (disc,) = sections(shapes.cylinder(10, 30), 3.0)
    assert [(run.curve, run.parameters) for run in disc.runs] == [("circle", (0.0, 0.0, 10.0))]
    lean = np.deg2rad(30)
    (slant,) = sections(
        shapes.cylinder(10, 300, (0, 0, -150), (np.sin(lean), 0, np.cos(lean))), 0.0
    )
    (run,) = slant.runs
    assert run.curve == "ellipse"
    _, _, major_x, major_y, ratio = run.parameters
    assert np.hypot(major_x, major_y) == pytest.approx(20 / ROOT3)
    assert ratio == pytest.approx(ROOT3 / 2)
    assert abs(major_y) < 1e-12
    (block,) = sections(shapes.box((0, 0, 0), (3, 2, 1)), 0.5)
    assert [run.curve for run in block.runs] == ["line"] * 4
    assert [len(ring) for ring in block.rings] == [4]


def test_ellipses_of_a_leaning_cone_lie_on_it():
    shape = shapes.cone(10, 2, 20, (3, 4, 0), (0.3, 0.2, 1))
    side = next(subshapes(shape, FACE))
    (section,) = sections(shape, 8.0)
    (run,) = section.runs
    assert run.curve == "ellipse"
    for point in section.rings[0]:
        assert distance_to_face(point, 8.0, side) < 1e-11


def primitive(random):
    size = random.uniform(4, 10, 3)
    at = tuple(random.uniform(-5, 5, 3))
    along = tuple(random.normal(size=3))
    kind = random.integers(5)
    if kind == 0:
        return shapes.box(at, tuple(np.array(at) + size))
    if kind == 1:
        return shapes.cylinder(size[0] / 2, size[1] * 1.5, at, along)
    if kind == 2:
        return shapes.cone(size[0] / 2, size[2] / 4, size[1], at, along)
    if kind == 3:
        return shapes.sphere(size[0] / 1.5, at, along)
    return shapes.torus(size[0], size[1] / 4, at, along)


@given(st.integers(0, 10**6))
@settings(max_examples=6, deadline=None, derandomize=True)
def test_random_booleans_have_occts_volume(seed: int):
    random = np.random.default_rng(seed)
    shape = primitive(random)
    for _ in range(3):
        operation = (shapes.fuse, shapes.cut, shapes.common)[random.choice(3, p=[0.5, 0.4, 0.1])]
        changed = operation(shape, primitive(random))
        if volume(changed) > 1:
            shape = changed
    mesh = surface_mesh(shape)
    for section in section_solids(mesh, middles(mesh, 60)):
        assert_whole(section)
    found = integrated(
        breaks(shape, mesh),
        lambda planes: np.array([exact_area(s) for s in section_solids(mesh, planes, 2e-5)]),
        16,
    )
    # OCCT's intersection curves are only as good as their stored tolerance.
    loose = max(map(tolerance_of, subshapes(shape, FACE)))
    assert found == pytest.approx(volume(shape), rel=max(1e-5, loose))


@pytest.mark.parametrize("name", ["loft", "tilted torus"])
def test_areas_agree_with_occts_own_section(name: str):
    shape = CURVED[name]()
    for z in (2.1, 5.3):
        own, occts = sections(shape, z)[0], occt_section(shape, z, False)
        assert len(own.rings) == len(occts.rings)
        assert exact_area(own) == pytest.approx(sum(map(ring_area, occts.rings)), rel=2e-3)


@pytest.fixture
def processes() -> Iterator[Executor]:
    """One more process; skipped where the system has no semaphores for it."""
    try:
        pool = ProcessPoolExecutor(1, get_context("spawn"))
    except OSError as error:
        pytest.skip(f"needs shared memory ({error}): mount -t tmpfs -o mode=1777 tmpfs /dev/shm")
    with pool:
        yield pool


@pytest.fixture
def threads() -> Iterator[Executor]:
    with ThreadPoolExecutor(2) as pool:
        yield pool


@pytest.mark.parametrize("kind", ["threads", "processes"])
def test_an_executor_changes_nothing(kind: str, request: pytest.FixtureRequest):
    mesh = surface_mesh(CURVED["tilted torus"]())
    heights = middles(mesh, 200)
    found = section_solids(mesh, heights, executor=request.getfixturevalue(kind))
    assert_same(list(section_solids(mesh, heights)), list(found))


def assert_same(one: list[Section], other: list[Section]) -> None:
    for a, b in zip(one, other, strict=True):
        assert a.z == b.z
        assert a.runs == b.runs
        assert all(map(np.array_equal, a.rings, b.rings))
        assert len(a.rings) == len(b.rings)


def test_the_shape_keeps_its_own_triangulation():
    shape = shapes.sphere(5)
    surface_mesh(shape)
    for face in subshapes(shape, FACE):
        assert BRep_Tool.Triangulation_s(TopoDS.Face_s(face), face.Location()) is None


def test_what_is_refused():
    block = shapes.box((0, 0, 0), (1, 1, 1))
    with pytest.raises(SettingError, match="chord_tolerance"):
        sections(block, 0.5, tolerance=0.0)
    with pytest.raises(GeometryError, match="ascending"):
        sections(block, 0.5, 0.4)
    builder, shell, solid = BRep_Builder(), TopoDS_Shell(), TopoDS_Solid()
    builder.MakeShell(shell)
    for face in list(subshapes(block, FACE))[1:]:
        builder.Add(shell, face)
    builder.MakeSolid(solid)
    builder.Add(solid, shell)
    with pytest.raises(KernelError, match=r"not closed, .* along 4 stretches"):
        surface_mesh(solid)
    with pytest.raises(KernelError, match="no face"):
        surface_mesh(shapes.compound([]))


def test_a_tip_at_which_chords_cross_is_meshed_finer() -> None:
    shape = shapes.horn()
    assert area_at(shape, 30) == pytest.approx(volume(shape) / 60, rel=1e-9)
