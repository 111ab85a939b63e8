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
from v3dcad.geometry.mesh.mending import near_welded, without_doubles, without_inner_sheets
from v3dcad.model import Floats, Ints, Mesh
from v3dcad.words import counted

FLAT = 1e-12
"""Share of the cube over a mesh's diagonal: what encloses less has no inside."""


def checked_mesh(mesh: Mesh, *, repair: bool = False) -> tuple[Mesh, list[str]]:
    """The mesh as the closed, outward surface of a solid, and what had to be done for it.

    Exactly equal vertices are welded, and near ones at open edges; two triangles that lie on each
    other back to back, as where bodies share a face, both go. Triangles are made to wind alike,
    inverted bodies turned, overlapping bodies united. With `repair` more corners are welded, fins
    and walls inside dropped, and all holes closed. One finding (a sentence) for each change that
    may matter. `GeometryError`, with counts and positions, where the mesh has no triangle, a vertex
    that is not finite, a one-sided surface, encloses nothing, or, without `repair`, is open.
    """
    findings: list[str] = []
    vertices, triangles = _welded(mesh, findings)
    triangles = without_doubles(vertices, triangles, findings)
    triangles = near_welded(vertices, triangles, findings, repair=repair)
    if repair:
        triangles = without_inner_sheets(vertices, triangles, findings)
    else:
        _refuse_open(vertices, triangles)
    triangles, turned = wound_alike(triangles)
    if turned:
        findings.append(f"turned {counted(turned, 'triangle')} that wound against the neighbours")
    rims = rims_of(triangles)
    if rims and not repair:
        raise GeometryError(
            f"triangles at {counted(sum(map(len, rims)), 'edge')} of the mesh do not wind alike, "
            f"{_where(vertices[rims[0]])}: let --repair close it"
        )
    if rims:
        patches = np.vstack([patch(vertices, rim) for rim in rims])
        triangles = np.vstack([triangles, patches])
        findings.append(
            f"closed {counted(len(rims), 'hole')} with {_area(vertices, patches):.4g} mm² "
            "of triangles"
        )
    triangles = _turned_outward(vertices, triangles, findings)
    _refuse_flat(vertices, triangles)
    return _united(Mesh(vertices, triangles), findings), findings


def _welded(mesh: Mesh, findings: list[str]) -> tuple[Floats, Ints]:
    """Vertices and triangles without equal vertices and collapsed triangles."""
    if not len(mesh.triangles):
        raise GeometryError("the mesh has no triangle")
    lost = ~np.isfinite(mesh.vertices).all(axis=1)
    if lost.any():
        raise GeometryError(
            f"the mesh has {counted(int(lost.sum()), 'vertex')} with coordinates that are not "
            f"finite numbers (the first is vertex {int(np.argmax(lost))})"
        )
    if mesh.triangles.min() < 0 or mesh.triangles.max() >= len(mesh.vertices):
        raise GeometryError(f"a triangle refers to a vertex beyond the mesh's {len(mesh.vertices)}")
    vertices, number = np.unique(mesh.vertices[mesh.triangles.ravel()], axis=0, return_inverse=True)
    triangles = number.reshape(-1, 3).astype(np.int64)
    triangles = triangles[np.all(triangles != np.roll(triangles, 1, axis=1), axis=1)]
    if len(triangles) < len(mesh.triangles):
        count = len(mesh.triangles) - len(triangles)
        findings.append(f"dropped {counted(count, 'triangle')} without area")
    return vertices, triangles


def _refuse_open(vertices: Floats, triangles: Ints) -> None:
    """Raise `GeometryError` for edges that an odd number of triangles share."""
    sides = sides_of(triangles)
    uses = sides.uses()
    boundary, odd = uses == 1, (uses > 2) & (uses % 2 == 1)
    if not boundary.any() and not odd.any():
        return
    faulty = odd if odd.any() else boundary
    middles = vertices[sides.ends[sides.starts[:-1][faulty]]].mean(axis=1)
    raise GeometryError(
        f"the mesh {'is not closed' if odd.any() else 'is open'}: "
        f"{counted(int(boundary.sum()), 'boundary edge')} and "
        f"{counted(int((uses > 2).sum()), 'non-manifold edge')}, {_where(middles)}: close it, or "
        "let --repair patch the holes"
    )


def _refuse_flat(vertices: Floats, triangles: Ints) -> None:
    """Raise `GeometryError` for a surface without anything inside."""
    size = np.linalg.norm(np.ptp(vertices[triangles.ravel()], axis=0)) if len(triangles) else 0.0
    volumes = signed_volumes(vertices, triangles, bodies_of(triangles))
    if np.abs(volumes).max(initial=0.0) <= FLAT * size**3:
        raise GeometryError("the mesh encloses nothing: it is a sheet without thickness")


def _where(points: Floats) -> str:
    """The first of points (k, 3), mm, in words."""
    shown = ", ".join(f"({x:.4g}, {y:.4g}, {z:.4g})" for x, y, z in points[:3])
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
