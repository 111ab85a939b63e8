"""Solids whose every face is a NURBS, as other programs export them, against the plain ones."""

from __future__ import annotations

import numpy as np
import pytest
from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
from OCP.TopoDS import TopoDS_Shape

import v3dcad
from tests.kernel import shapes
from tests.parts import ring_area
from v3dcad.kernel.part import SolidPart, solid_part

TILTED = (1.0, 2.0, 3.0)
SOLIDS = {
    "box": shapes.box((0, 0, 0), (10, 20, 30)),
    "cylinder": shapes.cylinder(5, 20),
    "lying cylinder": shapes.cylinder(5, 20, along=(1, 0, 0)),
    "tilted cylinder": shapes.cylinder(5, 20, along=TILTED),
    "cone": shapes.cone(8, 3, 20),
    "lying cone": shapes.cone(8, 3, 20, along=(0, 1, 0)),
    "sphere": shapes.sphere(10),
    "tilted sphere": shapes.sphere(10, along=TILTED),
    "torus": shapes.torus(12, 4),
    "standing torus": shapes.torus(12, 4, along=(1, 0, 0)),
    "tilted torus": shapes.torus(12, 4, along=TILTED),
    "bar with a boss": shapes.fuse(
        shapes.box((0, 0, 0), (40, 8, 6)), shapes.cylinder(4, 20, (20, 4, 0))
    ),
}


def converted(shape: TopoDS_Shape) -> SolidPart:
    return solid_part(BRepBuilderAPI_NurbsConvert(shape, True).Shape(), "nurbs", "nurbs")


def areas(part: SolidPart, shares: list[float]) -> list[float]:
    low, high = part.bounds[:, 2]
    sections = part.sections(low + (high - low) * np.array(shares), 1e-4)
    return [sum(map(ring_area, section.rings)) for section in sections]


@pytest.mark.parametrize("name", SOLIDS)
def test_sections_of_a_solid_as_nurbs_have_its_areas(name: str) -> None:
    shares = [0.1, 0.21, 0.37, 0.5, 0.63, 0.77, 0.9]
    plain = areas(solid_part(SOLIDS[name], "plain", "plain"), shares)
    assert areas(converted(SOLIDS[name]), shares) == pytest.approx(plain, rel=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["ftc_07_asme1_rd", "ftc_08_asme1_rc", "ftc_11_asme1_rb"])
def test_edges_along_an_inflection_are_not_split_without_end(name: str) -> None:
    """Of a tilted hole in the first OCCT's mesh has slivers there, once it stands on the bed."""
    shape = shapes.nist(name)
    shares = [1 / 16, 5 / 16, 11 / 16]
    plain = v3dcad.place_on_bed(solid_part(shape, "plain", "plain"))
    found = v3dcad.place_on_bed(converted(shape))
    assert isinstance(plain, SolidPart)
    assert isinstance(found, SolidPart)
    assert areas(found, shares) == pytest.approx(areas(plain, shares), rel=1e-4)
