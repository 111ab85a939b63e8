from __future__ import annotations

import bz2
import gzip
import lzma
import re
import tracemalloc
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from recipes import BREP, CHECKSUM, SITES, TETRAHEDRON, algorithm_10, recipe

from v3dcad.errors import FormatError
from v3dcad.formats.ont import document as ont
from v3dcad.formats.ont import settings as ont_settings
from v3dcad.formats.ont.armor import checked, packed
from v3dcad.formats.ont.document import ont_text, read_ont, recipe_in
from v3dcad.model import Mesh, Recipe
from v3dcad.settings import FillSettings

pytestmark = pytest.mark.slow

STL = ont_text(recipe(), "stl")
MESH = ont_text(recipe(), "exact")
BREP_TEXT = ont_text(recipe(BREP, None, sites=12, shift=(1.5, -2.25, 1e-17)), "exact")
LIFTED = SITES + np.array([0, 0, 4.25])
FOAM = {"method": "foam", "offset": "auto", "stretch": 1.25}
UNIFORM = ont_text(recipe(BREP, None, **FOAM, cell_size=6.5), "exact")
UNIFORM_STL = ont_text(recipe(places=None, **FOAM, cell_size=6.5), "stl")
IN_SPACE = ont_text(recipe(places=LIFTED, **FOAM), "exact")
COLUMNS = ont_text(recipe(**FOAM | {"stretch": "columns"}), "stl")
FOAMS = [UNIFORM, UNIFORM_STL, IN_SPACE, COLUMNS]

FIGURE_3_20 = """\
[OFFSET_VALUE]
0.1 //Example double value for offset

[LAYER_HEIGHT]
0.15 //Example double value for layer height

[INITIAL_LAYER_VORONOI_SEED_COORDINATES]
X,Y,Z
1.0,2.0,3.0
4.0,5.0,6.0
7.0,8.0,9.0

[BREP_PART_STL]
solid part_name
  facet normal 0 0 1
    outer loop
      vertex 0 0 0
      vertex 1 0 0
      vertex 0 1 0
    endloop
  endfacet
endsolid part_name
"""


def read(text: str | bytes) -> Recipe:
    return recipe_in(text.encode() if isinstance(text, str) else text, "a.ont")


def assert_same(one: Recipe, other: Recipe) -> None:
    """Bit for bit in every field."""
    assert one.settings == other.settings
    assert (one.checksum, one.software, one.name) == (other.checksum, other.software, other.name)
    assert one.placement.translation.tolist() == other.placement.translation.tolist()
    assert (one.sites is None) == (other.sites is None)
    if one.sites is not None and other.sites is not None:
        assert one.sites.tobytes() == other.sites.tobytes()
    assert type(one.boundary) is type(other.boundary)
    for field in fields(one.boundary):
        assert np.array_equal(
            getattr(one.boundary, field.name), getattr(other.boundary, field.name)
        )


@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_the_figure_of_the_thesis_is_read(ends: str, mark: str) -> None:
    found = read(mark + FIGURE_3_20.replace("\n", ends))
    assert found.settings == FillSettings(method="thesis", offset=0.1, layer_height=0.15, sites=3)
    assert found.sites is not None
    assert found.sites.tolist() == [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    assert isinstance(found.boundary, Mesh)
    assert found.boundary.vertices[found.boundary.triangles].tolist() == [
        [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    ]
    assert (found.checksum, found.software) == (None, "")


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace("INITIAL_LAYER_", "").replace("X,Y,Z\n", ""),
        lambda text: text.replace("\n\n", "\n"),
        lambda text: text.replace("[BREP_PART_STL]\n", ""),
        lambda text: re.sub(r"(end)?(solid|facet|loop)|vertex|normal|outer", _upper, text),
        lambda text: "\n".join(f"\t {line} " for line in text.split("\n")),
        lambda text: "".join("[" + section for section in reversed(text.split("[")[1:])),
        lambda text: text.replace("0.1 ", "+.1E0 ").replace("0.15", "15e-2"),
        lambda text: text.replace("0.1 ", "0x1.999999999999ap-4 "),
        lambda text: text.replace("vertex 1 0 0", "vertex 0X1P+0 -0. .0e5 // a corner"),
        lambda text: text.replace(
            "[LAYER", "[NOTES_OF_ANOTHER]\nanything = goes // here\n\n[LAYER"
        ),
        lambda text: text.replace("solid part_name", "solid"),
    ],
)
def test_other_forms_of_the_same(change) -> None:  # type: ignore[no-untyped-def]
    changed = change(FIGURE_3_20)
    assert changed != FIGURE_3_20
    assert_same(read(changed), read(FIGURE_3_20))


def _upper(match: re.Match[str]) -> str:
    return match[0].upper()


@pytest.mark.parametrize("text", [STL, MESH, BREP_TEXT, *FOAMS])
def test_what_is_written_comes_back_byte_for_byte(text: str) -> None:
    form = "stl" if "solid" in text else "exact"
    assert ont_text(read(text), form) == text
    reordered = "[".join(["", *reversed(text.split("[")[1:])])
    assert_same(read(reordered), read(text))


@given(
    st.lists(st.tuples(*[st.floats(-1e6, 1e6)] * 3), min_size=1, max_size=9),
    st.floats(0, 1e3),
    st.floats(1e-3, 1e3),
    st.integers(0, 2**63 - 1),
    st.booleans(),
    st.tuples(*[st.floats(-1e6, 1e6)] * 3),
)
def test_every_number_comes_back(
    sites: list[tuple[float, float, float]],
    offset: float,
    height: float,
    seed: int,
    insertion: bool,
    shift: tuple[float, float, float],
) -> None:
    given = recipe(
        places=np.array(sites),
        offset=offset,
        layer_height=height,
        random_seed=seed,
        insertion=insertion,
        shift=shift,
    )
    for form in ("stl", "exact"):
        assert_same(read(ont_text(given, form)), given)


def test_the_thesis_reads_what_we_write() -> None:
    offset, height, sites, mesh = algorithm_10(STL)
    assert (offset, height, sites) == (0.1, 0.15, SITES.tolist())
    assert mesh == TETRAHEDRON.vertices[TETRAHEDRON.triangles].reshape(-1, 3).tolist()


@pytest.mark.parametrize("text", [STL, MESH, BREP_TEXT, *FOAMS])
def test_no_line_of_ours_is_taken_for_a_solid(text: str) -> None:
    """Whatever the packed bytes are: their lines begin with a mark."""
    ours = text[text.index("[V3DCAD]") :].splitlines()
    assert not [line for line in ours if line.strip().lower().startswith("solid")]
    assert all(re.fullmatch(r"\[\w+\]|\w+ = .*|:[^/\[]+", line) for line in ours)


@given(
    st.lists(st.tuples(*[st.floats(-1e6, 1e6)] * 3), min_size=1, max_size=9),
    st.floats(1e-3, 1e3),
    st.floats(1, 100),
    st.floats(10, 80),
)
def test_every_number_of_a_foam_comes_back(
    sites: list[tuple[float, float, float]], size: float, stretch: float, limit: float
) -> None:
    known = {"method": "foam", "stretch": stretch, "max_overhang": limit}
    uniform = recipe(places=None, **known, cell_size=size)
    for foam in (recipe(places=np.array(sites), **known), uniform):
        for form in ("stl", "exact"):
            assert_same(read(ont_text(foam, form)), foam)


def test_a_foam_lists_the_sites_that_were_given_and_no_others() -> None:
    for text, sites in (
        (UNIFORM, None),
        (UNIFORM_STL, None),
        (IN_SPACE, LIFTED),
        (COLUMNS, SITES),
    ):
        assert text.startswith("[OFFSET_VALUE]\n0\n"), "readers of the thesis's form expect it"
        assert ("VORONOI_SEED_COORDINATES" in text) == (sites is not None)
        found = read(text).sites
        assert sites is found is None or np.array_equal(found, sites)


def test_what_a_foam_s_settings_look_like() -> None:
    ours = "method = {}\ncell_size = {}\nstretch = {}\nheights = middle\nmax_overhang = 45\n"
    ours += "random_seed = 7\n"
    assert "[SETTINGS]\n" + ours.format("foam", "6.5", "1.25") + "[BOUNDARY]" in UNIFORM
    assert ours.format("foam", "auto", "1.25") in IN_SPACE
    assert ours.format("foam", "auto", "columns") in COLUMNS


def test_a_foam_s_file_that_does_not_say_heights_is_older_than_they_are() -> None:
    assert "heights = middle\n" in UNIFORM
    old = UNIFORM.replace("heights = middle\n", "")
    assert read(old).settings.heights == "bottom"
    assert read(UNIFORM).settings.heights == "middle"


def test_of_the_thesis_s_settings_those_that_differ_are_written() -> None:
    ours = "[SETTINGS]\nmethod = thesis\nmax_overhang = 45\nrandom_seed = {}\n{}[BOUNDARY]"
    assert ours.format(0, "") in ont_text(recipe(BREP, None, random_seed=0), "exact")
    text = ont_text(recipe(BREP, None, insertion=False, sites=41), "exact")
    assert ours.format(7, "sites = 41\ninsertion = false\n") in text


def test_defaults_of_format_2() -> None:
    """Files leave defaults out, so another default is another structure.

    Where one must change, raise `FORMAT` and give `settings_from` the old ones for format 2.
    """
    assert ont.FORMAT == 2
    usual = FillSettings()
    assert (usual.sites, usual.insertion, usual.interpolate) == (40, True, False)
    assert (usual.boundary_tolerance, usual.weight_step) == (0.01, 0)
    assert (usual.chord_tolerance, usual.base_clearance) == (0.005, 0)
    pinned = {"sites", "insertion", "interpolate", "boundary_tolerance", "weight_step"}
    assert usual.strict is False
    assert (usual.roof_size, usual.density, usual.mass) == ("off", "off", "off")
    pinned |= {"chord_tolerance", "base_clearance", "strict", "roof_size", "density", "mass"}
    written = {*ont_settings.ALWAYS, *ont_settings.IN_OWN_SECTIONS}
    known = set(FillSettings.__dataclass_fields__)
    assert known == pinned | written, "pin the new setting's default here"


def test_files_of_any_settings_are_told_apart_from_stray_bytes(tmp_path: Path) -> None:
    path = tmp_path / "part.ont"
    path.write_bytes(MESH.encode())
    assert read_ont(path).name == "part"


SOLID = "[BREP_PART_STL]\n" + STL[STL.index("solid") : STL.index("[V3DCAD]")]


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new, 1)


def with_packed(kind: str, data: bytes, **fields: object) -> str:
    """A file whose boundary is these bytes, with the right size and check sum unless told."""
    known = {"kind": kind, "packing": "lzma-base85", "size": len(data), "crc32": checked(data)}
    if kind == "brep":
        known |= {"low": "0 0 0", "high": "1 1 1"}
    known |= fields
    head = BREP_TEXT[: BREP_TEXT.index("[BOUNDARY]")]
    rows = [f"{key} = {value}" for key, value in known.items()]
    return head + "\n".join(["[BOUNDARY]", *rows, *packed(data)])


NESTED = lzma.compress(b"\nOpen CASCADE Topology V4")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (b"", r"section \[OFFSET_VALUE\]: is missing"),
        (STL.encode() + b"\xff", "line 56: not a text file in UTF-8"),
        ("hello", "line 1: not an .ont file: 'hello'"),
        (gzip.compress(b"x", mtime=0), r"compressed \(gzip\)"),
        (lzma.compress(b"x"), r"compressed \(xz\)"),
        (bz2.compress(b"x"), r"compressed \(bzip2\)"),
        (b"PK\x03\x04...", r"compressed \(zip\)"),
        (changed(STL, "[LAYER_HEIGHT]", "[HEIGHT]"), r"section \[LAYER_HEIGHT\]: is missing"),
        (changed(STL, "[VORONOI_SEED", "[VORONOI"), r"\[VORONOI_SEED_COORDINATES\]: is missing"),
        (changed(STL, SOLID, ""), r"\[BREP_PART_STL\]: is missing"),
        (STL + "[OFFSET_VALUE]\n1\n", r"line 56, section \[OFFSET_VALUE\]: is given twice"),
        (STL + SOLID, r"\[BREP_PART_STL\]: is given twice"),
        (MESH + SOLID, r"line 17, section \[BOUNDARY\]: comes in addition to \[BREP_PART_STL\]"),
        (changed(STL, "]\n0.15", "]\n0.15 mm"), r"line 4, section \[LAYER_HEIGHT\].*'0.15 mm'"),
        (changed(STL, "]\n0.15", "]\n0,15"), "decimal point, not a comma"),
        (changed(STL, "]\n0.15", "]\n-0.15"), "give a number above 0 mm"),
        (changed(STL, "]\n0.15", "]\n0"), "give a number above 0 mm"),
        (changed(STL, "]\n0.1\n", "]\n-0.1\n"), "at least 0 mm²"),
        (changed(STL, "]\n0.15", "]\nnan"), "'nan' is not a finite number"),
        (changed(STL, "]\n0.15", "]\n1e999"), "'1e999' is not a finite number"),
        (changed(STL, "]\n0.15", "]\n1_0"), "'1_0' is not a finite number"),
        (changed(STL, "]\n0.15", "]\n0." + "1" * 800), "is not a finite number"),
        (changed(STL, "]\n0.15", "]\n1\n2"), "contains more than one line"),
        (changed(STL, "]\n0.15", "]\n"), "contains nothing"),
        (changed(STL, "]\n0.15", "]\n/etc/layer_height"), "'/etc/layer_height' is not a finite"),
        (changed(STL, "0.1,0.2,0\n", "0.1,0.2\n"), r"line 6.*'0.1,0.2' is not three numbers"),
        (changed(STL, "0.1,0.2,0\n", "0.1,0.2,0,4\n"), r"line 6.*is not three numbers"),
        (changed(STL, "0.1,0.2,0\n", "0.1,inf,0\n"), "line 6.*'inf'"),
        (changed(STL, "0.1,0.2,0\n", "...\n"), r"line 6.*'...' is not three numbers"),
        (re.sub("0.1,0.2,0\n.*?\n", "", STL, count=1), "line 5.*contains no sites"),
        (STL[:500], r"line 27, section \[BREP_PART_STL\]: 'vertex 1.0 0.0 0.' is not"),
        (STL[: STL.index("endfacet")], r"line 16, .*cut off: `endfacet` or `endsolid` is missing"),
        (changed(STL, "solid mesh", "parts/mesh.stl"), r"'parts/mesh.stl' is not the `solid` line"),
        (changed(STL, "vertex 1.0 0.0", "vertex one 0.0"), "'vertex one 0.0 0.0' is not"),
        (changed(STL, "vertex 1.0 0.0", "vertex 0.0"), r"'vertex 0.0 0.0' is not `vertex x"),
        (changed(STL, "vertex 1.0 0.0", "vertex 1e999 0"), "number that is not finite"),
        (re.sub("facet.*endfacet\n", "", STL, flags=re.S), "it contains no triangles"),
        (changed(STL, "[V3DCAD]\n", "[V3DCAD]\nfile = a.brep\n"), "`file` is unknown"),
        (changed(STL, "[V3DCAD]\n", "[V3DCAD]\na.brep\n"), "'a.brep' is not `key = value`"),
        (changed(STL, "format = 2", "format = 3"), "format 3, this v3dcad reads format 2; update"),
        (changed(STL, "format = 2", "format = 1"), "format 1, of columns that grew.* fill the"),
        (changed(STL, "format = 2", "format = one"), "'one' is not a whole number"),
        (changed(STL, "format = 2\n", ""), r"line 39, section \[V3DCAD\]: `format` is missing"),
        (changed(STL, "format = 2\n", "format = 2\nformat = 2\n"), "`format` is given twice"),
        (changed(STL, "v3dcad 1.2.3", "../../x"), "'../../x' is not a program's name and version"),
        (changed(STL, "units = mm", "units = inch"), "'inch' is unknown.*reads 'mm'"),
        (changed(STL, "[V3DCAD]", "[X]"), r"\[V3DCAD\]: is missing"),
        (changed(STL, "[SETTINGS]", "[X]"), r"\[SETTINGS\]: is missing"),
        (changed(STL, "random_seed", "colour"), r"line 46.*the setting 'colour' is unknown"),
        (changed(STL, "random_seed = 7", "offset = 7"), "the setting 'offset' is unknown"),
        (changed(STL, "random_seed = 7", "random_seed = -7"), "'-7' is not a value"),
        (changed(STL, "random_seed = 7", f"random_seed = {2**63}"), "random_seed .* at most"),
        (changed(STL, "random_seed = 7", "method = /bin/sh"), "`method` is given twice"),
        (changed(STL, "method = thesis", "method = /bin/sh"), "'/bin/sh' is not a value"),
        (changed(STL, "method = thesis", "method = continuous"), "give foam or thesis"),
        (changed(UNIFORM, "cell_size = 6.5", "cell_size = 0"), "cell_size 0.* above 0 mm"),
        (changed(UNIFORM, "cell_size = 6.5", "cell_size = big"), "give a number or auto"),
        (changed(UNIFORM, "stretch = 1.25", "stretch = 0.5"), "stretch 0.5.* at least 1"),
        (
            changed(UNIFORM, "max_overhang = 45", "max_overhang = 85"),
            "max_overhang 85.* at most",
        ),
        (changed(UNIFORM, "method = foam", "method = thesis"), "cell_size is a setting of .* foam"),
        (changed(UNIFORM, "random_seed", "sites"), "sites is a setting of method thesis"),
        (changed(STL, "random_seed = 7", "insertion = yes"), "'yes' is not a value"),
        (changed(STL, "sites = 2", "sites = 10000000"), "10000000.*at most 200000"),
        (changed(STL, "sites = 2", "sites = 100000"), "states 100000 sites, but 2 are listed"),
        (changed(STL, "layers = 3", "layers = three"), "'three' is not a whole number"),
        (changed(STL, "sha256 = ab", "sha256 = xy"), "is not 64 hexadecimal digits"),
        (changed(STL, "walls = 12\n", ""), r"\[CHECKSUM\]: `walls` is missing"),
        (changed(BREP_TEXT, "shift = 1.5", "shift ="), "is not 3 numbers"),
        (changed(BREP_TEXT, "shift = 1.5", "shift = nan"), "'nan' is not a finite number"),
        (changed(BREP_TEXT, "kind = brep", "kind = step"), "'step' is unknown"),
        (changed(BREP_TEXT, "kind = brep", "kind = file:///etc/passwd"), "is unknown"),
        (changed(BREP_TEXT, "low = -1", "low = 2"), "`low` does not lie below its `high`"),
        (changed(BREP_TEXT, "lzma-base85", "zip"), "'zip' is unknown.*reads 'lzma-base85'"),
        (changed(BREP_TEXT, "crc32 = ", "crc32 = 0"), "their CRC-32 does not match"),
        (changed(BREP_TEXT, "size = 36", "size = 37"), "states 37 bytes and contains 36"),
        (changed(BREP_TEXT, "size = 36", "size = 35"), "states 35 bytes and contains more"),
        (changed(BREP_TEXT, "\n:", "\n:é"), "packed lines are damaged"),
        (changed(BREP_TEXT, "\n:", "\n:zzzz"), "packed lines are damaged"),
        (with_packed("brep", NESTED), "does not contain a B-rep"),
        (with_packed("mesh", NESTED), "the mesh states"),
        (with_packed("mesh", b""), "header is cut off"),
        (with_packed("brep", b"", size=1 << 40), "more than the 134217728 allowed"),
        ("[a]\n" + "\n".join(f"[{k}]" for k in range(500)), "more than 200 sections"),
        (STL + "\n".join(f"{k} = 1" for k in range(500)), "more than 200 fields"),
    ],
)
def test_damaged_files_are_refused(text: str | bytes, says: str) -> None:
    with pytest.raises(FormatError, match=says) as caught:
        read(text)
    assert str(caught.value).startswith("a.ont")
    assert caught.value.path == "a.ont"


def test_a_bomb_takes_no_more_memory_than_it_announces() -> None:
    bomb = with_packed("mesh", bytes(40 << 20), size=1000)
    tracemalloc.start()
    with pytest.raises(FormatError, match="states 1000 bytes and contains more"):
        read(bomb)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1 << 20


def test_too_long_a_file_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ont, "MAX_FILE_BYTES", 100)
    (tmp_path / "a.ont").write_text(STL, encoding="utf-8")
    with pytest.raises(FormatError, match="larger than 100 bytes"):
        read_ont(tmp_path / "a.ont")


def test_this_form_of_boundary_needs_triangles_and_sites() -> None:
    for unfit in (recipe(BREP), replace(recipe(), sites=None)):
        with pytest.raises(ValueError, match="needs triangles, and the thesis's method a"):
            ont_text(unfit, "stl")


GOOD = [text.encode() for text in (STL, MESH, BREP_TEXT, *FOAMS, FIGURE_3_20)]


@st.composite
def damaged(draw: st.DrawFn) -> bytes:
    """A good file with a few stretches cut out, doubled, swapped with others or overwritten."""
    data = draw(st.sampled_from(GOOD))
    for _ in range(draw(st.integers(1, 4))):
        a, b = sorted(draw(st.tuples(*[st.integers(0, len(data))] * 2)))
        b = min(b, a + draw(st.sampled_from([1, 2, 10, 100, 10_000])))
        other = draw(st.sampled_from(GOOD))
        c = draw(st.integers(0, len(other)))
        new = draw(
            st.sampled_from([b"", data[a:b] * 2, other[c : c + b - a], b"\n", b"[", b"1e9", b"\0"])
            | st.binary(max_size=8)
        )
        data = data[:a] + new + data[b:]
    return data


@settings(max_examples=400)
@given(damaged() | st.binary(max_size=200) | st.text(max_size=200).map(str.encode))
@example(b"[BREP_PART_STL]")
def test_nothing_but_format_errors(data: bytes) -> None:
    try:
        found = read(data)
    except FormatError:
        return
    form = "stl" if isinstance(found.boundary, Mesh) and found.sites is not None else "exact"
    assert_same(replace(read(ont_text(found, form)), software=found.software), found)


def test_checksums_tell_what_differs() -> None:
    other = replace(CHECKSUM, walls=13, topology="3" * 8, sha256="cd" * 32)
    assert other.differences(CHECKSUM) == ["13 walls instead of 12", "other topology"]
    assert CHECKSUM.differences(CHECKSUM) == []
    assert replace(CHECKSUM, sha256="cd" * 32).differences(CHECKSUM) == ["other sha256"]
