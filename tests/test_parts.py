"""Files of all kinds as parts: what is read, told, mended and refused."""

from __future__ import annotations

import ctypes
import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

import v3dcad
from tests.parts import part_file
from v3dcad.formats.mesh.stl import binary_stl
from v3dcad.model import Mesh, size_words

pytestmark = pytest.mark.slow

CUBE = Mesh(
    np.array([[x, y, z] for x in (0, 1.0) for y in (0, 1.0) for z in (0, 1.0)]),
    np.array(
        [
            *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
            *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
        ]
    ),
)


def volume(part) -> float:
    return float(part.contents()["volume"].split()[0])


def open_cube() -> Mesh:
    return Mesh(CUBE.vertices, CUBE.triangles[2:])


def threemf(path: Path, resources: str, items: str, unit: str = "millimeter") -> Path:
    """A 3MF made by hand, from the standard alone."""
    kind = "http://schemas.openxmlformats.org/package/2006/"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(
            "[Content_Types].xml",
            f'<?xml version="1.0" encoding="UTF-8"?><Types xmlns="{kind}content-types">'
            '<Default Extension="rels" '
            'ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
            '<Default Extension="model" '
            'ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>',
        )
        archive.writestr(
            "_rels/.rels",
            f'<?xml version="1.0" encoding="UTF-8"?><Relationships xmlns="{kind}relationships">'
            '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
            'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>',
        )
        archive.writestr(
            "3D/3dmodel.model",
            f'<?xml version="1.0" encoding="UTF-8"?><model unit="{unit}" xml:lang="en-US" '
            'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
            f"<resources>{resources}</resources><build>{items}</build></model>",
        )
    return path


def cube_object(number: int, kind: str = "model") -> str:
    points = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in CUBE.vertices)
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in CUBE.triangles)
    return (
        f'<object id="{number}" type="{kind}"><mesh><vertices>{points}</vertices>'
        f"<triangles>{faces}</triangles></mesh></object>"
    )


def test_threemf_is_flattened_with_its_placements(tmp_path: Path) -> None:
    pair = (
        '<object id="2" type="model"><components><component objectid="1"/>'
        '<component objectid="1" transform="-1 0 0 0 1 0 0 0 1 -1 0 0"/></components></object>'
    )
    turn = "0 2 0 -2 0 0 0 0 2 10 0 5"
    path = threemf(
        tmp_path / "a.3mf",
        cube_object(1) + pair + cube_object(3, "support"),
        f'<item objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 0"/>'
        f'<item objectid="2" transform="{turn}"/><item objectid="3"/>',
        unit="centimeter",
    )
    part = v3dcad.part_from(path)
    # A cube of 1, and two of 2 (one of them mirrored), in cm.
    assert volume(part) == pytest.approx((1 + 8 + 8) * 1000)
    assert part.bounds == pytest.approx(np.array([[0, -40, 0], [100, 20, 70]]))
    assert part.findings == ("left out 1 support object",)


def test_threemf_bombs_and_ruins(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from v3dcad.formats.mesh import threemf_reader as threemf_read

    levels = "".join(
        f'<object id="{k}" type="model"><components>'
        + f'<component objectid="{k - 1}"/>' * 10
        + "</components></object>"
        for k in range(2, 12)
    )
    path = threemf(tmp_path / "a.3mf", cube_object(1) + levels, '<item objectid="11"/>')
    monkeypatch.setattr(threemf_read, "MAX_COMPONENTS", 1000)
    with pytest.raises(v3dcad.FormatError, match=r"more than .* 1,000 components"):
        v3dcad.part_from(path)
    loop = '<object id="1"><components><component objectid="1"/></components></object>'
    with pytest.raises(v3dcad.FormatError, match="32 of them within each other"):
        v3dcad.part_from(threemf(tmp_path / "loop.3mf", loop, '<item objectid="1"/>'))
    (tmp_path / "cut.3mf").write_bytes(path.read_bytes()[:300])
    with pytest.raises(v3dcad.FormatError, match=r"cut\.3mf: not a whole 3MF"):
        v3dcad.part_from(tmp_path / "cut.3mf")
    for method in (zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        packed = io.BytesIO()
        with zipfile.ZipFile(path) as whole, zipfile.ZipFile(packed, "w", method) as other:
            for name in whole.namelist():
                other.writestr(name, whole.read(name))
                start = packed.tell() - 60
        damaged = bytearray(packed.getvalue())
        damaged[start : start + 40] = b"\xff" * 40
        (tmp_path / "damaged.3mf").write_bytes(damaged)
        with pytest.raises(v3dcad.FormatError, match=r"damaged\.3mf: not a whole 3MF"):
            v3dcad.part_from(tmp_path / "damaged.3mf")
    monkeypatch.setattr(threemf_read, "MAX_UNPACKED_BYTES", 1000)
    with pytest.raises(v3dcad.FormatError, match="it unpacks to"):
        v3dcad.part_from(path)


@pytest.mark.parametrize(
    ("resources", "items", "says"),
    [
        ("<object/>", "", "damaged"),
        ("<object", "", "damaged"),
        (cube_object(1), "", "no triangles"),
        (cube_object(1), '<item objectid="2"/>', "damaged .*'2'"),
        (cube_object(1), '<item objectid="1" transform="1 0"/>', "damaged"),
        (cube_object(1).replace('v1="0"', 'v1="9"'), '<item objectid="1"/>', "refers to a vertex"),
        (cube_object(1).replace('x="0.0"', 'x="nan"'), '<item objectid="1"/>', "not finite"),
        (cube_object(1).replace('x="0.0"', 'x="?"'), '<item objectid="1"/>', "damaged"),
    ],
)
def test_damaged_threemf(resources: str, items: str, says: str, tmp_path: Path) -> None:
    path = threemf(tmp_path / "a.3mf", resources, items)
    with pytest.raises((v3dcad.FormatError, v3dcad.GeometryError), match=says):
        v3dcad.part_from(path)


def test_what_lib3mf_writes_is_read(tmp_path: Path) -> None:
    from lib3mf import Lib3MF

    wrapper = Lib3MF.Wrapper()
    model = wrapper.CreateModel()
    model.SetUnit(Lib3MF.ModelUnit.Inch)
    item = model.AddMeshObject()
    item.SetGeometry(
        [Lib3MF.Position((ctypes.c_float * 3)(*point)) for point in CUBE.vertices.tolist()],
        [Lib3MF.Triangle((ctypes.c_uint32 * 3)(*row)) for row in CUBE.triangles.tolist()],
    )
    model.AddBuildItem(item, wrapper.GetIdentityTransform())
    model.QueryWriter("3mf").WriteToFile(str(tmp_path / "a.3mf"))
    assert volume(v3dcad.part_from(tmp_path / "a.3mf")) == pytest.approx(25.4**3, rel=1e-5)


OBJ = """# a cube, and a prism with a hollow side
v 0 0 0 0.5 0.5 0.5
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
g cube
f 4/1/1 3/2/1 2/3/1 1/4/1
f 5//1 6//1 7//1 8//1
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f -5 -8 -4 \\
 -1
"""


def test_obj_of_polygons(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text(OBJ)
    part = v3dcad.part_from(path)
    assert volume(part) == pytest.approx(1)
    arrow = [(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)]  # not convex: fans would fold over
    lines = [f"v {x} {y} {z}" for z in (0, 1) for x, y in arrow]
    sides = [f"f {k + 1} {(k + 1) % 5 + 1} {(k + 1) % 5 + 6} {k + 6}" for k in range(5)]
    path.write_text("\n".join([*lines, "f 5 4 3 2 1", "f 6 7 8 9 10", *sides, "curv 0 1 2"]))
    part = v3dcad.part_from(path)
    x, y = np.array(arrow).T
    assert volume(part) == pytest.approx((x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)
    assert part.findings == ("left out 1 free-form element",)
    (section,) = part.sections(np.array([0.5]))
    assert len(section.rings) == 1


@pytest.mark.parametrize("ending", ["stl", "obj"])
@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_text_begins_with_a_mark_or_is_refused_as_utf_16(
    ending: str, encoding: str, tmp_path: Path
) -> None:
    box = trimesh.creation.box([1, 2, 3])
    text = trimesh.exchange.export.export_mesh(
        box, None, file_type="stl_ascii" if ending == "stl" else "obj"
    )
    path = tmp_path / f"a.{ending}"
    path.write_text(text, encoding=encoding)
    if encoding == "utf-8-sig":
        assert volume(v3dcad.part_from(path)) == pytest.approx(6)
    else:
        with pytest.raises(v3dcad.FormatError, match=r"UTF-16: save it as UTF-8"):
            v3dcad.part_from(path)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("v 0 0\n", "line 1: a vertex needs three numbers"),
        ("v 0 0 x\n", "line 1: a vertex needs"),
        ("\nv 0 0 nan\n", "line 2: a coordinate is not a finite"),
        ("v 0 0 1e999\n", "not a finite"),
        ("v 0 0 0\nf 1 1 2\n", "line 2: a face refers to vertex 2 of 1"),
        ("v 0 0 0\nf 0 1 1\n", "refers to vertex 0"),
        ("v 0 0 0\nf -2 1 1\n", "refers to vertex -2"),
        ("v 0 0 0\nf 1 1\n", "a face of 2 corners"),
        ("v 0 0 0\nf" + " 1" * 501 + "\n", "a face of 501 corners"),
        ("v 0 0 0\nf a b c\n", "line 2: a face is written"),
        ("v 0 0 0\n", "no faces"),
        ("\0\1\2", "no faces"),
    ],
)
def test_obj_mistakes_are_told_with_their_line(text: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(text)
    with pytest.raises(v3dcad.FormatError, match=says):
        v3dcad.part_from(tmp_path / "a.obj")


@given(st.binary(max_size=200))
def test_no_bytes_make_the_readers_stumble(data: bytes) -> None:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        for ending, start in (("obj", b"v 0 0 0\nf "), ("stl", b""), ("3mf", b"PK\3\4")):
            path = Path(folder) / f"a.{ending}"
            path.write_bytes(start + data)
            with pytest.raises((v3dcad.FormatError, v3dcad.GeometryError)):
                v3dcad.part_from(path)


def test_a_file_that_claims_a_size_it_does_not_have(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    path.write_bytes(bytes(80) + (40_000_000).to_bytes(4, "little") + bytes(16))
    with pytest.raises(v3dcad.FormatError, match=r"states 40000000 triangles.* has 100 bytes"):
        v3dcad.part_from(path)


def test_holes_are_refused_or_patched(tmp_path: Path) -> None:
    path = tmp_path / "open.stl"
    path.write_bytes(binary_stl(open_cube()))
    with pytest.raises(v3dcad.GeometryError, match=r"open\.stl: .*4 boundary edges.*repair"):
        v3dcad.part_from(path)
    part = v3dcad.part_from(path, repair=True)
    assert volume(part) == pytest.approx(1)
    assert part.findings[0] == "closed 1 hole with 1 mm² of triangles"
    inside_out = Mesh(CUBE.vertices, CUBE.triangles[:, ::-1])
    part = v3dcad.part_from(inside_out)
    assert volume(part) == pytest.approx(1)
    assert "inside out" in part.findings[0]
    broken = CUBE.vertices.copy()
    broken[3, 1] = np.nan
    with pytest.raises(v3dcad.GeometryError, match="not finite"):
        v3dcad.part_from((broken, CUBE.triangles))


def test_findings_reach_structure_and_sections(tmp_path: Path) -> None:
    part = v3dcad.part_from(open_cube(), repair=True)
    structure = v3dcad.fill(part, layer_height=0.5, sites=[(0, 0)])
    assert structure.findings() == list(part.findings)
    assert v3dcad.section(part).part.findings == part.findings


def test_a_mesh_as_brep_is_cut_alike() -> None:
    from tests.parts import ring_area

    with_cavity = Mesh(
        np.vstack([CUBE.vertices * 9, CUBE.vertices * 3 + 3]),
        np.vstack([CUBE.triangles, CUBE.triangles[:, ::-1] + 8]),
    )
    solid = v3dcad.part_from(with_cavity, as_brep=True)
    assert solid.contents()["faces"] == "12", "coplanar triangles are one face"
    assert solid.contents()["solids"] == "1"
    assert volume(solid) == pytest.approx(9**3 - 3**3)
    assert solid.findings == ("made a B-rep of 12 plane faces of 24 triangles",)
    bunny = part_file("bunny.stl")
    one = v3dcad.section(v3dcad.part_from(bunny, as_brep=True), layer_height=3)
    other = v3dcad.section(bunny, layer_height=3)
    for a, b in zip(one, other, strict=True):
        assert len(a.rings) == len(b.rings)
        assert sum(map(ring_area, a.rings)) == pytest.approx(sum(map(ring_area, b.rings)))


def test_what_is_too_large_or_no_brep(monkeypatch: pytest.MonkeyPatch) -> None:
    from v3dcad.kernel import mesh_solid

    touching = Mesh(
        np.vstack([CUBE.vertices, CUBE.vertices + np.array([1, 1, 0])]),
        np.vstack([CUBE.triangles, CUBE.triangles + 8]),
    )
    assert volume(v3dcad.part_from(touching)) == pytest.approx(2)
    with pytest.raises(v3dcad.GeometryError, match="more than two triangles share"):
        v3dcad.part_from(touching, as_brep=True)
    monkeypatch.setattr(mesh_solid, "MAX_TRIANGLES", 11)
    with pytest.raises(v3dcad.GeometryError, match=r"12 triangles is too large .*at most 11"):
        v3dcad.part_from(CUBE, as_brep=True)


@pytest.mark.parametrize(
    ("unit", "factor"), [("mm", 1), ("cm", 10), ("m", 1000), ("inch", 25.4), ("foot", 304.8)]
)
def test_a_unit_is_what_coordinates_are_counted_in(unit: str, factor: float) -> None:
    from build123d import Box

    for source in (CUBE, (CUBE.vertices, CUBE.triangles), Box(1, 1, 1)):
        part = v3dcad.part_from(source, unit=unit)
        assert volume(part) == pytest.approx(factor**3, rel=1e-5)
        assert volume(v3dcad.part_from(source, unit=unit, scale=2)) == pytest.approx(
            (2 * factor) ** 3, rel=1e-5
        )


def test_a_recipe_is_no_part(tmp_path: Path) -> None:
    (tmp_path / "a.ont").write_text("anything", encoding="utf-8")
    with pytest.raises(v3dcad.FormatError, match=r"a\.ont: holds a filled part"):
        v3dcad.section(tmp_path / "a.ont")


def test_what_states_its_unit_is_only_scaled(samples: Path) -> None:
    once = v3dcad.part_from(samples / "bracket.step")
    twice = v3dcad.part_from(samples / "bracket.step", scale=2)
    assert twice.bounds == pytest.approx(2 * once.bounds)
    assert volume(twice) == pytest.approx(8 * volume(once), rel=1e-5)
    with pytest.raises(v3dcad.SettingError, match=r"a \.step file states its unit"):
        v3dcad.part_from(samples / "bracket.step", unit="inch")
    with pytest.raises(v3dcad.SettingError, match="unit yard: give mm or cm or m or inch or foot"):
        v3dcad.part_from(CUBE, unit="yard")
    for scale in (0, -1, "2", np.nan):
        with pytest.raises(v3dcad.SettingError, match=r"scale .*: give a number above 0"):
            v3dcad.part_from(CUBE, scale=scale)
    with pytest.raises(v3dcad.SettingError, match="in mm already"):
        v3dcad.part_from(once, scale=2)


def test_a_part_of_an_unlikely_size_is_told() -> None:
    assert v3dcad.part_from(CUBE).findings == ("1 mm long: in inches? --unit inch",)
    assert v3dcad.part_from(CUBE, unit="mm").findings == ()
    assert v3dcad.part_from(Mesh(CUBE.vertices * 3, CUBE.triangles)).findings == ()
    (large,) = v3dcad.part_from(Mesh(CUBE.vertices * 3001, CUBE.triangles)).findings
    assert large == "3001 mm long: in another unit? --scale 0.001 makes it smaller"


def test_a_size_is_told_to_a_hundredth_of_a_millimetre() -> None:
    sides = [44, 40.987654321, 0.001234567]
    part = v3dcad.part_from(Mesh(CUBE.vertices * sides, CUBE.triangles))
    assert size_words(part) == "44 × 40.99 × 0.00123457 mm"


def test_an_ont_of_a_part_in_inches_makes_the_same_again(tmp_path: Path) -> None:
    structure = v3dcad.fill(v3dcad.part_from(CUBE, unit="inch"), cell_size=9, layer_height=1)
    structure.write_ont(tmp_path / "a.ont")
    again = v3dcad.fill(tmp_path / "a.ont")
    assert again.checksum() == structure.checksum()
    assert np.ptp(again.part.bounds, axis=0) == pytest.approx([25.4] * 3)
