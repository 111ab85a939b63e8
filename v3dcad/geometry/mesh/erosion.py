"""A closed mesh less all that lies near its surface, with mitred edges as B-rep offsets have them.

What is taken away is a union of convex pieces: a prism over each triangle, over each edge that is
flat or hollow what lies between two prisms, with a mitre if it is hollow, and at the ends of hollow
edges what lies between mitres. Pieces overlap a little, so that rounding leaves nothing between.
(manifold3d's own difference with a ball takes as long, and thins the faces: its balls are
polyhedra.)
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from manifold3d import Manifold, OpType

from v3dcad.arguments import above_zero
from v3dcad.errors import GeometryError
from v3dcad.geometry.mesh.bodies import sides_of
from v3dcad.geometry.mesh.boolean import manifold
from v3dcad.model import Floats, Ints, Mesh

OUTWARD = 0.1
"""How far pieces reach out of the body, of the depth."""

OVERLAP = 1e-3
"""How far those of edges reach over their neighbours, of the depth; what is left with shorter edges
comes of rounding."""

ROUGHNESS = 0.01
"""How far the core may lie off, of the depth: triangles that matter less are joined before."""

FLAT = 1e-4
"""Sine of the least angle at which an edge is not flat."""

SHARPEST = 2.0
"""How far a mitre reaches at most, of the depth: for edges hollow by up to 120°."""


def eroded(body: Mesh, depth: float) -> Manifold:
    """What of a closed mesh lies `depth` mm and more from its surface.

    Edges where the surface is hollow are mitred. `GeometryError` where nothing is left.
    """
    above_zero("skin", depth)
    whole = manifold(body).simplify(depth * ROUGHNESS)
    found = whole.to_mesh64()
    points = np.array(found.vert_properties[:, :3], np.float64)
    # Counted in depths.
    pieces = _pieces(points / depth, np.array(found.tri_verts, np.int64))
    hulls = [Manifold.hull_points(piece * depth) for piece in pieces]
    core = Manifold.batch_boolean([whole, *hulls], OpType.Subtract).simplify(depth * OVERLAP)
    if core.volume() <= 0:
        raise GeometryError(f"a skin of {depth:g} mm leaves no room for cells; give a thinner one")
    return core


class _Edges(NamedTuple):
    """Edges of a closed mesh that are flat or hollow, each between two of its triangles."""

    ends: Ints
    """(e, 2) nodes, in the direction in which the first triangle passes them"""
    triangles: Ints
    """(e, 2)"""
    mitres: Floats
    """(e, 3) where the surface is hollow: to the edge of the core; 0 elsewhere"""


def _pieces(points: Floats, triangles: Ints) -> Iterator[Floats]:
    """The corners (k, 3) of the convex pieces that cover a surface to a depth of 1."""
    corners = points[triangles]
    normals = _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    out = OUTWARD * normals
    yield from np.concatenate([corners + out[:, None], corners - normals[:, None]], axis=1)
    edges = _edges(points, triangles, normals)
    ends = points[edges.ends]
    along = _unit(ends[:, 1] - ends[:, 0])
    ends = ends + OVERLAP * along[:, None] * [[-1], [1]]
    shifts = [edges.mitres]
    for side, way in zip(edges.triangles.T, (1, -1), strict=True):
        inward = way * OVERLAP * np.cross(normals[side], along)
        shifts += [out[side] + inward, inward - normals[side]]
    yield from (ends[:, :, None] + np.stack(shifts, axis=1)[:, None]).reshape(-1, 10, 3)
    yield from _between_mitres(points, triangles, normals, edges)


def _edges(points: Floats, triangles: Ints, normals: Floats) -> _Edges:
    sides = sides_of(triangles)
    begin = sides.starts[:-1]
    pair = np.column_stack([sides.triangle[begin], sides.triangle[begin + 1]])
    # The corner of the other triangle that is not on the edge.
    apex = triangles[pair[:, 1]].sum(axis=1) - sides.ends[begin].sum(axis=1)
    rise = ((points[apex] - points[sides.ends[begin, 0]]) * normals[pair[:, 0]]).sum(axis=1)
    ends = sides.ends[begin]
    rise /= np.linalg.norm(points[apex] - points[ends[:, 0]], axis=1)
    kept = rise > -FLAT
    ends, pair, rise = ends[kept], pair[kept], rise[kept]
    middle = normals[pair].sum(axis=1)
    half = np.linalg.norm(middle, axis=1) / 2
    mitres = -_unit(middle) / np.maximum(half, 1 / SHARPEST)[:, None]
    return _Edges(ends, pair, np.where(rise[:, None] > FLAT, mitres, 0.0))


def _between_mitres(
    points: Floats, triangles: Ints, normals: Floats, edges: _Edges
) -> Iterator[Floats]:
    """What lies between the mitres of two and more hollow edges that end in a node."""
    hollow = np.flatnonzero(edges.mitres.any(axis=1))
    node, edge = edges.ends[hollow].ravel(), np.repeat(hollow, 2)
    order = np.argsort(node, kind="stable")
    starts = np.searchsorted(node[order], np.arange(len(points) + 1))
    corner = np.argsort(triangles.ravel(), kind="stable")
    begins = np.searchsorted(triangles.ravel()[corner], np.arange(len(points) + 1))
    for at in np.flatnonzero(np.diff(starts) > 1).tolist():
        mitres = edges.mitres[edge[order[starts[at] : starts[at + 1]]]]
        planes = normals[corner[begins[at] : begins[at + 1]] // 3]
        tip = np.linalg.lstsq(planes, -np.ones(len(planes)), rcond=0.1)[0]
        tip *= min(1.0, SHARPEST / float(np.linalg.norm(tip)))
        yield points[at] + np.vstack([np.zeros(3), -planes, mitres, tip])


def _unit(vectors: Floats) -> Floats:
    """Vectors (k, 3) with a length of 1; 0 stays 0."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.where(lengths > 0, lengths, 1.0))
