"""Curves and surfaces of OCCT as an array of coefficients, for the evaluators of `geometry`."""

from __future__ import annotations

from typing import Any

import numpy as np
from OCP.GeomAbs import (
    GeomAbs_BezierSurface,
    GeomAbs_BSplineCurve,
    GeomAbs_BSplineSurface,
    GeomAbs_Circle,
    GeomAbs_Cone,
    GeomAbs_Cylinder,
    GeomAbs_Ellipse,
    GeomAbs_Hyperbola,
    GeomAbs_Line,
    GeomAbs_OffsetSurface,
    GeomAbs_Parabola,
    GeomAbs_Plane,
    GeomAbs_Sphere,
    GeomAbs_SurfaceOfExtrusion,
    GeomAbs_SurfaceOfRevolution,
    GeomAbs_Torus,
)
from OCP.GeomAdaptor import GeomAdaptor_Curve, GeomAdaptor_Surface
from OCP.GeomConvert import GeomConvert

from v3dcad.errors import KernelError
from v3dcad.geometry.surface import curves, surfaces
from v3dcad.model import Floats


class Flattener:
    """Collects the coefficients of curves and surfaces (see `geometry/surface/curves.py`)."""

    def __init__(self) -> None:
        self.numbers: list[float] = []

    def coefficients(self) -> Floats:
        """(c,) all coefficients so far."""
        return np.array(self.numbers, np.float64)

    def curve(self, curve: Any) -> int:
        """Add a `Geom_Curve`; returns the index of its first coefficient."""
        adaptor = GeomAdaptor_Curve(curve)
        kind = adaptor.GetType()
        if kind == GeomAbs_Line:
            axis = adaptor.Line().Position()
            return self._add(curves.LINE, *axis.Location().Coord(), *axis.Direction().Coord())
        if kind == GeomAbs_Circle:
            circle = adaptor.Circle()
            radius = circle.Radius()
            return self._add(curves.ELLIPSE, *_axes(circle.Position())[:9], radius, radius)
        if kind == GeomAbs_Ellipse:
            conic = adaptor.Ellipse()
            radii = conic.MajorRadius(), conic.MinorRadius()
            return self._add(curves.ELLIPSE, *_axes(conic.Position())[:9], *radii)
        if kind == GeomAbs_Hyperbola:
            conic = adaptor.Hyperbola()
            radii = conic.MajorRadius(), conic.MinorRadius()
            return self._add(curves.HYPERBOLA, *_axes(conic.Position())[:9], *radii)
        if kind == GeomAbs_Parabola:
            conic = adaptor.Parabola()
            return self._add(curves.PARABOLA, *_axes(conic.Position())[:9], conic.Focal(), 0.0)
        if kind == GeomAbs_BSplineCurve:
            return self._spline(adaptor.BSpline())
        # Béziers exactly; offsets of curves approximated by OCCT.
        return self._spline(GeomConvert.CurveToBSplineCurve_s(curve))

    def surface(self, surface: Any) -> int:
        """Add a `Geom_Surface`; returns the index of its first coefficient.

        `KernelError` for a kind of surface that is not known.
        """
        adaptor = GeomAdaptor_Surface(surface)
        kind = adaptor.GetType()
        if kind == GeomAbs_Plane:
            return self._add(surfaces.PLANE, *_axes(adaptor.Plane().Position()))
        if kind == GeomAbs_Cylinder:
            cylinder = adaptor.Cylinder()
            return self._add(
                surfaces.CYLINDER, *_axes(cylinder.Position()), cylinder.Radius(), 0.0, 0.0
            )
        if kind == GeomAbs_Cone:
            cone = adaptor.Cone()
            angle = cone.SemiAngle()
            shape = cone.RefRadius(), np.sin(angle), np.cos(angle)
            return self._add(surfaces.CONE, *_axes(cone.Position()), *shape)
        if kind == GeomAbs_Sphere:
            sphere = adaptor.Sphere()
            return self._add(surfaces.SPHERE, *_axes(sphere.Position()), sphere.Radius(), 0.0)
        if kind == GeomAbs_Torus:
            torus = adaptor.Torus()
            radii = torus.MajorRadius(), torus.MinorRadius()
            return self._add(surfaces.TORUS, *_axes(torus.Position()), *radii)
        if kind == GeomAbs_BSplineSurface:
            return self._spline_surface(adaptor.BSpline())
        if kind == GeomAbs_BezierSurface:
            return self._spline_surface(GeomConvert.SurfaceToBSplineSurface_s(surface))
        if kind == GeomAbs_SurfaceOfExtrusion:
            basis = self.curve(_untrimmed(surface).BasisCurve())
            return self._add(surfaces.EXTRUSION, *adaptor.Direction().Coord(), basis)
        if kind == GeomAbs_SurfaceOfRevolution:
            return self._revolution(_untrimmed(surface))
        if kind == GeomAbs_OffsetSurface:
            offset = _untrimmed(surface)
            basis = self.surface(offset.BasisSurface())
            return self._add(surfaces.OFFSET, offset.Offset(), basis)
        raise KernelError("a face lies on a surface of a kind that OCCT does not name")

    def _add(self, kind: int, *numbers: float) -> int:
        index = len(self.numbers)
        self.numbers += [kind, *numbers]
        return index

    def _spline(self, spline: Any) -> int:
        periodic = spline.IsPeriodic()
        if periodic:
            spline = spline.Copy()
            spline.SetNotPeriodic()
        knots = _values(spline.KnotSequence())
        poles = [
            number
            for i in range(1, spline.NbPoles() + 1)
            for number in _homogeneous(spline.Pole(i), spline.Weight(i))
        ]
        return self._add(
            curves.SPLINE, spline.Degree(), len(knots), float(periodic), *knots, *poles
        )

    def _spline_surface(self, spline: Any) -> int:
        u_periodic, v_periodic = spline.IsUPeriodic(), spline.IsVPeriodic()
        if u_periodic or v_periodic:
            spline = spline.Copy()
            if u_periodic:
                spline.SetUNotPeriodic()
            if v_periodic:
                spline.SetVNotPeriodic()
        u_knots, v_knots = _values(spline.UKnotSequence()), _values(spline.VKnotSequence())
        # Where all weights are 1, OCCT has zeros for them once a surface is no longer periodic.
        rational = spline.IsURational() or spline.IsVRational()
        poles = [
            number
            for i in range(1, spline.NbUPoles() + 1)
            for j in range(1, spline.NbVPoles() + 1)
            for number in _homogeneous(spline.Pole(i, j), spline.Weight(i, j) if rational else 1.0)
        ]
        return self._add(
            surfaces.SPLINE_SURFACE,
            *(spline.UDegree(), len(u_knots), float(u_periodic)),
            *(spline.VDegree(), len(v_knots), float(v_periodic)),
            *u_knots,
            *v_knots,
            *poles,
        )

    def _revolution(self, surface: Any) -> int:
        basis = self.curve(surface.BasisCurve())
        axis = surface.Axis()
        z = np.array(axis.Direction().Coord())
        x = np.cross(z, np.eye(3)[np.argmin(np.abs(z))])
        x /= np.linalg.norm(x)
        frame = (*axis.Location().Coord(), *x, *np.cross(z, x), *z)
        return self._add(surfaces.REVOLUTION, *frame, basis)


def _axes(position: Any) -> tuple[float, ...]:
    """Origin and x, y and z axis (which may be left-handed) of an OCCT frame, 12 numbers."""
    axis = position.Axis().Direction() if hasattr(position, "Axis") else position.Direction()
    return (
        *position.Location().Coord(),
        *position.XDirection().Coord(),
        *position.YDirection().Coord(),
        *axis.Coord(),
    )


def _untrimmed(surface: Any) -> Any:
    while hasattr(surface, "BasisSurface") and hasattr(surface, "SetTrim"):
        surface = surface.BasisSurface()
    return surface


def _values(array: Any) -> list[float]:
    return [array.Value(i) for i in range(array.Lower(), array.Upper() + 1)]


def _homogeneous(pole: Any, weight: float) -> tuple[float, float, float, float]:
    x, y, z = pole.Coord()
    return x * weight, y * weight, z * weight, weight
