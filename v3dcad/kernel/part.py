"""A part made of B-rep solids."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.GeomAbs import GeomAbs_Plane
from OCP.ShapeFix import ShapeFix_Shape
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS, TopoDS_Shape
from OCP.TopTools import TopTools_IndexedMapOfShape

from v3dcad.arguments import numbers, place
from v3dcad.errors import KernelError, SettingError
from v3dcad.geometry.mesh.bodies import overlap_findings
from v3dcad.geometry.section_union import united
from v3dcad.geometry.surface.mesh import SurfaceMesh
from v3dcad.geometry.surface.section import CHORD_TOLERANCE
from v3dcad.geometry.surface.wall_ends import exact_ends
from v3dcad.kernel.mesh import surface_mesh, triangle_mesh
from v3dcad.kernel.orientation import upright
from v3dcad.kernel.section import section_solids
from v3dcad.kernel.sewing import sewn
from v3dcad.kernel.shapes import (
    EDGE,
    FACE,
    SOLID,
    bounds,
    compound,
    location,
    scaled,
    subshapes,
    volume,
)
from v3dcad.kernel.slivers import without_slivers
from v3dcad.kernel.union import one_body, overlaps, solids_meet
from v3dcad.model import Brep, Floats, Layer, Mesh, Placement, Section, part_words
from v3dcad.words import counted, point_words

MESH_SAG = 0.05
"""Largest distance of `SolidPart.mesh()` from the true surface, mm."""
MESH_TURN = 0.3
"""Largest angle between two neighbouring triangles of `SolidPart.mesh()`, radians."""
TOLD_GAP = 0.01
"""mm: smaller gaps at edges, as most CAD programs leave them, are seen in no print."""


UNMOVED = Placement.none()


@lru_cache(maxsize=4)
def prepared(shape: TopoDS_Shape) -> SurfaceMesh:
    """The mesh that sections of a shape are made from, made once for each of the last shapes."""
    return surface_mesh(shape)


@dataclass(frozen=True, eq=False, slots=True)
class SolidPart:
    """Solids of a B-rep, all filled alike."""

    name: str
    shape: TopoDS_Shape
    """a compound of solids"""
    bounds: Floats
    findings: tuple[str, ...] = ()
    """what the user should know of how the file was read"""
    stored: Brep | None = None
    """the very bytes that the solids were read from, where they were"""
    placement: Placement = UNMOVED
    """how it came to where it is from where its source lies"""
    overlap: float = 0.0
    """mm³, by how much the sum of the solids' volumes exceeds that of their union"""
    library: str = ""
    """the CAD library that its shapes are given back to: "build123d", "cadquery" or none"""

    def __repr__(self) -> str:
        return f"<SolidPart {part_words(self)}>"

    def contents(self) -> dict[str, str]:
        """What it is made of, as lines to show."""
        return {
            "solids": f"{sum(1 for _ in subshapes(self.shape, SOLID))}",
            "faces": f"{sum(1 for _ in subshapes(self.shape, FACE))}",
            "volume": f"{volume(self.shape) - self.overlap:.6g} mm³",
        }

    def normal(self, face: int) -> Floats:
        """(3,) outward unit normal of a plane face, by its number from 0."""
        faces = list(subshapes(self.shape, FACE))
        chosen = faces[place("up", face, len(faces), "part's faces")]
        surface = BRepAdaptor_Surface(TopoDS.Face_s(chosen))
        if surface.GetType() != GeomAbs_Plane:
            raise SettingError("up", f"--up {face}: this face is not plane; name another")
        frame = surface.Plane().Position()
        axis = np.cross(frame.XDirection().Coord(), frame.YDirection().Coord())
        return -axis if chosen.Orientation() == TopAbs_REVERSED else axis

    def face_mesh(self, faces: tuple[int, ...]) -> Mesh:
        """Some faces as triangles, by their numbers from 0, within `MESH_SAG` of them."""
        count = sum(1 for _ in subshapes(self.shape, FACE))
        chosen = tuple(place("face", face, count, "part's faces") for face in faces)
        return triangle_mesh(self.shape, MESH_SAG, MESH_TURN, chosen)

    def placed(self, placement: Placement) -> SolidPart:
        """The same solids, moved; where they are only shifted, their bounds go with them."""
        if placement.is_still():
            return self
        shape = self.shape.Moved(location(placement))
        box = placement.to_bed(self.bounds) if placement.is_shift() else true_bounds(shape)
        moved = self.placement.then(placement)
        return replace(self, shape=shape, bounds=box, placement=moved, stored=None)

    def sections(
        self,
        heights: Floats,
        chord_tolerance: float = CHORD_TOLERANCE,
        executor: Executor | None = None,
    ) -> Sequence[Section]:
        """Sections of the exact surfaces at ascending heights (mm); solids that meet are one."""
        planes = numbers("heights", heights)
        found = section_solids(prepared(self.shape), planes, chord_tolerance, executor)
        return united(list(found), chord_tolerance, solids_meet(self.shape))

    def exact(self, layer: Layer) -> Layer:
        """The layer with the ends of its walls moved onto the true surface."""
        return exact_ends(layer, prepared(self.shape))

    def mesh(self) -> Mesh:
        """The surface as triangles, within `MESH_SAG` of it; solids that meet are one."""
        return triangle_mesh(one_body(self.shape), MESH_SAG, MESH_TURN)


def solid_part(shape: TopoDS_Shape, name: str, where: str, factor: float = 1.0) -> SolidPart:
    """The solids of any shape as a part, healed where OCCT finds faults in them.

    They are made larger by `factor`, about the origin.

    Solids that are inside out are turned; faces that enclose something without being a solid are
    sewn. Findings say what was left out, turned, sewn and healed. `KernelError`, naming `where`, if
    the shape holds no solid, or one that is not closed.
    """
    findings: list[str] = []
    if factor != 1:
        shape = scaled(shape, factor)
    solids = [upright(solid, findings) for solid in subshapes(shape, SOLID)]
    if solids:
        stray = sum(1 for _ in subshapes(shape, FACE, SOLID))
        findings += [f"left out {counted(stray, 'face')} of no solid"] if stray else []
    else:
        solids = sewn(shape, where, findings)
    solid = _healed(compound(solids), findings)
    try:
        solid, box = _bounded(solid, where, findings)
    except KernelError as error:
        raise KernelError(f"{where}: {error.message}") from error
    findings += _gap_findings(solid)
    overlap = _overlap(solid, findings)
    return SolidPart(name, solid, box, tuple(findings), overlap=overlap)


def _healed(solid: TopoDS_Shape, findings: list[str]) -> TopoDS_Shape:
    """The solids as they are where OCCT finds no fault, or else as ShapeFix mends them."""
    if BRepCheck_Analyzer(solid).IsValid():
        return solid
    fix = ShapeFix_Shape(BRepBuilderAPI_Copy(solid).Shape())  # the caller's own stays as it is
    fix.Perform()
    mended = fix.Shape()
    if next(subshapes(mended, SOLID), None) is None:
        mended = solid
    if BRepCheck_Analyzer(mended).IsValid():
        findings.append("OCCT found faults in the shape and healed them")
    else:
        findings.append("OCCT finds faults in the shape that it cannot heal: look at the sections")
    return mended


def _bounded(solid: TopoDS_Shape, where: str, findings: list[str]) -> tuple[TopoDS_Shape, Floats]:
    """The solids and their bounds; without slivers, where these keep them from being meshed."""
    try:
        return solid, true_bounds(solid)
    except KernelError:
        mended = without_slivers(solid, where, findings)
        if mended is solid:
            raise
        return mended, true_bounds(mended)


def _overlap(solid: TopoDS_Shape, findings: list[str]) -> float:
    """By how much, mm³, the sum of the solids' volumes exceeds that of their union."""
    try:
        pairs, excess = overlaps(solid)
    except KernelError:
        findings.append("OCCT cannot tell by how much solids overlap: the volume may be too large")
        return 0.0
    findings += overlap_findings("solids", pairs)
    return excess


def _gap_findings(solid: TopoDS_Shape) -> list[str]:
    """What to report of edges that may lie off their faces, by the tolerance stored with them."""
    edges = TopTools_IndexedMapOfShape()
    TopExp.MapShapes_s(solid, EDGE, edges)
    ids = range(1, edges.Extent() + 1)
    gaps = np.array([BRep_Tool.Tolerance_s(TopoDS.Edge_s(edges(k))) for k in ids])
    loose = int((gaps > TOLD_GAP).sum())
    if not loose:
        return []
    worst = BRepAdaptor_Curve(TopoDS.Edge_s(edges(int(np.argmax(gaps)) + 1)))
    at = worst.Value((worst.FirstParameter() + worst.LastParameter()) / 2)
    return [
        f"{counted(loose, 'edge')} may lie off the faces there by up to {gaps.max():.3g} mm, most "
        f"near {point_words(at.Coord())}: contours step across such gaps, and where they cross "
        "themselves there the loops are cut off"
    ]


def true_bounds(shape: TopoDS_Shape) -> Floats:
    """(2, 3) least and greatest coordinates of solids, mm; z to rounding, as sections have it."""
    box = bounds(shape)
    heights = prepared(shape).nodes[:, 2]
    box[:, 2] = heights.min(), heights.max()
    return box
