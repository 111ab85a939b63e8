"""Parts as other programs make them, with their faults: read, and filled, as what they are.

Right volumes are those of OCCT's booleans, trimesh, manifold3d or a formula.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
import trimesh
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape

import v3dcad
from tests.geometry.test_mesh_overlap import eight, piece
from tests.kernel import shapes
from v3dcad.kernel.shapes import FACE, compound, subshapes, volume
from v3dcad.model import Part

Meshed = tuple[Any, Any]

PLATE = shapes.cut(shapes.box((0, 0, 0), (30, 30, 6)), shapes.cylinder(5, 6, (15, 15, 0)))
PIN = shapes.cylinder(5, 16, (15, 15, -5))
BLOCK = shapes.box((0, 0, 0), (20, 20, 10))
BOSS = shapes.cylinder(6, 20, (20, 10, -5))
CORE = shapes.box((5, 5, 3), (15, 15, 7))
BRACKET = shapes.cut(shapes.box((0, 0, 0), (20, 10, 8)), shapes.cylinder(2, 8, (15, 4, 0)))


def faces(*solids: TopoDS_Shape) -> TopoDS_Shape:
    return compound(face for solid in solids for face in subshapes(solid, FACE))


def moved(motion: str) -> TopoDS_Shape:
    """The bracket, mirrored or twice as large by its location alone."""
    change = gp_Trsf()
    if motion == "mirrored":
        change.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)))
    else:
        change.SetScale(gp_Pnt(0, 0, 0), 2)
    assert abs(volume(BRepBuilderAPI_Transform(BRACKET, change, True).Shape())) > 0
    return BRACKET.Moved(TopLoc_Location(change), False)


def ball() -> trimesh.Trimesh:
    return trimesh.creation.icosphere(subdivisions=2, radius=15)


def apart(corners: Any) -> Meshed:
    """Triangles (t, 3, 3) each with corners of its own, as STL has them."""
    return np.reshape(corners, (-1, 3)).astype(float), np.arange(corners.size // 3).reshape(-1, 3)


def last_bits() -> Meshed:
    corners = ball().triangles.astype(np.float32)
    up = np.random.default_rng(0).random(corners.shape) < 0.3
    return apart(np.where(up, np.nextafter(corners, np.float32(1e9)), corners))


def noisy() -> Meshed:
    corners = ball().triangles
    return apart(corners + np.random.default_rng(0).normal(0, 1e-6, corners.shape))


def sharing_a_face() -> Meshed:
    one = trimesh.creation.box(bounds=[[0, 0, 0], [20, 20, 10]])
    other = one.copy()
    other.vertices = other.vertices * [-1, 1, 1] + [40, 0, 0]
    other.invert()
    whole = trimesh.util.concatenate([one, other])
    return whole.vertices, whole.faces


def through_itself() -> Meshed:
    tube = eight()
    return tube.vertices, tube.triangles


def quarters() -> float:
    """The volume of the tube by manifold3d: the union of pieces that do not cross themselves."""
    from manifold3d import Manifold, OpType

    pieces = [piece(first, first + 15) for first in range(0, 60, 15)]
    return float(Manifold.batch_boolean(pieces, OpType.Add).volume())


@dataclass(frozen=True)
class Fault:
    """A part with a fault, its right volume, mm³, and what is told of it."""

    make: Callable[[], Any]
    right: Callable[[], float]
    told: tuple[str, ...] = ()


FAULTS = {
    "a pin in its hole": Fault(
        lambda: compound([PLATE, PIN]), lambda: volume(shapes.fuse(PLATE, PIN))
    ),
    "bodies that overlap": Fault(
        lambda: compound([BLOCK, BOSS]),
        lambda: volume(shapes.fuse(BLOCK, BOSS)),
        ("solids 1 and 2 overlap by 565.5 mm³",),
    ),
    "the same body twice": Fault(
        lambda: compound([BLOCK, BLOCK]),
        lambda: volume(BLOCK),
        ("solids 1 and 2 overlap by 4000 mm³",),
    ),
    "a body in another": Fault(
        lambda: compound([BLOCK, CORE]),
        lambda: volume(shapes.fuse(BLOCK, CORE)),
        ("solids 1 and 2 overlap by 400 mm³",),
    ),
    "loose faces": Fault(
        lambda: faces(BLOCK),
        lambda: volume(BLOCK),
        ("sewed 6 faces, which no solid had, to 1 solid",),
    ),
    "loose faces of a hollow body": Fault(
        lambda: faces(CORE, BLOCK),
        lambda: volume(shapes.cut(BLOCK, CORE)),
        ("sewed 12 faces, which no solid had, to 1 solid with 1 cavity",),
    ),
    "inside out": Fault(
        lambda: BRACKET.Reversed(), lambda: volume(BRACKET), ("a solid was inside out",)
    ),
    "mirrored by its location": Fault(lambda: moved("mirrored"), lambda: volume(BRACKET)),
    "scaled by its location": Fault(lambda: moved("scaled"), lambda: 8 * volume(BRACKET)),
    "corners that differ in the last bit": Fault(
        last_bits, lambda: float(ball().volume), ("joined 461 corners",)
    ),
    "corners with noise": Fault(noisy, lambda: float(ball().volume), ("joined 798 corners",)),
    "two boxes that share a face": Fault(sharing_a_face, lambda: 8000.0),
    "a tube through itself": Fault(
        through_itself, quarters, ("the surface passes through itself",)
    ),
}  # fmt: skip


def told_volume(part: Part) -> float:
    return float(part.contents()["volume"].split()[0])


@pytest.mark.parametrize("name", FAULTS)
@pytest.mark.parametrize("repair", [False, True])
def test_a_faulty_part_is_read_and_filled_as_what_it_is(name: str, repair: bool) -> None:
    fault = FAULTS[name]
    part = v3dcad.part_from(fault.make(), repair=repair)
    right = fault.right()
    assert told_volume(part) == pytest.approx(right, rel=2e-5)
    assert len(part.findings) == len(fault.told)
    for finding, told in zip(part.findings, fault.told, strict=True):
        assert finding.startswith(told)
    structure = v3dcad.fill(part, layer_height=0.4, cell_size=8)
    areas = [layer.diagram.areas(len(layer.state.sites)).sum() for layer in structure.layers]
    assert 0.4 * sum(areas) == pytest.approx(right, rel=0.02)


def test_repairing_what_is_sound_changes_nothing() -> None:
    for make in (sharing_a_face, through_itself, noisy):
        plain, repaired = (
            v3dcad.part_from(make(), repair=repair).mesh() for repair in (False, True)
        )
        assert np.array_equal(plain.vertices, repaired.vertices)
        assert np.array_equal(plain.triangles, repaired.triangles)
