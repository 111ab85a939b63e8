"""The lines by which a part's surface is known: sharp edges, and where it turns from the eye."""

from __future__ import annotations

import numpy as np

from v3dcad.model import Floats, Mesh
from v3dcad.view.perspective import DISTANCE, Eye

SHARP = np.radians(35)
"""Triangles that meet at a larger angle meet in an edge that one sees."""


def outline(mesh: Mesh, eye: Eye) -> Floats:
    """(m, 2, 3) mm: the edges of a surface that are sharp, or lie on its silhouette."""
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    place = eye.middle + DISTANCE * eye.size * eye.towards()
    facing = ((place - corners[:, 0]) * normals).sum(axis=1) > 0
    pairs = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    owners = np.repeat(np.arange(len(corners)), 3)
    order = np.lexsort(pairs.T)
    pairs, owners = pairs[order], owners[order]
    shared = (pairs[1:] == pairs[:-1]).all(axis=1)
    one, other, pairs = owners[1:][shared], owners[:-1][shared], pairs[1:][shared]
    sharp = (normals[one] * normals[other]).sum(axis=1) < np.cos(SHARP)
    return np.asarray(mesh.vertices[pairs[sharp | (facing[one] != facing[other])]])
