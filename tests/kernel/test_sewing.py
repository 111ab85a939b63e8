"""Loose faces as solids: cavities by nesting, bodies side by side; against OCCT's booleans."""

from __future__ import annotations

import numpy as np
import pytest
from OCP.TopoDS import TopoDS_Shape

from tests.kernel import shapes
from tests.kernel.exact import exact_area
from v3dcad.errors import KernelError
from v3dcad.kernel.part import SolidPart, solid_part
from v3dcad.kernel.shapes import FACE, SHELL, SOLID, compound, count, subshapes, volume

BRACKET = shapes.cut(shapes.box((0, 0, 0), (20, 10, 8)), shapes.cylinder(2, 8, (15, 4, 0)))
BLOCK = shapes.box((0, 0, 0), (30, 30, 30))
ROOM = shapes.box((5, 5, 5), (25, 25, 25))
CORE = shapes.sphere(6, (15, 15, 15))
PIT = shapes.torus(2, 1, (15, 15, 15))
BESIDE = shapes.cylinder(4, 12, (40, 5, 3))
ACROSS = shapes.box((20, 10, 10), (45, 20, 20))


def faces_of(*solids: TopoDS_Shape) -> TopoDS_Shape:
    """All faces of some shapes, loose."""
    return compound(face for solid in solids for face in subshapes(solid, FACE))


def part_of(shape: TopoDS_Shape) -> SolidPart:
    return solid_part(shape, "a", "a")


def section_area(part: SolidPart, z: float) -> float:
    (section,) = part.sections(np.array([z]))
    return exact_area(section)


def surfaces() -> list[TopoDS_Shape]:
    return [next(subshapes(BRACKET, SHELL)), faces_of(BRACKET)]


@pytest.mark.parametrize("shape", [*surfaces(), *(one.Reversed() for one in surfaces())])
def test_faces_that_enclose_are_sewn(shape: TopoDS_Shape) -> None:
    part = part_of(shape)
    assert part.findings == ("sewed 7 faces, which no solid had, to 1 solid",)
    assert volume(part.shape) == pytest.approx(volume(BRACKET))


@pytest.mark.parametrize("round_solid", [CORE, PIT])
def test_one_face_may_enclose_a_solid(round_solid: TopoDS_Shape) -> None:
    part = part_of(faces_of(round_solid))
    assert part.findings == ("sewed 1 face, which no solid had, to 1 solid",)
    assert volume(part.shape) == pytest.approx(volume(round_solid))


HOLLOW = shapes.cut(BLOCK, ROOM)
NESTS = {
    "a cavity": ((BLOCK, ROOM), HOLLOW, 1, 1),
    "a body in a cavity": ((CORE, BLOCK, ROOM), compound([HOLLOW, CORE]), 2, 1),
    "a cavity of that body": (
        (PIT, ROOM, CORE, BLOCK),
        compound([HOLLOW, shapes.cut(CORE, PIT)]),
        2,
        2,
    ),
    "bodies in a row": ((BLOCK, ROOM, BESIDE), compound([HOLLOW, BESIDE]), 2, 1),
    "bodies that cross": ((BLOCK, ACROSS), shapes.fuse(BLOCK, ACROSS), 2, 0),
}


@pytest.mark.parametrize("name", NESTS)
@pytest.mark.parametrize("inside_out", [False, True])
def test_nested_shells_are_bodies_and_cavities_by_turns(name: str, inside_out: bool) -> None:
    loose, expected, solids, cavities = NESTS[name]
    surface = faces_of(*loose)
    part = part_of(surface.Reversed() if inside_out else surface)
    found = volume(part.shape) - part.overlap
    assert found == pytest.approx(volume(expected), rel=1e-9)
    assert count(part.shape, SOLID) == solids
    told = {0: "", 1: " with 1 cavity", 2: " with 2 cavities"}[cavities]
    assert part.findings[0].endswith(f"to {solids} solid{'s' if solids > 1 else ''}{told}")
    for z in (7.0, 15.0, 27.0):
        plane = section_area(part_of(expected), z)
        assert section_area(part, z) == pytest.approx(plane, rel=1e-9)


def test_faces_without_an_inside_are_left_out_and_told() -> None:
    lid = compound(list(subshapes(shapes.box((60, 0, 0), (70, 10, 10)), FACE))[:4])
    part = part_of(faces_of(BLOCK, lid))
    assert volume(part.shape) == pytest.approx(volume(BLOCK))
    assert part.findings == (
        "sewed 6 faces, which no solid had, to 1 solid",
        "left out 4 faces without an inside",
    )


def test_faces_that_enclose_nothing_are_refused() -> None:
    side = next(subshapes(shapes.cylinder(2, 4), FACE))
    with pytest.raises(KernelError, match=r"only 1 face without an inside, with 2 open edges"):
        part_of(compound([side]))
