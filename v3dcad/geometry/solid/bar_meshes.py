"""Struts and beads as meshes: round bars in space, and the layers' lines with a width."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import shapely
from manifold3d import CrossSection, FillRule, Manifold

from v3dcad.arguments import above_zero
from v3dcad.geometry.mesh.boolean import united
from v3dcad.model import Floats, Ints, Layer, Mesh

SIDES = 12
"""Sides of the prism that represents a round bar."""


def bar_mesh(points: Floats, struts: Ints, diameter: float, sides: int = SIDES) -> Mesh:
    """Struts (s, 2) between points (v, 3), mm, as one closed mesh: prisms, balls at the joints.

    `sides` are those of a prism and of a ball; the more, the closer they are to round ones.
    """
    above_zero("diameter", diameter)
    radius = diameter / 2
    ball = Manifold.sphere(radius, sides)
    joints = [ball.translate(point) for point in points[np.unique(struts)].tolist()]
    rod = Manifold.cylinder(1.0, radius, radius, sides)
    return united([rod.transform(frame) for frame in _frames(points[struts])] + joints)


def _frames(ends: Floats) -> Floats:
    """(s, 3, 4) affine maps of the unit z axis onto segments (s, 2, 3), keeping round what is."""
    along = ends[:, 1] - ends[:, 0]
    unit = along / np.linalg.norm(along, axis=1, keepdims=True)
    aside = np.where(np.abs(unit[:, [0]]) < 0.6, [[1.0, 0, 0]], [[0, 1.0, 0]])
    first = np.cross(unit, aside)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(unit, first), along, ends[:, 0]], axis=2)


def bead_mesh(layers: Iterable[Layer], width: float, height: float, base: float = 0.0) -> Mesh:
    """What is printed, as one closed mesh: each layer's lines, `width` wide and `height` high (mm).

    Lines have round ends and corners, true to a hundredth of the width. A layer's bead stands
    `base` mm over the layer's height.
    """
    above_zero("width", width)
    above_zero("height", height)
    return united(
        [
            CrossSection(_outlines(layer, width), FillRule.EvenOdd)
            .extrude(height)
            .translate((0, 0, layer.z + base))
            for layer in layers
            if len(layer.diagram.edges)
        ]
    )


def _outlines(layer: Layer, width: float) -> list[Floats]:
    lines = shapely.multilinestrings(
        shapely.linestrings(layer.diagram.vertices[layer.diagram.edges])
    )
    area = shapely.simplify(shapely.buffer(lines, width / 2, quad_segs=4), width / 100)
    return [
        np.asarray(shapely.get_coordinates(ring)[:-1])
        for polygon in shapely.get_parts(area)
        for ring in (polygon.exterior, *polygon.interiors)
    ]


def wall_strips(layers: Iterable[Layer], height: float, base: float = 0.0) -> Mesh:
    """Each edge of each layer as an upright strip of two triangles, without a thickness.

    Strips are `height` high and begin `base` over the layer's height, mm.
    """
    corners = []
    for layer in layers:
        ends = layer.diagram.vertices[layer.diagram.edges]
        low = np.dstack([ends, np.full(ends.shape[:2], layer.z + base)])
        high = low + np.array([0.0, 0.0, height])
        a, b, c, d = low[:, 0], low[:, 1], high[:, 1], high[:, 0]
        corners.append(np.stack([a, b, c, a, c, d], axis=1).reshape(-1, 3))
    points = np.concatenate(corners) if corners else np.empty((0, 3))
    return Mesh(points, np.arange(len(points)).reshape(-1, 3))
