"""Structures through `.ont` files and back: the same bytes, the same check sum, or an error."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from parts import part_file
from recipes import algorithm_10

import v3dcad
from v3dcad import FillSettings, FormatError, SettingError, ont
from v3dcad.errors import KernelError
from v3dcad.formats.ont.document import ont_text
from v3dcad.model import Brep, Mesh
from v3dcad.structure.placement import on_bed

pytestmark = pytest.mark.slow

SAMPLES = ["bracket.step", "cone.step", "islands.step", "pyramid.step", "pyramid.stl"]
SHARED = ["bunny.stl", "nist_ftc_11_asme1_rb.stp"]
FOAM = {"layer_height": 2.0, "cell_size": 9.0, "random_seed": 3}
THESIS = {"method": "thesis", "layer_height": 2.0, "offset": 0.3, "sites": 20, "random_seed": 3}


def path_of(name: str, samples: Path) -> Path:
    return samples / name if name in SAMPLES else part_file(name)


@pytest.mark.parametrize(
    ("name", "boundary"),
    [
        *((name, boundary) for name in SAMPLES + SHARED for boundary in ("stl", "exact")),
        ("nist_ctc_01_asme1_rd.stp", "exact"),
    ],
)
def test_round_trip(name: str, boundary: str, samples: Path, tmp_path: Path) -> None:
    """Byte for byte, the same structure, where it lay, and never moved again."""
    part = v3dcad.parts.part_from(path_of(name, samples))
    size = np.ptp(part.bounds, axis=0)
    settings = {"layer_height": size[2] / 7.3, "cell_size": size.max() / 6}
    structure = v3dcad.build(part, FillSettings(**FOAM | settings))
    structure.write_ont(tmp_path / "a.ont", boundary)
    recipe = v3dcad.read_ont(tmp_path / "a.ont")
    assert recipe.sites is None, "the settings make them again"
    again = v3dcad.fill(recipe)
    assert not on_bed(again.part.bounds).translation.any()
    assert again.checksum() == recipe.checksum
    exact = boundary == "exact" or name.endswith(".stl")
    assert not exact or again.checksum() == structure.checksum()
    if exact:
        assert again.sites.tobytes() == structure.sites.tobytes()
        assert np.array_equal(again.placement.translation, structure.placement.translation)
    assert np.allclose(again.placement.translation, structure.placement.translation, atol=0.05)
    again.write_ont(tmp_path / "b.ont", boundary)
    assert (tmp_path / "a.ont").read_bytes() == (tmp_path / "b.ont").read_bytes()
    if boundary == "stl":
        offset, height, sites, mesh = algorithm_10((tmp_path / "a.ont").read_text(encoding="utf-8"))
        assert (offset, height, sites) == (0, structure.settings.layer_height, [])
        assert isinstance(recipe.boundary, Mesh)
        corners = recipe.boundary.vertices[recipe.boundary.triangles]
        assert mesh == corners.reshape(-1, 3).tolist()


RANDOM = np.random.default_rng(8)
KINDS = {
    "uniform": FOAM,
    "uniform columns": FOAM | {"stretch": "columns"},
    "sites in space": {
        "layer_height": 3.0,
        "sites": RANDOM.uniform([-20, -20, 0], [20, 20, 30], (30, 3)),
        "stretch": 2.5,
        "max_overhang": 90,
    },
    "sites of a plane": {"layer_height": 3.0, "sites": RANDOM.uniform(-20, 20, (12, 2))},
    "thesis, scattered": THESIS,
    "thesis, listed": THESIS | {"sites": RANDOM.uniform(-20, 20, (12, 2))},
}


@pytest.mark.parametrize("boundary", ["stl", "exact"])
@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_comes_back(kind: str, boundary: str, samples: Path, tmp_path: Path) -> None:
    """Settings and given sites to the last bit; sites that the settings make are left out."""
    structure = v3dcad.fill(samples / "cone.step", **KINDS[kind])
    structure.write_ont(tmp_path / "a.ont", boundary)
    recipe = v3dcad.read_ont(tmp_path / "a.ont")
    given = KINDS[kind].get("sites")
    listed = isinstance(given, np.ndarray)
    if listed:
        assert recipe.sites is not None
        assert recipe.sites[:, : given.shape[1]].tobytes() == given.tobytes()
        assert not recipe.sites[:, given.shape[1] :].any()
        assert structure.given is not None
    else:
        assert (recipe.sites is None) == (boundary == "exact" or "thesis" not in kind)
    again = v3dcad.fill(recipe)
    assert again.settings == structure.settings == recipe.settings
    assert boundary == "stl" or again.sites.tobytes() == structure.sites.tobytes()
    again.write_ont(tmp_path / "b.ont", boundary)
    assert (tmp_path / "a.ont").read_bytes() == (tmp_path / "b.ont").read_bytes()
    offset, *_ = algorithm_10((tmp_path / "a.ont").read_text(encoding="utf-8"))
    assert offset == (0.3 if "thesis" in kind else 0)


def test_format_1_is_refused_in_words(tmp_path: Path, samples: Path) -> None:
    structure = v3dcad.fill(samples / "cone.step", **FOAM | {"layer_height": 10.0})
    text = ont_text(structure.recipe("exact"), "exact")
    old = text.replace("format = 2", "format = 1").replace("method = foam", "method = continuous")
    (tmp_path / "a.ont").write_text(old, encoding="utf-8")
    with pytest.raises(FormatError, match=r"format 1, of columns that grew.*; fill the part"):
        v3dcad.fill(tmp_path / "a.ont")


@pytest.fixture(scope="module")
def bracket(samples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("ont") / "bracket.ont"
    v3dcad.fill(samples / "bracket.step", **FOAM).write_ont(path)
    return path


@pytest.fixture(scope="module")
def thesis(samples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("ont") / "thesis.ont"
    v3dcad.fill(samples / "cone.step", **THESIS).write_ont(path)
    return path


def test_a_brep_is_kept_exactly_by_default_and_triangles_as_stl(samples: Path) -> None:
    assert isinstance(v3dcad.fill(samples / "cone.step", **FOAM).recipe().boundary, Brep)
    mesh = v3dcad.fill(samples / "pyramid.stl", **FOAM)
    assert isinstance(mesh.recipe().boundary, Mesh)


def test_the_same_in_a_second_process(bracket: Path) -> None:
    code = f"import v3dcad; print(v3dcad.fill({str(bracket)!r}, verify=False).checksum().sha256)"
    root = Path(v3dcad.__file__).parents[1]
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, encoding="utf-8", check=True, cwd=root
    )
    written = v3dcad.read_ont(bracket).checksum
    assert written is not None
    assert done.stdout.strip() == written.sha256


def test_the_same_with_the_sites_in_another_order(thesis: Path) -> None:
    """All but the first, at which the tree is rooted that picks the cells which grow."""
    structure = v3dcad.fill(thesis)
    order = [0, *range(19, 0, -1)]
    other = v3dcad.fill(thesis, sites=structure.sites[order])
    assert other.checksum() == structure.checksum()


def test_another_structure_than_was_written_is_an_error(bracket: Path, tmp_path: Path) -> None:
    recipe = v3dcad.read_ont(bracket)
    assert recipe.checksum is not None
    wrong = replace(
        recipe.checksum, walls=recipe.checksum.walls + 1, topology="0" * 8, sha256="0" * 64
    )
    path = tmp_path / "wrong.ont"
    path.write_text(ont_text(replace(recipe, checksum=wrong), "exact"), encoding="utf-8")
    with pytest.raises(FormatError, match=r"wrong.ont, section \[CHECKSUM\].*other topology") as e:
        v3dcad.fill(path)
    assert f"{recipe.checksum.walls} walls instead of {wrong.walls}" in str(e.value)
    assert "verify=False" in str(e.value)
    with pytest.raises(FormatError, match="CHECKSUM"):
        ont.check(path)
    with pytest.raises(FormatError, match="CHECKSUM"):
        ont.convert(path, tmp_path / "other.ont", "stl")
    assert not (tmp_path / "other.ont").exists()
    assert v3dcad.fill(path, verify=False).checksum() == recipe.checksum
    ont.convert(path, tmp_path / "mended.ont", "exact", verify=False)
    assert (tmp_path / "mended.ont").read_bytes() == bracket.read_bytes()


def test_other_settings_make_another_structure_and_are_not_compared(
    bracket: Path, thesis: Path
) -> None:
    written = v3dcad.read_ont(bracket)
    assert v3dcad.fill(bracket, cell_size=15).settings.cell_size == 15
    other = v3dcad.fill(bracket, random_seed=4)
    assert other.settings.random_seed == 4
    assert not np.array_equal(other.sites, v3dcad.fill(bracket).sites)
    with pytest.raises(SettingError, match="'colour'"):
        v3dcad.fill(written, colour=1)
    with pytest.raises(SettingError, match="stretch 1: walls would lean more than 45°"):
        v3dcad.fill(written, stretch=1.0)
    assert v3dcad.fill(thesis, offset=0.4).settings.offset == 0.4
    assert len(v3dcad.fill(thesis, sites=7).sites) == 7
    assert v3dcad.fill(thesis, random_seed=4).settings.random_seed == 4
    turned = v3dcad.fill(thesis, method="foam")
    assert (turned.settings.method, turned.settings.random_seed) == ("foam", 3)
    for recipe, wrong, says in (
        (thesis, {"cell_size": 5}, "cell_size is a setting of method foam"),
        (bracket, {"offset": 0.4}, "offset is a setting of method thesis"),
        (bracket, {"sites": 7}, "sites is a setting of method thesis"),
    ):
        with pytest.raises(SettingError, match=says):
            v3dcad.fill(recipe, **wrong)


def test_other_sites_take_the_place_of_a_file_s(bracket: Path, thesis: Path) -> None:
    plane, space = [(0.0, 0.0), (1.0, 5.0)], [(0.0, 0.0, 0.0), (1.0, 5.0, 2.0)]
    columns = v3dcad.fill(bracket, sites=plane)
    assert (columns.settings.stretch, columns.settings.cell_size) == ("columns", "auto")
    assert columns.given is not None
    assert columns.given.tolist() == [list(place) for place in plane]
    spread = v3dcad.fill(bracket, sites=space, stretch=2)
    assert spread.given is not None
    assert spread.given.tolist() == [list(place) for place in space]
    again = v3dcad.fill(columns.recipe(), sites=space, stretch=2)
    assert again.checksum() == spread.checksum()
    assert v3dcad.fill(thesis, sites=plane).sites.shape == (2, 2)
    for file, sites, settings, says in (
        (bracket, space, {}, "stretch auto: sites in space need a number"),
        (spread.recipe(), None, {"stretch": "columns"}, "stretch columns: sites in space need"),
        (columns.recipe(), None, {"stretch": 2}, "stretch 2: sites of x, y are columns"),
        (bracket, plane, {"cell_size": 6}, "cell_size 6: sites are given"),
        (thesis, space, {}, "method thesis takes sites as rows of x, y"),
    ):
        with pytest.raises(SettingError, match=says):
            v3dcad.fill(file, sites=sites, **settings)


def test_convert_and_check(bracket: Path, tmp_path: Path) -> None:
    ont.convert(bracket, tmp_path / "stl.ont", "stl")
    assert isinstance(v3dcad.read_ont(tmp_path / "stl.ont").boundary, Mesh)
    ont.convert(tmp_path / "stl.ont", tmp_path / "exact.ont", "exact")
    ont.convert(tmp_path / "exact.ont", tmp_path / "back.ont", "stl")
    assert (tmp_path / "back.ont").read_bytes() == (tmp_path / "stl.ont").read_bytes()
    said = ont.check(tmp_path / "exact.ont")
    assert said["result"] == "the structure is the one that was written"
    assert said["layers"] == "24"
    with pytest.raises(SettingError, match="boundary step: give stl or exact"):
        ont.convert(bracket, tmp_path / "other.ont", "step")


def test_a_file_in_the_thesis_s_form_is_placed_and_has_nothing_to_compare(tmp_path: Path) -> None:
    from recipes import SITES, TETRAHEDRON

    from v3dcad.formats.mesh.stl import ascii_stl

    text = "[OFFSET_VALUE]\n0.001\n[LAYER_HEIGHT]\n0.1\n[VORONOI_SEED_COORDINATES]\n"
    text += "".join(f"{x},{y},{z}\n" for x, y, z in SITES - 0.3)
    (tmp_path / "a.ont").write_text(
        f"{text}[BREP_PART_STL]\n{ascii_stl(TETRAHEDRON, 'mesh')}", encoding="utf-8"
    )
    structure = v3dcad.fill(tmp_path / "a.ont")
    assert structure.placement.translation.tolist() == [-0.5, -0.5, 0]
    assert len(structure.layers) == 4
    assert "no check sum" in ont.check(tmp_path / "a.ont")["result"]


def test_a_solid_that_occt_cannot_read_is_an_error(bracket: Path) -> None:
    recipe = v3dcad.read_ont(bracket)
    assert isinstance(recipe.boundary, Brep)
    broken = replace(recipe.boundary, data=recipe.boundary.data[:1000])
    with pytest.raises(KernelError, match="bracket: "):
        v3dcad.fill(replace(recipe, boundary=broken))


def test_describe_tells_what_a_file_says(bracket: Path, thesis: Path, tmp_path: Path) -> None:
    held = v3dcad.recipes.describe_ont(bracket)
    assert (held["boundary"], held["method"]) == ("B-rep", "foam")
    assert (held["cell size"], held["stretch"]) == ("9.0 mm", "1.25")
    assert "offset" not in held
    assert "sites" not in held
    assert held["random seed"] == "3"
    assert held["size"] == "60 × 40 × 48 mm"
    assert held["written by"].startswith("v3dcad ")
    held = v3dcad.recipes.describe_ont(thesis)
    assert held["sites"] == "20, scattered again from the random seed"
    assert (held["method"], held["offset"]) == ("thesis", "0.3 mm² a layer")
    v3dcad.fill(bracket, sites=[(0, 0)]).write_ont(tmp_path / "a.ont")
    held = v3dcad.recipes.describe_ont(tmp_path / "a.ont")
    assert (held["sites"], held["stretch"]) == ("1, listed", "columns")
    assert "cell size" not in held
