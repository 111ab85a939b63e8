"""How far places are from triangles."""

from __future__ import annotations

import numpy as np

from v3dcad.model import Floats, Mesh
from v3dcad.settings import Field

SAMPLES = 300
"""The surface is sampled by points at most a diagonal / SAMPLES apart: so far may a distance be off
right at the surface, and less by its square farther away."""


def distance_to(surface: Mesh) -> Field:
    """The distance from triangles, mm."""
    from scipy.spatial import KDTree

    corners = surface.vertices[surface.triangles]
    diagonal = float(np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0)))
    tree = KDTree(_samples(corners, diagonal / SAMPLES))

    def field(x: Floats, y: Floats, z: Floats) -> Floats:
        return np.asarray(tree.query(np.stack([x, y, z], axis=-1))[0])

    return field


def _samples(corners: Floats, apart: float) -> Floats:
    """Points (n, 3) on triangles (t, 3, 3), none of theirs farther than `apart` from one."""
    sides = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
    parts = np.maximum(np.ceil(sides / max(apart, 1e-300)).astype(np.int64), 1)
    found = []
    for count in np.unique(parts).tolist():
        i, j = np.meshgrid(np.arange(count + 1), np.arange(count + 1), indexing="ij")
        within = i + j <= count
        weights = np.stack([i, j, count - i - j], axis=-1)[within] / count
        found.append((weights @ corners[parts == count]).reshape(-1, 3))
    return np.concatenate(found)
