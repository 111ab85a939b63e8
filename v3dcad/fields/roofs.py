"""Cells under roofs that are so narrow that skins need not span far.

Cells of a random foam differ so much that the widest one of a section is more than twice as wide as
most. So under roofs sites stand in a hexagonal pattern, all in the plane where the skin will rest.
A section through sites of one plane is their own Voronoi diagram, here equal hexagons. From side to
side they are one roof size wide; from corner to corner 1.15, less a wall of two beads.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import shapely

from v3dcad.fields.distance import distance_to
from v3dcad.model import Floats, Mesh

FLAT = 25.0
"""Degrees to the horizontal: on steeper faces perimeters carry each other, and there is no skin."""

REST = 1.0
"""mm under a roof: about where a skin of four layers of 0.2 mm rests on cells."""

ROUNDING = 1e-6
"""mm: places that are less far outside a triangle than this lie in it."""

AREA = 3**0.5 / 2
"""Of a hexagon that is 1 wide from side to side."""

COSINE, SINE, SHIFT = 112 / 113, 15 / 113, np.array([0.38, 0.17])
"""The pattern is turned by 7.6° and shifted a little, so that its walls do not lie along the faces
of boxes: OCCT cannot cut those well. The numbers are the same to the last bit on every machine."""

WIDEST, WALL = 1.9, 0.8
"""A skin spans at most so many sizes of cells of one size, less a wall of two usual beads, mm."""

Sizes = Callable[[Floats], Floats]
"""Cell sizes (n,), mm, at places (n, 3), mm."""


def widest(cell_size: float) -> float:
    """How far a skin spans over cells of one size at most, mm."""
    return WIDEST * cell_size - WALL


@dataclass(frozen=True, eq=False, slots=True)
class Roofs:
    """The faces of a part that look up and are flat enough for a skin, and what a skin may span."""

    surface: Mesh
    """those triangles, at least one"""
    size: float
    """mm"""

    @classmethod
    def of(cls, surface: Mesh, size: float) -> Roofs | None:
        """Those of a part with a surface, if it has any; skins are to span `size` mm at most.

        What is narrower than that, seen from above, needs no cells to rest on.
        """
        normals = _normals(surface.vertices[surface.triangles])
        upward = normals[:, 2] > np.cos(np.radians(FLAT)) * np.linalg.norm(normals, axis=1)
        triangles = surface.triangles[upward]
        flat = shapely.polygons(surface.vertices[triangles][..., :2])
        seen = shapely.get_parts(shapely.union_all(flat))
        wide = seen[~shapely.is_empty(shapely.buffer(seen, -size / 2))]
        if not len(wide):
            return None
        kept, _ = shapely.STRtree(wide).query(shapely.centroid(flat), "within")
        return cls(Mesh(surface.vertices, triangles[np.sort(kept)]), size)

    def finer(self, sizes: Sizes, slope: float, stretch: float) -> Sizes:
        """Sizes that are at most those of the pattern's hexagons, and away from roofs grow by
        `slope` mm a mm, upward 1 / `stretch` of that, up to those that are given.
        """
        squeezed = np.array([1, 1, 1 / stretch])
        away = distance_to(Mesh(self.surface.vertices * squeezed, self.surface.triangles))
        least = np.sqrt(AREA) * self.size

        def field(places: Floats) -> Floats:
            grown = least + slope * away(*np.ascontiguousarray((places * squeezed).T))
            return np.asarray(np.minimum(sizes(places), grown))

        return field

    def sites(self) -> Floats:
        """Sites (n, 3), mm, in a hexagonal pattern seen from above, `REST` under the roofs.

        The pattern is the same for all roofs, and goes on for a hexagon beyond each. Sites straight
        under a roof come first.
        """
        corners = self.surface.vertices[self.surface.triangles]
        nodes = self._nodes(corners[..., :2])
        flat = shapely.polygons(corners[..., :2])
        node, of = shapely.STRtree(flat).query(shapely.points(nodes), "dwithin", self.size)
        ways = shapely.shortest_line(flat[of], shapely.points(nodes[node]))
        nearest = shapely.get_coordinates(ways)[::2]
        normals, corner = _normals(corners[of]), corners[of, 0]
        rise = (normals[:, :2] * (nearest - corner[:, :2])).sum(axis=1) / normals[:, 2]
        height = corner[:, 2] - rise - REST
        outside = np.rint(shapely.length(ways) / ROUNDING)
        return np.column_stack([nodes[node], height])[np.lexsort((-height, node, outside))]

    def _nodes(self, flat: Floats) -> Floats:
        """Points (n, 2) of the pattern in and around the box of some points (…, 2)."""
        pitch = self.size * np.array([1, AREA])
        turned = _turned(flat.reshape(-1, 2), -SINE) / pitch - SHIFT
        around = self.size / pitch
        low, high = np.floor(turned.min(axis=0) - around), np.ceil(turned.max(axis=0) + around)
        i, j = np.meshgrid(np.arange(low[0] - 1, high[0] + 1), np.arange(low[1], high[1] + 1))
        nodes = np.stack([i + j % 2 / 2, j], axis=-1).reshape(-1, 2)
        return _turned((nodes + SHIFT) * pitch, SINE)


def _normals(corners: Floats) -> Floats:
    """(t, 3) normals, not of unit length, of triangles by their corners (t, 3, 3)."""
    a, b, c = np.moveaxis(corners, 1, 0)
    return np.cross(b - a, c - a)


def _turned(points: Floats, sine: float) -> Floats:
    """Points (n, 2) turned about 0 by an angle whose cosine is `COSINE`."""
    x, y = points.T
    return np.column_stack([COSINE * x - sine * y, sine * x + COSINE * y])
