"""Faces by themselves as triangles: of no solid, and not closed."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Shape

from v3dcad.kernel.shapes import FACE, subshapes
from v3dcad.model import Mesh


def faces_mesh(shapes: Iterable[TopoDS_Shape], sag: float, angle: float) -> Mesh:
    """All faces of shapes as triangles, within `sag` (mm) of them; none if they have no face.

    `angle` (radians) is the largest turn between neighbours.
    """
    vertices, triangles, count = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], 0
    for shape in shapes:
        # The caller's shape keeps its own triangulation.
        copy = BRepBuilderAPI_Copy(shape, True, False).Shape()
        BRepMesh_IncrementalMesh(copy, sag, False, angle, False)
        for face in map(TopoDS.Face_s, subshapes(copy, FACE)):
            place = TopLoc_Location()
            facets = BRep_Tool.Triangulation_s(face, place)
            if facets is None:  # so thin that it has no area
                continue
            move = place.Transformation()
            nodes = range(1, facets.NbNodes() + 1)
            vertices.append(np.array([facets.Node(k).Transformed(move).Coord() for k in nodes]))
            rows = range(1, facets.NbTriangles() + 1)
            triangles.append(np.array([facets.Triangle(k).Get() for k in rows]) - 1 + count)
            count += len(nodes)
    return Mesh(np.concatenate(vertices), np.concatenate(triangles))
