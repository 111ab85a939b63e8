"""Parts whose edges lie off their faces: sections that can be filled, and what they enclose."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
from OCP.BRep import BRep_Builder
from OCP.GeomAPI import GeomAPI_Interpolate
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_HArray1OfPnt
from OCP.TopoDS import TopoDS

import v3dcad
from tests.kernel import shapes
from tests.kernel.exact import breaks, closed_volume, exact_area, face_volume, integrated
from tests.parts import part_file, ring_area
from v3dcad.geometry.surface.gaps import MIN_GAP
from v3dcad.kernel.mesh import surface_mesh
from v3dcad.kernel.part import solid_part
from v3dcad.kernel.section import section_solids
from v3dcad.kernel.shapes import EDGE, bounds, subshapes
from v3dcad.model import Section

CTC_02 = "nist_ctc_02_asme1_rc.stp"


def dented_box(x: float, y: float, tolerance: float):
    """A box 4 × 6 × 10 whose edge at x = y = 0 is a curve that bends to (x, y) half way up."""
    box = shapes.box((0, 0, 0), (4, 6, 10))
    edges = map(TopoDS.Edge_s, subshapes(box, EDGE))
    edge = next(edge for edge in edges if np.allclose(bounds(edge)[:, :2], 0, atol=1e-6))
    array = TColgp_HArray1OfPnt(1, 3)
    for k, place in enumerate([(0, 0, 0), (x, y, 5), (0, 0, 10)], start=1):
        array.SetValue(k, gp_Pnt(*place))
    spline = GeomAPI_Interpolate(array, False, 1e-9)
    spline.Perform()
    builder = BRep_Builder()
    builder.UpdateEdge(edge, spline.Curve(), tolerance)
    builder.Range(edge, 0.0, spline.Curve().LastParameter())
    return box


@pytest.mark.parametrize(
    ("x", "y", "lost"),
    [
        (-0.05, -0.03, 0.0),  # outwards of both faces: a loop, cut off where they meet
        (0.05, 0.03, 0.05 * 0.03),  # inwards: a step from either face to the edge
        (-0.05, 0.0, 0.0),  # along one face and off the other: to and fro
        (0.0, -0.05, 0.0),
        (-0.05, 0.03, 0.0),
    ],
)
def test_straight_runs_lie_on_their_faces(x: float, y: float, lost: float) -> None:
    shape = dented_box(x, y, 0.06)
    (section,) = section_solids(shape, np.array([5.0]))
    (ring,) = section.rings
    assert shapely.LinearRing(ring).is_simple
    # To second order in the gap; leaning from edge to edge would lose (4 y + 6 x) / 2.
    assert ring_area(ring) == pytest.approx(24 - lost, abs=1e-12 + abs(x * y))
    at = 0
    for run in section.runs:
        assert run.curve == "line"
        assert run.start == at
        at = run.stop
    assert at == len(ring)
    long = [run for run in section.runs if np.ptp(ring[[run.start, run.stop % at]]) > 1]
    for run in long:
        assert np.ptp(ring[[run.start, run.stop % at]], axis=0).min() < 1e-12
    assert len({run.face for run in long}) == 4


def test_an_edge_that_hardly_lies_off_its_face_changes_nothing() -> None:
    (section,) = section_solids(dented_box(MIN_GAP / 4, MIN_GAP / 4, MIN_GAP / 2), np.array([5.0]))
    assert [run.curve for run in section.runs] == ["line"] * 4
    assert len(section.rings[0]) == 4


def test_gaps_are_reported_once_for_the_part() -> None:
    part = solid_part(dented_box(0.05, 0.03, 0.06), "a", "a")
    (finding,) = part.findings
    assert finding.startswith("1 edge may lie off the faces there by up to 0.06 mm, most near (0.0")
    assert solid_part(shapes.box((0, 0, 0), (1, 1, 1)), "a", "a").findings == ()
    small = solid_part(dented_box(0.004, 0.003, 0.005), "a", "a").findings
    assert not any("lie off" in finding for finding in small), "it is seen in no print"


def is_simple(section: Section) -> bool:
    rings = [shapely.linearrings(ring) for ring in section.rings]
    return bool(shapely.is_simple(shapely.multilinestrings(rings)))


@pytest.mark.parametrize(("gaps", "is_cut"), [(7.5, True), (8.5, False)])
def test_a_loop_is_cut_off_up_to_eight_gaps(gaps: float, is_cut: bool) -> None:
    """A longer one may be the part's own: it stays, for `fill` to refuse."""
    loop = 2 * (0.05 + 0.03)
    (section,) = section_solids(dented_box(-0.05, -0.03, loop / gaps), np.array([5.0]))
    assert is_simple(section) == is_cut


def test_a_wedge_with_a_gap_is_cut_where_its_faces_meet(samples: Path) -> None:
    part = v3dcad.place_on_bed(samples / "wedge.step")
    (finding,) = part.findings
    assert "lie off the faces there by up to 0.0358 mm" in finding
    for section in part.sections(np.linspace(0.0, 10.0, 21)):
        assert is_simple(section)
        (ring,) = section.rings
        assert ring_area(ring) == pytest.approx(20**2 * np.tan(np.radians(21)), rel=1e-9)
    structure = v3dcad.fill(part, layer_height=2)
    assert len(structure.layers) == 5


def test_a_real_part_with_gaps_can_be_filled() -> None:
    part = v3dcad.place_on_bed(part_file(CTC_02))
    assert any("lie off the faces there by up to 0.108 mm" in finding for finding in part.findings)
    heights = part.bounds[1, 2] * (np.arange(100) + 0.5) / 100
    for section in part.sections(np.append(30.0, heights[np.argsort(heights) > 7])):
        assert is_simple(section), section.z
        for number in range(len(section.rings)):
            runs = [run for run in section.runs if run.ring == number]
            stops = [run.stop for run in runs]
            assert [0, *stops] == [*(run.start for run in runs), len(section.rings[number])]
    structure = v3dcad.fill(part, layer_height=20)
    for layer in structure.layers:
        cells = layer.diagram.areas(len(layer.state.sites)).sum()
        assert cells == pytest.approx(sum(map(ring_area, layer.section.rings)), rel=1e-9)
    assert structure.findings() == list(part.findings)


@pytest.mark.long
def test_sections_enclose_the_volume_that_the_closed_faces_do() -> None:
    """Where faces have gaps GProp's volume depends on the point that its cones start from. With the
    gaps closed by strips it does not, and it is the sections'.
    """
    shape = shapes.nist("ctc_02_asme1_rc")
    mesh = surface_mesh(shape)
    found = integrated(
        breaks(shape, mesh),
        lambda planes: np.array([exact_area(s) for s in section_solids(mesh, planes, 2e-4)]),
        8,
    )
    low, high = bounds(shape)
    apices = [np.array([low[0], low[1], high[2]]), np.array([high[0], high[1], low[2]])]
    one, other = (face_volume(shape, apex) for apex in apices)
    assert abs(one - other) > 1e-5 * found
    for apex in apices:
        assert found == pytest.approx(closed_volume(shape, apex), rel=1e-7)
