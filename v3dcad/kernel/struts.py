"""Struts as B-rep: cylinders along straight axes, spheres where they meet."""

from __future__ import annotations

import math

import numpy as np
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape

from v3dcad.arguments import above_zero
from v3dcad.errors import KernelError
from v3dcad.geometry.mesh.boolean import manifold, mesh_volume
from v3dcad.geometry.solid.bar_meshes import bar_mesh
from v3dcad.kernel.booleans import common, fused
from v3dcad.kernel.mesh import triangle_mesh
from v3dcad.kernel.shapes import SOLID, area, subshapes, volume
from v3dcad.model import Floats, Ints

FUSE_LIMIT = 200
"""Struts that OCCT unites soundly: at 969 its result was invalid."""

FUSE_CHECK = 0.01
"""Largest relative difference between the volumes of the united solid and the united mesh."""

CUT_CHECK = 0.05
"""The same for a bar cut to the part, of the whole bar's volume."""

CHECK_SAG, CHECK_TURN = 0.05, 0.3
"""mm and radians: tolerances of the meshes that bars are checked with."""


def bars(points: Floats, struts: Ints, diameter: float) -> list[TopoDS_Shape]:
    """A cylinder along each strut and a sphere at each joint; they overlap.

    `points` (v, 3), mm, `struts` (s, 2) point ids. Raises `SettingError` for a diameter of 0,
    `KernelError` where there are no struts.
    """
    above_zero("diameter", diameter)
    if not len(struts):
        raise KernelError("there are no struts: no three cells meet; give more sites")
    cylinders = []
    for start, stop in points[struts]:
        along = stop - start
        axis = gp_Ax2(gp_Pnt(*start.tolist()), gp_Dir(*along.tolist()))
        length = float(np.linalg.norm(along))
        cylinders.append(BRepPrimAPI_MakeCylinder(axis, diameter / 2, length).Shape())
    # Tilted, since OCCT loses balls whose poles or seams lie along a part's own.
    ball = BRepPrimAPI_MakeSphere(gp_Ax2(gp_Pnt(), gp_Dir(0.48, 0.6, 0.64)), diameter / 2).Shape()
    joints = [ball.Located(_to(point)) for point in points[np.unique(struts)].tolist()]
    return [*cylinders, *joints]


def cut_bars(made: list[TopoDS_Shape], solid: TopoDS_Shape) -> list[TopoDS_Shape]:
    """What of each bar lies inside a solid.

    Raises `KernelError` where nothing does, and where OCCT leaves another volume of a bar than
    meshes do (by more than `CUT_CHECK` and what the meshes are off): it loses some at the surface.
    """
    whole, inside = manifold(triangle_mesh(solid, CHECK_SAG, CHECK_TURN)), []
    for bar in made:
        pieces = list(subshapes(common([bar], [solid]), SOLID))
        found = sum(map(volume, pieces))
        expected = (manifold(triangle_mesh(bar, CHECK_SAG, CHECK_TURN)) ^ whole).volume()
        if abs(found - expected) > CUT_CHECK * volume(bar) + CHECK_SAG * area(bar) / 2:
            raise KernelError(
                f"OCCT leaves {found:.3g} mm³ of a strut, but {expected:.3g} mm³ lie in the part; "
                "change the diameter slightly, or cut a mesh: write_stl(..., 'struts', cut=True)"
            )
        inside += pieces
    if not inside:
        raise KernelError("OCCT found no strut inside the part; give more sites")
    return inside


def fused_bars(points: Floats, struts: Ints, diameter: float) -> TopoDS_Shape:
    """Struts and joints as one solid, united in pairs, pairs of pairs, and so on.

    Raises `KernelError` above `FUSE_LIMIT` struts, and where the volume is not that of the same
    bars united as meshes.
    """
    instead = (
        "write_stl(..., form='struts') unites them as a mesh, write_3mf(..., form='beams') "
        "keeps them as beams, and without fuse they are a compound"
    )
    if len(struts) > FUSE_LIMIT:
        raise KernelError(
            f"fuse: {len(struts)} struts are more than the {FUSE_LIMIT} that OCCT unites soundly; "
            + instead
        )
    shapes = bars(points, struts, diameter)
    while len(shapes) > 1:
        pairs = zip(shapes[::2], shapes[1::2], strict=False)
        odd = shapes[-1:] if len(shapes) % 2 else []
        shapes = [fused([one], [other]) for one, other in pairs] + odd
    expected = mesh_volume(bar_mesh(points, struts, diameter, sides=64))
    found = volume(shapes[0])
    if not math.isclose(found, expected, rel_tol=FUSE_CHECK):
        raise KernelError(
            f"fuse: OCCT's solid has {found:.6g} mm³ where the struts have {expected:.6g}; "
            + instead
        )
    return shapes[0]


def _to(point: list[float]) -> TopLoc_Location:
    shift = gp_Trsf()
    shift.SetTranslation(gp_Vec(*point))
    return TopLoc_Location(shift)
