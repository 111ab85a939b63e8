"""Solids that meet: how much they share, told and measured; OCCT's figures against manifold3d's."""

from __future__ import annotations

import numpy as np
import pytest
from manifold3d import Manifold, Mesh64, OpType
from OCP.TopoDS import TopoDS_Shape

import v3dcad
from tests.kernel import shapes
from v3dcad.kernel import union
from v3dcad.kernel.mesh import triangle_mesh
from v3dcad.kernel.part import solid_part
from v3dcad.kernel.shapes import area, compound, volume

SIZES = {"layer_height": 0.5, "cell_size": 6}


def fine(solid: TopoDS_Shape) -> Manifold:
    mesh = triangle_mesh(solid, 1e-3, 0.05)
    return Manifold(Mesh64(mesh.vertices.copy(), mesh.triangles.astype(np.uint64)))


def boxes(*corners: tuple[int, int, int]) -> list[TopoDS_Shape]:
    return [shapes.box(low, tuple(x + 10 for x in low)) for low in corners]


BODIES = {
    "three boxes": boxes((0, 0, 0), (5, 0, 0), (2, 5, 3)),
    "balls": [shapes.sphere(8), shapes.sphere(7, (6, 2, 1)), shapes.sphere(5, (0, 9, 0))],
    "the same three times": [shapes.cylinder(4, 9)] * 3,
    "apart": boxes((0, 0, 0), (20, 0, 0)),
    "side by side": boxes((0, 0, 0), (10, 3, 0)),
}


@pytest.mark.parametrize("name", BODIES)
def test_volume_and_union_are_those_of_manifold3d(name: str) -> None:
    solids = BODIES[name]
    part = solid_part(compound(solids), "part", "part")
    expected = Manifold.batch_boolean([fine(solid) for solid in solids], OpType.Add).volume()
    assert volume(part.shape) - part.overlap == pytest.approx(expected, rel=1e-3)
    assert part.contents()["volume"] == f"{volume(part.shape) - part.overlap:.6g} mm³"
    assert volume(union.one_body(part.shape)) == pytest.approx(expected, rel=1e-3)
    mesh = part.mesh()
    assert np.linalg.det(mesh.vertices[mesh.triangles]).sum() / 6 == pytest.approx(
        expected, rel=3e-2
    )


def test_it_is_told_which_overlap_and_by_how_much() -> None:
    part = solid_part(compound(BODIES["three boxes"]), "part", "part")
    assert part.findings == (
        "solids 1 and 2 overlap by 500 mm³: they are filled as one",
        "solids 1 and 3 overlap by 280 mm³: they are filled as one",
        "solids 2 and 3 overlap by 245 mm³: they are filled as one",
    )
    assert part.overlap == pytest.approx(500 + 280 + 245 - 5 * 5 * 7)
    for name in ("apart", "side by side"):
        part = solid_part(compound(BODIES[name]), "part", "part")
        assert (part.findings, part.overlap) == ((), 0.0)
    many = solid_part(compound(boxes(*((k, 0, 0) for k in range(0, 40, 5)))), "part", "part")
    assert len(many.findings) == 6
    assert many.findings[-1] == "2 more pairs of solids overlap by less"


def test_each_solid_is_measured_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """It takes as long as a boolean, and solids of an assembly meet many others."""
    solids = [shapes.box((0, 0, 0), (40, 10, 10)), *boxes(*((k, 0, 10) for k in range(0, 40, 10)))]
    measured: list[TopoDS_Shape] = []

    def counted(shape: TopoDS_Shape) -> float:
        measured.append(shape)
        return volume(shape)

    monkeypatch.setattr(union, "volume", counted)
    moved = boxes((5, 0, 5))
    pairs, _ = union.overlaps(compound([*solids, *moved]))
    assert len(pairs) == 3
    assert all(sum(shape.IsSame(solid) for shape in measured) <= 1 for solid in (*solids, *moved))


def test_what_occt_cannot_unite_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    pair = compound(BODIES["balls"][:2])
    monkeypatch.setattr(union, "fused", lambda some, others: some[0])
    with pytest.raises(v3dcad.KernelError, match=r"union of the part's 2 solids has .* instead of"):
        union.one_body(pair)


def test_every_form_is_that_of_one_body() -> None:
    solids = [shapes.box((0, 0, 0), (20, 20, 8)), shapes.cylinder(6, 16, (20, 10, -4))]
    whole = volume(shapes.fuse(*solids))
    structure = v3dcad.fill(compound(solids), **SIZES)
    assert sum(map(volume, structure.cells())) == pytest.approx(whole, rel=1e-6)
    inner = area(structure.faces())
    assert inner == pytest.approx(area(v3dcad.fill(shapes.fuse(*solids), **SIZES).faces()))
    again = v3dcad.fill(compound(reversed(solids)), **SIZES)
    assert structure.checksum() == again.checksum()
    recipe = structure.recipe()
    assert v3dcad.fill(recipe).findings() == structure.findings()
