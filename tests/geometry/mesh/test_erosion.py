"""What is left of a mesh under a skin: against OCCT's offset, and by distance to its surface."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from build123d import Box, Cylinder, Part, Pos, Rot, Sphere, fillet
from occt import distance_to, volume_of
from OCP.BRepOffset import BRepOffset_Skin
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakeOffsetShape
from OCP.GeomAbs import GeomAbs_Intersection

import v3dcad
from tests.geometry.mesh.test_section import as_mesh, box, together
from v3dcad.errors import GeometryError
from v3dcad.geometry.mesh.erosion import eroded

PARTS: dict[str, Part] = {
    "box": Box(30, 20, 10),
    "step": Box(30, 20, 10) - Pos(10, 5, 3) * Box(30, 20, 10),
    "pocket": Box(30, 24, 12) - Pos(0, 0, 4) * Box(14, 12, 12),
    "hole": Box(30, 24, 12) - Cylinder(5, 12),
    "groove": Box(30, 24, 12) - Pos(0, 0, 6) * Rot(45, 0, 0) * Box(40, 6, 6),
    "round": fillet(Box(30, 24, 12).edges(), 3),
    "ball": Sphere(9),
}


@pytest.mark.parametrize("depth", [0.5, 1.2])
@pytest.mark.parametrize("name", PARTS)
def test_a_core_is_the_parts_own_offset(name: str, depth: float) -> None:
    part = v3dcad.part_from(PARTS[name])
    core = eroded(part.mesh(), depth)
    offset = BRepOffsetAPI_MakeOffsetShape()
    solid = PARTS[name].solids()[0].wrapped
    offset.PerformByJoin(solid, -depth, 1e-4, BRepOffset_Skin, False, False, GeomAbs_Intersection)
    assert core.volume() == pytest.approx(volume_of(offset.Shape()), rel=0.02)
    if name in ("box", "step", "pocket"):
        assert core.volume() == pytest.approx(volume_of(offset.Shape()), rel=2e-3)
    corners = np.asarray(core.to_mesh64().vert_properties)[:, :3]
    some = np.random.default_rng(0).permutation(len(corners))[:40]
    for corner in corners[some]:
        away = distance_to(corner, part.shape)
        assert away > depth * 0.99 - 0.05  # of the triangles' own distance
        assert away < depth * 2.01


def test_cavities_keep_their_distance_too() -> None:
    outside, inside = box((0, 0, 0), (20, 20, 20)), box((8, 8, 8), (12, 12, 12))
    inside = type(inside)(inside.vertices, inside.triangles[:, ::-1])
    core = eroded(together(outside, inside), 1.0)
    assert core.volume() == pytest.approx(18**3 - 6**3, rel=1e-3)


def test_a_skin_as_thick_as_the_part_is_refused() -> None:
    ball = as_mesh(trimesh.creation.icosphere(subdivisions=2, radius=5))
    with pytest.raises(GeometryError, match=r"a skin of 6 mm leaves no room for cells"):
        eroded(ball, 6.0)
