"""A structure in space as faces and solids: its walls, its cells, and thick walls."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepOffset import BRepOffset_Skin
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakeOffsetShape
from OCP.GeomAbs import GeomAbs_Intersection
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopoDS import TopoDS, TopoDS_Face, TopoDS_Shape, TopoDS_Shell, TopoDS_Solid
from OCP.TopTools import TopTools_IndexedMapOfShape

from v3dcad.arguments import above_zero
from v3dcad.errors import KernelError
from v3dcad.geometry.solid.convex_cells import hollows
from v3dcad.geometry.solid.enclosed import (
    INSIDE,
    NEAR,
    OUTSIDE,
    CellWalls,
    sides_of,
    volumes_and_middles,
    whole_cells,
)
from v3dcad.geometry.solid.facets import Facets
from v3dcad.kernel.booleans import common, cut, split
from v3dcad.kernel.mesh import triangle_mesh
from v3dcad.kernel.part import MESH_SAG, MESH_TURN
from v3dcad.kernel.plane_faces import connected_shells, convex_solid, solid_within, wall_faces
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

MARGIN = 1.0
"""mm that the cells of thick walls reach beyond the part, so that no side of theirs lies in its."""


LOSS = 1e-6
"""Of a part's volume: the most that its cells' may differ. OCCT leaves 1e-8, but files come with
edges that are off their faces by hundredths of a millimetre (NIST's: 6e-7)."""


CLEAR = 2 * MESH_SAG
"""mm; what stays so far from the part's triangles stays inside its true surface."""


def cut_walls(solid: TopoDS_Shape, walls: Facets, placement: Placement) -> list[TopoDS_Shell]:
    """The walls inside a solid: plane faces that share their edges, a shell for each piece.

    Walls wholly inside go in as they are; OCCT cuts the others. Solid and result lie where the
    source lies. Raises `KernelError` where there are no walls, or where OCCT finds none inside.
    """
    space = _Space(solid, walls, placement)
    found = [face for wall, face in space.faces.items() if space.sides[wall] == INSIDE]
    crossing = [face for wall, face in space.faces.items() if space.sides[wall] == NEAR]
    if crossing:
        inside = common([compound(crossing)], [solid])
        if not area(inside) <= area(compound(crossing)) * (1 + 1e-9):
            raise KernelError("OCCT made walls larger than they are; change a site slightly")
        found += [TopoDS.Face_s(face) for face in subshapes(inside, FACE)]
    if not found:
        raise KernelError("OCCT found no walls inside the part; change a site slightly")
    return connected_shells(found)


def cut_cells(
    solid: TopoDS_Shape, walls: Facets, placement: Placement
) -> tuple[list[TopoDS_Shape], Floats]:
    """The cells as solids, neighbours sharing their faces, and a point (k, 3) inside each, mm.

    Cells wholly inside the part are built of their walls. Their union is one of the pieces that
    the walls of the others part the part into; what else OCCT leaves of a cell may be several
    solids. Raises `KernelError` where all do not add up to the part (to `LOSS` of its volume, or a
    hundredth of that where OCCT can).
    """
    space, whole = _Space(solid, walls, placement), volume(solid)
    cells = whole_cells(space.walls, space.inside(), space.surface)
    volumes, middles = volumes_and_middles(space.walls, cells)
    around, tool = space.rim(cells), compound(space.parting(cells))
    left = whole - float(volumes.sum())
    pieces = _pieces(solid, tool, around)
    if pieces.miss(left) > LOSS / 100 * whole:
        # Where a wall crosses a wide round face, OCCT may fit the curve badly: with quarters of
        # such faces it does better, at the price of seams between them.
        others = _pieces(quartered(solid), tool, around)
        pieces = min(pieces, others, key=lambda some: (not some.are_sound(), some.miss(left)))
    if not pieces.miss(left) <= LOSS * whole:
        raise KernelError(
            f"OCCT's cells add up to {whole - left + sum(pieces.volumes):.10g} mm³, the part to "
            f"{whole:.10g}; change a site slightly, or write thick walls (solid) instead"
        )
    return [*space.solids(cells), *pieces.solids], np.vstack([middles, *pieces.centres])


class _Space:
    """The walls of a foam beside a part, and which of them lie inside it."""

    def __init__(self, solid: TopoDS_Shape, walls: Facets, placement: Placement) -> None:
        self.walls = walls.moved(placement.to_source(walls.points))
        self.surface = triangle_mesh(solid, MESH_SAG, MESH_TURN)
        self.sides = sides_of(self.walls, self.surface, CLEAR)
        self.faces = wall_faces(self.walls, np.flatnonzero(self.sides != OUTSIDE))
        """by number of wall: all that are not outside, and have an area"""
        if not self.faces:
            raise KernelError(
                "there are no walls inside the part: it holds a single cell; give smaller cells"
            )

    def inside(self) -> NDArray[np.bool_]:
        """(f,) which walls are faces wholly inside."""
        made = np.zeros(len(self.walls), np.bool_)
        made[list(self.faces)] = True
        return made & (self.sides == INSIDE)

    def parting(self, cells: CellWalls) -> list[TopoDS_Face]:
        """The faces that are not between two of the given cells."""
        uses = np.bincount(cells.walls, minlength=len(self.walls))
        return [face for wall, face in self.faces.items() if uses[wall] < 2]

    def rim(self, cells: CellWalls) -> _Rim:
        """The faces around the given cells."""
        uses = np.bincount(cells.walls, minlength=len(self.walls))
        alone = uses[cells.walls] == 1
        rim = _Rim(TopTools_IndexedMapOfShape(), cells.turned[alone].tolist())
        for wall in cells.walls[alone].tolist():
            rim.faces.Add(self.faces[wall])
        return rim

    def solids(self, cells: CellWalls) -> Iterator[TopoDS_Solid]:
        """The given cells, built of their walls."""
        for begin, end in pairwise(cells.starts.tolist()):
            turned = zip(cells.walls[begin:end].tolist(), cells.turned[begin:end], strict=True)
            yield solid_within(
                self.faces[wall].Reversed() if back else self.faces[wall] for wall, back in turned
            )


class _Rim(NamedTuple):
    """The faces around some cells."""

    faces: TopTools_IndexedMapOfShape
    turned: list[bool]
    """by a face's number from 0: whether its normal points into the cells"""

    def holds(self, piece: TopoDS_Shape) -> bool:
        """Whether a piece that OCCT made is made of these cells."""
        for face in subshapes(piece, FACE):
            number = self.faces.FindIndex(face)
            if number:
                return bool((face.Orientation() == TopAbs_REVERSED) == self.turned[number - 1])
        return False


class _Pieces(NamedTuple):
    """What a part is split into."""

    solids: list[TopoDS_Shape]
    volumes: list[float]
    centres: list[Floats]

    def miss(self, whole: float) -> float:
        """How far off a volume, mm³, the sum of theirs is."""
        return abs(sum(self.volumes) - whole)

    def are_sound(self) -> bool:
        """Whether OCCT finds no fault in them."""
        return bool(BRepCheck_Analyzer(compound(self.solids)).IsValid())


def _pieces(solid: TopoDS_Shape, tool: TopoDS_Shape, rim: _Rim) -> _Pieces:
    """The pieces of a solid split by a tool, but for those of the cells that have been built."""
    pieces = subshapes(split([solid], [tool]), SOLID)
    solids = [piece for piece in pieces if not rim.holds(piece)]
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
        above_zero("skin", skin)
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
