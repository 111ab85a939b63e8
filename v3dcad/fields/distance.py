"""How far places are from triangles."""

from __future__ import annotations

import numpy as np

from v3dcad.model import Floats, Mesh
from v3dcad.settings import Field


def distance_to(surface: Mesh) -> Field:
    """The distance from triangles, mm."""
    from v3dcad.geometry.mesh.distance import distances, triangle_tree

    tree = triangle_tree(surface.vertices[surface.triangles])

    def field(x: Floats, y: Floats, z: Floats) -> Floats:
        return distances(tree, np.stack([x, y, z], axis=-1, dtype=np.float64))

    return field
