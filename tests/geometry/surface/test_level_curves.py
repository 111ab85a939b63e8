"""Level curves end where their faces do, even where an edge bows into the face."""

from __future__ import annotations

import numpy as np
import pytest
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_NurbsConvert
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
from OCP.TopoDS import TopoDS_Shape

from tests.kernel import shapes
from tests.parts import part_file, ring_area
from v3dcad.geometry.section_union import faulty
from v3dcad.kernel.load import load_step
from v3dcad.kernel.section import section_solids
from v3dcad.kernel.shapes import area, bounds


def chamfered(half_angle: float, radius: float) -> TopoDS_Shape:
    """A nut's end with a flat chamfer: hyperbolas, which bow into the lying cone."""
    end = shapes.box((0, -6.35, -6.6), (1, 6.35, 6.6))
    wide = radius + np.tan(np.radians(half_angle))
    return shapes.common(end, shapes.cone(wide, radius, 1, along=(1, 0, 0)))


@pytest.mark.parametrize(
    ("half_angle", "radius", "splines"), [(80, 5.9, False), (70, 5.9, True), (80, 6.3, True)]
)
def test_a_chamfer_bounded_by_hyperbolas(half_angle: float, radius: float, splines: bool) -> None:
    """Mesh edges of the cone lie beyond the hyperbola there; a contour went to them and back."""
    shape = chamfered(half_angle, radius)
    cut = BRepBuilderAPI_NurbsConvert(shape).Shape() if splines else shape
    heights = np.linspace(*bounds(shape)[:, 2], 202)[1:-1]
    sections = list(section_solids(cut, heights))
    assert faulty(sections) == []
    for section in sections[::20]:
        plane = gp_Pln(gp_Pnt(0, 0, section.z), gp_Dir(0, 0, 1))
        level = BRepBuilderAPI_MakeFace(plane, -9, 9, -9, 9).Face()
        expected = area(shapes.common(level, shape))
        found = sum(map(ring_area, section.rings))
        assert found == pytest.approx(expected, abs=0.03)  # chords of 5 µm


@pytest.mark.slow
def test_11752() -> None:
    part = load_step(part_file("11752.stp"))
    heights = np.linspace(*part.bounds[:, 2], 202)[1:-1]
    assert faulty(list(section_solids(part.shape, heights))) == []
