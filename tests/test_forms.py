"""What a structure gives as CAD, written and read back by others: OCCT, lib3mf, trimesh."""

from __future__ import annotations

import re
import shutil
import subprocess
import warnings
from pathlib import Path

import numpy as np
import pytest
import trimesh
from build123d import Axis, Box, Cylinder, Part, Pos, Rot, fillet
from lib3mf import Lib3MF
from occt import area_of, box_of, faces_of, is_valid, length_of, read_step, solids_of, volume_of
from OCP.BRep import BRep_Builder
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepTools import BRepTools
from OCP.TopoDS import TopoDS_Shape

import v3dcad
from v3dcad import KernelError, SettingError, Structure
from v3dcad.geometry.mesh.boolean import mesh_volume
from v3dcad.geometry.solid.convex_cells import inset_cells

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore:.* narrower than a .*, and filled solid"),
]

SETTINGS = {"cell_size": 8.0, "layer_height": 1.0}


def part() -> Box:
    body = Box(30, 24, 12) - Cylinder(5, 12)
    return Pos(7, -3, 20) * fillet(body.edges().filter_by(Axis.Z), 3)


@pytest.fixture(scope="module")
def structure() -> Structure:
    return v3dcad.fill(part().wrapped, **SETTINGS)


def test_cells_add_up_and_lie_where_the_part_lies(structure: Structure) -> None:
    cells = structure.cells()
    assert sum(map(volume_of, cells)) == pytest.approx(part().volume, rel=1e-8)
    faces = structure.faces()
    assert is_valid(faces)
    low, high = part().bounding_box().min, part().bounding_box().max
    box = box_of(faces)
    assert (box[0] >= np.array(tuple(low)) - 1e-3).all()
    assert (box[1] <= np.array(tuple(high)) + 1e-3).all()
    assert box[:, 2] == pytest.approx([14, 26], abs=1e-3)  # from the base to the very top


def test_cells_are_known_by_their_sites(structure: Structure) -> None:
    """A cell's slices make up its volume; points left and right of a wall have its two sites."""
    cells = structure.cells_by_site()
    assert list(cells) == sorted(cells)
    count = len(structure.layers[-1].state.sites)
    swept = np.zeros(count)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    for z, weight in zip(6 + 6 * nodes, 6 * weights, strict=True):
        diagram = structure.at(z)
        swept += weight * diagram.areas(count)
        walls = diagram.inner() & (diagram.lengths() > 1e-3)
        ends = diagram.vertices[diagram.edges[walls]]
        left = (ends[:, 1] - ends[:, 0]) @ [[0, 1], [-1, 0]]
        for side, beside in ((1, left), (0, -left)):
            # Farther than heights are snapped to the grid.
            points = ends.mean(axis=1) + 1e-5 * beside / np.hypot(*left.T)[:, None]
            at_source = np.column_stack([points, np.full(len(points), z)])
            at_source = structure.placement.to_source(at_source)
            expected = diagram.edge_sites[walls, side]
            assert structure.sites_at(at_source).tolist() == expected.tolist()
    for site in range(count):
        volume = sum(map(volume_of, cells.get(site, [])))
        assert volume == pytest.approx(swept[site], rel=0.01, abs=0.5)


def test_pieces_of_one_cell_are_named(tmp_path: Path) -> None:
    apart = Pos(10, 0, 0) * Box(5, 20, 10) + Pos(-10, 0, 0) * Box(5, 20, 10)
    structure = v3dcad.fill(apart.wrapped, sites=[(0, -5), (0, 5)], layer_height=1.0)
    structure.write_step(tmp_path / "a.step", "cells")
    named = read_step(tmp_path / "a.step")
    assert list(named) == [f"cell {site}, piece {k} of 2" for site in (0, 1) for k in (1, 2)]
    lows = np.array([box_of(shape)[0] for shape in named.values()])
    assert lows == pytest.approx(
        np.array([[-12.5, -10, -5], [7.5, -10, -5], [-12.5, 0, -5], [7.5, 0, -5]]), abs=1e-6
    )


def test_layers_are_slices_of_the_faces(structure: Structure) -> None:
    """∫ wall length dz of fine layers = Σ wall area · cos(tilt from vertical)."""
    fine = v3dcad.fill(part().wrapped, **SETTINGS | {"layer_height": 0.05})
    lengths = [layer.diagram.lengths()[layer.diagram.inner()].sum() for layer in fine.layers]
    swept = 0.05 * sum(lengths)  # heights are in the middle of layers
    upright = 0.0
    for face in faces_of(fine.faces()):
        normal = BRepAdaptor_Surface(face).Plane().Axis().Direction()
        upright += area_of(face) * np.hypot(normal.X(), normal.Y())
    assert swept == pytest.approx(upright, rel=2e-4)  # walls end on chords
    assert upright < 0.999 * area_of(fine.faces())


@pytest.mark.parametrize("schema", ["AP214", "AP242"])
def test_wires_in_step(structure: Structure, tmp_path: Path, schema: str) -> None:
    structure.write_step(tmp_path / "a.step", schema=schema)
    shapes = read_step(tmp_path / "a.step")
    assert list(shapes) == [f"layer {layer.index} z {layer.z:g}" for layer in structure.layers]
    assert all(map(is_valid, shapes.values()))
    assert sum(map(length_of, shapes.values())) == pytest.approx(
        length_of(structure.wires()), rel=1e-9
    )
    for layer, shape in zip(structure.layers, shapes.values(), strict=True):
        assert box_of(shape)[:, 2] == pytest.approx(layer.z + 14, abs=1e-6)
    structure.write_step(tmp_path / "b.step", schema=schema)
    assert (tmp_path / "a.step").read_bytes() == (tmp_path / "b.step").read_bytes()


@pytest.mark.parametrize(
    ("form", "sizes", "measure"),
    [
        ("faces", {}, area_of),
        ("cells", {}, volume_of),
        ("solid", {"thickness": 1.0}, volume_of),
        ("struts", {"diameter": 1.5}, volume_of),
    ],
)
def test_forms_come_back_from_step_and_brep(
    structure: Structure, tmp_path: Path, form: str, sizes: dict[str, float], measure
) -> None:
    made = getattr(structure, form)(**sizes)
    expected = sum(map(measure, made)) if form == "cells" else measure(made)
    assert expected > 100
    structure.write_step(tmp_path / "a.step", form, **sizes)
    shapes = read_step(tmp_path / "a.step")
    assert all(map(is_valid, shapes.values()))
    assert sum(map(measure, shapes.values())) == pytest.approx(expected, rel=1e-6)
    structure.write_step(tmp_path / "b.step", form, **sizes)
    assert (tmp_path / "a.step").read_bytes() == (tmp_path / "b.step").read_bytes()
    assert "COLOUR_RGB" in (tmp_path / "a.step").read_text(encoding="utf-8")
    structure.write_brep(tmp_path / "a.brep", form, **sizes)
    again = TopoDS_Shape()
    BRepTools.Read_s(again, str(tmp_path / "a.brep"), BRep_Builder())
    assert measure(again) == pytest.approx(expected, rel=1e-9)


def test_struts_cut_to_the_part_come_back(structure: Structure, tmp_path: Path) -> None:
    """From BREP to the last digit. From STEP OCCT reads some balls that the part's surface cuts as
    the rest of the ball (docs/brep.md).
    """
    sizes = {"diameter": 1.5, "cut": True}
    made = structure.struts(**sizes)
    structure.write_brep(tmp_path / "a.brep", "struts", **sizes)
    again = TopoDS_Shape()
    BRepTools.Read_s(again, str(tmp_path / "a.brep"), BRep_Builder())
    assert volume_of(again) == pytest.approx(volume_of(made), rel=1e-9)
    structure.write_step(tmp_path / "a.step", "struts", **sizes)
    read = [
        piece for shape in read_step(tmp_path / "a.step").values() for piece in solids_of(shape)
    ]
    assert all(map(is_valid, read))
    written = np.array([volume_of(piece) for piece in solids_of(made)])
    assert len(read) == len(written) > 100
    wrong = ~np.isclose([volume_of(piece) for piece in read], written, rtol=1e-6)
    assert wrong.mean() < 0.01


def test_struts_cut_and_fused() -> None:
    structure = v3dcad.fill(Box(20, 20, 10).wrapped, cell_size=9.0, layer_height=1.0)
    fused = structure.struts(1.5, fuse=True)
    assert is_valid(fused)
    assert volume_of(fused) == pytest.approx(mesh_volume(structure.strut_mesh(1.5)), rel=0.06)
    assert volume_of(fused) < volume_of(structure.struts(1.5))
    cut = structure.struts(1.5, fuse=True, cut=True)
    assert 0 < volume_of(cut) < volume_of(fused)
    assert (np.abs(box_of(cut)) <= np.array([10, 10, 5]) + 1e-6).all()
    many = v3dcad.fill(Box(40, 40, 10).wrapped, cell_size=4.0, layer_height=1.0)
    with pytest.raises(KernelError, match="more than the 200 that OCCT unites") as refused:
        many.struts(0.5, fuse=True)
    for way in ("write_stl", "write_3mf", "compound"):
        assert way in str(refused.value)


@pytest.mark.parametrize("profile", ["rectangle", "rounded"])
def test_beads_have_the_volume_of_their_parts(profile: str, tmp_path: Path) -> None:
    structure = v3dcad.fill(Box(20, 20, 2).wrapped, cell_size=10.0, layer_height=0.5)
    beads = structure.beads(0.8, profile)
    assert is_valid(beads)
    area = 0.8 * 0.5 if profile == "rectangle" else 0.3 * 0.5 + np.pi * 0.25**2
    # Pappus: a profile's half turned about the middle.
    joint = np.pi * 0.4**2 * 0.5
    if profile == "rounded":
        joint = np.pi * (0.15**2 * 0.5 + 2 * (0.15 * np.pi * 0.25**2 / 2 + 2 / 3 * 0.25**3))
    diagrams = [layer.diagram for layer in structure.layers]
    expected = sum(area * d.lengths().sum() + joint * len(d.vertices) for d in diagrams)
    assert volume_of(beads) == pytest.approx(expected, rel=1e-9)
    structure.write_step(tmp_path / "a.step", "beads", width=0.8, profile=profile)
    assert list(read_step(tmp_path / "a.step"))[1] == "layer 1 z 0.75"


def test_thick_walls_as_mesh_and_solid_agree(structure: Structure, tmp_path: Path) -> None:
    structure.write_stl(tmp_path / "a.stl", "solid", thickness=1.0)
    mesh = trimesh.load(tmp_path / "a.stl")
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(volume_of(structure.solid(1.0)), rel=2e-3)
    assert mesh.bounds == pytest.approx(box_of(structure.solid(1.0)), abs=1e-3)


@pytest.mark.filterwarnings("error")
def test_a_skin_is_in_meshes_as_it_is_in_solids(tmp_path: Path) -> None:
    structure = v3dcad.fill(part().wrapped, **SETTINGS)
    exact = structure.solid(0.6, skin=1.2)
    assert len(solids_of(exact)) == 1
    structure.write_stl(tmp_path / "a.stl", "solid", thickness=0.6, skin=1.2)
    mesh = trimesh.load(tmp_path / "a.stl")
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(volume_of(exact), rel=1e-3)
    bodies = mesh.split(only_watertight=False)
    assert sum(body.volume > 0 for body in bodies) == 1  # the others are closed cells
    assert len(bodies) > 10
    structure.write_3mf(tmp_path / "a.3mf", thickness=0.6, skin=1.2)
    assert (
        v3dcad.part_from(tmp_path / "a.3mf").contents()["volume"].startswith(f"{mesh.volume:.4g}")
    )


def bracket() -> Part:
    """A base and an arm over it, and a post that holds the arm up."""
    return Box(30, 10, 30) - Pos(5, 0, 0) * Box(30, 10, 20)


def test_thick_walls_that_fall_apart_are_told(tmp_path: Path) -> None:
    """The whole post lies in one cell, so that nothing of it is left."""
    structure = v3dcad.fill(bracket().wrapped, sites=[(-10, 0), (0, 0), (10, 0)], layer_height=1.0)
    for make in (structure.solid, structure.solid_mesh):
        with pytest.warns(UserWarning, match="bodies that hang together nowhere") as told:
            made = make(1.0)
        words = str(told[0].message)
        assert words.startswith("the thick walls are 4 bodies")
        assert words.count("50 mm³ at") == 3
        assert words.count("on the bed") + words.count("25 mm up in the air") == 3
        assert words.endswith("; a skin holds them together")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            held = make(1.0, skin=1.0)
        if make == structure.solid:
            assert len(solids_of(made)) == 4
            whole = volume_of(held)
    assert mesh_volume(held) == pytest.approx(whole, rel=1e-6)


@pytest.mark.skipif(shutil.which("prusa-slicer") is None, reason="needs PrusaSlicer")
@pytest.mark.parametrize("form", ["solid", "struts", "beads"])
def test_a_slicer_takes_what_is_in_3mf(structure: Structure, tmp_path: Path, form: str) -> None:
    sizes = {"solid": {"thickness": 1.0}, "struts": {"diameter": 1.0}, "beads": {"width": 0.8}}
    structure.write_3mf(tmp_path / "a.3mf", form, **sizes[form])
    command = ["prusa-slicer", "--info", str(tmp_path / "a.3mf")]
    said = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
    assert "manifold = yes" in said
    found = float(re.search(r"volume = ([\d.]+)", said)[1])
    whole = v3dcad.part_from(tmp_path / "a.3mf").contents()["volume"]
    assert found == pytest.approx(float(whole.split()[0]), rel=1e-4)


def test_meshes_of_a_turned_part(tmp_path: Path) -> None:
    """Its faces carry motions of their own: nodes are shared by edge, not by coordinates."""
    body = fillet(Box(20, 20, 20).edges().filter_by(Axis.X), 4) - Cylinder(4, 60)
    turned = Rot(20, 35, 10) * body
    structure = v3dcad.fill(turned.wrapped, cell_size=9.0, layer_height=1.0)
    assert mesh_volume(structure.part.mesh()) == pytest.approx(turned.volume, rel=5e-3)
    assert mesh_volume(structure.solid_mesh(1.0)) == pytest.approx(
        volume_of(structure.solid(1.0)), rel=5e-3
    )


def test_struts_cut_to_the_part_as_a_mesh(structure: Structure, tmp_path: Path) -> None:
    """What the part's planes, holes and fillets cut off is gone."""
    whole, cut = structure.strut_mesh(1.5), structure.strut_mesh(1.5, cut=True)
    assert mesh_volume(cut) < 0.9 * mesh_volume(whole)
    assert whole.vertices[:, 2].min() < 13.9
    assert cut.vertices[:, 2].min() == pytest.approx(14, abs=1e-6)
    assert cut.vertices[:, 2].max() == pytest.approx(26, abs=1e-6)
    structure.write_stl(tmp_path / "a.stl", "struts", diameter=1.5, cut=True)
    mesh = trimesh.load(tmp_path / "a.stl")
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(mesh_volume(cut), rel=1e-4)
    few = v3dcad.fill(Box(20, 20, 10).wrapped, cell_size=9.0, layer_height=1.0)
    exact = volume_of(few.struts(1.5, fuse=True, cut=True))
    assert mesh_volume(few.strut_mesh(1.5, cut=True)) == pytest.approx(exact, rel=0.06)


def test_triangles_have_thick_walls_too(samples: Path, tmp_path: Path) -> None:
    pyramid = v3dcad.fill(samples / "pyramid.stl", cell_size=20.0, layer_height=5.0)
    mesh = pyramid.solid_mesh(2.0, skin=1.0)
    assert 0 < mesh_volume(mesh) < mesh_volume(pyramid.part.mesh())
    pyramid.write_3mf(tmp_path / "a.3mf", "solid", thickness=2.0, skin=1.0)
    with pytest.raises(KernelError, match="made of triangles"):
        pyramid.cells()


def test_bead_mesh_is_closed(tmp_path: Path) -> None:
    structure = v3dcad.fill(Box(20, 20, 2).wrapped, cell_size=10.0, layer_height=0.5)
    structure.write_3mf(tmp_path / "a.3mf", "beads", width=0.8)
    model = Lib3MF.Wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromFile(str(tmp_path / "a.3mf"))
    objects = model.GetMeshObjects()
    assert objects.MoveNext()
    assert objects.GetCurrentMeshObject().IsManifoldAndOriented()
    structure.write_stl(tmp_path / "a.stl", "beads", width=0.8)
    mesh = trimesh.load(tmp_path / "a.stl")
    # Layers may touch in an edge, which STL, having no ids, gives four triangles.
    uses = np.unique(np.sort(mesh.edges, axis=1), axis=0, return_counts=True)[1]
    assert (uses % 2 == 0).all()
    assert mesh.bounds == pytest.approx(np.array([[-10.4, -10.4, -1], [10.4, 10.4, 1]]), abs=1e-2)
    lengths = sum(layer.diagram.lengths().sum() for layer in structure.layers)
    assert 0.85 * lengths * 0.4 < mesh.volume < lengths * 0.4


def test_walls_of_zero_thickness(structure: Structure, tmp_path: Path) -> None:
    structure.write_stl(tmp_path / "a.stl")
    structure.write_stl(tmp_path / "b.stl", "walls", ascii=True)
    edges = sum(len(layer.diagram.edges) for layer in structure.layers)
    lengths = sum(layer.diagram.lengths().sum() for layer in structure.layers)
    for name in ("a.stl", "b.stl"):
        mesh = trimesh.load(tmp_path / name, process=False)
        assert len(mesh.faces) == 2 * edges
        assert mesh.area == pytest.approx(lengths, rel=1e-5)


def test_beams_are_the_struts(structure: Structure, tmp_path: Path) -> None:
    structure.write_3mf(tmp_path / "a.3mf", "beams", diameter=1.5)
    model = Lib3MF.Wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromFile(str(tmp_path / "a.3mf"))
    objects, found = model.GetMeshObjects(), {}
    while objects.MoveNext():
        item = objects.GetCurrentMeshObject()
        found[item.BeamLattice().GetBeamCount() > 0] = item
    lattice, fallback = found[True], found[False]
    facets = structure.facets()
    beams = lattice.BeamLattice().GetBeams()
    assert [tuple(beam.Indices) for beam in beams] == [tuple(s) for s in facets.struts().tolist()]
    assert {tuple(beam.Radii) for beam in beams} == {(0.75, 0.75)}
    places = np.array([tuple(place.Coordinates) for place in lattice.GetVertices()])
    assert places == pytest.approx(structure.placement.to_source(facets.points), abs=1e-5)
    assert lattice.BeamLattice().GetRepresentation() == (True, fallback.GetResourceID())
    assert fallback.IsManifoldAndOriented()
    structure.write_3mf(tmp_path / "b.3mf", "beams", diameter=1.5)
    assert (tmp_path / "a.3mf").read_bytes() == (tmp_path / "b.3mf").read_bytes()


def test_svg_shows_every_edge(structure: Structure, tmp_path: Path) -> None:
    structure.write_svg(tmp_path / "a.svg", layer=-1)
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    *_, last = structure.layers
    number = r"(-?[\d.]+)"
    rows = re.findall(rf"M{number} {number}L{number} {number}", text)
    ends = np.array(rows, np.float64)
    lengths = np.hypot(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1])
    assert lengths.sum() == pytest.approx(last.diagram.lengths().sum(), rel=1e-5)
    assert f"layer {last.index}" in text


def test_the_thesis_has_no_walls_in_space() -> None:
    structure = v3dcad.fill(
        Box(20, 20, 5).wrapped, method="thesis", sites=6, layer_height=1.0, offset=0.1
    )
    for refused in (structure.faces, lambda: structure.sites_at([(0, 0, 1)])):
        with pytest.raises(SettingError, match=r"thesis: its layers have no walls"):
            refused()
    assert len(solids_of(structure.beads(0.8, "rectangle"))) > 10


@pytest.mark.parametrize(("width", "height"), [(0.01, 0.05), (0.02, 0.4), (2.0, 40.0)])
def test_tiny_and_slender_parts_have_walls_to_the_top(width: float, height: float) -> None:
    part = Box(width, width, height)
    slender = v3dcad.fill(part.wrapped, cell_size=width / 3, layer_height=height / 50)
    facets = slender.facets()
    assert facets.points[:, 2].min() <= height * 1e-9
    assert facets.points[:, 2].max() >= height * (1 - 1e-9)
    assert len(facets) >= len(slender.walls.tilts) > 20


def test_mistakes_are_named(structure: Structure, tmp_path: Path) -> None:
    for wrong in (
        lambda: structure.struts(0),
        lambda: structure.beads(0),
        lambda: structure.write_3mf(tmp_path / "a.3mf", "beams", diameter=-1),
        lambda: structure.write_stl(tmp_path / "a.stl", "solid", thickness=0),
    ):
        with pytest.raises(SettingError, match="give a number above 0 mm"):
            wrong()
    with pytest.raises(SettingError, match="solid needs a thickness"):
        structure.write_stl(tmp_path / "a.stl", "solid")
    for write in (structure.write_step, structure.write_brep):
        for form, needed in {"solid": "thickness", "struts": "diameter", "beads": "width"}.items():
            with pytest.raises(SettingError, match=f"{form} needs a {needed}, mm"):
                write(tmp_path / "a", form)
            with pytest.raises(SettingError, match=f"{form} has no size: it takes {needed}, "):
                write(tmp_path / "a", form, size=1)
        with pytest.raises(SettingError, match="wires has no diameter: it takes no size"):
            write(tmp_path / "a", "wires", diameter=1)
        with pytest.raises(SettingError, match="form 'foam'"):
            write(tmp_path / "a", "foam")
    with pytest.raises(SettingError, match="form 'foam'"):
        structure.write_stl(tmp_path / "a.stl", "foam")
    with pytest.raises(SettingError, match="AP214 or AP242"):
        structure.write_step(tmp_path / "a.step", schema="AP203")
    with pytest.raises(SettingError, match=r"rounded bead 0\.5 mm wide"):
        structure.beads(0.5)
    assert not list(tmp_path.iterdir())


def test_cells_that_struts_close_up_are_counted(structure: Structure) -> None:
    facets, (low, high) = structure.facets(), structure.part.bounds
    count = len(np.unique(facets.sites))
    for diameter in (14.0, 20.0, 60.0):
        closed = count - len(inset_cells(facets, diameter / 2, low - 1, high + 1))
        assert closed > 0
        narrow = "1 cell is" if closed == 1 else f"{closed} cells are"
        says = f"{narrow} narrower than a diameter of {diameter:g} mm, and filled solid"
        with pytest.warns(UserWarning, match=says):
            structure.strut_mesh(diameter)
