"""Walls and contours in space as an eye sees them: strips, each one layer high.

The eye looks down on the part. So layers are painted from the lowest to the highest, and the strips
of each from the farthest to the nearest, and every strip hides what lies behind it. No buffer of
depths is needed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from v3dcad.geometry.section_area import contour_lines
from v3dcad.model import Floats, Layer
from v3dcad.view.trimming import trimmed

TURN = np.radians(-30)
"""How the eye stands around the part: to the front and right of it."""

ABOVE, ON_TOP = np.radians(38), np.radians(90)
"""How high the eye stands: above the part, or right on top of it."""

DISTANCE = 2.2
"""From the eye to the part's middle, in sizes of the part."""

FASTEST, FLAT = 3.0, 1e-3
"""How far a corner drifts per height at most, and the least determinant of what says whither: where
walls are nearly parallel, it could be anything."""


class Eye(NamedTuple):
    """Where one looks at a part from."""

    middle: Floats
    """(3,) mm: what it looks at"""
    size: float
    """mm: the diagonal of the part's box"""
    tilt: float = ABOVE
    """radians above the horizon"""

    @property
    def turn(self) -> float:
        """Radians around the part; from on top, x points to the right and y upwards."""
        return TURN if self.tilt < ON_TOP else 0.0

    def towards(self) -> Floats:
        """(3,) the direction from the part to the eye, a unit vector."""
        flat = np.cos(self.tilt)
        return np.array([-np.sin(self.turn) * flat, -np.cos(self.turn) * flat, np.sin(self.tilt)])

    def seen(self, points: Floats) -> tuple[Floats, Floats]:
        """Where points (…, 3) are in the picture (…, 2), and how far away (…), mm."""
        x, y, z = np.moveaxis(points - self.middle, -1, 0)
        right = x * np.cos(self.turn) - y * np.sin(self.turn)
        away = x * np.sin(self.turn) + y * np.cos(self.turn)
        up = z * np.cos(self.tilt) + away * np.sin(self.tilt)
        depth = away * np.cos(self.tilt) - z * np.sin(self.tilt)
        nearer = 1 / (1 + depth / (DISTANCE * self.size))
        return np.stack([right * nearer, up * nearer], axis=-1), depth


class Areas(NamedTuple):
    """A layer's section and those of the layers below and above that are drawn, as areas."""

    below: shapely.Geometry
    own: shapely.Geometry
    above: shapely.Geometry


class Strips(NamedTuple):
    """The walls, or the contours, of one layer from its lower to its upper end."""

    corners: Floats
    """(s, 4, 3) mm: two below, then the two above them in the opposite order"""
    values: Floats
    """(s,) of the edges they stand on"""
    cut: NDArray[np.bool_]
    """(s, 2) which of their upright sides, first and second, lie on a plane of the cut"""

    def sides(self) -> Floats:
        """(c, 2, 3) the upright sides that lie on a plane of the cut."""
        first, second = self.corners[:, [0, 3]], self.corners[:, [1, 2]]
        return np.concatenate([first[self.cut[:, 0]], second[self.cut[:, 1]]])


def wall_strips(
    layer: Layer,
    span: tuple[float, float],
    values: Floats,
    corner: Floats | None,
    areas: Areas,
) -> Strips:
    """The walls of a layer from the lower to the upper height of its span, mm, leaning as they do.

    They end at the layer's section, and where the sides of the part slope, at the next one.
    `values` (e,) are those of all edges. What lies to the right of `corner` (2,), mm, and in front
    of it is cut away; without a corner nothing is.
    """
    diagram = layer.diagram
    inner = diagram.inner()
    drifts = _drifts(layer)
    slope = FASTEST * (span[1] - span[0])
    lower, upper = (
        trimmed(trimmed(_leaning(layer, drifts, height), areas.own), beside, slope)
        for height, beside in zip(span, (areas.below, areas.above), strict=True)
    )
    count = len(lower)
    which, cut = np.arange(count), np.zeros((count, 2), np.bool_)
    if corner is not None:
        enters, leaves = _within(lower, corner)
        enters_above, leaves_above = _within(upper, corner)
        missed = enters >= leaves
        before, after = ~missed & (enters > 0), ~missed & (leaves < 1)
        which = np.concatenate([np.flatnonzero(part) for part in (missed, before, after)])
        ends = np.repeat([0, 1, 2], [missed.sum(), before.sum(), after.sum()])
        cut = np.column_stack([ends == 2, ends == 1])
        # Above, a wall may end elsewhere; where it is cut there, too, that is where it ends.
        enters_above = np.where((enters_above > 0) & (enters_above < 1), enters_above, enters)
        leaves_above = np.where((leaves_above > 0) & (leaves_above < 1), leaves_above, leaves)
        lower = _between(lower[which], cut, leaves[which], enters[which])
        upper = _between(upper[which], cut, leaves_above[which], enters_above[which])
    return Strips(_standing(lower, upper, span), values[inner][which], cut)


def contour_strips(layer: Layer, span: tuple[float, float], tolerance: float) -> Strips:
    """The contours of a layer, upright from the lower to the upper height of its span, mm.

    Corners that lie within `tolerance`, mm, of a straight line are left out.
    """
    rings = shapely.get_parts(shapely.simplify(contour_lines(layer.section), tolerance))
    lines = [shapely.get_coordinates(ring) for ring in rings]
    ends = np.concatenate(
        [np.empty((0, 2, 2)), *(np.stack([line[:-1], line[1:]], axis=1) for line in lines)]
    )
    corners = _standing(ends, ends, span)
    return Strips(corners, np.zeros(len(ends)), np.zeros((len(ends), 2), np.bool_))


def _leaning(layer: Layer, drifts: Floats, height: float) -> Floats:
    """(w, 2, 2) where the walls of a layer are at a height, mm, as its corners drift."""
    edges = layer.diagram.edges[layer.diagram.inner()]
    here = layer.diagram.vertices[edges]
    farthest = layer.area_per_cell**0.5 / 3  # farther on, other walls meet
    drift = np.clip((height - layer.z) * drifts, -farthest, farthest)
    return _uncrossed(here, here + drift[edges])


def _standing(lower: Floats, upper: Floats, span: tuple[float, float]) -> Floats:
    """Strips (s, 4, 3) from edges (s, 2, 2) at the lower height to edges at the upper one."""
    flat = np.concatenate([lower, upper[:, ::-1]], axis=1)
    heights = np.broadcast_to(np.repeat(span, 2), flat.shape[:2])
    return np.concatenate([flat, heights[:, :, None]], axis=2)


def _between(ends: Floats, cut: NDArray[np.bool_], begin: Floats, stop: Floats) -> Floats:
    """Edges (s, 2, 2) that begin and stop at shares (s,) of their way where they are cut."""
    first, second = ends[:, 0], ends[:, 1]
    along = second - first
    return np.stack(
        [
            np.where(cut[:, :1], first + begin[:, None] * along, first),
            np.where(cut[:, 1:], first + stop[:, None] * along, second),
        ],
        axis=1,
    )


def _uncrossed(here: Floats, there: Floats) -> Floats:
    """The edges there (w, 2, 2); one that is turned round has shrunk to a point on its way."""
    turned = ((here[:, 1] - here[:, 0]) * (there[:, 1] - there[:, 0])).sum(axis=1) < 0
    middle = there.mean(axis=1, keepdims=True)
    return np.where(turned[:, None, None], middle, there)


def _drifts(layer: Layer) -> Floats:
    """(v, 2) how far each corner of a layer moves to the side per height.

    It stays on all walls that meet in it. A wall between two sites d apart, whose weights grow by g
    and h a height, moves by (g - h) / 2|d| straight from the first to the second; contours stay.
    Where more walls than two meet, least squares say where.
    """
    diagram, state = layer.diagram, layer.state
    inner = diagram.inner()
    i, j = diagram.edge_sites[inner].T
    apart = state.sites[j, :2] - state.sites[i, :2]
    lengths = np.maximum(np.linalg.norm(apart, axis=1, keepdims=True), 1e-300)
    ends = diagram.vertices[diagram.edges]
    along = ends[:, 1] - ends[:, 0]
    normals = np.column_stack([along[:, 1], -along[:, 0]])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    normals[inner] = apart / lengths
    speeds = np.zeros(len(normals))
    speeds[inner] = (state.growth[i] - state.growth[j]) / (2 * lengths[:, 0])
    count = len(diagram.vertices)

    def summed(values: Floats) -> Floats:
        return np.asarray(np.bincount(diagram.edges.ravel(), np.repeat(values, 2), count), float)

    x, y = normals.T
    xx, xy, yy = summed(x * x), summed(x * y), summed(y * y)
    right, forth = summed(x * speeds), summed(y * speeds)
    size = np.maximum(xx * yy - xy * xy, FLAT)
    drift = np.column_stack([yy * right - xy * forth, xx * forth - xy * right]) / size[:, None]
    return np.clip(drift, -FASTEST, FASTEST)


def _within(ends: Floats, corner: Floats) -> tuple[Floats, Floats]:
    """Where edges (e, 2, 2) enter and leave what is cut away, as shares (e,) of their way.

    It is what lies right of the corner and in front of it; those outside leave before they enter.
    """
    enters, leaves = np.zeros(len(ends)), np.ones(len(ends))
    for inside in (ends[:, :, 0] - corner[0], corner[1] - ends[:, :, 1]):
        start, stop = inside.T
        crosses = (start > 0) != (stop > 0)
        share = start / np.where(crosses, start - stop, 1.0)
        enters = np.where(crosses & (stop > 0), np.maximum(enters, share), enters)
        leaves = np.where(crosses & (start > 0), np.minimum(leaves, share), leaves)
        leaves = np.where((start <= 0) & (stop <= 0), -1.0, leaves)
    return enters, leaves
