"""A vertical plane through a structure, seen as its layers see it.

Each wall is plane, so the plane cuts it in a straight line. Where a wall crosses the plane on two
layers, one above the other, the two points are joined. What begins or ends between two layers is
found there: in the plane, the cells of both layers are those of a power diagram of x and z, whose
walls are clipped by all cells around. So nothing but the layers is needed, and it holds for the
thesis's method too. Contours are joined in their order along the plane, where it crosses as many as
on the layer below; where it does not, each layer is drawn by itself, to the middle between the two.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from v3dcad.model import OUTSIDE, Floats, Ints, Layer, SiteState

Pair = tuple[int, int]

SHORTEST = 1e-9
"""mm: what of a wall is shorter is none."""


class VerticalCut(NamedTuple):
    """Lines in a plane parallel to x and z, bed coordinates."""

    points: Floats
    """(n, 3) mm"""
    walls: Ints
    """(w, 2) rows of `points`"""
    contours: Ints
    """(c, 2) rows of `points`"""


@dataclass
class _Crossings:
    """Where one layer's edges cross the plane, from left to right."""

    z: float
    x: list[float]
    pairs: list[Pair]
    """the cells left and right of each, by their sites; `OUTSIDE` where there is none"""
    rows: list[int]
    """the points that are drawn for them"""
    state: SiteState
    slopes: dict[int, float] = field(default_factory=dict)
    """how far contours move to the right per height, as far as the layers around tell"""

    def walls(self) -> dict[Pair, int]:
        """Where each wall is in the order."""
        return {pair: place for place, pair in enumerate(self.pairs) if OUTSIDE not in pair}

    def contours(self) -> list[int]:
        """The places of contours."""
        return [place for place, pair in enumerate(self.pairs) if OUTSIDE in pair]

    def cells(self, first: int, last: int) -> list[int]:
        """The cells between two crossings, from left to right."""
        return [pair[1] for pair in self.pairs[first:last]]

    def at(self, contour: int, z: float) -> float:
        """Where a contour is at another height."""
        return self.x[contour] + (z - self.z) * self.slopes.get(contour, 0.0)


class _Side(NamedTuple):
    """The left or right end of what is drawn between two heights, mm."""

    low: float
    high: float


@dataclass
class _Drawing:
    """Points and lines, as they are drawn in the plane at y."""

    y: float
    points: list[tuple[float, float, float]] = field(default_factory=list)
    walls: list[Pair] = field(default_factory=list)
    contours: list[Pair] = field(default_factory=list)

    def point(self, x: float, z: float) -> int:
        """The row of a new point."""
        self.points.append((x, self.y, z))
        return len(self.points) - 1

    def fill(
        self, cells: dict[int, Floats], left: _Side, right: _Side, low: float, high: float
    ) -> None:
        """Draw the walls among some cells, whose planes are given, between heights and sides."""
        for ends in _walls_among(np.array(list(cells.values())), left, right, low, high).tolist():
            start, stop = (self.point(*end) for end in ends)
            self.walls.append((start, stop))


def vertical_cut(
    layers: Iterable[Layer], y: float = 0.0, span: tuple[float, float] = (0.0, 0.0)
) -> VerticalCut:
    """The cut of a structure by the plane at y, mm, bed coordinates: by default the part's middle.

    `span` says how high a layer is and where it begins (`FillSettings.layer_span`): the first one
    is drawn from its lower end, the last one up to its upper end. Goes through the layers once.
    """
    height, base = span
    drawing = _Drawing(y)
    first = below = None
    for layer in layers:
        here = _crossings(layer, drawing)
        if below is None:
            first = here
        elif len(below.contours()) == len(here.contours()):
            _join(below, here, drawing)
        else:
            middle = (below.z + here.z) / 2
            _alone(below, drawing, below.z, middle)
            _alone(here, drawing, middle, here.z)
            _shelves(below, here, drawing, middle)
        below = here
    if first is not None and below is not None:
        _alone(first, drawing, first.z + base, first.z)
        _alone(below, drawing, below.z, below.z + base + height)
    points = np.array(drawing.points, float).reshape(-1, 3)
    return VerticalCut(points, _rows(drawing.walls), _rows(drawing.contours))


def _join(lower: _Crossings, upper: _Crossings, drawing: _Drawing) -> None:
    """Draw what lies between two layers with as many contours, side by side."""
    contours = list(zip(lower.contours(), upper.contours(), strict=True))
    for one, other in contours:
        slope = (upper.x[other] - lower.x[one]) / (upper.z - lower.z)
        lower.slopes[one] = upper.slopes[other] = slope
        drawing.contours.append((lower.rows[one], upper.rows[other]))
    above = upper.walls()
    both = [(place, above[pair]) for pair, place in lower.walls().items() if pair in above]
    drawing.walls += [(lower.rows[one], upper.rows[other]) for one, other in both]
    common = _common(lower, upper)
    for begin, end in pairwise(sorted([*contours, *both])):
        found = {
            **_planes(upper, upper.cells(begin[1], end[1]), drawing.y, lower.z, common),
            **_planes(lower, lower.cells(begin[0], end[0]), drawing.y, lower.z),
        }
        if len(found) > 1:
            left, right = (_Side(lower.x[one], upper.x[other]) for one, other in (begin, end))
            drawing.fill(found, left, right, lower.z, upper.z)


def _common(lower: _Crossings, upper: _Crossings) -> float:
    """What all weights of the upper layer have more than those of the lower one there, mm²."""
    cells = sorted({*lower.cells(0, len(lower.x))} & {*upper.cells(0, len(upper.x))} - {OUTSIDE})
    grown = lower.state.weights + (upper.z - lower.z) * lower.state.growth
    return float(np.median(upper.state.weights[cells] - grown[cells])) if cells else 0.0


def _alone(one: _Crossings, drawing: _Drawing, low: float, high: float) -> None:
    """Draw the cells of one layer between two heights, of which one may be its own."""
    if high <= low:
        return
    contours = one.contours()
    sides = [_Side(one.at(place, low), one.at(place, high)) for place in contours]
    for side in sides:
        ends = drawing.point(side.low, low), drawing.point(side.high, high)
        drawing.contours.append(ends)
    for (begin, end), (left, right) in zip(pairwise(contours), pairwise(sides), strict=True):
        found = _planes(one, one.cells(begin, end), drawing.y, low)
        if len(found) > 1:
            drawing.fill(found, left, right, low, high)


def _shelves(lower: _Crossings, upper: _Crossings, drawing: _Drawing, z: float) -> None:
    """Draw the sides that face down and up between two layers: where only one of them is."""
    ends = [{one.at(place, z) for place in one.contours()} for one in (lower, upper)]
    for left, right in pairwise(sorted(ends[0] | ends[1])):
        inside = [sum(end <= left for end in side) % 2 for side in ends]
        if inside[0] != inside[1]:
            drawing.contours.append((drawing.point(left, z), drawing.point(right, z)))


def _planes(
    one: _Crossings, cells: list[int], y: float, low: float, common: float = 0.0
) -> dict[int, Floats]:
    """(3,) for each cell: a, b, c of its power at (x, y, low + t), a x + b t + c, but for what is
    the same for all. `common` is taken from the weights.
    """
    inside = [cell for cell in cells if cell != OUTSIDE]
    x0, y0 = one.state.sites[inside, :2].T
    growth = one.state.growth[inside]
    weights = one.state.weights[inside] - common + (low - one.z) * growth
    planes = np.column_stack([-2 * x0, -growth, x0 * x0 + (y - y0) ** 2 - weights])
    return dict(zip(inside, planes, strict=True))


def _walls_among(planes: Floats, left: _Side, right: _Side, low: float, high: float) -> Floats:
    """(w, 2, 2) x and z of the ends of the walls among cells whose powers are planes (n, 3).

    On the line where two planes meet, every other plane, and each border, cuts one side away.
    """
    height = high - low
    one, other = np.triu_indices(len(planes), 1)
    apart = planes[one] - planes[other]
    steep = np.hypot(*apart[:, :2].T)
    one, other, apart, steep = (part[steep > 0] for part in (one, other, apart, steep))
    normals = apart[:, :2] / steep[:, None]
    along = normals[:, ::-1] * [1, -1]
    nearest = -(apart[:, 2] / steep)[:, None] * normals
    borders = np.array([
        [0, 1, 0], [0, -1, height],
        [1, -(left.high - left.low) / height, -left.low],
        [-1, (right.high - right.low) / height, right.low],
    ])  # fmt: skip
    cuts = planes - planes[one][:, None]
    cuts = np.concatenate([cuts, np.broadcast_to(borders, (len(one), *borders.shape))], axis=1)
    change = np.einsum("pki,pi->pk", cuts[..., :2], along)
    here = np.einsum("pki,pi->pk", cuts[..., :2], nearest) + cuts[..., 2]
    pair = np.arange(len(one))
    here[pair, one] = here[pair, other] = change[pair, one] = change[pair, other] = 0.0
    end = -here / np.where(change == 0, 1.0, change)
    begins = np.where(change > 0, end, -np.inf).max(axis=1)
    ends = np.where(change < 0, end, np.inf).min(axis=1)
    there = (ends - begins > SHORTEST) & ~((change == 0) & (here < 0)).any(axis=1)
    shares = np.stack([begins, ends], axis=1)[there]
    places = nearest[there, None] + shares[:, :, None] * along[there, None]
    return np.asarray(places + np.array([0.0, low]))


def _crossings(layer: Layer, drawing: _Drawing) -> _Crossings:
    """Where edges of a layer cross the plane; one that ends on it counts where it lies above."""
    diagram, y = layer.diagram, drawing.y
    start, stop = np.moveaxis(diagram.vertices[diagram.edges], 1, 0)
    crossing = (start[:, 1] < y) != (stop[:, 1] < y)
    start, stop = start[crossing], stop[crossing]
    share = (y - start[:, 1]) / (stop[:, 1] - start[:, 1])
    x = start[:, 0] + share * (stop[:, 0] - start[:, 0])
    order = np.argsort(x, kind="stable")
    # A diagram's second site lies on the left of its edges, seen along them.
    upward = (start[:, 1] < stop[:, 1])[:, None]
    sites = diagram.edge_sites[crossing]
    pairs = np.where(upward, sites[:, ::-1], sites)[order].tolist()
    rows = [drawing.point(place, layer.z) for place in x[order].tolist()]
    named = [(left, right) for left, right in pairs]
    return _Crossings(layer.z, x[order].tolist(), named, rows, layer.state)


def _rows(pairs: list[Pair]) -> Ints:
    return np.array(pairs, np.int64).reshape(-1, 2)
