"""Solids inside out, mirrored or scaled by their location: by OCCT's transforms."""

from __future__ import annotations

import numpy as np
import pytest
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf
from OCP.TopLoc import TopLoc_Location

from tests.kernel import shapes
from v3dcad.kernel.part import solid_part
from v3dcad.kernel.shapes import compound, measured, volume

BRACKET = shapes.cut(shapes.box((0, 0, 0), (20, 10, 8)), shapes.cylinder(2, 8, (15, 4, 0)))


def mirror() -> gp_Trsf:
    motion = gp_Trsf()
    motion.SetMirror(gp_Ax2(gp_Pnt(3, 0, 0), gp_Dir(1, 1, 0)))
    return motion


def scale() -> gp_Trsf:
    motion = gp_Trsf()
    motion.SetScale(gp_Pnt(1, 2, 3), 2.5)
    return motion


def turn() -> gp_Trsf:
    motion = gp_Trsf()
    motion.SetRotation(gp_Ax2(gp_Pnt(1, 2, 3), gp_Dir(1, 1, 1)).Axis(), 0.7)
    return motion


@pytest.mark.parametrize("motion", [mirror(), scale(), turn(), mirror().Multiplied(scale())])
@pytest.mark.parametrize("nested", [False, True])
def test_a_solid_lies_where_its_location_says(motion: gp_Trsf, nested: bool) -> None:
    whole = compound([BRACKET]) if nested else BRACKET
    part = solid_part(whole.Moved(TopLoc_Location(motion), False), "a", "a")
    expected, centre = measured(BRepBuilderAPI_Transform(BRACKET, motion, True).Shape())
    found, at = measured(part.shape)
    assert found == pytest.approx(abs(expected))
    assert at == pytest.approx(centre)
    assert part.findings == ()
    low, high = part.bounds[:, 2]
    heights = np.linspace(low, high, 6)[1:-1]
    for section, z in zip(part.sections(heights), heights, strict=True):
        assert section.z == z
        assert section.rings


def test_a_solid_inside_out_is_turned() -> None:
    part = solid_part(BRACKET.Reversed(), "a", "a")
    assert part.findings == ("a solid was inside out: it was turned",)
    assert volume(part.shape) == pytest.approx(volume(BRACKET))
    (section,) = part.sections(np.array([4.0]))
    (same,) = solid_part(BRACKET, "a", "a").sections(np.array([4.0]))
    assert sorted(map(len, section.rings)) == sorted(map(len, same.rings))
