"""A horizontal section of B-rep solids by OCCT's own section algorithm."""

from __future__ import annotations

import numpy as np
import shapely
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepAlgoAPI import BRepAlgoAPI_Section
from OCP.GCPnts import GCPnts_TangentialDeflection
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
from OCP.TopoDS import TopoDS, TopoDS_Shape
from scipy.spatial import KDTree

from v3dcad.errors import KernelError
from v3dcad.kernel.shapes import EDGE, subshapes
from v3dcad.model import Floats, Section

CHORD_TOLERANCE = 0.005
ASIDE = 1e-5
"""How far from its height the plane is laid (mm), so that it never lies in a face."""


def section(shape: TopoDS_Shape, z: float, at_base: bool) -> Section:
    """The section at height z (mm): the limit from below, at the base from above.

    Raises `KernelError` where OCCT's section leaves a contour open.
    """
    plane = gp_Pln(gp_Pnt(0, 0, z + (ASIDE if at_base else -ASIDE)), gp_Dir(0, 0, 1))
    cutter = BRepAlgoAPI_Section(shape, plane, False)
    cutter.Approximation(True)
    cutter.Build()
    lines = [
        _polyline(BRepAdaptor_Curve(TopoDS.Edge_s(edge)))
        for edge in subshapes(cutter.Shape(), EDGE)
    ]
    if not lines:
        return Section(z, ())
    _join_ends(lines)
    area = shapely.build_area(shapely.union_all([shapely.linestrings(line) for line in lines]))
    dangling = shapely.polygonize_full([shapely.linestrings(line) for line in lines])[2]
    if not shapely.is_empty(dangling):
        raise KernelError(f"the section at z = {z:g} mm has an open contour")
    rings = [
        shapely.get_coordinates(ring)[:-1]
        for polygon in shapely.get_parts(shapely.orient_polygons(area))
        for ring in (polygon.exterior, *polygon.interiors)
    ]
    return Section(z, tuple(rings))


def _polyline(curve: BRepAdaptor_Curve) -> Floats:
    points = GCPnts_TangentialDeflection(curve, 0.2, CHORD_TOLERANCE)
    return np.array([points.Value(i + 1).Coord()[:2] for i in range(points.NbPoints())])


def _join_ends(lines: list[Floats]) -> None:
    """Give line ends that meet within OCCT's tolerance the very same coordinates."""
    ends = np.array([line[i] for line in lines for i in (0, -1)])
    first = [min(near) for near in KDTree(ends).query_ball_point(ends, 0.02)]
    for k, line in enumerate(lines):
        line[0], line[-1] = ends[first[2 * k]], ends[first[2 * k + 1]]
