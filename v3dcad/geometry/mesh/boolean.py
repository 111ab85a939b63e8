"""Triangle meshes united, subtracted and intersected by manifold3d: watertight, or an error."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from manifold3d import Error, Manifold, Mesh64, OpType

from v3dcad.errors import GeometryError
from v3dcad.model import Mesh

SHORTEST = 1e-4
"""mm; shorter edges are collapsed: float32, as STL and 3MF have it, would tear the mesh there."""


def united(bodies: Sequence[Mesh | Manifold]) -> Mesh:
    """The union of closed meshes. `GeometryError` as `checked_mesh` raises it."""
    return checked_mesh(Manifold.batch_boolean([manifold(body) for body in bodies], OpType.Add))


def subtracted(body: Mesh, tools: Sequence[Mesh], within: Manifold | None = None) -> Mesh:
    """A closed mesh without the closed meshes of the tools, or without what of them is `within`."""
    cut = list(map(manifold, tools))
    if within is not None:
        cut = [Manifold.batch_boolean(cut, OpType.Add) ^ within]
    return checked_mesh(Manifold.batch_boolean([manifold(body), *cut], OpType.Subtract))


def intersected(one: Mesh, other: Mesh) -> Mesh:
    """The intersection of two closed meshes."""
    return checked_mesh(manifold(one) ^ manifold(other))


def manifold(body: Mesh | Manifold) -> Manifold:
    """A closed mesh as manifold3d holds it. `GeometryError` where it is not closed."""
    if isinstance(body, Manifold):
        return body
    # Copies: manifold3d takes no read-only arrays.
    vertices = np.array(body.vertices, np.float64, order="C")
    made = Manifold(Mesh64(vertices, np.array(body.triangles, np.uint64, order="C")))
    if made.status() != Error.NoError:
        raise GeometryError(f"a mesh is not the surface of a solid ({made.status().name})")
    return made


def checked_mesh(body: Manifold) -> Mesh:
    """The mesh of a result. `GeometryError` where it is empty, open or turned inside out."""
    if body.status() != Error.NoError:
        raise GeometryError(f"the meshes could not be united ({body.status().name})")
    found = body.simplify(SHORTEST).to_mesh64()
    mesh = Mesh(
        np.asarray(found.vert_properties)[:, :3].copy(),
        np.asarray(found.tri_verts).astype(np.int64),
    )
    if not len(mesh.triangles) or not is_watertight(mesh) or mesh_volume(mesh) <= 0:
        raise GeometryError("the united mesh is empty or not closed; change a size slightly")
    return mesh


def is_watertight(mesh: Mesh) -> bool:
    """Whether every edge of a mesh belongs to two triangles, once in each direction."""
    ends = mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    there = np.sort(ends @ [len(mesh.vertices), 1])
    back = np.sort(ends[:, ::-1] @ [len(mesh.vertices), 1])
    return bool(np.array_equal(there, back) and (np.diff(there) > 0).all())


def mesh_volume(mesh: Mesh) -> float:
    """Volume of a closed mesh, mm³ (divergence theorem)."""
    corners = mesh.vertices[mesh.triangles] - mesh.vertices.mean(axis=0)
    return float(np.linalg.det(corners).sum()) / 6
