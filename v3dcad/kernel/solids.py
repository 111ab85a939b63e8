"""A structure in space as faces and solids: its walls, its cells, and thick walls."""

from __future__ import annotations

import warnings

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Splitter
from OCP.BRepOffset import BRepOffset_Skin
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakeOffsetShape
from OCP.GeomAbs import GeomAbs_Intersection
from OCP.TopoDS import TopoDS, TopoDS_Shape, TopoDS_Shell, TopoDS_Solid
from OCP.TopTools import TopTools_ListOfShape

from v3dcad.errors import KernelError, SettingError
from v3dcad.geometry.convex import inset_cells
from v3dcad.geometry.facets import Facets
from v3dcad.kernel.plane_faces import connected_shells, convex_solid, wall_faces
from v3dcad.kernel.shapes import FACE, SOLID, area, bounds, compound, subshapes, volume
from v3dcad.model import Placement

MARGIN = 1.0
"""mm that the cells of thick walls reach beyond the part, so that no side of theirs lies in its."""


def cut_walls(solid: TopoDS_Shape, walls: Facets, placement: Placement) -> list[TopoDS_Shell]:
    """The walls inside a solid: plane faces that share their edges, a shell for each piece.

    Solid and result lie where the source lies. Raises `KernelError` where there are no walls, or
    where OCCT finds none of them inside.
    """
    faces = _faces(walls, placement)
    inside = _done(BRepAlgoAPI_Common(), [compound(faces)], [solid], "cutting the walls")
    found = [TopoDS.Face_s(face) for face in subshapes(inside, FACE)]
    if not found or not 0 < area(inside) <= area(compound(faces)) * (1 + 1e-9):
        raise KernelError("OCCT found no walls inside the part; change a site or the offset a bit")
    return connected_shells(found)


def cut_cells(solid: TopoDS_Shape, walls: Facets, placement: Placement) -> list[TopoDS_Shape]:
    """The cells as solids: the part split by its walls, neighbours sharing their faces.

    Raises `KernelError` where the cells do not add up to the part (to 1e-6 of its volume).
    """
    faces = _faces(walls, placement)
    split = _done(BRepAlgoAPI_Splitter(), [solid], [compound(faces)], "splitting the part")
    cells = list(subshapes(split, SOLID))
    whole, parts = volume(solid), sum(map(volume, cells))
    if not abs(whole - parts) <= 1e-6 * whole:
        raise KernelError(
            f"OCCT's cells add up to {parts:.6g} mm³, the part to {whole:.6g}; "
            "change a site or the offset a bit"
        )
    return cells


def thick_walls(
    solid: TopoDS_Shape, walls: Facets, placement: Placement, thickness: float, skin: float = 0.0
) -> TopoDS_Shape:
    """The part without its cells, each moved in by half the thickness (mm): mitred thick walls.

    With `skin` (mm) above 0 the cells also keep that far from the part's surface, which leaves a
    closed hull. Warns how many cells close up. Raises `SettingError` for a thickness of 0 or one
    that closes all cells, `KernelError` where OCCT fails or its result has no sound volume.
    """
    for name, value in (("thickness", thickness), ("skin", skin)):
        check_size(name, value, zero_allowed=name == "skin")
    low, high = bounds(solid)
    moved = walls.moved(placement.to_source(walls.points))
    inset = inset_cells(moved, thickness / 2, low - MARGIN, high + MARGIN)
    closed = len(np.unique(walls.sites)) - len(inset)
    if not inset:
        raise SettingError(
            "thickness", f"thickness {thickness:g} mm closes all cells; give a smaller one"
        )
    if closed:
        warnings.warn(
            f"thickness {thickness:g} mm is more than {closed} cells are wide: they close up",
            stacklevel=2,
        )
    cells = [convex_solid(inset[site]) for site in inset]
    if skin:
        cores = [_core(TopoDS.Solid_s(body), skin) for body in subshapes(solid, SOLID)]
        kept = _done(BRepAlgoAPI_Common(), [compound(cells)], cores, "making the skin")
        cells = list(subshapes(kept, SOLID))
    result = _done(BRepAlgoAPI_Cut(), [solid], cells, "cutting the cells out")
    if not 0 < volume(result) < volume(solid):
        raise KernelError(
            f"OCCT's thick walls have {volume(result):.6g} mm³ of the part's {volume(solid):.6g}; "
            "change the thickness or the offset a bit"
        )
    return result


def check_size(name: str, value: float, zero_allowed: bool = False) -> None:
    """Raise `SettingError` unless a length is a finite number above 0 (or 0 where allowed)."""
    if not np.isfinite(value) or value < 0 or (value == 0 and not zero_allowed):
        bound = "of at least 0" if zero_allowed else "above 0"
        raise SettingError(name, f"{name} {value:g}: give a number {bound} mm")


def _core(body: TopoDS_Solid, skin: float) -> TopoDS_Shape:
    """One solid without a skin of that thickness."""
    offset = BRepOffsetAPI_MakeOffsetShape()
    offset.PerformByJoin(body, -skin, 1e-4, BRepOffset_Skin, False, False, GeomAbs_Intersection)
    core = offset.Shape() if offset.IsDone() else TopoDS_Solid()
    if core.IsNull() or core.ShapeType() != SOLID or not 0 < volume(core) < volume(body):
        raise KernelError(
            f"OCCT cannot offset the part by a skin of {skin:g} mm; give a thinner one or none"
        )
    return core


def _faces(walls: Facets, placement: Placement) -> list[TopoDS_Shape]:
    faces = wall_faces(walls.moved(placement.to_source(walls.points)))
    if not faces:
        raise KernelError("there are no walls: the part holds a single cell; give more sites")
    return list(faces)


def _done(
    boolean: BRepAlgoAPI_Common | BRepAlgoAPI_Cut | BRepAlgoAPI_Splitter,
    arguments: list[TopoDS_Shape],
    tools: list[TopoDS_Shape],
    what: str,
) -> TopoDS_Shape:
    """A boolean's result. `KernelError` where it is not done or empty."""
    boolean.SetArguments(_list(arguments))
    boolean.SetTools(_list(tools))
    boolean.SetNonDestructive(True)
    boolean.Build()
    if not boolean.IsDone() or boolean.Shape().IsNull():
        raise KernelError(f"OCCT failed at {what}; change a site or the offset a bit")
    return boolean.Shape()


def _list(shapes: list[TopoDS_Shape]) -> TopTools_ListOfShape:
    listed = TopTools_ListOfShape()
    for shape in shapes:
        listed.Append(shape)
    return listed
