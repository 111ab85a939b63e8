"""The main job on real parts: laws of every layer, and what the files hold."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import shapely
from gcode_reader import read_moves
from parts import part_file

import v3dcad
from v3dcad import PrintSettings, Structure
from v3dcad.model import Layer, Placement

SAMPLE_PARTS = ["bracket.step", "cone.step", "islands.step", "pyramid.step", "pyramid.stl"]
SHARED_PARTS = ["bunny.stl", "nist_ctc_01_asme1_rd.stp", "nist_ftc_11_asme1_rb.stp"]


def area_of(layer: Layer) -> shapely.Geometry:
    return shapely.build_area(
        shapely.multilinestrings(
            [shapely.linestrings(np.vstack([ring, ring[:1]])) for ring in layer.section.rings]
        )
    )


def path_of(name: str, samples: Path) -> Path:
    return part_file(name) if name in SHARED_PARTS else samples / name


@pytest.mark.parametrize("name", SAMPLE_PARTS + SHARED_PARTS)
def test_every_layer_of_a_real_part_is_tiled(name: str, samples: Path) -> None:
    path = path_of(name, samples)
    high = np.ptp(v3dcad.pipeline.part_from(path).bounds[:, 2])
    structure = v3dcad.fill(path, layer_height=high / 23, offset=0.1)
    assert len(structure.layers) == 23
    born_in, newborn = structure.filling.births.T
    for layer in structure.layers:
        if not layer.section.rings:
            assert name == "bunny.stl", "of these parts the bunny alone stands on a single point"
            assert layer.index == 0
            continue
        area = area_of(layer).area
        assert layer.diagram.areas(len(layer.state.sites)).sum() == pytest.approx(area, rel=1e-9)
        ends = np.sort(layer.diagram.edges, axis=1)
        assert len(np.unique(ends, axis=0)) == len(ends)
        cells = np.nonzero(layer.diagram.areas(len(layer.state.sites)) > 0)[0]
        # A newborn counts from its first layer on, although its cell is still empty there; but one
        # that comes in from outside counts once its cell is in the section.
        counted = np.union1d(cells, newborn[born_in == layer.index])
        count = round(area / layer.area_per_cell)
        assert len(cells) <= count <= len(counted)
        assert layer.area_per_cell * count == pytest.approx(area)


def test_volumes_of_samples_by_their_sections(samples: Path) -> None:
    """Section areas, summed by the midpoint rule, give the volume known in closed form."""
    known = {
        "cone.step": math.pi * 30 / 3 * (20**2 + 20 * 15 + 15**2),
        "islands.step": 20 * (math.pi * 10**2 + 24**2 - math.pi * 6**2),
    }
    for name, volume in known.items():
        structure = v3dcad.fill(samples / name, layer_height=0.25, sites=1)
        areas = [area_of(layer).area for layer in structure.layers][1::2]
        assert sum(areas) * 0.5 == pytest.approx(volume, rel=1e-3)


def test_inches_are_millimetres(tmp_path: Path, samples: Path) -> None:
    """A STEP file whose unit is the inch comes in at 25.4 times its numbers."""
    text = (samples / "pyramid.step").read_text(encoding="utf-8")
    unit = re.search(
        r"#\d+ = \( LENGTH_UNIT\(\) NAMED_UNIT\(\*\) SI_UNIT\(\.MILLI\.,\.METRE\.\) \);", text
    )
    assert unit is not None
    number = re.match(r"#\d+", unit[0])
    assert number is not None
    inch = (
        f"{number[0]} = "
        "( CONVERSION_BASED_UNIT('INCH',#90001) LENGTH_UNIT() NAMED_UNIT(#90003) );\n"
        "#90001 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#90002);\n"
        "#90002 = ( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) );\n"
        "#90003 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);"
    )
    path = tmp_path / "inches.step"
    path.write_text(text.replace(unit[0], inch), encoding="utf-8")
    bounds = v3dcad.pipeline.part_from(path).bounds
    assert np.ptp(bounds, axis=0) == pytest.approx([67 * 25.4, 67 * 25.4, 50 * 25.4])


def test_a_part_fills_alike_wherever_it_lies(samples: Path) -> None:
    part = v3dcad.pipeline.part_from(samples / "bracket.step")
    moved = part.placed(Placement(np.eye(3), np.array([64.0, -32.0, 128.0])))
    one = v3dcad.build(part, v3dcad.FillSettings(layer_height=4.0, sites=12))
    other = v3dcad.build(moved, v3dcad.FillSettings(layer_height=4.0, sites=12))
    for a, b in zip(one.layers, other.layers, strict=True):
        assert b.diagram.areas(12) == pytest.approx(a.diagram.areas(12), abs=1e-4)


@pytest.fixture(scope="module")
def bracket(samples: Path) -> Structure:
    return v3dcad.fill(samples / "bracket.step", layer_height=2.0, offset=0.2, sites=40)


@pytest.mark.parametrize("name", ["bracket.step", "islands.step", "pyramid.stl"])
def test_gcode_stays_in_the_part_and_lays_every_edge(
    name: str, samples: Path, tmp_path: Path
) -> None:
    structure = v3dcad.fill(samples / name, layer_height=2.0)
    settings = PrintSettings(retraction=1.0, contour="centre", minimum_edge=0.0)
    structure.write_gcode(tmp_path / "a.gcode", settings)
    text = (tmp_path / "a.gcode").read_text(encoding="utf-8")
    moves = read_moves(text)
    printing = moves.printing()
    shift = np.array([110.0, 110.0, 0.0])
    below = 0.0
    total = 0.0
    for layer in structure.layers:
        z = layer.z + settings.first_layer_height
        rows = printing & (np.abs(moves.stops[:, 2] - z) < 1e-6)
        lines = shapely.linestrings(
            np.stack([moves.starts[rows], moves.stops[rows]], axis=1)[:, :, :2] - shift[:2]
        )
        grown = area_of(layer).buffer(1e-3)
        shapely.prepare(grown)
        assert shapely.covers(grown, lines).all()
        lengths = layer.diagram.lengths()
        assert shapely.length(lines).sum() == pytest.approx(lengths.sum(), rel=1e-3)
        # G-code counts in µm: shorter edges may vanish.
        assert np.count_nonzero(lengths > 1.5e-3) <= len(lines) <= np.count_nonzero(lengths > 1e-4)
        total += lengths.sum() * settings.bead_width * (z - below)
        below = z
    filament = math.pi / 4 * settings.filament_diameter**2
    assert moves.extruded.sum() * filament == pytest.approx(total, rel=1e-6)
    assert moves.extruded[moves.extruded < 0] == pytest.approx(-1.0, abs=2e-5)
    heights = moves.stops[printing, 2]
    assert (np.diff(heights) >= 0).all()
    assert (moves.stops[printing, :2] > 0).all()
    assert (moves.stops[printing, :2] < 220).all()


def test_step_lies_where_the_part_lies(bracket: Structure, samples: Path, tmp_path: Path) -> None:
    bracket.write_step(tmp_path / "a.step")
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopoDS import TopoDS_Iterator

    reader = STEPControl_Reader()
    reader.ReadFile(str(tmp_path / "a.step"))
    reader.TransferRoots()
    shape = reader.OneShape()
    assert BRepCheck_Analyzer(shape).IsValid()
    properties = GProp_GProps()
    BRepGProp.LinearProperties_s(shape, properties)
    length = sum(layer.diagram.lengths().sum() for layer in bracket.layers)
    # Arcs are longer than their chords, and walls end on them.
    assert properties.Mass() == pytest.approx(length, rel=1e-4)
    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    part = v3dcad.pipeline.part_from(samples / "bracket.step")
    low = [box.CornerMin().X(), box.CornerMin().Y(), box.CornerMin().Z()]
    assert low == pytest.approx(part.bounds[0], abs=1e-4)
    children = TopoDS_Iterator(shape)
    count = 0
    while children.More():
        count += 1
        children.Next()
    assert count == len(bracket.layers)


def test_step_by_an_independent_reading(samples: Path, tmp_path: Path) -> None:
    """Part 21 taken apart by hand: one named product a layer, every edge in one polyline."""
    pyramid = v3dcad.fill(samples / "pyramid.stl", layer_height=5.0)
    pyramid.write_step(tmp_path / "a.step")
    text = (tmp_path / "a.step").read_text(encoding="utf-8").replace("\n", "")
    assert "1970-01-01T00:00:00" in text
    names = re.findall(r"PRODUCT\('([^']*)'", text)
    for layer in pyramid.layers:
        assert f"layer {layer.index} z {layer.z:g}" in names
    polylines = re.findall(r"B_SPLINE_CURVE_WITH_KNOTS\('',1,\(([^)]*)\)", text)
    drawn = sum(poles.count("#") - 1 for poles in polylines)
    assert drawn == sum(
        np.count_nonzero(layer.diagram.lengths() > 1e-7) for layer in pyramid.layers
    )
    # A vertex of odd degree ends a trail: never more of them than needed.
    odd = sum(
        np.count_nonzero(np.bincount(layer.diagram.edges.ravel()) % 2) for layer in pyramid.layers
    )
    assert len(polylines) <= odd / 2 + sum(len(layer.section.rings) for layer in pyramid.layers)


def test_ont_of_an_stl_part_regenerates_it(samples: Path, tmp_path: Path) -> None:
    structure = v3dcad.fill(samples / "pyramid.stl", layer_height=2.5, offset=0.3, sites=20)
    structure.write_ont(tmp_path / "a.ont")
    again = v3dcad.fill(tmp_path / "a.ont")
    assert not again.placement.translation.any()
    assert again.settings.offset == 0.3
    for one, other in zip(structure.layers, again.layers, strict=True):
        assert np.array_equal(one.diagram.vertices, other.diagram.vertices)
        assert np.array_equal(one.diagram.edges, other.diagram.edges)
        assert np.array_equal(one.diagram.edge_sites, other.diagram.edge_sites)
    again.write_ont(tmp_path / "b.ont")
    assert (tmp_path / "a.ont").read_bytes() == (tmp_path / "b.ont").read_bytes()


def test_every_file_is_the_same_twice(samples: Path, tmp_path: Path) -> None:
    for run in ("one", "two"):
        structure = v3dcad.fill(samples / "islands.step", layer_height=5.0, sites=10)
        for kind in ("ont", "gcode", "step", "png", "report"):
            getattr(structure, f"write_{kind}")(tmp_path / run / f"islands.{kind}")
    for file in sorted((tmp_path / "one").iterdir()):
        assert file.read_bytes() == (tmp_path / "two" / file.name).read_bytes(), file.name


def test_report_counts_what_the_layers_hold(bracket: Structure, tmp_path: Path) -> None:
    bracket.write_report(tmp_path / "a.json")
    report = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    assert report["layers"] == len(bracket.layers) == len(report["by_layer"]) == 24
    first = next(iter(bracket.layers))
    assert report["by_layer"][0]["cells"] == 40
    assert report["by_layer"][0]["contour_length_mm"] == pytest.approx(area_of(first).length)
    assert report["settings"]["layer_height"] == 2.0


def test_picture_is_a_png_with_something_on_it(bracket: Structure, tmp_path: Path) -> None:
    from matplotlib.image import imread

    bracket.write_png(tmp_path / "a.png")
    pixels = imread(tmp_path / "a.png")
    assert pixels.shape[:2] == (1200, 1200)
    assert 0.05 < np.mean(pixels[:, :, :3].min(axis=2) < 0.99) < 0.95


def test_shapes_and_meshes_are_parts_too(samples: Path) -> None:
    from build123d import Box, import_step

    box = v3dcad.fill(Box(10, 10, 10), layer_height=5.0, sites=4)
    vertices = np.array([[x, y, z] for x in (0, 9.0) for y in (0, 9.0) for z in (0, 9.0)])
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    faces += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    cube = v3dcad.fill((vertices, np.array(faces)), layer_height=4.5, sites=4)
    again = v3dcad.fill(import_step(samples / "pyramid.step"), layer_height=25.0, sites=4)
    for structure, side in ((box, 10), (cube, 9), (again, 67)):
        assert area_of(next(iter(structure.layers))).area == pytest.approx(side**2, rel=1e-4)


def test_sites_may_be_given(samples: Path) -> None:
    places = [(-5.0, -5.0), (5.0, 5.0), (0.0, 8.0)]
    structure = v3dcad.fill(samples / "cone.step", layer_height=10.0, sites=places)
    assert structure.sites == pytest.approx(np.array(places), abs=3e-6), "snapped to the grid"


def test_mistakes_in_a_call_are_named(samples: Path) -> None:
    with pytest.raises(v3dcad.SettingError, match="'layerheight'"):
        v3dcad.fill(samples / "cone.step", layerheight=1)
    with pytest.raises(v3dcad.GeometryError, match="dict cannot be filled"):
        v3dcad.fill({})
    with pytest.raises(v3dcad.SettingError, match="all sites lie outside"):
        v3dcad.fill(samples / "cone.step", sites=[(90.0, 0.0)])
