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
from v3dcad.structure.sites import scatter_sites

pytestmark = pytest.mark.slow

SAMPLES = ["bracket.step", "cone.step", "islands.step", "pyramid.step", "pyramid.stl"]
SHARED = ["bunny.stl", "nist_ftc_11_asme1_rb.stp"]
FEW = {"layer_height": 2.0, "offset": 0.3, "sites": 20, "random_seed": 3}


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
    height = float(np.ptp(part.bounds[:, 2])) / 7.3
    structure = v3dcad.build(part, FillSettings(**FEW | {"layer_height": height}))
    structure.write_ont(tmp_path / "a.ont", boundary)
    recipe = v3dcad.read_ont(tmp_path / "a.ont")
    again = v3dcad.fill(recipe)
    assert not on_bed(again.part.bounds).translation.any()
    assert again.checksum() == recipe.checksum
    exact = boundary == "exact" or name.endswith(".stl")
    assert not exact or again.checksum() == structure.checksum()
    if exact:
        assert again.places.tobytes() == structure.places.tobytes()
        assert np.array_equal(again.placement.translation, structure.placement.translation)
    assert np.allclose(again.placement.translation, structure.placement.translation, atol=0.05)
    again.write_ont(tmp_path / "b.ont", boundary)
    assert (tmp_path / "a.ont").read_bytes() == (tmp_path / "b.ont").read_bytes()
    if boundary == "stl":
        offset, height, sites, mesh = algorithm_10((tmp_path / "a.ont").read_text(encoding="utf-8"))
        assert (offset, height) == (0.3, structure.settings.layer_height)
        assert np.array(sites)[:, :2].tobytes() == structure.places.tobytes()
        assert isinstance(recipe.boundary, Mesh)
        corners = recipe.boundary.vertices[recipe.boundary.triangles]
        assert mesh == corners.reshape(-1, 3).tolist()


@pytest.fixture(scope="module")
def bracket(samples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("ont") / "bracket.ont"
    v3dcad.fill(samples / "bracket.step", **FEW).write_ont(path)
    return path


def test_scattered_sites_are_left_out_and_explicit_ones_kept(samples: Path, tmp_path: Path) -> None:
    scattered = v3dcad.fill(samples / "cone.step", **FEW)
    assert scattered.recipe("exact").sites is None
    assert scattered.recipe("stl").sites is not None
    places = scattered.places.copy()
    places[3, 0] = np.nextafter(places[3, 0], 99)
    explicit = v3dcad.fill(samples / "cone.step", **FEW | {"sites": places})
    explicit.write_ont(tmp_path / "a.ont")
    kept = v3dcad.read_ont(tmp_path / "a.ont").sites
    assert kept is not None
    assert kept[:, :2].tobytes() == places.tobytes()


@pytest.mark.parametrize("chosen", ["a density", "fewer"])
def test_sites_that_the_settings_do_not_scatter_come_back(chosen: str, tmp_path: Path) -> None:
    """By a density, or 9 as the seed scatters them: the settings of both say 20."""
    corners = [[0.0, 0, 0], [30, 0, 0], [0, 30, 0], [0, 0, 9]]
    part = v3dcad.part_from((corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
    settings = v3dcad.FillSettings(layer_height=1.0, offset=0.1, sites=20)
    scattered = scatter_sites(np.array([[-15.0, -15], [15, 15]]), 9, settings.random_seed)
    sites = {"a density": v3dcad.density(lambda x, y: 0.02), "fewer": scattered}[chosen]
    structure = v3dcad.build(part, settings, sites)
    structure.write_ont(tmp_path / "a.ont", "exact")
    again = v3dcad.fill(tmp_path / "a.ont")
    assert again.settings.sites == structure.settings.sites == len(structure.places) < 20
    assert again.places.tobytes() == structure.places.tobytes()
    assert again.checksum() == structure.checksum()


def test_a_brep_is_kept_exactly_by_default_and_triangles_as_stl(samples: Path) -> None:
    assert isinstance(v3dcad.fill(samples / "cone.step", **FEW).recipe().boundary, Brep)
    mesh = v3dcad.fill(samples / "pyramid.stl", **FEW)
    assert isinstance(mesh.recipe().boundary, Mesh)
    assert mesh.recipe().sites is not None


def test_the_same_in_a_second_process(bracket: Path) -> None:
    code = f"import v3dcad; print(v3dcad.fill({str(bracket)!r}, verify=False).checksum().sha256)"
    root = Path(v3dcad.__file__).parents[1]
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, encoding="utf-8", check=True, cwd=root
    )
    written = v3dcad.read_ont(bracket).checksum
    assert written is not None
    assert done.stdout.strip() == written.sha256


def test_the_same_with_the_sites_in_another_order(bracket: Path) -> None:
    """All but the first, at which the tree is rooted that picks the cells which grow."""
    structure = v3dcad.fill(bracket)
    order = [0, *range(19, 0, -1)]
    other = v3dcad.fill(bracket, sites=structure.places[order])
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
    assert "--no-verify" in str(e.value)
    with pytest.raises(FormatError, match="CHECKSUM"):
        ont.check(path)
    with pytest.raises(FormatError, match="CHECKSUM"):
        ont.convert(path, tmp_path / "other.ont", "stl")
    assert not (tmp_path / "other.ont").exists()
    assert v3dcad.fill(path, verify=False).checksum() == recipe.checksum
    ont.convert(path, tmp_path / "mended.ont", "exact", verify=False)
    assert (tmp_path / "mended.ont").read_bytes() == bracket.read_bytes()


def test_other_settings_make_another_structure_and_are_not_compared(bracket: Path) -> None:
    written = v3dcad.read_ont(bracket)
    assert v3dcad.fill(bracket, offset=0.4).settings.offset == 0.4
    assert len(v3dcad.fill(bracket, sites=7).sites) == 7
    other = v3dcad.fill(bracket, random_seed=4)
    assert other.settings.random_seed == 4
    assert not np.array_equal(other.sites, v3dcad.fill(bracket).sites)
    assert v3dcad.fill(bracket, sites=[(0.0, 0.0), (1, 5)]).places.tolist() == [[0, 0], [1, 5]]
    with pytest.raises(SettingError, match="'colour'"):
        v3dcad.fill(written, colour=1)


def test_convert_and_check(bracket: Path, tmp_path: Path) -> None:
    ont.convert(bracket, tmp_path / "stl.ont", "stl")
    assert isinstance(v3dcad.read_ont(tmp_path / "stl.ont").boundary, Mesh)
    ont.convert(tmp_path / "stl.ont", tmp_path / "exact.ont", "exact")
    ont.convert(tmp_path / "exact.ont", tmp_path / "back.ont", "stl")
    assert (tmp_path / "back.ont").read_bytes() == (tmp_path / "stl.ont").read_bytes()
    said = ont.check(tmp_path / "exact.ont")
    assert said["result"] == "the structure is the one that was written"
    assert said["layers"] == "24"
    with pytest.raises(SettingError, match="--boundary step: give stl or exact"):
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


def test_describe_tells_what_a_file_says(bracket: Path) -> None:
    held = v3dcad.recipes.describe(bracket)
    assert held["boundary"] == "B-rep"
    assert held["sites"] == "20, scattered again from the random seed"
    assert held["random seed"] == "3"
    assert held["size"] == "60 × 40 × 48 mm"
    assert held["written by"].startswith("v3dcad ")
