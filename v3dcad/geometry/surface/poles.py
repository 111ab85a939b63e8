"""Poles: points of a face where one of its parameters has no effect.

A triangulation gives a pole any value of that parameter, so that its mesh edges would wind
around the pole. Here they become meridians: an edge that ends in the pole keeps, at the pole, the
parameter of its other end. A triangle with its corner in the pole is then a quadrilateral with
one side shrunk to the pole, cut into two.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from v3dcad.geometry.surface.mesh import SurfaceMesh
from v3dcad.geometry.surface.surfaces import surface_at


def with_meridians(mesh: SurfaceMesh, poles: NDArray[np.bool_]) -> SurfaceMesh:
    """The mesh with meridians at those corners of its triangles (t, 3) that are poles."""
    if not poles.any():
        return mesh
    triangles, corners, sides = mesh.triangles.copy(), mesh.corners.copy(), mesh.sides.copy()
    spans = mesh.edge_spans.copy()
    new_triangles: list[Any] = []
    new_corners: list[Any] = []
    new_sides: list[Any] = []
    new_nodes: list[Any] = []
    new_spans: list[Any] = []
    owner: list[int] = []
    new_faces: list[int] = []
    for triangle, pole in np.argwhere(poles).tolist():
        after, before = (pole + 1) % 3, (pole + 2) % 3
        at = mesh.corners[triangle]
        tangents = surface_at(mesh.coefficients, mesh.surfaces[mesh.faces[triangle]], *at[pole])[1:]
        free = int(np.argmin(np.linalg.norm(tangents, axis=1)))
        out, back = at[pole].copy(), at[pole].copy()
        out[free], back[free] = at[after, free], at[before, free]
        for edge, there in ((sides[triangle, pole], out), (sides[triangle, before], back)):
            if edge >= 0 and mesh.edge_curves[edge] < 0:
                end = 0 if mesh.edge_nodes[edge, 0] == triangles[triangle, pole] else 1
                spans[edge, 2 * end : 2 * end + 2] = there
        corners[triangle, pole] = out
        if poles[triangle, after] or poles[triangle, before]:
            corners[triangle, pole] = back if poles[triangle, after] else out
            continue
        # (pole, after, before) and, beyond the diagonal, (pole, before, pole).
        diagonal = len(mesh.edge_nodes) + len(new_nodes)
        new_nodes.append([triangles[triangle, pole], triangles[triangle, before]])
        new_spans.append([*out, *at[before]])
        new_faces.append(mesh.faces[triangle])
        new_triangles.append(triangles[triangle, [pole, before, pole]])
        new_corners.append([out, at[before], back])
        new_sides.append([diagonal, sides[triangle, before], -1])
        owner.append(triangle)
        sides[triangle, before] = diagonal
    count = len(new_nodes)
    if not count:
        return replace(mesh, corners=corners, edge_spans=spans)
    order = np.argsort(np.concatenate([np.arange(len(triangles)), owner]), kind="stable")
    return replace(
        mesh,
        triangles=np.concatenate([triangles, new_triangles])[order],
        corners=np.concatenate([corners, new_corners])[order],
        faces=np.concatenate([mesh.faces, new_faces])[order],
        sides=np.concatenate([sides, new_sides])[order],
        edge_nodes=np.concatenate([mesh.edge_nodes, new_nodes]),
        edge_faces=np.concatenate([mesh.edge_faces, new_faces]),
        edge_curves=np.concatenate([mesh.edge_curves, np.full(count, -1)]),
        edge_spans=np.concatenate([spans, new_spans]),
    )
