"""What Python code gives: NumPy's numbers are taken, anything else is refused by its name."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest

import v3dcad
from v3dcad.arguments import above_zero, finite, numbers, place, rows, whole_rows
from v3dcad.settings import ExportSettings, FillSettings, PrintSettings


@pytest.mark.parametrize(
    ("value", "own"),
    [
        (np.float64(0.1), 0.1),
        (np.float32(0.5), 0.5),
        (np.longdouble(0.5), 0.5),
        (np.int64(3), 3),
        (np.array(2.5), 2.5),
        (Fraction(1, 4), 0.25),
    ],
)
def test_numpys_scalars_become_pythons_own(value: object, own: float) -> None:
    for cls, name in ((FillSettings, "layer_height"), (PrintSettings, "bead_width")):
        found = getattr(cls(**{name: value}), name)
        assert type(found) is type(own)
        assert found == own
    assert above_zero("size", value) == finite("size", value) == own


def test_words_and_flags_of_numpy_too() -> None:
    chosen = FillSettings(stretch=np.str_("columns"), strict=np.True_, random_seed=np.uint8(7))
    assert type(chosen.stretch) is str
    assert chosen.strict is True
    assert type(chosen.random_seed) is int


@pytest.mark.parametrize(
    ("cls", "name", "value", "says"),
    [
        (FillSettings, "layer_height", "1", "'1': give a number"),
        (FillSettings, "layer_height", True, "True: give a number"),
        (FillSettings, "layer_height", np.array([1.0]), r"array\(\[1.\]\): give a number"),
        (FillSettings, "layer_height", 10**400, "give a finite number"),
        (FillSettings, "layer_height", math.nan, "give a finite number"),
        (FillSettings, "max_overhang", "auto", "give a number"),
        (FillSettings, "stretch", b"auto", "give a number or auto or columns"),
        (FillSettings, "random_seed", 2.0, "2.0: give a whole number"),
        (FillSettings, "strict", 1, "1: give True or False"),
        (FillSettings, "method", 1, "give foam or thesis"),
        (PrintSettings, "perimeters", 2.0, "2.0: give a whole number"),
        (PrintSettings, "perimeters", "2", "'2': give a whole number"),
        (PrintSettings, "machine", 3, "give text"),
        (PrintSettings, "arcs", None, "give True or False"),
        (ExportSettings, "svg_layer", 1.5, "give a whole number"),
    ],
)
def test_what_is_no_such_value_is_named(cls: type, name: str, value: object, says: str) -> None:
    with pytest.raises(v3dcad.SettingError, match=says) as caught:
        cls(**{name: value})
    assert caught.value.name == name


@pytest.mark.parametrize("value", ["1", None, [1], np.array([1.0, 2.0]), True, math.nan, math.inf])
def test_only_a_number_is_a_size(value: object) -> None:
    for check in (above_zero, finite):
        with pytest.raises(v3dcad.SettingError, match=r"width .*: give a"):
            check("width", value)
    with pytest.raises(v3dcad.SettingError, match="width 0: give a number above 0 mm"):
        above_zero("width", 0)


def test_a_place_is_one_that_is_there() -> None:
    assert [place("layer", np.int8(k), 3, "layers", from_end=True) for k in (-3, -1, 0, 2)] == [
        0, 2, 0, 2
    ]  # fmt: skip
    for index in (3, -4):
        with pytest.raises(IndexError, match=rf"layer {index}: the layers are 0 to 2"):
            place("layer", index, 3, "layers", from_end=True)
    with pytest.raises(v3dcad.SettingError, match="face -1: the faces are 0 to 2"):
        place("face", -1, 3, "faces")
    for wrong in (1.0, "1", None, True):
        with pytest.raises(v3dcad.SettingError, match="give a whole number"):
            place("face", wrong, 3, "faces")


def test_arrays_have_the_shape_that_is_meant() -> None:
    assert rows("points", [(1, 2, 3)], "x, y, z").tolist() == [[1, 2, 3]]
    assert rows("points", [], "x, y, z").shape == (0, 3)
    assert rows("sites", [(1, 2)], "x, y, z", "x, y").shape == (1, 2)
    assert whole_rows("triangles", np.array([[0.0, 1, 2]]), "a, b, c").dtype == np.int64
    # Six numbers are two points in space, or three in a plane: never the one for the other.
    for wrong in (np.zeros((3, 2)), "abc", [(1, 2), (3,)], None, np.zeros((1, 2, 3)), [["a"] * 3]):
        with pytest.raises(v3dcad.SettingError, match=r"points .*: give rows of x, y, z"):
            rows("points", wrong, "x, y, z")
    with pytest.raises(v3dcad.SettingError, match="not all of them are whole"):
        whole_rows("triangles", [[0, 1, 1.5]], "a, b, c")
    with pytest.raises(v3dcad.SettingError, match="rotate 'abc': give a sequence of 3 numbers"):
        numbers("rotate", "abc", 3)
    with pytest.raises(v3dcad.SettingError, match="not all of them are finite"):
        numbers("heights", [math.nan])
