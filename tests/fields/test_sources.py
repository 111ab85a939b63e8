"""Each kind of field, from real files with values known by hand; what is wrong says so."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from v3dcad.errors import FormatError, SettingError, V3dcadError
from v3dcad.fields.expression import field_of
from v3dcad.fields.image import image_field
from v3dcad.fields.sources import in_range, sources_of
from v3dcad.fields.stress import read_stress, von_mises
from v3dcad.fields.table import read_table
from v3dcad.formats.mesh.stl import binary_stl
from v3dcad.model import Mesh
from v3dcad.parts import MeshPart, part_from

SIDES = [
    [0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4],
    [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7],
]  # fmt: skip

POINTS = np.array([[5.0, 5, 5], [1.0, 9, 2]])


def cube() -> MeshPart:
    """A cube of 10 mm at the origin; triangles 0 and 1 are its base."""
    square = np.array([[0.0, 0], [10, 0], [10, 10], [0, 10]])
    corners = [np.column_stack([square, np.full(4, z)]) for z in (0.0, 10.0)]
    part = part_from((np.concatenate(corners), np.array(SIDES)))
    assert isinstance(part, MeshPart)
    return part


def at(text: str) -> np.ndarray:
    """What an expression says at POINTS in the cube."""
    return field_of(text, sources_of(cube()))(*POINTS.T)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("2 + 0.1 * x", [2.5, 2.1]),
        ("min(x, y, 4)", [4, 1]),
        ("max(x, z) ** 2 / -2", [-12.5, -2]),
        ("3 if x < 4 else z", [5, 3]),
        ("ramp(x, 1, 5, 2, 4)", [4, 2]),
        ("smooth(x, 0, 10, 0, 8)", [4, 8 * 0.01 * (3 - 0.2)]),
        ("faces(0, 1)", [5, 2]),
        ("surface()", [5, 1]),
        ("hypot(x, y) + 0 * pi", [50**0.5, 82**0.5]),
    ],
)
def test_an_expression_is_what_it_says(text: str, expected: list[float]) -> None:
    assert at(text) == pytest.approx(expected, abs=0.03)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("3 + q", "'q' is not known"),
        ("sinh(x)", "no function 'sinh'"),
        ("x.real", "not allowed"),
        ("__import__('os')", "no function"),
        ("[x for x in y]", "not allowed"),
        ("ramp(x, 1)", "takes 5 values"),
        ("faces()", "numbers of faces"),
        ("faces(12)", "0 to 11"),
        ("faces(True)", "numbers and texts"),
        ("table('a.csv', 3)", "column's name"),
        ("image('a.png', view='side')", "top or front"),
        ("table('a\\0b.csv')", "a file, in quotes"),
        ("3 +", "invalid syntax"),
        ("(" * 900 + "x" + ")" * 900, "cell_size"),
        ("-" * 3000 + "x", "cell_size"),
        ("x" * 5000, "4000"),
    ],
)
def test_a_wrong_expression_says_what_is_wrong(text: str, told: str) -> None:
    with pytest.raises(SettingError, match=told):
        at(text)


@given(st.text("xyz0123456789.+-*/()<>, 'ifelsmnq[]{}:=\\\0", max_size=40))
def test_any_text_is_a_field_or_a_setting_error(text: str) -> None:
    try:
        field = field_of(text, {})
    except SettingError:
        return
    assert field(*POINTS.T).shape == (2,)


def test_a_distance_from_triangles_that_are_not_closed(tmp_path: Path) -> None:
    lid = Mesh(cube().surface.vertices, cube().surface.triangles[2:4])
    (tmp_path / "a.stl").write_bytes(binary_stl(lid))
    assert at(f"distance({str(tmp_path / 'a.stl')!r})") == pytest.approx([5, 8], abs=0.03)
    for name, told in (("b.stl", "cannot be read"), ("a.obj", "give .stl")):
        with pytest.raises(FormatError, match=told):
            at(f"distance({str(tmp_path / name)!r})")


@pytest.mark.parametrize("size", [0.0, -1.0, np.nan, np.inf, 1e-9, 1e9])
def test_a_size_that_cannot_be_is_refused_with_its_place(size: float) -> None:
    field = in_range(lambda x, y, z: np.where(x == 1, size, 2.0))
    with pytest.raises(SettingError, match=r"at \(1, 9, 2\) mm"):
        field(*POINTS.T)


def test_a_table_is_linear_between_its_rows(tmp_path: Path) -> None:
    rows = ["x [mm];y;z;size", *(f"{x};{y};{z};{1 + 0.2 * x + 0.1 * z}" for x in (0, 10)
            for y in (0, 10) for z in (0, 10))]  # fmt: skip
    (tmp_path / "a.csv").write_text("\n".join(rows))
    assert at(f"table({str(tmp_path / 'a.csv')!r})") == pytest.approx([2.5, 1.4])
    # In a plane it says nothing of the height.
    (tmp_path / "b.csv").write_text("0,0,0,1\n10,0,0,3\n0,10,0,1\n10,10,0,3\n")
    assert at(f"table({str(tmp_path / 'b.csv')!r})") == pytest.approx([2, 1.2])


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("x,y,size\n1,2,3\n", "no column 'z'"),
        ("x,y,z,a,b\n1,2,3,4,5\n", "name one column"),
        ("x [m],y,z,a\n1,2,3,4\n", "in mm"),
        ("1,2,3\n", "needs x, y, z and a value"),
        ("1,2,3,4\n1,2,x,4\n", "not four numbers"),
        ("1,2,3,nan\n", "not finite"),
        ("", "no points"),
    ],
)
def test_a_wrong_table_says_what_is_wrong(text: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(FormatError, match=told):
        read_table(tmp_path / "a.csv")


def test_a_table_of_another_place_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("0,0,0,1\n0.01,0,0,1\n0,0.01,0.01,2\n")
    with pytest.raises(SettingError, match="are both in mm"):
        at(f"table({str(tmp_path / 'a.csv')!r})")


def test_a_vtu_file_and_its_stress(tmp_path: Path) -> None:
    points = np.array([[x, y, z] for x in (0.0, 10) for y in (0.0, 10) for z in (0.0, 10)])
    data = {"von Mises Stress": 3 * points[:, 0], "size": 1 + points[:, 2] / 10}
    mesh = meshio.Mesh(points, [("vertex", np.arange(8)[:, None])], point_data=data)
    mesh.write(tmp_path / "a.vtu")
    assert at(f"table({str(tmp_path / 'a.vtu')!r}, 'size')") == pytest.approx([1.5, 1.2])
    assert at(f"stress({str(tmp_path / 'a.vtu')!r})") == pytest.approx([15, 3])
    del data["von Mises Stress"]
    mesh.write(tmp_path / "b.vtu")
    with pytest.raises(FormatError, match="no von Mises stress"):
        read_stress(tmp_path / "b.vtu")


def test_an_image_lies_over_the_part(tmp_path: Path) -> None:
    grey = np.zeros((10, 10), np.uint8)
    grey[:5] = 255  # the upper half is the far one, y > 5
    Image.fromarray(grey).save(tmp_path / "a.png")
    name = str(tmp_path / "a.png")
    x, y, z = np.array([[2.0, 2, 1], [2.0, 8, 1], [2.0, 2, 9]]).T
    assert field_of(f"image({name!r})", sources_of(cube()))(x, y, z).tolist() == [0, 1, 0]
    assert field_of(f"image({name!r}, view='front')", sources_of(cube()))(x, y, z).tolist() == [
        0,
        0,
        1,
    ]
    Image.fromarray(255 - grey).save(tmp_path / "b.png")
    stack = [tmp_path / "a.png", tmp_path / "b.png"]
    field = image_field(stack, "top", np.array([[0.0, 0, 0], [10, 10, 10]]))
    ends = field(np.full(3, 2.0), np.full(3, 8.0), np.array([0.0, 5, 10]))
    assert ends.tolist() == [1, 0.5, 0]


def frd(stresses: list[list[float]]) -> str:
    """A CalculiX result: nodes 1, 2, … along x with their stresses."""
    lines = ["    1C", f"    2C{len(stresses):30d}{1:37d}"]
    nodes = [[5.0 * k, 0, 0] for k in range(len(stresses))]
    lines += [f" -1{k:10d}" + "".join(f"{v:12.5E}" for v in row) for k, row in enumerate(nodes, 1)]
    lines += [" -3", " -4  STRESS      6    1", " -5  SXX         1    4    1    1"]
    lines += [
        f" -1{k:10d}" + "".join(f"{v:12.5E}" for v in row) for k, row in enumerate(stresses, 1)
    ]
    return "\n".join([*lines, " -3", " 9999", ""])


def test_the_stress_of_an_frd_file(tmp_path: Path) -> None:
    # Pulled along x by 7; sheared by 2; pressed from all sides.
    stresses = [[7.0, 0, 0, 0, 0, 0], [0, 0, 0, 2, 0, 0], [-5, -5, -5, 0, 0, 0]]
    assert von_mises(np.array(stresses)) == pytest.approx([7, 12**0.5, 0])
    (tmp_path / "a.frd").write_text(frd(stresses))
    points, values = read_stress(tmp_path / "a.frd")
    assert points[:, 0].tolist() == [0, 5, 10]
    assert values == pytest.approx([7, 12**0.5, 0])
    (tmp_path / "b.frd").write_text(frd(stresses).replace("STRESS", "DISP  "))
    with pytest.raises(FormatError, match="no stress"):
        read_stress(tmp_path / "b.frd")


@given(
    st.binary(max_size=300),
    st.sampled_from(["csv", "vtu", "vtk", "png", "frd", "stl"]),
    st.booleans(),
)
def test_any_file_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, data: bytes, ending: str, damaged: bool
) -> None:
    path = tmp_path_factory.getbasetemp() / f"hostile.{ending}"
    if damaged and ending == "frd":
        data = frd([[1.0] * 6]).encode()[: len(data)] + data
    if damaged and ending == "png":
        data = b"\x89PNG\r\n\x1a\n" + data
    path.write_bytes(data)
    try:
        if ending == "png":
            image_field([path], "top", np.zeros((2, 3)))
        elif ending == "csv":
            read_table(path)
        elif ending == "stl":
            sources_of(cube())["distance"](str(path))
        else:
            read_stress(path)
    except V3dcadError:
        return
