"""The exact curve of a run, and where walls end on it."""

from __future__ import annotations

import numpy as np
from OCP.Geom import Geom_Circle, Geom_Curve, Geom_Ellipse
from OCP.GeomAPI import GeomAPI_Interpolate, GeomAPI_ProjectPointOnCurve
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Elips, gp_Pnt, gp_Vec
from OCP.TColgp import TColgp_HArray1OfPnt

from v3dcad.errors import KernelError
from v3dcad.geometry.drawing import Conic, Spline
from v3dcad.geometry.surface.wall_ends import MAX_END_SHIFT
from v3dcad.kernel.shapes import TOLERANCE
from v3dcad.model import CurveRun, Floats, Section


def run_curve(run: CurveRun, section: Section) -> Geom_Curve | None:
    """The exact curve of a run in bed coordinates, running as its ring does; None for a line.

    A circle or ellipse as the section says; of a run of points the cubic spline through them
    (they lie on the true surface; the chords between them do not).
    """
    if run.curve == "line":
        return None
    ring = section.rings[run.ring]
    along = ring[np.arange(run.start, run.stop + 1) % len(ring)]
    if run.curve == "circle":
        x, y, radius = run.parameters
        frame = _frame(along, x, y, section.z, (1.0, 0.0))
        return Geom_Circle(gp_Circ(frame, radius))
    if run.curve == "ellipse":
        x, y, major_x, major_y, ratio = run.parameters
        frame = _frame(along, x, y, section.z, (major_x, major_y))
        major = float(np.hypot(major_x, major_y))
        return Geom_Ellipse(gp_Elips(frame, major, major * ratio))
    apart = _apart(along)
    return _spline(apart, section.z) if len(apart) > 2 else None


def _frame(along: Floats, x: float, y: float, z: float, first: tuple[float, float]) -> gp_Ax2:
    """A conic's frame whose angle grows the way that its points (k, 2) run."""
    a, b = along[:2] - (x, y)
    way = 1.0 if a[0] * b[1] > a[1] * b[0] else -1.0
    return gp_Ax2(gp_Pnt(x, y, z), gp_Dir(0, 0, way), gp_Dir(*first, 0))


def _apart(along: Floats) -> Floats:
    """The points (k, 2) of a run, without those that OCCT would not tell from the one before."""
    kept = [0]
    for k in range(1, len(along)):
        if np.hypot(*(along[k] - along[kept[-1]])) > 2 * TOLERANCE:
            kept.append(k)
    # The end stays where it is, even if the point before it has to be dropped.
    kept[max(len(kept) - 1, 1) :] = [len(along) - 1]
    return along[kept]


def _spline(along: Floats, z: float) -> Geom_Curve:
    closed = bool((along[0] == along[-1]).all())
    through = along[:-1] if closed else along
    points = TColgp_HArray1OfPnt(1, len(through))
    for k, (x, y) in enumerate(through.tolist(), start=1):
        points.SetValue(k, gp_Pnt(x, y, z))
    spline = GeomAPI_Interpolate(points, closed, TOLERANCE)
    spline.Perform()
    if not spline.IsDone():
        raise KernelError(f"no spline can be laid through a contour at z = {z:g} mm")
    return spline.Curve()


def parameter_at(curve: Geom_Curve, point: Floats) -> float:
    """The parameter of the curve's nearest point to a point (3,)."""
    projection = GeomAPI_ProjectPointOnCurve(gp_Pnt(*point.tolist()), curve)
    if projection.NbPoints() == 0:  # off one end of an open curve
        first, last = curve.FirstParameter(), curve.LastParameter()
        at = gp_Pnt(*point.tolist())
        nearer = at.Distance(curve.Value(first)) < at.Distance(curve.Value(last))
        return float(first if nearer else last)
    return float(projection.LowerDistanceParameter())


def hit(curve: Geom_Curve, end: Floats, way: Floats) -> Floats:
    """The point (3,), mm, where a wall that ends near the curve meets it.

    The wall's line runs through `end` (3,) along `way` (3,). Newton's method finds where it meets
    the curve; where the angle is too flat for that, the nearest point to `end` is taken.
    """
    point, tangent = gp_Pnt(), gp_Vec()
    start = parameter = parameter_at(curve, end)
    for _ in range(12):
        curve.D1(parameter, point, tangent)
        off = end[:2] - (point.X(), point.Y())
        rows = np.array([[tangent.X(), -way[0]], [tangent.Y(), -way[1]]])
        if abs(np.linalg.det(rows)) < 1e-3 * tangent.Magnitude() * np.hypot(*way[:2]):
            break
        step = float(np.linalg.solve(rows, off)[0])
        parameter += step
        if abs(step) * tangent.Magnitude() < 1e-12:
            break
    found = point_at(curve, parameter)
    return found if np.linalg.norm(found - end) < MAX_END_SHIFT else point_at(curve, start)


def span(curve: Geom_Curve, start: Floats, stop: Floats) -> tuple[float, float]:
    """The parameters of two points (3,) on the curve, ascending; once around where they are one."""
    first, last = parameter_at(curve, start), parameter_at(curve, stop)
    if curve.IsPeriodic() and last <= first + 1e-12:
        last += curve.Period()
    return first, last


def point_at(curve: Geom_Curve, parameter: float) -> Floats:
    """A curve's point (3,), mm, at a parameter."""
    point = curve.Value(parameter)
    return np.array([point.X(), point.Y(), point.Z()])


def plain_curve(curve: Geom_Curve, first: float, last: float) -> Conic | Spline:
    """A stretch of a run's curve, between two parameters, as plain numbers."""
    if isinstance(curve, Geom_Circle | Geom_Ellipse):
        frame = curve.Position()
        circle = isinstance(curve, Geom_Circle)
        radii = (curve.Radius(),) * 2 if circle else (curve.MajorRadius(), curve.MinorRadius())
        centre, axis, towards = frame.Location(), frame.Direction(), frame.XDirection()
        return Conic(centre.Coord(), axis.Coord(), towards.Coord(), *radii, first, last)
    spline = curve.Copy()
    spline.Segment(first, last, TOLERANCE)  # knots are put in where it ends; its shape stays
    ids = range(1, spline.NbKnots() + 1)
    return Spline(
        spline.Degree(),
        np.array([spline.Pole(k).Coord() for k in range(1, spline.NbPoles() + 1)]),
        [spline.Knot(k) for k in ids],
        [spline.Multiplicity(k) for k in ids],
    )
