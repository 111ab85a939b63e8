"""Walls, cells and thick walls as B-rep: areas and volumes against ways without OCCT."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from build123d import (
    Axis,
    Box,
    Cylinder,
    Plane,
    Polyline,
    Pos,
    Rot,
    Sphere,
    Spline,
    Torus,
    export_step,
    fillet,
    make_face,
    revolve,
    scale,
)
from occt import area_of, distinct, faces_of, is_valid, occurrences, solids_of, volume_of
from OCP.BRep import BRep_Tool
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_VERTEX
from OCP.TopoDS import TopoDS, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape
from one_diagram import power_diagram
from scipy.spatial import ConvexHull, Voronoi
from walls_oracle import power_walls

import v3dcad
from tests.kernel.exact import breaks, exact_area, integrated
from tests.kernel.shapes import nist
from v3dcad import Structure
from v3dcad.errors import KernelError, SettingError
from v3dcad.geometry.solid.convex_cells import inset_cells
from v3dcad.geometry.solid.facets import Facets, welded_facets
from v3dcad.kernel.booleans import split
from v3dcad.kernel.cells import cut_cells, cut_walls, thick_walls
from v3dcad.kernel.mesh import surface_mesh
from v3dcad.kernel.plane_faces import wall_faces
from v3dcad.kernel.section import section_solids
from v3dcad.kernel.shapes import SOLID, compound, measured, subshapes, volume
from v3dcad.model import Floats, Placement, Section

pytestmark = pytest.mark.slow

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
    volumes = sorted(volume_of(cell) for cell in cut_cells(part, walls, SHIFT)[0])
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
    cells, _ = cut_cells(filleted(), walls, SHIFT)
    assert all(is_valid(cell) for cell in cells)
    assert sum(map(volume_of, cells)) == pytest.approx(volume_of(filleted()), rel=1e-8)
    cells, _ = cut_cells(block(), walls, SHIFT)
    assert sorted(map(volume_of, cells)) == pytest.approx(sorted(cells_within(walls, 0)), rel=1e-7)


def knob() -> Any:
    """A turned knob with fillets and a cross hole."""
    body = fillet(Cylinder(18, 14).edges(), 3) + Pos(0, 0, 14) * Cylinder(7, 16)
    return body - Pos(0, 0, 6) * Cylinder(3, 40) - Pos(9, 0, 4) * Rot(0, 90, 0) * Cylinder(1.6, 24)


def vase() -> Any:
    outline = Spline((15, 0), (22, 12), (12, 28), (16, 40)) + Polyline(
        (16, 40), (0, 40), (0, 0), (15, 0)
    )
    return revolve(Plane.XZ * make_face(outline), Axis.Z)


ROUND = {
    "knob": (knob, None),
    "torus": (lambda: Torus(25, 8), 2 * math.pi**2 * 25 * 8**2),
    "ellipsoid": (lambda: scale(Sphere(15), (1.4, 1, 0.8)), 4 / 3 * math.pi * 15**3 * 1.4 * 0.8),
    "vase": (vase, None),
}


def sliced_volume(part: TopoDS_Shape) -> float:
    """∫ area of exact sections dz, without OCCT's integration."""
    mesh = surface_mesh(part)

    def areas(heights: Floats) -> Floats:
        order = np.argsort(heights)
        found = np.empty(len(heights))
        found[order] = [exact_area(section) for section in section_solids(mesh, heights[order])]
        return found

    return integrated(breaks(part, mesh), areas, 20)


@pytest.mark.parametrize("name", ROUND)
def test_volumes_of_round_parts_are_right(name: str) -> None:
    make, closed_form = ROUND[name]
    part = make().wrapped
    expected = sliced_volume(part) if closed_form is None else closed_form
    assert volume(part) == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("name", ROUND)
def test_cells_of_round_parts_add_up_and_are_sound(name: str) -> None:
    part = ROUND[name][0]()
    structure = v3dcad.fill(part.wrapped, cell_size=8, layer_height=1.0)
    cells = structure.cells()
    assert all(map(is_valid, cells))
    assert sum(map(volume_of, cells)) == pytest.approx(volume_of(part.wrapped), rel=1e-8)
    assert is_valid(structure.faces())


@pytest.mark.parametrize(("name", "seed"), [("torus", 3), ("knob", 3)])
def test_curves_that_occt_fits_badly(name: str, seed: int, tmp_path: Path) -> None:
    """A wall's curve on the torus comes out as chords, 1e-4 mm off, and 5e-8 of the volume."""
    part = ROUND[name][0]()
    export_step(part, tmp_path / "part.step")
    structure = v3dcad.fill(tmp_path / "part.step", cell_size=6, random_seed=seed)
    cells = structure.cells()
    assert all(map(is_valid, cells))
    assert sum(map(volume_of, cells)) == pytest.approx(volume_of(part.wrapped), rel=1e-8)


def test_walls_with_welded_corners_are_sound() -> None:
    """Corners at events are equal but for rounding, and so lie a bit off their walls' planes."""
    exact = case(20).walls()
    blurred = exact.points[exact.corners]
    blurred += np.random.default_rng(9).uniform(-2e-6, 2e-6, blurred.shape)
    walls = welded_facets(exact.sites, blurred, exact.starts)
    assert len(walls) == len(exact)
    assert len(walls.points) == len(exact.points)
    assert walls.slack.max() > 1e-6
    vertices = subshapes(compound(wall_faces(walls, np.arange(len(walls))).values()), TopAbs_VERTEX)
    tolerances = [BRep_Tool.Tolerance_s(TopoDS.Vertex_s(vertex)) for vertex in vertices]
    assert max(tolerances) >= walls.slack.max(), "a vertex holds all corners welded into it"
    cells, _ = cut_cells(block(), walls, SHIFT)
    assert len(cells) == len(np.unique(exact.sites))
    assert all(map(is_valid, cells))
    assert all(map(is_valid, cut_walls(block(), walls, SHIFT)))


def box_of_foam(cell_size: float) -> tuple[Structure, Floats]:
    """A foam in a box, and its sites where the box lies."""
    structure = v3dcad.fill(Box(20, 16, 12).wrapped, cell_size=cell_size, layer_height=1.0)
    return structure, structure.placement.to_source(structure.sites)


def test_cells_wholly_inside_are_scipys() -> None:
    """Volumes of Voronoi regions in the stretched space, where the box does not cut them."""
    structure, places = box_of_foam(2.0)
    squeezed = np.array([1, 1, 1 / structure.settings.stretch])
    diagram = Voronoi(places * squeezed)
    inside = 0
    for site, cells in structure.cells_by_site().items():
        region = diagram.regions[diagram.point_region[site]]
        corners = diagram.vertices[region] / squeezed
        if -1 in region or (np.abs(corners) > [10, 8, 6]).any():
            continue
        inside += 1
        assert len(cells) == 1
        assert is_valid(cells[0])
        assert volume_of(cells[0]) == pytest.approx(ConvexHull(corners).volume, rel=1e-9)
    assert inside > 50


def test_neighbours_share_their_faces() -> None:
    """Inside, across the border to those that OCCT cuts, and there: one face for two cells."""
    structure, _ = box_of_foam(3.0)
    cells = structure.cells_by_site()
    users: dict[int, set[int]] = {}
    known = TopTools_IndexedMapOfShape()
    for site, (cell, *others) in cells.items():
        assert not others
        for face in faces_of(cell):
            users.setdefault(known.Add(face), set()).add(site)
    shared = {tuple(sorted(sites)) for sites in users.values() if len(sites) == 2}
    assert max(map(len, users.values())) == 2
    walls = structure.facets()
    areas = np.linalg.norm(walls.vectors(), axis=1)
    met = {tuple(pair) for pair in walls.sites[areas > 1e-6].tolist()}
    assert met <= shared
    assert shared <= {tuple(pair) for pair in structure.facets(1.0).sites.tolist()}
    # What no two cells share is the box's surface.
    alone = compound(known(number) for number, sites in users.items() if len(sites) == 1)
    assert area_of(alone) == pytest.approx(2 * (20 * 16 + 16 * 12 + 12 * 20), rel=1e-9)
    # And faces() are the shared ones.
    both = compound(known(number) for number, sites in users.items() if len(sites) == 2)
    assert area_of(structure.faces()) == pytest.approx(area_of(both), rel=1e-9)


def shapes_with_voids() -> dict[str, Any]:
    block = Box(24, 18, 14)
    return {
        "hole": block - Cylinder(4, 14),
        "void": block - Sphere(5),
        "small void": block - Pos(2, 1, 1) * Sphere(0.4),
        "nested": block - Sphere(6) + Sphere(3),
        "islands": Pos(-9, 0, 0) * Box(14, 18, 14) + Pos(9, 0, 0) * Cylinder(6, 14),
        "turned": Rot(20, 35, 10) * (block - Cylinder(4, 14)),
    }


@pytest.mark.parametrize("name", ["hole", "void", "small void", "nested", "islands", "turned"])
def test_cells_of_parts_with_voids_and_islands(name: str) -> None:
    part = shapes_with_voids()[name]
    structure = v3dcad.fill(part.wrapped, cell_size=3, layer_height=1.0)
    cells = structure.cells_by_site()
    every = [cell for pieces in cells.values() for cell in pieces]
    assert all(map(is_valid, every))
    assert sum(map(volume_of, every)) == pytest.approx(volume_of(part.wrapped), rel=1e-8)
    for site, pieces in cells.items():
        assert set(structure.sites_at([measured(piece)[1] for piece in pieces])) == {site}
    shells = structure.faces()
    assert is_valid(shells)
    assert len(faces_of(shells)) == occurrences(shells, TopAbs_FACE)
    # Each wall has a cell on either side: all faces of cells are twice the walls and the surface.
    assert sum(map(area_of, every)) == pytest.approx(
        2 * area_of(shells) + area_of(part.wrapped), rel=1e-8
    )


@pytest.mark.parametrize("name", ["ctc_01_asme1_rd", "ftc_06_asme1_rd"])
def test_cells_of_real_parts_add_up(name: str) -> None:
    part = nist(name)
    structure = v3dcad.fill(part, cell_size=60, layer_height=10.0)
    cells = structure.cells()
    assert all(map(is_valid, cells))
    assert sum(map(volume_of, cells)) == pytest.approx(volume_of(part), rel=1e-6)


def test_a_loss_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    def lossy(arguments: list[TopoDS_Shape], tools: list[TopoDS_Shape]) -> TopoDS_Shape:
        return compound(list(subshapes(split(arguments, tools), SOLID))[1:])

    monkeypatch.setattr("v3dcad.kernel.cells.split", lossy)
    with pytest.raises(KernelError, match=r"cells add up to .* change a site .* thick walls"):
        cut_cells(block(), case(8).walls(), SHIFT)


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
    with pytest.raises(SettingError, match=r"skin -1\.0: give a number above 0 mm"):
        thick_walls(block(), walls, SHIFT, 1.0, skin=-1.0)
    with pytest.raises(SettingError, match="closes all cells"):
        thick_walls(block(), walls, SHIFT, 60.0)
    with pytest.warns(UserWarning, match=r"\d+ cells are narrower than a"):
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
