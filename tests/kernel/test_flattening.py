"""Our evaluators against OCCT's, for every kind of curve and surface."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import comb

import numpy as np
import pytest
from OCP.Geom import (
    Geom_BezierCurve,
    Geom_BezierSurface,
    Geom_BSplineCurve,
    Geom_BSplineSurface,
    Geom_Circle,
    Geom_ConicalSurface,
    Geom_CylindricalSurface,
    Geom_Ellipse,
    Geom_Hyperbola,
    Geom_Line,
    Geom_OffsetSurface,
    Geom_Parabola,
    Geom_Plane,
    Geom_RectangularTrimmedSurface,
    Geom_SphericalSurface,
    Geom_SurfaceOfLinearExtrusion,
    Geom_SurfaceOfRevolution,
    Geom_ToroidalSurface,
    Geom_TrimmedCurve,
)
from OCP.GeomAPI import GeomAPI_Interpolate
from OCP.GeomConvert import GeomConvert
from OCP.gp import gp_Ax1, gp_Ax2, gp_Ax3, gp_Circ, gp_Dir, gp_Elips, gp_Pnt, gp_Vec
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt, TColgp_HArray1OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal

from v3dcad.geometry.compiled.intrinsics import STACK_ROOM
from v3dcad.geometry.surface.curves import curve_at
from v3dcad.geometry.surface.surfaces import surface_at
from v3dcad.kernel.flattening import Flattener

FRAME = gp_Ax2(gp_Pnt(1, 2, 3), gp_Dir(0.3, -0.4, 1), gp_Dir(1, 0.2, 0))
SPACE = gp_Ax3(FRAME)
MIRRORED = gp_Ax3(gp_Ax2(gp_Pnt(1, 2, 3), gp_Dir(0.3, -0.4, 1), gp_Dir(1, 0.2, 0)))
MIRRORED.YReverse()


def bezier():
    poles, weights = TColgp_Array1OfPnt(1, 4), TColStd_Array1OfReal(1, 4)
    for i, (point, weight) in enumerate(
        [((0, 0, 1), 1), ((1, 2, 0), 3), ((2, 1, 4), 0.5), ((5, 1, 1), 2)], start=1
    ):
        poles.SetValue(i, gp_Pnt(*point))
        weights.SetValue(i, weight)
    return Geom_BezierCurve(poles, weights)


def spline(periodic: bool):
    points = TColgp_HArray1OfPnt(1, 6)
    for i, (x, y, z) in enumerate(np.random.default_rng(3).uniform(1, 5, (6, 3)), start=1):
        points.SetValue(i, gp_Pnt(x, y, z))
    interpolation = GeomAPI_Interpolate(points, periodic, 1e-7)
    interpolation.Perform()
    return interpolation.Curve()


def bezier_surface(rows=3, columns=4):
    poles = TColgp_Array2OfPnt(1, rows, 1, columns)
    for i in range(rows):
        for j in range(columns):
            poles.SetValue(i + 1, j + 1, gp_Pnt(i, j, np.sin(2 * i + j)))
    return Geom_BezierSurface(poles)


def periodic_surface():
    """Closed both ways, with weights: a torus."""
    return GeomConvert.SurfaceToBSplineSurface_s(Geom_ToroidalSurface(SPACE, 5, 2))


def periodic_surface_without_weights():
    """A tube, closed one way."""
    poles = TColgp_Array2OfPnt(1, 2, 1, 8)
    for i in range(2):
        for j, angle in enumerate(np.arange(8) * np.pi / 4):
            poles.SetValue(i + 1, j + 1, gp_Pnt(np.cos(angle), np.sin(angle), i))
    along, around = TColStd_Array1OfReal(1, 2), TColStd_Array1OfReal(1, 9)
    ends, knots = TColStd_Array1OfInteger(1, 2), TColStd_Array1OfInteger(1, 9)
    ends.Init(2)
    knots.Init(1)
    for array in (along, around):
        for i in range(array.Length()):
            array.SetValue(i + 1, i)
    return Geom_BSplineSurface(poles, along, around, ends, knots, 1, 3, False, True)


CURVES = {
    "line": Geom_Line(gp_Pnt(1, 2, 3), gp_Dir(1, 1, 0.5)),
    "circle": Geom_Circle(gp_Circ(FRAME, 3)),
    "ellipse": Geom_Ellipse(gp_Elips(FRAME, 3, 1.5)),
    "hyperbola": Geom_Hyperbola(FRAME, 3, 1.5),
    "parabola": Geom_Parabola(FRAME, 0.7),
    "bezier": bezier(),
    "spline": spline(False),
    "periodic spline": spline(True),
    "trimmed": Geom_TrimmedCurve(spline(False), 0.5, 3.0),
}

SURFACES = {
    "plane": Geom_Plane(SPACE),
    "cylinder": Geom_CylindricalSurface(SPACE, 4),
    "mirrored cylinder": Geom_CylindricalSurface(MIRRORED, 4),
    "cone": Geom_ConicalSurface(SPACE, 0.4, 3),
    "sphere": Geom_SphericalSurface(SPACE, 4),
    "torus": Geom_ToroidalSurface(SPACE, 5, 2),
    "bezier": bezier_surface(),
    "periodic spline": periodic_surface(),
    "periodic spline without weights": periodic_surface_without_weights(),
    "extrusion": Geom_SurfaceOfLinearExtrusion(spline(False), gp_Dir(0.2, 1, 3)),
    "revolution": Geom_SurfaceOfRevolution(
        spline(False), gp_Ax1(gp_Pnt(-3, 0, 1), gp_Dir(0, 0.3, 1))
    ),
    "trimmed": Geom_RectangularTrimmedSurface(
        Geom_RectangularTrimmedSurface(
            Geom_SurfaceOfLinearExtrusion(bezier(), gp_Dir(0, 0, 1)), 0.1, 0.9, 0.0, 2.0
        ),
        0.2,
        0.8,
        0.1,
        1.0,
    ),
    "offset": Geom_OffsetSurface(bezier_surface(), 0.3),
    "offset of an extrusion": Geom_OffsetSurface(
        Geom_SurfaceOfLinearExtrusion(bezier(), gp_Dir(0.2, 1, 3)), -0.2
    ),
}


@pytest.mark.parametrize("name", CURVES)
def test_curves(name: str):
    curve = CURVES[name]
    flattener = Flattener()
    flattener.numbers += [7.0, 7.0]
    place = flattener.curve(curve)
    coefficients = flattener.coefficients()
    first = max(curve.FirstParameter(), -2)
    last = min(curve.LastParameter(), 2)
    for t in [*np.linspace(first, last, 23), *([last + 1.0] if curve.IsPeriodic() else [])]:
        point, tangent = gp_Pnt(), gp_Vec()
        curve.D1(float(t), point, tangent)
        true = [*point.Coord(), *tangent.Coord()]
        assert curve_at(coefficients, place, float(t)) == pytest.approx(true, abs=1e-12, rel=1e-12)


@pytest.mark.parametrize("name", SURFACES)
def test_surfaces(name: str):
    surface = SURFACES[name]
    flattener = Flattener()
    flattener.numbers += [7.0]
    place = flattener.surface(surface)
    coefficients = flattener.coefficients()
    u_first, u_last, v_first, v_last = surface.Bounds()
    close = 1e-12 if "offset" not in name else 1e-6
    for u in np.linspace(max(u_first, -2), min(u_last, 2), 9):
        for v in np.linspace(max(v_first, -1.3), min(v_last, 1.3), 9):
            point, along_u, along_v = gp_Pnt(), gp_Vec(), gp_Vec()
            surface.D1(float(u), float(v), point, along_u, along_v)
            own = surface_at(coefficients, place, float(u), float(v))
            assert own[0] == pytest.approx(point.Coord(), abs=1e-12, rel=1e-12)
            assert own[1] == pytest.approx(along_u.Coord(), abs=close, rel=close)
            assert own[2] == pytest.approx(along_v.Coord(), abs=close, rel=close)


@pytest.mark.parametrize(
    "kind", [Geom_BSplineCurve, Geom_BezierCurve, Geom_BSplineSurface, Geom_BezierSurface]
)
def test_no_spline_needs_more_room_than_there_is(kind):
    """They are evaluated in room for so many poles, and nothing else looks at their degree."""
    assert kind.MaxDegree_s() + 1 == STACK_ROOM


def test_splines_of_the_highest_degree():
    """Against fractions: OCCT itself is off by up to 1e-6 there."""
    surface = bezier_surface(STACK_ROOM, STACK_ROOM)
    flattener = Flattener()
    place, curve = flattener.surface(surface), flattener.curve(surface.UIso(0.0))
    coefficients, degree = flattener.coefficients(), STACK_ROOM - 1
    rows = [[Fraction(surface.Pole(i, j).Z()) for j in range(1, 27)] for i in range(1, 27)]

    def bernstein(poles, t):
        chosen = [comb(len(poles) - 1, k) * t**k for k in range(len(poles))]
        return sum(
            share * (1 - t) ** (len(poles) - 1 - k) * poles[k] for k, share in enumerate(chosen)
        )

    def differences(poles):
        return [degree * (after - before) for before, after in pairwise(poles)]

    for u, v in [(0.0, 0.4), (0.3, 0.77), (1.0, 0.999), (0.51, 0.0)]:
        across = [bernstein(row, Fraction(v)) for row in rows]
        along_v = [bernstein(differences(row), Fraction(v)) for row in rows]
        z = bernstein(across, Fraction(u))
        z_u, z_v = (bernstein(poles, Fraction(u)) for poles in (differences(across), along_v))
        point, own_u, own_v = surface_at(coefficients, place, u, v)
        assert point == pytest.approx([25 * u, 25 * v, float(z)], abs=1e-13)
        assert own_u == pytest.approx([25, 0, float(z_u)], abs=1e-12)
        assert own_v == pytest.approx([0, 25, float(z_v)], abs=1e-12)
        found = curve_at(coefficients, curve, v)
        assert found[2] == pytest.approx(float(bernstein(rows[0], Fraction(v))), abs=1e-13)
