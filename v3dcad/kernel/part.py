"""A part made of B-rep solids."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Shape

from v3dcad.errors import KernelError
from v3dcad.kernel.section import section_solids
from v3dcad.kernel.shapes import FACE, SOLID, bounds, compound, location, subshapes
from v3dcad.model import Floats, Mesh, Placement, Section

TESSELLATION = 0.05
"""Largest distance of `SolidPart.mesh()` from the true surface, mm."""


@dataclass(frozen=True, eq=False, slots=True)
class SolidPart:
    """Solids of a B-rep, all filled alike."""

    name: str
    shape: TopoDS_Shape
    """a compound of solids"""
    bounds: Floats
    findings: tuple[str, ...] = ()
    """what the user should know of how the file was read"""

    def contents(self) -> dict[str, str]:
        """What it is made of, as lines to show."""
        properties = GProp_GProps()
        BRepGProp.VolumeProperties_s(self.shape, properties)
        return {
            "solids": f"{sum(1 for _ in subshapes(self.shape, SOLID))}",
            "faces": f"{sum(1 for _ in subshapes(self.shape, FACE))}",
            "volume": f"{properties.Mass():.6g} mm³",
        }

    def placed(self, placement: Placement) -> SolidPart:
        """The same solids, moved."""
        shape = self.shape.Moved(location(placement))
        return SolidPart(self.name, shape, bounds(shape), self.findings)

    def sections(self, heights: Floats) -> Sequence[Section]:
        """Sections of the exact surfaces at ascending heights (mm)."""
        return list(section_solids(self.shape, heights))

    def mesh(self) -> Mesh:
        """The surface as triangles, within `TESSELLATION` of it."""
        BRepMesh_IncrementalMesh(self.shape, TESSELLATION, False, 0.3, False)
        corners: list[Floats] = []
        for face in map(TopoDS.Face_s, subshapes(self.shape, FACE)):
            place = TopLoc_Location()
            facets = BRep_Tool.Triangulation_s(face, place)
            if facets is None:
                continue
            motion = place.Transformation()
            nodes = [facets.Node(i).Transformed(motion) for i in range(1, facets.NbNodes() + 1)]
            points = np.array([(p.X(), p.Y(), p.Z()) for p in nodes])
            ids = np.array([facets.Triangle(i).Get() for i in range(1, facets.NbTriangles() + 1)])
            if face.Orientation() == TopAbs_REVERSED:
                ids = ids[:, ::-1]
            corners.append(points[ids - 1])
        vertices, triangles = np.unique(
            np.concatenate(corners).reshape(-1, 3), axis=0, return_inverse=True
        )
        return Mesh(vertices, triangles.reshape(-1, 3))


def solid_part(shape: TopoDS_Shape, name: str, where: str) -> SolidPart:
    """The solids of any shape as a part; `KernelError` naming `where` if it holds none."""
    solids = list(subshapes(shape, SOLID))
    if not solids:
        raise KernelError(f"{where}: holds no solid, only a solid can be filled; export a solid")
    stray = sum(1 for _ in subshapes(shape, FACE, SOLID))
    findings = (f"{stray} faces belong to no solid and were left out",) if stray else ()
    solid = compound(solids)
    return SolidPart(name, solid, bounds(solid), findings)
