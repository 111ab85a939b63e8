"""Pictures: what is painted against the structure, and how it looks against stored references."""

from __future__ import annotations

import io
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
import pytest
import shapely
import trimesh
from PIL import Image

import v3dcad
from tests.view.references import LAYER, channels, picture, pyramid, small, stored_picture
from tests.view.similarity import similarity
from v3dcad import PrintSettings
from v3dcad.errors import SettingError
from v3dcad.formats.gcode.blocks import Totals
from v3dcad.geometry.section_area import section_area
from v3dcad.model import Diagram, Floats, Layer, Section
from v3dcad.report import Print
from v3dcad.view import picture as painting
from v3dcad.view.outline import outline
from v3dcad.view.perspective import Areas, Eye, Strips, contour_strips, wall_strips
from v3dcad.view.picture import choose
from v3dcad.view.targets.declared import TARGETS
from v3dcad.view.trimming import HAIR, trimmed

pytestmark = pytest.mark.slow


def above(layer: Layer) -> tuple[float, float]:
    """From a layer's height to 0.5 mm above it."""
    return layer.z, layer.z + 0.5


def strips_of(layer: Layer, span: tuple[float, float], corner: Floats | None = None) -> Strips:
    """A layer's wall strips, where the sides of the part are upright."""
    zeros = np.zeros(len(layer.diagram.edges))
    return wall_strips(layer, span, zeros, corner, Areas(*3 * [section_area(layer.section)]))


def strips(layer: Layer, corner: Floats | None = None) -> Floats:
    """The corners of a layer's wall strips, 0.5 mm high."""
    return strips_of(layer, above(layer), corner).corners


def corners_by_sites(diagram: Diagram) -> dict[tuple[int, ...], Floats]:
    """Where three cells and no contour meet, by the three sites."""
    met: dict[int, set[int]] = {}
    for ends, sites in zip(diagram.edges.tolist(), diagram.edge_sites.tolist(), strict=True):
        for end in ends:
            met.setdefault(end, set()).update(sites)
    return {
        tuple(sorted(sites)): diagram.vertices[end]
        for end, sites in met.items()
        if len(sites) == 3 and -1 not in sites
    }


@pytest.mark.parametrize("higher", [-0.5, 0.5])
def test_strips_lean_as_the_walls_do(higher: float) -> None:
    """Against the diagram half a millimetre higher or lower, which is computed anew."""
    layer = pyramid().layers[LAYER]
    here, there = (
        corners_by_sites(diagram) for diagram in (layer.diagram, pyramid().at(layer.z + higher))
    )
    painted = strips_of(layer, (layer.z - 0.5, layer.z + 0.5)).corners.reshape(-1, 3)
    ends = painted[painted[:, 2] == layer.z + higher][:, :2]
    checked = 0
    for sites in here.keys() & there.keys():
        if np.linalg.norm(here[sites] - there[sites]) > 1:
            continue  # it moves so fast that the picture holds it back
        assert np.linalg.norm(ends - there[sites], axis=1).min() < 1e-6
        checked += np.linalg.norm(here[sites] - there[sites]) > 1e-3
    assert checked > 5


def test_the_picture_is_of_the_same_layers_as_the_part(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where sections lie in the middle of layers, strips begin below them, on the bed."""
    spans = []

    def seen(layer: Layer, span: tuple[float, float], *more: object) -> Strips:
        spans.append(span)
        return wall_strips(layer, span, *more)  # type: ignore[arg-type]

    monkeypatch.setattr(painting, "wall_strips", seen)
    pyramid().picture()
    assert spans == [(2.0 * k, 2.0 * (k + 1)) for k in range(25)]


@pytest.mark.parametrize("corner", [(0.0, 0.0), (-9.0, 4.0), (100.0, 0.0), (-100.0, 100.0)])
def test_just_the_nearest_quarter_is_cut_away(corner: tuple[float, float]) -> None:
    layer = pyramid().layers[LAYER]
    diagram, (x, y) = layer.diagram, corner
    gone = shapely.box(x, -1000, 1000, y)
    walls = shapely.multilinestrings(list(diagram.vertices[diagram.edges[diagram.inner()]]))
    left = strips(layer, np.array(corner))[:, :2, :2]
    expected = shapely.difference(walls, gone)
    found = shapely.union_all(shapely.linestrings(left))
    assert found.length == pytest.approx(expected.length, abs=1e-9)
    if not expected.is_empty:
        assert shapely.hausdorff_distance(found, expected) < 1e-9


def test_cut_sides_stand_on_the_planes_of_the_cut() -> None:
    layer = pyramid().layers[LAYER]
    sides = strips_of(layer, above(layer), np.zeros(2)).sides()
    assert len(sides) > 3
    assert np.abs(sides[:, 0, :2]).min(axis=1).max() < 1e-9
    assert (sides[:, 1, 2] == layer.z + 0.5).all()
    assert not len(strips_of(layer, above(layer)).sides())


@pytest.mark.parametrize("file", ["pyramid.stl", "cone.step"])
@pytest.mark.parametrize("height", [0.4, 3.0])
def test_walls_stay_in_the_part(
    file: str, height: float, samples: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where its sides slope and layers are high; the mesh of the part is the oracle."""
    drawn = []

    def seen(*arguments: object) -> Strips:
        found = wall_strips(*arguments)  # type: ignore[arg-type]
        drawn.append(found.corners)
        return found

    monkeypatch.setattr(painting, "wall_strips", seen)
    structure = v3dcad.fill(samples / file, cell_size=8, layer_height=height)
    structure.picture()
    mesh = structure.part.mesh()
    body = trimesh.Trimesh(mesh.vertices, mesh.triangles)
    corners = np.concatenate(drawn).reshape(-1, 3)
    assert len(corners) > 500
    for z in np.unique(corners[:, 2])[:-1]:  # the last layer is upright, up to the top
        near = np.clip([z - 1e-3, z + 1e-3], 1e-3, mesh.vertices[:, 2].max() - 1e-3)
        part = shapely.union_all([mesh_section(body, height) for height in near])
        points = shapely.points(corners[corners[:, 2] == z, :2])
        assert shapely.distance(points, part).max() < 0.05


def mesh_section(body: trimesh.Trimesh, z: float) -> shapely.Geometry:
    """The area in which a plane cuts a mesh, by trimesh and shapely."""
    lines = trimesh.intersections.mesh_plane(body, [0, 0, 1], [0, 0, z])[:, :, :2]
    return shapely.build_area(shapely.union_all(shapely.linestrings(lines), grid_size=1e-6))


def test_edges_are_trimmed_to_their_longest_piece_in_an_area() -> None:
    """Against shapely's own intersection, and by cases that are worked out by hand."""
    area = shapely.box(0, 0, 10, 10).difference(shapely.box(4, 4, 5, 6))
    edges = np.random.default_rng(4).uniform(-2, 12, (400, 2, 2))
    found = trimmed(edges, area)
    pieces = shapely.intersection(shapely.linestrings(edges), area)
    inside = shapely.contains_xy(area, *np.moveaxis(edges, 2, 0)).all(axis=1)
    np.testing.assert_array_equal(found[inside], edges[inside])
    assert 50 < inside.sum() < 300
    for edge, kept, piece in zip(edges[~inside], found[~inside], pieces[~inside], strict=True):
        longest = max((part.length for part in shapely.get_parts(piece)), default=0.0)
        assert np.linalg.norm(kept[1] - kept[0]) == pytest.approx(longest, abs=HAIR * 20)
        assert (kept[1] - kept[0]) @ (edge[1] - edge[0]) >= 0
        assert shapely.distance(shapely.points(kept), area).max() < HAIR * 20
    np.testing.assert_allclose(trimmed(np.array([[[5.0, 2], [14, 2]]]), area), [[[5, 2], [10, 2]]])
    far = np.array([[[12.0, 3], [14, 3]]])
    np.testing.assert_allclose(trimmed(far, area), [[[10, 3], [10, 3]]])
    np.testing.assert_array_equal(trimmed(far, area, 1.9), far)
    np.testing.assert_array_equal(trimmed(far, shapely.Polygon()), far)


def test_contours_stand_upright() -> None:
    layer = pyramid().layers[LAYER]
    corners = contour_strips(layer, above(layer), 0.0).corners
    np.testing.assert_array_equal(corners[:, :2, :2], corners[:, [3, 2], :2])
    length = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1).sum()
    assert length == pytest.approx(shapely.Polygon(layer.section.rings[0]).length)


def test_the_outline_of_a_block_is_its_edges() -> None:
    mesh = pyramid().part.mesh()
    low, high = pyramid().part.bounds
    eye = Eye((low + high) / 2, float(np.linalg.norm(high - low)))
    edges = {tuple(sorted(map(tuple, ends.round(6).tolist()))) for ends in outline(mesh, eye)}
    assert len(edges) == 12
    heights = sorted(tuple(sorted({z for _, _, z in ends})) for ends in edges)
    top = float(high[2].round(6))
    assert heights == 4 * [(0.0,)] + 4 * [(0.0, top)] + 4 * [(top,)]


def test_what_is_nearer_looks_larger_and_what_is_higher_lies_higher() -> None:
    eye = Eye(np.zeros(3), 10.0)
    towards = eye.towards()
    assert np.linalg.norm(towards) == pytest.approx(1)
    places = np.array([towards, 0 * towards, -towards])
    across = np.array([np.cos(eye.turn), -np.sin(eye.turn), 0.0])
    (left, depth), (right, _) = eye.seen(places - across), eye.seen(places + across)
    assert (np.diff(depth) > 0).all()
    assert (np.diff(np.linalg.norm(right - left, axis=1)) < 0).all()
    flat, _ = eye.seen(np.array([[0, 0, 0.0], [0, 0, 1.0]]))
    assert flat[1, 1] > flat[0, 1]


@pytest.mark.parametrize("target", TARGETS)
def test_pictures_look_like_those_that_were_looked_at(target: str) -> None:
    found = channels(small(picture(target)))
    stored = {name: channels(stored_picture(name)) for name in TARGETS}
    likeness = {
        name: similarity(found, other)
        for name, other in stored.items()
        if found.shape == other.shape
    }
    assert likeness[target] > 0.95
    assert target == max(likeness, key=likeness.__getitem__)


def test_similarity_tells_pictures_apart() -> None:
    random = np.random.default_rng(1).uniform(size=(40, 60, 3))
    assert similarity(random, random) == pytest.approx(1)
    assert similarity(random, random[::-1]) < 0.3
    assert similarity(random, 0.9 * random) > similarity(random, 0.5 * random)


@pytest.mark.parametrize("kind", ["png", "svg"])
@pytest.mark.parametrize("target", ["full", "sizes"])
def test_the_same_picture_is_the_same_bytes_whatever_the_users_settings(
    target: str, kind: str
) -> None:
    first = pyramid().picture(target, kind=kind)
    with matplotlib.rc_context({"font.size": 30, "axes.facecolor": "red", "text.usetex": True}):
        assert pyramid().picture(target, kind=kind) == first


def words(svg: bytes) -> list[str]:
    """The texts in an SVG."""
    return ["".join(one.itertext()) for one in ET.fromstring(svg).iter() if one.tag[-5:] == "}text"]


def test_numbers_of_cells_are_drawn_when_they_are_asked_for() -> None:
    layer = pyramid().layers[LAYER]
    sites = {str(site) for site in layer.diagram.sites().tolist()}
    assert sites <= set(words(pyramid().picture("layer", LAYER, kind="svg", ids=True)))
    assert not sites & set(words(pyramid().picture("layer", LAYER, kind="svg"))) - {"0", "10", "20"}


def test_the_title_tells_size_cells_mass_and_time() -> None:
    totals = Totals(time_s=3 * 3600 + 5 * 60, mass_g=12.34)
    report = pyramid().report()
    plain = words(pyramid().picture(kind="svg"))
    assert plain == ["pyramid", f"67 × 67 × 50 mm, {report['cells']} cells"]
    told = words(pyramid().picture(kind="svg", printed=Print(totals, [], [])))
    assert told[1] == plain[1] + ", 12.3 g, 3 h 05 min"


def test_names_are_text_whatever_letters_they_have() -> None:
    name = "<script>alert(1)</script> $\\frac{1}{0}$ & co"
    part = replace(pyramid().part, name=name)  # type: ignore[type-var]
    drawn = words(replace(pyramid(), part=part).picture("layer", LAYER, kind="svg"))
    assert name in drawn


def block(*size: float) -> trimesh.Trimesh:
    return trimesh.creation.box(size)


def size_of(picture: bytes) -> tuple[int, int]:
    """Pixels: how wide and tall a PNG is."""
    return Image.open(io.BytesIO(picture)).size


def test_pictures_are_as_tall_as_what_they_show() -> None:
    square = v3dcad.fill(block(80, 80, 6), layer_height=2.0, cell_size=10.0)
    strip = v3dcad.fill(block(80, 20, 6), layer_height=2.0, cell_size=10.0)
    whole, flat = (size_of(one.picture("layer")) for one in (square, strip))
    assert whole == (1200, 1200)
    assert flat[0] == 1200
    assert flat[1] < 800
    assert size_of(strip.picture())[1] < 1000
    assert size_of(strip.thumbnail(100)) == (100, 100)


def test_of_very_many_layers_some_are_drawn_and_the_title_says_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    cells = choose(pyramid().layers).cells
    monkeypatch.setattr(painting, "MOST_WALLS", 300)
    chosen = choose(pyramid().layers)
    assert chosen.thinned
    assert chosen.cells == cells
    assert [layer.index for layer in chosen.layers] == [*range(0, 25, chosen.step)]
    told = words(pyramid().picture(kind="svg"))[1]
    assert told.endswith(f"; one in {chosen.step} of 25 layers is drawn")


def test_notebooks_show_structures_layers_and_sections() -> None:
    assert pyramid()._repr_html_().startswith("<iframe")
    layer = pyramid().layers[LAYER]
    drawn = ET.fromstring(layer._repr_svg_())
    paths = {one.get("id"): one.get("d", "") for one in drawn.iter() if one.tag[-4:] == "path"}
    inner = layer.diagram.inner()
    assert paths["walls"].count("M") == inner.sum()
    assert paths["contours"].count("M") == (~inner).sum()
    assert f"layer {LAYER}" in layer._repr_svg_()
    section = ET.fromstring(layer.section._repr_svg_())
    assert sum(one.tag[-4:] == "path" for one in section.iter()) == 1


@pytest.mark.parametrize("side", [0.5, 40.0, 1000.0])
def test_notebooks_show_every_size_as_large_and_with_the_same_lines(side: float) -> None:
    ring = np.array([[0.0, 0.0], [side, 0.0], [side, side / 2], [0.0, side / 2]])
    section = Section(0.0, (ring,))

    def drawn(text: str) -> tuple[float, float]:
        """The longer side in mm on the screen, and how wide lines are there."""
        svg = ET.fromstring(text)
        unit = float(svg.attrib["width"].removesuffix("mm")) / float(
            svg.attrib["viewBox"].split()[2]
        )
        return float(svg.attrib["width"].removesuffix("mm")), unit * float(
            svg[0].attrib["stroke-width"]
        )

    assert drawn(section.svg()) == pytest.approx((side + 2, 0.1), rel=1e-3)
    assert drawn(section._repr_svg_()) == pytest.approx((127.0, 0.3175), rel=1e-3)


def test_a_picture_is_written_by_its_ending(tmp_path: Path) -> None:
    pyramid().write_picture(tmp_path / "a.svg", "cut")
    assert "z (mm)" in words((tmp_path / "a.svg").read_bytes())
    pyramid().write_picture(tmp_path / "a.PNG", "toolpath", 3, printing=PrintSettings())
    assert (tmp_path / "a.PNG").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(SettingError, match=r"a\.pdf: not a kind of picture; give \.png or \.svg"):
        pyramid().write_picture(tmp_path / "a.pdf")
    with pytest.raises(SettingError, match="kind pdf: give png or svg"):
        pyramid().picture(kind="pdf")
    with pytest.raises(SettingError, match="layer 25: the layers are 0 to 24"):
        pyramid().write_picture(tmp_path / "b.png", "layer", 25)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.PNG", "a.svg"]


def test_pictures_need_nothing_that_could_open_a_window() -> None:
    code = (
        "import sys, v3dcad\n"
        "structure = v3dcad.fill(sys.argv[1], cell_size=20, layer_height=10.0)\n"
        "structure.picture(), structure.picture('sizes')\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    sample = Path(__file__).parents[2] / "samples" / "pyramid.stl"
    done = subprocess.run(
        [sys.executable, "-c", code, str(sample)], capture_output=True, check=False
    )
    assert done.returncode == 0, done.stderr
