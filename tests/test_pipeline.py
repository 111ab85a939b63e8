"""The main job on real parts: laws of every layer, and what the files hold."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import shapely
from build123d import Box, import_step
from diagrams import WIDE
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
    structure = v3dcad.fill(path, layer_height=high / 23)
    assert len(structure.layers) == 23
    for layer in structure.layers:
        if not layer.section.rings:
            assert name == "bunny.stl", "of these parts the bunny alone stands on a single point"
            assert layer.index == 0
            continue
        area = area_of(layer).area
        assert layer.diagram.areas(len(layer.state.sites)).sum() == pytest.approx(area, rel=1e-9)
        ends = np.sort(layer.diagram.edges, axis=1)
        assert len(np.unique(ends, axis=0)) == len(ends)
        cells = layer.diagram.sites()
        assert np.isin(cells, layer.state.present()).all()
        assert layer.area_per_cell * len(cells) == pytest.approx(area)


def test_volumes_of_samples_by_their_sections(samples: Path) -> None:
    """Section areas, summed by the midpoint rule, give the volume known in closed form."""
    known = {
        "cone.step": math.pi * 30 / 3 * (20**2 + 20 * 15 + 15**2),
        "islands.step": 20 * (math.pi * 10**2 + 24**2 - math.pi * 6**2),
    }
    for name, volume in known.items():
        structure = v3dcad.fill(samples / name, layer_height=0.5, sites=[(0, 0)])
        areas = [area_of(layer).area for layer in structure.layers]
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
    one = v3dcad.build(part, v3dcad.FillSettings(layer_height=4.0, cell_size=10.0))
    other = v3dcad.build(moved, v3dcad.FillSettings(layer_height=4.0, cell_size=10.0))
    count = len(one.sites)
    assert len(other.sites) == count
    for a, b in zip(one.layers, other.layers, strict=True):
        assert b.diagram.areas(count) == pytest.approx(a.diagram.areas(count), abs=1e-4)


@pytest.fixture(scope="module")
def bracket(samples: Path) -> Structure:
    return v3dcad.fill(samples / "bracket.step", layer_height=2.0, cell_size=8.0)


@pytest.mark.parametrize("name", ["bracket.step", "islands.step", "pyramid.stl"])
def test_gcode_stays_in_the_part_and_lays_every_edge(
    name: str, samples: Path, tmp_path: Path
) -> None:
    structure = v3dcad.fill(samples / name, layer_height=0.8)
    settings = PrintSettings(
        **{
            **WIDE,
            "retraction": 1.0,
            "contour": "centre",
            "minimum_edge": 0.0,
            "bridge_speed": 10.0,
        }
    )
    structure.write_gcode(tmp_path / "a.gcode", settings)
    text = (tmp_path / "a.gcode").read_text(encoding="utf-8")
    moves = read_moves(text)
    printing = moves.printing()
    shift = np.array([110.0, 110.0, 0.0])
    below = 0.0
    total = 0.0
    for layer in structure.layers:
        z = layer.z - structure.layers[0].z + settings.first_layer_height
        rows = printing & (np.abs(moves.stops[:, 2] - z) < 1e-6)
        lines = shapely.linestrings(
            np.stack([moves.starts[rows], moves.stops[rows]], axis=1)[:, :, :2] - shift[:2]
        )
        grown = area_of(layer).buffer(1e-3)
        shapely.prepare(grown)
        assert shapely.covers(grown, lines).all()
        # Some walls are passed twice, there and back; G-code counts in µm.
        ends = shapely.get_coordinates(lines).round(3).view(np.complex128).reshape(-1, 2)
        once = np.unique(np.sort(ends, axis=1), axis=0)
        there = shapely.linestrings(once.view(np.float64).reshape(-1, 2, 2))
        lengths = layer.diagram.lengths()
        assert shapely.length(there).sum() == pytest.approx(lengths.sum(), rel=1e-3)
        # The shortest edges may vanish.
        assert np.count_nonzero(lengths > 1.5e-3) <= len(there) <= np.count_nonzero(lengths > 1e-4)
        room = shapely.union_all(lines).buffer(settings.bead_width / 2).area
        total += room * (z - below)
        below = z
    filament = math.pi / 4 * settings.filament_diameter**2
    assert moves.extruded.sum() * filament == pytest.approx(total, rel=0.04)
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
    first = np.array([0, 0, 1.0])  # in the middle of a layer of 2 mm
    assert low == pytest.approx(part.bounds[0] + first, abs=1e-4)
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
    polylines = re.findall(r"POLYLINE\('',\(([^)]*)\)", text)
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
    structure = v3dcad.fill(samples / "pyramid.stl", layer_height=2.5, cell_size=14.0)
    structure.write_ont(tmp_path / "a.ont")
    again = v3dcad.fill(tmp_path / "a.ont")
    assert not again.placement.translation.any()
    assert again.settings == structure.settings
    for one, other in zip(structure.layers, again.layers, strict=True):
        assert np.array_equal(one.diagram.vertices, other.diagram.vertices)
        assert np.array_equal(one.diagram.edges, other.diagram.edges)
        assert np.array_equal(one.diagram.edge_sites, other.diagram.edge_sites)
    again.write_ont(tmp_path / "b.ont")
    assert (tmp_path / "a.ont").read_bytes() == (tmp_path / "b.ont").read_bytes()


def test_every_file_is_the_same_twice(samples: Path, tmp_path: Path) -> None:
    for run in ("one", "two"):
        structure = v3dcad.fill(samples / "islands.step", layer_height=0.4, cell_size=8.0)
        for kind in ("ont", "gcode", "step", "report"):
            getattr(structure, f"write_{kind}")(tmp_path / run / f"islands.{kind}")
        structure.write_picture(tmp_path / run / "islands.png")
    for file in sorted((tmp_path / "one").iterdir()):
        assert file.read_bytes() == (tmp_path / "two" / file.name).read_bytes(), file.name


def test_report_counts_what_the_layers_hold(bracket: Structure, tmp_path: Path) -> None:
    bracket.write_report(tmp_path / "a.json")
    report = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    assert report["layers"] == len(bracket.layers) == len(report["by_layer"]) == 24
    first = next(iter(bracket.layers))
    assert report["by_layer"][0]["cells"] == len(first.diagram.sites())
    assert report["by_layer"][0]["contour_length_mm"] == pytest.approx(area_of(first).length)
    assert report["settings"]["layer_height"] == 2.0


def test_picture_is_a_png_with_something_on_it(bracket: Structure, tmp_path: Path) -> None:
    from matplotlib.image import imread

    bracket.write_picture(tmp_path / "a.png")
    pixels = imread(tmp_path / "a.png")
    assert pixels.shape[:2] == (1200, 1200)
    assert 0.05 < np.mean(pixels[:, :, :3].min(axis=2) < 0.99) < 0.95


def test_shapes_and_meshes_are_parts_too(samples: Path) -> None:
    box = v3dcad.fill(Box(10, 10, 10), layer_height=5.0, cell_size=4.0)
    vertices = np.array([[x, y, z] for x in (0, 9.0) for y in (0, 9.0) for z in (0, 9.0)])
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    faces += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    cube = v3dcad.fill((vertices, np.array(faces)), layer_height=4.5, cell_size=4.0)
    again = v3dcad.fill(
        import_step(samples / "pyramid.step"), layer_height=25.0, cell_size=4.0, heights="bottom"
    )
    for structure, side in ((box, 10), (cube, 9), (again, 67)):
        assert area_of(next(iter(structure.layers))).area == pytest.approx(side**2, rel=1e-4)


def test_sites_of_a_plane_are_columns(samples: Path) -> None:
    places = [(-5.0, -5.0), (5.0, 5.0), (0.0, 8.0)]
    structure = v3dcad.fill(samples / "cone.step", layer_height=10.0, sites=places)
    expected = np.column_stack([places, np.zeros(3)])
    assert structure.sites == pytest.approx(expected, abs=3e-6), "snapped to the grid"
    assert structure.settings.stretch == "columns"
    pairs = [sorted(layer.diagram.neighbours.tolist()) for layer in structure.layers]
    assert pairs == [[[0, 1], [0, 2], [1, 2]]] * 3


def test_sites_in_space_need_a_stretch(samples: Path) -> None:
    """Two sites, which once were silently read as three pairs: a wall upright between them."""
    places = [(0, 0, 0), (5, 5, 0)]
    with pytest.raises(v3dcad.SettingError, match="sites in space need a number") as caught:
        v3dcad.fill(samples / "cone.step", layer_height=10.0, sites=places)
    assert caught.value.name == "stretch"
    structure = v3dcad.fill(samples / "cone.step", layer_height=10.0, sites=places, stretch=1.5)
    assert structure.sites == pytest.approx(np.array(places), abs=3e-6)
    for layer in structure.layers:
        assert layer.diagram.neighbours.tolist() == [[0, 1]]
        wall = layer.diagram.vertices[layer.diagram.edges[layer.diagram.inner()]]
        assert wall.sum(axis=2) == pytest.approx(5.0, abs=1e-5)


def test_walls_that_lean_too_much_are_refused(samples: Path) -> None:
    places = [(0, 0, 0), (4, 0, 3), (0, 9, 5)]
    fill = {"layer_height": 10.0, "sites": places}
    with pytest.raises(v3dcad.SettingError, match=r"sites 0 and 1 leans 36\.87°, more") as e:
        v3dcad.fill(samples / "cone.step", **fill, stretch=1, max_overhang=30)
    assert e.value.name == "max_overhang"
    for allowed in ({"stretch": 1.2}, {"stretch": 1, "max_overhang": 40}):
        v3dcad.fill(samples / "cone.step", **fill, **{"max_overhang": 30, **allowed})
    flat = {"layer_height": 10.0, "sites": [(0, 0, 5), (0, 0, 20)], "stretch": 1}
    with pytest.raises(v3dcad.SettingError, match=r"leans 90°, more than 80°"):
        v3dcad.fill(samples / "cone.step", **flat, max_overhang=80)
    taken = v3dcad.fill(samples / "cone.step", **flat, max_overhang=90)
    # Sections at 5, 15 and 25 mm, the wall at 12.5.
    assert [layer.diagram.sites().tolist() for layer in taken.layers] == [[0], [1], [1]]


def test_mistakes_in_a_call_are_named(samples: Path) -> None:
    with pytest.raises(v3dcad.SettingError, match="'layerheight'"):
        v3dcad.fill(samples / "cone.step", layerheight=1)
    with pytest.raises(v3dcad.GeometryError, match="dict cannot be filled"):
        v3dcad.fill({})
    with pytest.raises(v3dcad.SettingError, match="all sites lie outside"):
        v3dcad.fill(samples / "cone.step", sites=[(90.0, 0.0)])
    for sites in ([1, 2, 3], [(1, 2), (3, 4, 5)], [(1, 2, 3, 4)], [], "12", [("a", "b")]):
        with pytest.raises(v3dcad.SettingError, match="give rows of x, y, z, or of x, y for col"):
            v3dcad.fill(samples / "cone.step", sites=sites)


@pytest.mark.parametrize(
    ("settings", "name"),
    [
        ({"sites": 40}, "sites"),
        ({"offset": "auto"}, "offset"),
        ({"weight_step": 1.0}, "weight_step"),
        ({"boundary_tolerance": 0.1}, "boundary_tolerance"),
        ({"method": "thesis", "cell_size": "auto"}, "cell_size"),
        ({"method": "thesis", "stretch": "columns"}, "stretch"),
    ],
)
def test_a_setting_of_the_other_method_is_refused(
    settings: dict[str, object], name: str, samples: Path
) -> None:
    """Even where it is given as its default."""
    own = "foam" if "method" in settings else "thesis"
    says = f"{name} is a setting of method {own}, not of "
    with pytest.raises(v3dcad.SettingError, match=says) as caught:
        v3dcad.fill(samples / "cone.step", **settings)
    assert caught.value.name == name


def test_settings_say_what_auto_stood_for(samples: Path) -> None:
    filled = {
        limit: v3dcad.fill(samples / "cone.step", layer_height=10.0, max_overhang=limit).settings
        for limit in (30.0, 45.0, 80.0, 90.0)
    }
    for limit, settings in filled.items():
        least = max(1.0, 1.25 / math.tan(math.radians(min(limit, 89.9))))
        assert settings.stretch == pytest.approx(least)
        assert settings.cell_size == pytest.approx(40 / math.sqrt(40))
    for size, expected in (((60, 40, 9), math.sqrt(60)), ((200, 200, 9), 15), ((9, 9, 9), 3)):
        made = v3dcad.fill(Box(*size), layer_height=3.0)
        assert made.settings.cell_size == pytest.approx(expected)
    tiny = v3dcad.fill(Box(1, 1, 2), layer_height=0.5)
    assert tiny.settings.cell_size == pytest.approx(1), "at most as wide as the part"


def test_what_sites_weigh(bracket: Structure) -> None:
    """The slice law: squared distance in the stretched space, less what is common to all."""
    stretch = bracket.settings.stretch
    assert isinstance(stretch, float)
    for layer in bracket.layers:
        x, y, z = layer.state.sites.T
        assert layer.state.growth == pytest.approx(2 * z / stretch**2, rel=1e-9)
        expected = -(((layer.z - z) / stretch) ** 2)
        assert layer.state.weights == pytest.approx(expected, rel=1e-6, abs=1e-3)
        ends = layer.diagram.vertices[layer.diagram.edges[layer.diagram.inner()]]
        middle = ends.mean(axis=1)
        beside = layer.diagram.edge_sites[layer.diagram.inner()]
        far = [
            (middle[:, 0] - x[k]) ** 2
            + (middle[:, 1] - y[k]) ** 2
            + ((layer.z - z[k]) / stretch) ** 2
            for k in beside.T
        ]
        assert far[0] == pytest.approx(far[1], abs=1e-4)


def test_settings_of_numpy_make_an_ont_that_is_read_back(samples: Path, tmp_path: Path) -> None:
    size, height = np.float32(10), np.float64(4)
    structure = v3dcad.fill(samples / "pyramid.stl", cell_size=size, layer_height=height)
    structure.write_ont(tmp_path / "a.ont")
    assert v3dcad.read_ont(tmp_path / "a.ont").settings == structure.settings


def test_what_cannot_be_meant_is_refused_by_its_name(samples: Path) -> None:
    structure = v3dcad.fill(samples / "pyramid.stl", cell_size=10, layer_height=4)
    count = len(structure.layers)
    for index in (count, -count - 1):
        with pytest.raises(v3dcad.SettingError, match=f"layer {index}: the layers are 0 to"):
            structure.layers[index]
    assert next(reversed(structure.layers)).index == count - 1
    cases = {
        "points": lambda: structure.sites_at([(0, 0), (1, 1), (2, 2)]),
        "z": lambda: structure.at("3"),
        "bead_width": lambda: structure.overhang("1"),
        "density": lambda: structure.properties(density=None),
        "beyond": lambda: structure.facets("1"),
        "thickness": lambda: structure.solid_mesh("1"),
        "diameter": lambda: structure.strut_mesh([1]),
        "svg_layer": lambda: structure.write_svg("a.svg", layer=1.0),
        "count": lambda: structure.layers[0].diagram.areas(1),
        "up": lambda: v3dcad.place_on_bed(structure.part, up=1.5),
        "rotate": lambda: v3dcad.place_on_bed(structure.part, rotate=(1, 2, "a")),
        "section": lambda: v3dcad.section(structure.part)[-10_000],
        "heights": lambda: structure.part.sections("abc"),
        "sites": lambda: v3dcad.fill(structure.part, sites=[(1, 2), (3,)]),
        "vertices": lambda: v3dcad.part_from(([(0, 0)], [(0, 0, 0)])),
        "triangles": lambda: v3dcad.part_from(([(0, 0, 0)], [(0, 0, 0.5)])),
    }
    for name, call in cases.items():
        with pytest.raises(v3dcad.SettingError) as caught:
            call()
        assert caught.value.name == name
