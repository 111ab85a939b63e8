"""Is a triangle mesh the surface of a solid? What can be repaired is repaired and reported."""

from __future__ import annotations

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.mesh.bodies import (
    bodies_of,
    body_bounds,
    containers,
    overlap_findings,
    sides_of,
    signed_volumes,
    wound_alike,
)
from v3dcad.geometry.mesh.holes import patch, rims_of
from v3dcad.geometry.mesh.mending import near_welded, without_odd_edges
from v3dcad.geometry.mesh.section import mesh_edges
from v3dcad.model import Floats, Ints, Mesh

BEYOND = (
    "what is left cannot be repaired here; remesh it where it was made, or in a mesh editor, and "
    "export it again"
)

FLAT = 1e-12
"""Share of the cube over a mesh's diagonal: what encloses less has no inside."""


def checked_mesh(mesh: Mesh, *, repair: bool = False) -> tuple[Mesh, list[str]]:
    """The mesh as the closed, outward surface of a solid, and what had to be done for it.

    Exactly equal vertices are welded, and near ones at open edges; two triangles that lie on each
    other back to back, as where bodies share a face, both go. Triangles are made to wind alike,
    inverted bodies turned, overlapping bodies united; with `repair` holes are closed. One finding
    (a sentence) for each change that may matter. `GeometryError`, with counts and positions, where
    the mesh has no triangle, a vertex that is not finite, holes or edges of an odd number of
    triangles (and `repair` is not given), or encloses nothing.
    """
    findings: list[str] = []
    vertices, triangles = _welded(mesh, findings)
    triangles = near_welded(vertices, triangles, findings)
    if repair:
        triangles = without_odd_edges(triangles, findings)
    _count_uses(vertices, triangles, repair)
    triangles, turned = wound_alike(triangles)
    if turned:
        findings.append(f"turned {turned} triangles that wound against their neighbours")
    rims = rims_of(triangles)
    if rims:
        patches = np.vstack([patch(vertices, rim) for rim in rims])
        triangles = np.vstack([triangles, patches])
        findings.append(
            f"closed {len(rims)} holes with {_area(vertices, patches):.4g} mm² of triangles"
        )
    triangles = _turned_outward(vertices, triangles, findings)
    try:
        mesh_edges(triangles)
    except GeometryError as error:
        raise GeometryError(BEYOND) from error
    _refuse_flat(vertices, triangles)
    return _united(Mesh(vertices, triangles), findings), findings


def _welded(mesh: Mesh, findings: list[str]) -> tuple[Floats, Ints]:
    """Vertices and triangles without equal vertices, collapsed and repeated triangles."""
    if not len(mesh.triangles):
        raise GeometryError("the mesh has no triangle")
    lost = ~np.isfinite(mesh.vertices).all(axis=1)
    if lost.any():
        raise GeometryError(
            f"{int(lost.sum())} vertices of the mesh are not finite numbers "
            f"(the first is vertex {int(np.argmax(lost))})"
        )
    if mesh.triangles.min() < 0 or mesh.triangles.max() >= len(mesh.vertices):
        raise GeometryError(f"a triangle refers to a vertex beyond the mesh's {len(mesh.vertices)}")
    vertices, number = np.unique(mesh.vertices[mesh.triangles.ravel()], axis=0, return_inverse=True)
    triangles = number.reshape(-1, 3).astype(np.int64)
    triangles = triangles[np.all(triangles != np.roll(triangles, 1, axis=1), axis=1)]
    if len(triangles) < len(mesh.triangles):
        count = len(mesh.triangles) - len(triangles)
        findings.append(f"dropped {count} triangles without area")
    return vertices, _once(triangles, findings)


def _once(triangles: Ints, findings: list[str]) -> Ints:
    """Triangles without repeated ones, and without any two that lie on each other back to back."""
    ordered = np.sort(triangles, axis=1)
    _, first, group = np.unique(ordered, axis=0, return_index=True, return_inverse=True)
    if len(first) == len(triangles):
        return triangles
    group = group.ravel()
    turn = (triangles.argmin(axis=1)[:, None] + np.arange(3)) % 3
    begun = np.take_along_axis(triangles, turn, axis=1)
    way = np.where(begun[:, 1] == ordered[:, 1], 1, -1)
    cancels = (np.bincount(group, way) == 0) & (np.bincount(group) == 2)
    if cancels.all():  # both sides of every triangle are there: one surface all the same
        cancels[:] = False
    repeated = len(triangles) - len(first) - int(cancels.sum())
    if repeated:
        findings.append(f"dropped {repeated} repeated triangles")
    return triangles[np.sort(first[~cancels])]


def _count_uses(vertices: Floats, triangles: Ints, repair: bool) -> None:
    """Refuse edges shared by an odd number, and holes, unless they are to be repaired."""
    sides = sides_of(triangles)
    uses = sides.uses()
    boundary, odd = uses == 1, (uses > 2) & (uses % 2 == 1)
    if not odd.any() and (repair or not boundary.any()):
        return
    faulty = odd if odd.any() else boundary
    raise GeometryError(
        f"the mesh {'is not closed' if odd.any() else 'is open'}: {int(boundary.sum())} boundary "
        f"edges and {int((uses > 2).sum())} non-manifold edges, "
        f"{_where(vertices, sides.ends[sides.starts[:-1][faulty]])}: "
        + (BEYOND if repair else "close it, or let --repair patch the holes")
    )


def _refuse_flat(vertices: Floats, triangles: Ints) -> None:
    """Raise `GeometryError` for a surface without anything inside."""
    low, high = vertices[triangles.ravel()].min(axis=0), vertices[triangles.ravel()].max(axis=0)
    volumes = signed_volumes(vertices, triangles, bodies_of(triangles))
    if np.abs(volumes).max(initial=0.0) <= FLAT * np.linalg.norm(high - low) ** 3:
        raise GeometryError("the mesh encloses nothing: it is a sheet without thickness")


def _where(vertices: Floats, edges: Ints) -> str:
    """The positions of the first edges, in words."""
    middles = vertices[edges].mean(axis=1)
    shown = ", ".join(f"({x:.4g}, {y:.4g}, {z:.4g})" for x, y, z in middles[:3])
    return f"the first at {shown}"


def _area(vertices: Floats, triangles: Ints) -> float:
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def _turned_outward(vertices: Floats, triangles: Ints, findings: list[str]) -> Ints:
    """Bodies that lie in no other turned to face outward, together with the bodies inside them."""
    body = bodies_of(triangles)
    inverted = signed_volumes(vertices, triangles, body) < 0
    if not inverted.any():
        return triangles
    within = containers(vertices, triangles, body)
    outermost = ~within.any(axis=0)
    wrong = inverted & outermost
    wrong |= within[wrong].any(axis=0)
    if wrong.any():
        findings.append(f"turned {int(wrong.sum())} inverted bodies inside out")
    return np.where(wrong[body][:, None], triangles[:, ::-1], triangles)


def _united(mesh: Mesh, findings: list[str]) -> Mesh:
    """The mesh with overlapping bodies united by manifold3d; itself where none overlap."""
    vertices, triangles = mesh.vertices, mesh.triangles
    body = bodies_of(triangles)
    volumes = signed_volumes(vertices, triangles, body)
    solid = np.flatnonzero(volumes > 0)
    low, high = body_bounds(vertices, triangles, body)
    low, high = low[solid], high[solid]
    close = np.all((low[:, None] < high) & (high[:, None] > low), axis=2)
    if np.count_nonzero(close) == len(solid):
        return mesh
    # A cavity belongs to the smallest solid that holds it.
    from manifold3d import Manifold, Mesh64, OpType

    within = containers(vertices, triangles, body)
    owner = np.arange(len(volumes))
    for cavity in np.flatnonzero(volumes <= 0):
        holders = solid[within[solid, cavity]]
        if len(holders):
            owner[cavity] = holders[np.argmin(volumes[holders])]
    pieces = []
    for number in solid:
        nodes, member = np.unique(triangles[owner[body] == number], return_inverse=True)
        piece = Manifold(Mesh64(vertices[nodes], member.reshape(-1, 3).astype(np.uint64)))
        if piece.is_empty():
            return mesh
        pieces.append(piece)
    union = Manifold.batch_boolean(pieces, OpType.Add)
    apart = sum(piece.volume() for piece in pieces)
    if abs(union.volume() - apart) <= 1e-9 * apart:
        return mesh
    pairs = [
        (i, j, (pieces[i] ^ pieces[j]).volume()) for i, j in np.argwhere(np.triu(close, 1)).tolist()
    ]
    findings += overlap_findings("bodies", [pair for pair in pairs if pair[2] > 1e-9 * apart])
    result = union.to_mesh64()
    return Mesh(
        np.array(result.vert_properties[:, :3], np.float64),
        np.array(result.tri_verts, np.int64),
    )
