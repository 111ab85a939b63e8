"""Walls, cells and thick walls as B-rep: areas and volumes against ways without OCCT."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from build123d import Axis, Box, Cylinder, Pos, fillet
from occt import area_of, distinct, faces_of, is_valid, occurrences, solids_of, volume_of
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
from OCP.TopoDS import TopoDS_Shape
from one_diagram import power_diagram
from walls_oracle import power_walls

from v3dcad.errors import KernelError, SettingError
from v3dcad.geometry.convex import inset_cells
from v3dcad.geometry.facets import Facets
from v3dcad.kernel.cells import cut_cells, cut_walls, thick_walls
from v3dcad.kernel.shapes import compound
from v3dcad.model import Floats, Placement, Section

SHIFT = Placement(np.eye(3), np.array([-5.0, 2.0, -7.0]))
LOW, HIGH = np.array([-20.0, -15, 0]), np.array([20.0, 15, 25])
WIDE = np.array([1.0, 1, 1])


@dataclass
class Case:
    sites: Floats
    growth: Floats

    def walls(self) -> Facets:
        base = np.zeros(len(self.sites))
        return power_walls(self.sites, self.growth, base, LOW - WIDE, HIGH + WIDE)


def case(count: int, seed: int = 3) -> Case:
    random = np.random.default_rng(seed)
    growth = np.where(random.random(count) < 0.5, 1.0, 0.0) + 1e-6 * random.random(count)
    return Case(random.uniform(LOW[:2], HIGH[:2], (count, 2)), growth)


def block() -> TopoDS_Shape:
    return (Pos(5, -2, 19.5) * Box(40, 30, 25)).wrapped


def filleted() -> TopoDS_Shape:
    body = Box(40, 30, 25) - Cylinder(7, 25)
    return (Pos(5, -2, 19.5) * fillet(body.edges().filter_by(Axis.Z), 5)).wrapped


def cells_within(walls: Facets, inset: float) -> list[float]:
    """Volumes of the inset cells inside the block, by cutting convex polyhedra."""
    return [cell.volume() for cell in inset_cells(walls, inset, LOW, HIGH).values()]


def test_two_cells_of_a_box_in_closed_form() -> None:
    """Two sites 10 mm apart, one growing by 2 mm² per mm: the wall moves 0.1 mm per mm."""
    two = Case(np.array([[-5.0, 0], [5.0, 0]]), np.array([2.0, 0.0]))
    walls = two.walls()
    part = block()
    (shell,) = cut_walls(part, walls, SHIFT)
    assert area_of(shell) == pytest.approx(30 * np.hypot(25, 2.5), rel=1e-12)
    volumes = sorted(volume_of(cell) for cell in cut_cells(part, walls, SHIFT))
    # Its middle lies at x = 1.25 of −20 … 20.
    assert volumes == pytest.approx([18.75 * 30 * 25, 21.25 * 30 * 25], rel=1e-12)
    thick = thick_walls(part, walls, SHIFT, thickness=1.5)
    assert volume_of(thick) == pytest.approx(1.5 * 30 * np.hypot(25, 2.5), rel=1e-12)


def test_walls_by_slices() -> None:
    """Σ area · cos(tilt from vertical) = ∫ length of the layers' walls dz (Gauss's rule)."""
    some = case(15)
    walls = some.walls()
    vectors = walls.vectors()
    areas = np.linalg.norm(vectors, axis=1)
    upright = np.hypot(*vectors[:, :2].T)
    shells = cut_walls(block(), walls, SHIFT)
    assert all(is_valid(shell) for shell in shells)
    within = power_walls(some.sites, some.growth, np.zeros(15), LOW, HIGH)
    assert area_of(compound(shells)) == pytest.approx(
        np.linalg.norm(within.vectors(), axis=1).sum(), rel=1e-9
    )
    corners = LOW[:2], (HIGH[0], LOW[1]), HIGH[:2], (LOW[0], HIGH[1])
    nodes, weights = np.polynomial.legendre.leggauss(200)
    total = 0.0
    for node, weight in zip(nodes, weights, strict=True):
        z = 12.5 * (1 + node)
        diagram = power_diagram(some.sites, some.growth * z, Section(z, (np.array(corners),)))
        total += 12.5 * weight * diagram.lengths()[diagram.inner()].sum()
    assert np.hypot(*within.vectors()[:, :2].T).sum() == pytest.approx(total, rel=1e-5)
    assert (upright <= areas + 1e-9).all()


def test_walls_share_their_edges_and_meet_the_part() -> None:
    shells = compound(cut_walls(filleted(), case(25).walls(), SHIFT))
    assert is_valid(shells)
    assert len(distinct(shells, TopAbs_EDGE)) < 0.8 * occurrences(shells, TopAbs_EDGE)
    assert len(faces_of(shells)) == occurrences(shells, TopAbs_FACE)


@pytest.mark.parametrize("seed", range(3))
def test_cells_add_up_to_the_part_and_are_the_convex_ones(seed: int) -> None:
    walls = case(20, seed).walls()
    cells = cut_cells(filleted(), walls, SHIFT)
    assert all(is_valid(cell) for cell in cells)
    assert sum(map(volume_of, cells)) == pytest.approx(volume_of(filleted()), rel=1e-8)
    cells = cut_cells(block(), walls, SHIFT)
    assert sorted(map(volume_of, cells)) == pytest.approx(sorted(cells_within(walls, 0)), rel=1e-7)


@pytest.mark.parametrize("thickness", [0.4, 3.0])
def test_thick_walls_and_inset_cells_make_the_part(thickness: float) -> None:
    walls = case(20).walls()
    thick = thick_walls(block(), walls, SHIFT, thickness)
    assert is_valid(thick)
    assert len(solids_of(thick)) == 1
    inset = cells_within(walls, thickness / 2)
    assert volume_of(thick) + sum(inset) == pytest.approx(40 * 30 * 25, rel=1e-9)


def test_a_skin_closes_the_part() -> None:
    walls = case(12).walls()
    thick = thick_walls(block(), walls, SHIFT, 1.0, skin=2.0)
    assert is_valid(thick)
    inner = inset_cells(walls, 0.5, LOW + 2, HIGH - 2)
    hollow = sum(cell.volume() for cell in inner.values())
    assert volume_of(thick) == pytest.approx(40 * 30 * 25 - hollow, rel=1e-9)


def test_a_part_is_not_changed_by_its_filling() -> None:
    part = filleted()
    before = [area_of(face) for face in faces_of(part)]
    walls = case(20).walls()
    cut_walls(part, walls, SHIFT)
    cut_cells(part, walls, SHIFT)
    assert is_valid(part)
    assert [area_of(face) for face in faces_of(part)] == before


def test_errors_say_what_to_do() -> None:
    walls = case(8).walls()
    for wrong in (0.0, -1.0, float("nan")):
        with pytest.raises(SettingError, match=r"thickness .*: give a number above 0 mm"):
            thick_walls(block(), walls, SHIFT, wrong)
    with pytest.raises(SettingError, match="skin -1: give a number above 0 mm"):
        thick_walls(block(), walls, SHIFT, 1.0, skin=-1.0)
    with pytest.raises(SettingError, match="closes all cells"):
        thick_walls(block(), walls, SHIFT, 60.0)
    with pytest.warns(UserWarning, match=r"more than \d+ cells are wide: they close up"):
        thick_walls(block(), walls, SHIFT, 16.0)
    far = Placement(np.eye(3), np.array([500.0, 0, 0]))
    with pytest.raises(KernelError, match="no walls inside the part"):
        cut_walls(block(), walls, far)
    one = Facets(
        np.empty((0, 3)), np.empty(0), np.empty(0, np.int64), np.zeros(1, np.int64),
        np.empty((0, 2), np.int64),
    )  # fmt: skip
    with pytest.raises(KernelError, match="a single cell"):
        cut_walls(block(), one, SHIFT)
    with pytest.raises(KernelError, match="skin of 14 mm"):
        thick_walls(block(), walls, SHIFT, 1.0, skin=14.0)
