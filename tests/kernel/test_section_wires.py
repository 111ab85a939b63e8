"""Wires of a section: closed, oriented, exact."""

from __future__ import annotations

import numpy as np
import pytest
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeVertex
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepGProp import BRepGProp
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.TopoDS import TopoDS

from tests.kernel import shapes
from tests.kernel.exact import exact_area
from v3dcad.kernel.section import section_solids
from v3dcad.kernel.section_wires import section_wires
from v3dcad.kernel.shapes import EDGE, FACE, compound, subshapes
from v3dcad.model import CurveRun, Placement, Section


def wire_area(wire, z: float) -> float:
    """Signed: a wire that goes clockwise bounds what is outside it."""
    face = BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1)), wire, False).Face()
    properties = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, properties, 1e-10)
    return properties.Mass()


SHAPES = {
    "drilled box": lambda: shapes.cut(
        shapes.box((0, 0, 0), (30, 20, 10)), shapes.cylinder(5, 50, (10, 10, -5), (0.2, 0.1, 1))
    ),
    "tilted torus": lambda: shapes.torus(20, 7, along=(0.3, 0.2, 1)),
    "sphere": lambda: shapes.sphere(8, along=(1, 0, 0)),
    "tilted cone": lambda: shapes.cone(10, 4, 20, along=(0.2, 0, 1)),
    "loft": shapes.loft,
}


@pytest.mark.parametrize("name", SHAPES)
def test_wires_are_closed_valid_and_have_the_sections_area(name: str):
    shape = SHAPES[name]()
    for section in section_solids(shape, np.array([1.0, 3.3, 5.2])):
        wires = section_wires(section)
        assert len(wires) == len(section.rings) > 0
        assert all(
            BRep_Tool.IsClosed_s(wire) and BRepCheck_Analyzer(wire).IsValid() for wire in wires
        )
        area = sum(wire_area(wire, section.z) for wire in wires)
        # Splines follow the true section more closely than the chords do.
        exact = all(run.curve != "points" for run in section.runs)
        assert area == pytest.approx(exact_area(section), rel=1e-9 if exact else 2e-3)


@pytest.mark.parametrize("name", ["tilted torus", "loft"])
def test_splines_stay_within_the_chord_tolerance_of_the_true_faces(name: str):
    shape = SHAPES[name]()
    skin = compound(subshapes(shape, FACE))
    (section,) = section_solids(shape, np.array([4.4]))
    for edge in subshapes(compound(section_wires(section)), EDGE):
        curve = BRepAdaptor_Curve(TopoDS.Edge_s(edge))
        for t in np.linspace(curve.FirstParameter(), curve.LastParameter(), 57):
            vertex = BRepBuilderAPI_MakeVertex(curve.Value(t)).Vertex()
            assert BRepExtrema_DistShapeShape(vertex, skin).Value() < 0.005


def test_exact_curves_are_circles_and_ellipses():
    (section,) = section_solids(SHAPES["drilled box"](), np.array([5.0]))
    kinds = [
        BRepAdaptor_Curve(TopoDS.Edge_s(edge)).GetType().name
        for edge in subshapes(compound(section_wires(section)), EDGE)
    ]
    assert sorted(kinds) == ["GeomAbs_Ellipse"] + 4 * ["GeomAbs_Line"]


def test_a_section_of_triangles_gives_polygons_and_a_placement_takes_them_home():
    ring = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]])
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    placement = Placement(turn, np.array([10.0, 0.0, 2.0]))
    (wire,) = section_wires(Section(z=5.0, rings=(ring,)), placement)
    corners = {
        tuple(np.round(BRepAdaptor_Curve(TopoDS.Edge_s(edge)).Value(0.0).Coord(), 9))
        for edge in subshapes(wire, EDGE)
    }
    there = placement.to_source(np.column_stack([ring, [5.0] * 3]))
    assert corners == {tuple(np.round(point, 9)) for point in there.tolist()}
    assert wire_area(wire, 3.0) == pytest.approx(6.0)


def test_points_that_occt_takes_for_one_do_not_stop_a_spline():
    angle = np.array([0, 0.5, 0.5 + 1e-9, 1, 2, 3, 4, 5, 6, 2 * np.pi - 1e-9])
    ring = 3 * np.column_stack([np.cos(angle), np.sin(angle)])
    for stop in (10, 9):
        runs = [CurveRun(0, 0, stop, "points", 0, ())]
        runs += [CurveRun(0, 9, 10, "line", 1, ())] if stop == 9 else []
        (wire,) = section_wires(Section(1.0, (ring,), tuple(runs)))
        assert wire_area(wire, 1.0) == pytest.approx(9 * np.pi, rel=0.01)
