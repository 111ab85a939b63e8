"""Wires of a layer: on the exact curves, sharing vertices, the same length as computed apart."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagrams import layer as layer_of_qhull
from occt import distinct, edges_of, is_valid, length_of, read_step
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.GeomAbs import GeomAbs_Circle, GeomAbs_Ellipse
from OCP.TopAbs import TopAbs_VERTEX
from OCP.TopoDS import TopoDS, TopoDS_Shape
from one_diagram import GRID, power_diagram

from v3dcad.formats.curve_step import step_text
from v3dcad.geometry.surface.contour_curves import Stretch, contours
from v3dcad.kernel.curves import run_curve
from v3dcad.kernel.wires import _arc, layer_curves, layer_wires
from v3dcad.model import CurveRun, Diagram, Floats, Layer, Placement, Section
from v3dcad.structure.thesis.sites import PlaneSites

PLACEMENT = Placement(np.eye(3), np.array([3.0, -7.0, 11.0]))


def around(count: int, rx: float, ry: float, turn: float = 0.0, way: int = 1) -> Floats:
    angle = way * np.linspace(0, 2 * np.pi, count, endpoint=False)
    flat = np.column_stack([rx * np.cos(angle), ry * np.sin(angle)])
    c, s = math.cos(turn), math.sin(turn)
    return flat @ np.array([[c, s], [-s, c]])


def layer_of(section: Section, sites: Floats) -> Layer:
    diagram = power_diagram(sites, np.zeros(len(sites)), section)
    zeros = np.zeros(len(sites))
    return Layer(0, section, PlaneSites(GRID, sites, zeros, zeros), diagram, 1.0)


def sites_in(radius: float, count: int = 25) -> Floats:
    return GRID.millimetres(
        GRID.snap(np.random.default_rng(5).uniform(-radius, radius, (count, 2)))
    )


def points_of(shape: TopoDS_Shape) -> Floats:
    """(v, 3) mm: the vertices of a shape, each once."""
    points = [BRep_Tool.Pnt_s(TopoDS.Vertex_s(corner)) for corner in distinct(shape, TopAbs_VERTEX)]
    return np.array([(p.X(), p.Y(), p.Z()) for p in points])


def read_back(layer: Layer, folder: Path) -> TopoDS_Shape:
    """A layer's curves as OCCT reads them from STEP."""
    drawing = layer_curves(layer, PLACEMENT, "it's ½ é 😀")
    pieces = step_text([drawing], "é", "AP242", "1970-01-01T00:00:00")
    (folder / "a.step").write_text("".join(pieces), encoding="ascii")
    ((name, shape),) = read_step(folder / "a.step").items()
    assert name == drawing.name
    return shape


def washer() -> Section:
    """A disc of radius 10 with a hole of radius 4, each ring in two runs of one circle."""
    outer, hole = around(96, 10, 10), around(48, 4, 4, way=-1)
    runs = [
        CurveRun(0, 0, 40, "circle", 0, (0.0, 0.0, 10.0)),
        CurveRun(0, 40, 96, "circle", 1, (0, 0, 10.0)),
    ]
    runs += [CurveRun(1, 0, 48, "circle", 2, (0.0, 0.0, 4.0))]
    return Section(2.0, (outer, hole), tuple(runs))


def test_contours_are_true_arcs_between_the_walls(tmp_path: Path) -> None:
    layer = layer_of(washer(), sites_in(10))
    for shape in (layer_wires(layer, PLACEMENT), read_back(layer, tmp_path)):
        assert is_valid(shape)
        arcs = [c for c in map(BRepAdaptor_Curve, edges_of(shape)) if c.GetType() == GeomAbs_Circle]
        swept = {10.0: 0.0, 4.0: 0.0}
        for arc in arcs:
            swept[round(arc.Circle().Radius(), 9)] += arc.LastParameter() - arc.FirstParameter()
            centre = arc.Circle().Location()
            assert (centre.X(), centre.Y(), centre.Z()) == pytest.approx((-3, 7, -9), abs=1e-12)
        assert swept == {10.0: pytest.approx(2 * math.pi), 4.0: pytest.approx(2 * math.pi)}
        hits = sum(len(contour) for contour in contours(layer.section, layer.diagram))
        assert len(arcs) == hits > 10
    walls = layer.diagram.lengths()[layer.diagram.inner()].sum()
    # Walls end on the arcs now, not on the chords: by less than the chords' sag.
    exact = length_of(layer_wires(layer, PLACEMENT))
    assert exact == pytest.approx(2 * math.pi * 14 + walls, abs=0.006 * hits)
    assert exact == pytest.approx(length_of(read_back(layer, tmp_path)), rel=1e-9)


def test_walls_end_on_the_arcs_and_keep_their_lines() -> None:
    layer = layer_of(washer(), sites_in(10))
    shape = layer_wires(layer, PLACEMENT)
    places = points_of(shape)[:, :2] + [3, -7]
    # Every vertex is an interior one of the diagram, or lies on a circle.
    radius = np.hypot(*places.T)
    on = np.isclose(radius, 10, atol=1e-9) | np.isclose(radius, 4, atol=1e-9)
    diagram = layer.diagram
    inner_ends = diagram.vertices[np.unique(diagram.edges[diagram.inner()])]
    rest = np.min(np.hypot(*(places[~on, None] - inner_ends).transpose(2, 0, 1)), axis=1)
    assert rest.max() < 1e-9
    # A wall's end has moved along the bisector of its two sites.
    sites = layer.state.sites[:, :2]
    distance = np.sort(np.hypot(*(places[on, None] - sites).transpose(2, 0, 1)), axis=1)
    shared = np.isclose(distance[:, 0], distance[:, 1], atol=1e-9)
    assert shared.sum() >= on.sum() - 2  # the seam's vertices alone are no walls' ends


def test_a_wall_that_ends_where_runs_meet_stays_there() -> None:
    """A half disc whose corners lie 0.01 mm off its circle, as in a part with gaps."""
    angle = np.linspace(0, np.pi, 25)
    ring = 10 * np.column_stack([np.cos(angle), np.sin(angle)])
    runs = CurveRun(0, 0, 24, "circle", 0, (0.0, 0.0, 10.01)), CurveRun(0, 24, 25, "line", 1, ())
    number = np.arange(25)
    boundary = np.column_stack([number, (number + 1) % 25])
    owners = np.column_stack([np.full(25, -1), np.where((number >= 8) & (number < 24), 1, 0)])
    wall = np.array([[24, 8]])  # from the corner where the circle ends to a point of the circle
    diagram = Diagram(ring, np.vstack([boundary, wall]), np.vstack([owners, [[0, 1]]]), wall * 0)
    zeros = np.zeros(2)
    state = PlaneSites(GRID, np.zeros((2, 2)), zeros, zeros)
    layer = Layer(0, Section(2.0, (ring,), runs), state, diagram, 1.0)
    shape = layer_wires(layer, Placement.none())
    points = [BRep_Tool.Pnt_s(TopoDS.Vertex_s(corner)) for corner in distinct(shape, TopAbs_VERTEX)]
    found = np.array([(point.X(), point.Y()) for point in points])
    assert np.hypot(*(found - ring[0]).T).min() < 1e-12
    assert np.hypot(*(found - ring[24]).T).min() < 1e-12
    assert np.sort(np.hypot(*found.T)) == pytest.approx([10, 10, 10.01], abs=1e-9)


def test_an_ellipse_and_a_spline() -> None:
    ring = around(300, 12, 5, turn=0.4)
    parameters = (0.0, 0.0, 12 * math.cos(0.4), 12 * math.sin(0.4), 5 / 12)
    exact = length_of(layer_wires(layer_of(Section(1.0, (ring,), ()), np.zeros((1, 2))), PLACEMENT))
    lengths = {}
    for curve, known in (("ellipse", parameters), ("points", ())):
        section = Section(1.0, (ring,), (CurveRun(0, 0, 300, curve, 0, known),))
        layer = layer_of(section, sites_in(9, 12))
        shape = layer_wires(layer, PLACEMENT)
        assert is_valid(shape)
        outline = [BRepAdaptor_Curve(edge) for edge in edges_of(shape)]
        kinds = [curve.GetType() == GeomAbs_Ellipse for curve in outline]
        assert any(kinds) == (curve == "ellipse")
        walls = layer.diagram.lengths()[layer.diagram.inner()].sum()
        lengths[curve] = length_of(shape) - walls
    assert lengths["points"] == pytest.approx(lengths["ellipse"], rel=1e-6)
    assert lengths["ellipse"] == pytest.approx(exact, rel=2e-4)


def test_a_circle_no_wall_ends_on_is_one_edge() -> None:
    section = replace(washer(), rings=(around(96, 10, 10),), runs=washer().runs[:1])
    section = replace(section, runs=(CurveRun(0, 0, 96, "circle", 0, (0.0, 0.0, 10.0)),))
    shape = layer_wires(layer_of(section, np.zeros((1, 2))), PLACEMENT)
    assert is_valid(shape)
    assert len(edges_of(shape)) == 1
    assert length_of(shape) == pytest.approx(20 * math.pi)


def test_triangles_have_straight_contours() -> None:
    ring = around(7, 10, 10)
    layer = layer_of(Section(1.0, (ring,)), sites_in(8, 9))
    shape = layer_wires(layer, PLACEMENT)
    assert is_valid(shape)
    assert length_of(shape) == pytest.approx(layer.diagram.lengths().sum(), rel=1e-12)
    assert len(edges_of(shape)) == len(layer.diagram.edges)


def test_a_wall_that_ends_where_two_curves_meet_leaves_their_corner_alone() -> None:
    """Three quarters of a disc whose circle is 0.0005 mm off the corner, as where edges stand off.

    The wall x + y = -10 ends at (0, -10), where the circle ends and a line begins.
    """
    angle = np.radians(np.linspace(0, 270, 73))
    arc = 10 * np.column_stack([np.cos(angle), np.sin(angle)])
    ring = np.vstack([arc, [[0.0, 0.0]]]).round(9)
    runs = (
        CurveRun(0, 0, 72, "circle", 0, (0.0, 0.0, 10.0005)),
        CurveRun(0, 72, 74, "line", 1, ()),
    )
    layer = layer_of_qhull(np.array([[-4.0, -2], [-8, -6]]), Section(1.0, (ring,), runs))
    (wall,) = layer.diagram.vertices[layer.diagram.edges[layer.diagram.inner()]]
    assert [0, -10] in wall.tolist()
    points = points_of(layer_wires(layer, Placement.none()))
    assert np.hypot(*(points[:, :2] - [0, -10]).T).min() < 1e-9


@pytest.mark.parametrize(("stop", "curved"), [(0.9424, False), (0.95, True), (4.0, True)])
def test_walls_that_pass_each_other_on_a_circle_leave_no_circle_behind(
    stop: float, curved: bool
) -> None:
    """The second of two walls ends 7 µm before the first, or after it."""
    angles = np.linspace(0.9431, stop, 2 if stop < 1 else 40)
    points = np.column_stack([10 * np.cos(angles), 10 * np.sin(angles), np.zeros(len(angles))])
    ring = 10 * np.column_stack([f(np.linspace(0, 6, 60)) for f in (np.cos, np.sin)])
    run = CurveRun(0, 0, 59, "circle", 0, (0.0, 0.0, 10.0))
    curve = run_curve(run, Section(0.0, (ring,), (run,)))
    arc = _arc(Stretch(list(range(len(angles))), run), curve, points)
    assert (arc.curve is not None) == curved
    assert arc.last - arc.first == pytest.approx(stop - 0.9431 if curved else 0)
