"""Curves of contours as plain numbers, against OCCT's own values of them."""

from __future__ import annotations

import numpy as np
import pytest
from OCP.Geom import Geom_Curve
from scipy.interpolate import BSpline

from v3dcad.formats.curve_step import step_text
from v3dcad.geometry.drawing import Conic, Drawing, Spline
from v3dcad.kernel.curves import plain_curve, run_curve
from v3dcad.model import CurveRun, Floats, Section

ANGLES = np.linspace(0, 2 * np.pi, 40, endpoint=False)
RING = np.column_stack([9 * np.cos(ANGLES), 5 * np.sin(ANGLES) + np.cos(3 * ANGLES)])


def curve(kind: str, stop: int, *parameters: float) -> Geom_Curve:
    run = CurveRun(0, 0, stop, kind, 0, parameters)
    made = run_curve(run, Section(2.5, (RING,), (run,)))
    assert made is not None
    return made


def along(made: Geom_Curve, first: float, last: float) -> Floats:
    return np.array([made.Value(t).Coord() for t in np.linspace(first, last, 50)])


@pytest.mark.parametrize(
    ("stop", "first", "share"), [(20, 0.0, 1.0), (20, 0.2, 0.5), (40, 0.0, 1.0), (40, 0.7, 0.8)]
)
def test_a_stretch_of_a_spline_keeps_its_shape(stop: int, first: float, share: float) -> None:
    """Open ones and closed ones, across the place where a closed one begins."""
    made = curve("points", stop)
    begin = made.FirstParameter()
    length = made.LastParameter() - begin
    start, end = begin + first * length, begin + (first + share) * length
    expected = along(made, start, end)
    plain = plain_curve(made, start, end)
    assert isinstance(plain, Spline)
    knots = np.repeat(plain.knots, plain.multiplicities)
    drawn = BSpline(knots, plain.poles, plain.degree)(np.linspace(knots[0], knots[-1], 50))
    assert drawn == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    ("kind", "parameters"),
    [("circle", (1.0, 2.0, 7.0)), ("ellipse", (1.0, 2.0, 3.0, 4.0, 0.25))],
)
def test_an_arc_keeps_its_shape(kind: str, parameters: tuple[float, ...]) -> None:
    made = curve(kind, 20, *parameters)
    plain = plain_curve(made, 0.3, 2.0)
    assert isinstance(plain, Conic)
    centre, axis, towards = map(np.array, plain[:3])
    angles = np.linspace(plain.first, plain.last, 50)[:, None]
    drawn = centre + plain.major * np.cos(angles) * towards
    drawn = drawn + plain.minor * np.sin(angles) * np.cross(axis, towards)
    assert drawn == pytest.approx(along(made, 0.3, 2.0), abs=1e-12)


def test_numbers_are_written_as_part_21_has_them() -> None:
    points = np.array([[0.0, -1e-12, 1234.56789012], [1e-3, 2.0, 1e-9]])
    conic = Conic((1e-20, 0.0, -0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), 3e22, 1.0, 0.0, 1.5)
    drawing = Drawing("a", points, [[0, 1]], [conic], [])
    text = "".join(step_text([drawing], "a", "AP214", "1970-01-01T00:00:00"))
    assert "(0.00000000,0.00000000,1234.56789012)" in text
    assert "(0.00100000,2.00000000,0.0)" in text
    assert "(1.E-20,0.0,0.0)" in text
    assert "3.E+22,1.0);" in text
