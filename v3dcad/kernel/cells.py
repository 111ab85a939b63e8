"""A structure in space as faces and solids: its walls, its cells, and thick walls."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepOffset import BRepOffset_Skin
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakeOffsetShape
from OCP.GeomAbs import GeomAbs_Intersection
from OCP.TopoDS import TopoDS, TopoDS_Shape, TopoDS_Shell, TopoDS_Solid

from v3dcad.errors import KernelError
from v3dcad.geometry.solid.convex_cells import hollows
from v3dcad.geometry.solid.facets import Facets
from v3dcad.kernel.booleans import common, cut, split
from v3dcad.kernel.plane_faces import connected_shells, convex_solid, wall_faces
from v3dcad.kernel.shapes import (
    FACE,
    SOLID,
    area,
    bounds,
    compound,
    measured,
    quartered,
    subshapes,
    volume,
)
from v3dcad.model import Floats, Placement
from v3dcad.settings import check_size

MARGIN = 1.0
"""mm that the cells of thick walls reach beyond the part, so that no side of theirs lies in its."""


LOSS = 1e-6
"""Of a part's volume: the most that its cells' may differ. OCCT leaves 1e-8, but files come with
edges that are off their faces by hundredths of a millimetre (NIST's: 6e-7)."""


def cut_walls(solid: TopoDS_Shape, walls: Facets, placement: Placement) -> list[TopoDS_Shell]:
    """The walls inside a solid: plane faces that share their edges, a shell for each piece.

    Solid and result lie where the source lies. Raises `KernelError` where there are no walls, or
    where OCCT finds none of them inside.
    """
    faces = _faces(walls, placement)
    inside = common([compound(faces)], [solid])
    found = [TopoDS.Face_s(face) for face in subshapes(inside, FACE)]
    if not found or not 0 < area(inside) <= area(compound(faces)) * (1 + 1e-9):
        raise KernelError(
            "OCCT found no walls inside the part; change a site or the offset slightly"
        )
    return connected_shells(found)


def cut_cells(
    solid: TopoDS_Shape, walls: Facets, placement: Placement
) -> tuple[list[TopoDS_Shape], Floats]:
    """The cells as solids, neighbours sharing their faces, and their centres of mass (k, 3), mm.

    The part is split by its walls; what it leaves of a cell may be several solids. Raises
    `KernelError` where they do not add up to the part (to `LOSS` of its volume, or a hundredth of
    that where OCCT can).
    """
    tool, whole = compound(_faces(walls, placement)), volume(solid)
    pieces = _pieces(solid, tool)
    if pieces.miss(whole) > LOSS / 100:
        # Where a wall crosses a wide round face, OCCT may fit the curve badly: with quarters of
        # such faces it does better, at the price of seams between them.
        others = _pieces(quartered(solid), tool)
        pieces = min(pieces, others, key=lambda some: (not some.are_sound(), some.miss(whole)))
    if not pieces.miss(whole) <= LOSS:
        raise KernelError(
            f"OCCT's cells add up to {sum(pieces.volumes):.10g} mm³, the part to {whole:.10g}; "
            "change a site or the offset slightly, or write thick walls (solid) instead"
        )
    return pieces.solids, np.array(pieces.centres)


class _Pieces(NamedTuple):
    """What a part is split into."""

    solids: list[TopoDS_Shape]
    volumes: list[float]
    centres: list[Floats]

    def miss(self, whole: float) -> float:
        """How far off the whole part's volume the pieces' sum is, as a share of it."""
        return abs(sum(self.volumes) - whole) / whole

    def are_sound(self) -> bool:
        """Whether OCCT finds no fault in them."""
        return bool(BRepCheck_Analyzer(compound(self.solids)).IsValid())


def _pieces(solid: TopoDS_Shape, tool: TopoDS_Shape) -> _Pieces:
    solids = list(subshapes(split([solid], [tool]), SOLID))
    found = [measured(piece) for piece in solids]
    return _Pieces(solids, [size for size, _ in found], [centre for _, centre in found])


def thick_walls(
    solid: TopoDS_Shape, walls: Facets, placement: Placement, thickness: float, skin: float = 0.0
) -> TopoDS_Shape:
    """The part without its cells, each moved in by half the thickness (mm): mitred thick walls.

    With `skin` (mm) above 0 the cells also keep that far from the part's surface, which leaves a
    closed hull. Warns how many cells close up. Raises `SettingError` for a thickness of 0 or one
    that closes all cells, `KernelError` where OCCT fails or its result has no sound volume.
    """
    if skin:
        check_size("skin", skin)
    low, high = bounds(solid)
    moved = walls.moved(placement.to_source(walls.points))
    cells = [convex_solid(cell) for cell in hollows(moved, thickness, low - MARGIN, high + MARGIN)]
    if skin:
        cores = [_core(TopoDS.Solid_s(body), skin) for body in subshapes(solid, SOLID)]
        kept = common([compound(cells)], cores)
        cells = list(subshapes(kept, SOLID))
    result = cut([solid], cells)
    if not 0 < volume(result) < volume(solid):
        raise KernelError(
            f"OCCT's thick walls have {volume(result):.6g} mm³ of the part's {volume(solid):.6g}; "
            "change the thickness or the offset slightly"
        )
    return result


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
        raise KernelError("there are no walls: the part has a single cell; give more sites")
    return list(faces)
