"""What holds up a layer's walls: the certificate that a structure prints without support.

A wall between two sites leans by tan θ = |difference of growth| / (2 · distance of the sites). How
far its points lie from the walls and contours of the layer below is computed, not sampled: the
bound given is at most `SLACK` above the true greatest distance, and never below it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
import shapely

from v3dcad.arguments import above_zero
from v3dcad.geometry.power_diagram.grid import Grid, curve_order
from v3dcad.geometry.power_diagram.regular_triangulation import neighbour_pairs, triangulation
from v3dcad.geometry.section_area import contour_lines, section_area
from v3dcad.model import OUTSIDE, Diagram, Floats, Ints, Layer, Section, Value
from v3dcad.structure.wall_distance import distance_to_walls

SLACK = 0.01
"""Relative excess of the bound over the true greatest distance."""

ROUNDING = 1e-9
"""Relative error that bounds may have."""

NEGLIGIBLE = 1e-6
"""mm; distances no farther apart than this are not told apart."""


@dataclass(frozen=True, eq=False, slots=True)
class Overhang(Value):
    """How every layer rests on the one below. Layer 0 rests on the bed: its entries are 0."""

    wall_tilt: Floats
    """(layers,) largest tilt of a wall from the vertical, degrees"""
    strut_tilt: Floats
    """(layers,) largest tilt of a line where three walls meet, degrees"""
    distance: Floats
    """(layers,) mm: largest distance of a wall's point to walls and contours of the layer below,
    among the points that lie over the section below"""
    unsupported: Floats
    """(layers,) mm of wall over the section below that lie farther than half a bead from its
    walls and contours"""
    outside: Floats
    """(layers,) mm of wall that lie outside the section below: the part's own overhang"""


def overhang(layers: Iterable[Layer], bead_width: float) -> Overhang:
    """The certificate of a stack of layers (ascending), for beads of a width in mm.

    Raises `SettingError` for a width that is not above 0.
    """
    bead_width = above_zero("bead_width", bead_width)
    rows: list[tuple[float, ...]] = []
    below: Layer | None = None
    for layer in layers:
        tilts = (_degrees(layer.slopes(layer.diagram.neighbours)), _degrees(strut_slopes(layer)))
        rest = (0.0, 0.0, 0.0) if below is None else _rests(layer, below, bead_width / 2)
        rows.append((*tilts, *rest))
        below = layer
    return Overhang(*np.array(rows, dtype=np.float64).reshape(-1, 5).T)


def all_neighbours(places: Ints, weights: Ints) -> Ints:
    """(m, 2) pairs i < j of sites, in grid units, that share a wall anywhere in the frame."""
    order = curve_order(places)
    return neighbour_pairs(triangulation(places[order], weights[order]), order)


def _neighbours_over(sites: Floats, weights: Floats, section: Section) -> Ints:
    """(m, 2) pairs i < j of sites (n, 2) that share a wall anywhere in a section, at least.

    The grid's frame holds section and sites, its safe range the weights (n,), of which only
    differences matter.
    """
    corners = np.concatenate([sites, *section.rings])
    weights = weights - weights.min()
    grid = Grid.around(corners.min(axis=0), corners.max(axis=0), float(weights.max()))
    return all_neighbours(grid.snap(sites), grid.snap_weights(weights))


def _degrees(slopes: Floats) -> float:
    return float(np.degrees(np.arctan(slopes.max(initial=0.0))))


def strut_slopes(layer: Layer) -> Floats:
    """Shift per height of each point where three cells meet inside the section.

    The point keeps equal power to three sites p with growth b, so that its velocity v solves
    2 v · (p_j − p_i) = b_i − b_j for two pairs of them.
    """
    sites = meeting_sites(layer.diagram)
    p, b = layer.state.sites[sites, :2], layer.state.growth[sites]
    sides = 2 * (p[:, 1:] - p[:, :1])
    change = b[:, :1] - b[:, 1:]
    double = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    x = change[:, 0] * sides[:, 1, 1] - change[:, 1] * sides[:, 0, 1]
    y = sides[:, 0, 0] * change[:, 1] - sides[:, 1, 0] * change[:, 0]
    return np.asarray(np.hypot(x, y)[double != 0] / np.abs(double[double != 0]))


def meeting_sites(diagram: Diagram) -> Ints:
    """(s, 3) the sites around every vertex where exactly three cells meet."""
    ends = np.repeat(diagram.edges.ravel(), 2)
    sites = np.repeat(diagram.edge_sites, 2, axis=0).ravel()
    around = np.unique(np.column_stack([ends, sites]), axis=0)
    count = np.bincount(around[:, 0], minlength=len(diagram.vertices))
    on_contour = np.zeros(len(diagram.vertices), dtype=bool)
    on_contour[around[around[:, 1] == OUTSIDE, 0]] = True
    chosen = (count == 3) & ~on_contour
    return np.asarray(around[chosen[around[:, 0]], 1].reshape(-1, 3))


def _rests(layer: Layer, below: Layer, reach: float) -> tuple[float, float, float]:
    """Largest distance, unsupported length and length outside the section below, mm."""
    diagram, state = layer.diagram, below.state
    inner = diagram.inner()
    segments = diagram.vertices[diagram.edges[inner]]
    hints = diagram.edge_sites[inner, 0]
    outside = 0.0
    if not layer.section.same_rings(below.section):
        whole = float(np.hypot(*(segments[:, 1] - segments[:, 0]).T).sum())
        segments, hints = _within(segments, hints, section_area(below.section))
        outside = whole - float(np.hypot(*(segments[:, 1] - segments[:, 0]).T).sum())
        outside = outside if outside > NEGLIGIBLE else 0.0
    if not len(segments):
        return 0.0, 0.0, outside
    present = state.present()
    sites, weights = np.ascontiguousarray(state.sites[present, :2]), state.weights[present]
    neighbours = _neighbours_over(sites, weights, below.section)
    # A cell that opens here has none below from which a search could start; any site will do that
    # has one.
    has_cell = np.zeros(len(present), dtype=bool)
    has_cell[neighbours] = True
    start = int(neighbours[0, 0]) if len(neighbours) else 0
    rows = np.minimum(np.searchsorted(present, hints), len(present) - 1)
    hints = np.where((present[rows] == hints) & has_cell[rows], rows, start)

    def to_walls(pieces: Floats, hints: Ints) -> tuple[Floats, Floats]:
        return distance_to_walls(pieces, hints, sites, weights, neighbours, reach)

    farthest, beyond = to_walls(segments, hints)
    contours = contour_lines(below.section)
    shapely.prepare(contours)
    unsupported = 0.0
    far = beyond > 0
    if far.any():
        clear = shapely.buffer(contours, reach, quad_segs=64)
        shapely.prepare(clear)
        pieces, of = _split(segments[far], hints[far], shapely.difference, clear)
        unsupported = float(to_walls(pieces, of)[1].sum())
    return _largest(segments, hints, farthest, contours, to_walls), unsupported, outside


def _largest(
    segments: Floats,
    hints: Ints,
    farthest: Floats,
    contours: shapely.Geometry,
    to_walls: Callable[[Floats, Ints], tuple[Floats, Floats]],
) -> float:
    """The largest distance of a point of the segments to walls and contours, at most SLACK above.

    Branch and bound: distance to walls is exact on a segment; distance to contours is at most
    that of the middle plus half the length. Halve what may still hold a larger distance.
    """
    best = certified = 0.0
    bound = farthest
    while True:
        open_ = bound > best * (1 + SLACK) + NEGLIGIBLE
        certified = max(certified, float(bound[~open_].max(initial=0.0)))
        if not open_.any():
            return certified * (1 + ROUNDING)
        segments, hints = segments[open_], hints[open_]
        middle = segments.mean(axis=1)
        half = np.hypot(*(segments[:, 1] - segments[:, 0]).T) / 2
        to_contours = shapely.distance(contours, shapely.points(middle))
        there = to_walls(np.stack([middle, middle], axis=1), hints)[0]
        best = max(best, float(np.minimum(there, to_contours).max()))
        bound = np.minimum(to_walls(segments, hints)[0], to_contours + half)
        segments = np.concatenate(
            [np.stack([segments[:, 0], middle], axis=1), np.stack([middle, segments[:, 1]], axis=1)]
        )
        hints = np.concatenate([hints, hints])
        bound = np.concatenate([bound, bound])


def _within(segments: Floats, hints: Ints, area: shapely.Geometry) -> tuple[Floats, Ints]:
    """The parts of segments (s, 2, 2) inside an area, and the hint of each."""
    shapely.prepare(area)
    covered = shapely.covers(area, shapely.linestrings(segments))
    pieces, of = _split(segments[~covered], hints[~covered], shapely.intersection, area)
    return np.concatenate([segments[covered], pieces]), np.concatenate([hints[covered], of])


def _split(
    segments: Floats, hints: Ints, operation: Callable[..., object], area: shapely.Geometry
) -> tuple[Floats, Ints]:
    """What an overlay operation with an area leaves of segments, piece by piece."""
    left, of = shapely.get_parts(operation(shapely.linestrings(segments), area), return_index=True)
    lines = shapely.get_type_id(left) == shapely.GeometryType.LINESTRING
    lines &= shapely.length(left) > NEGLIGIBLE
    ends = [shapely.get_coordinates(line)[[0, -1]] for line in left[lines]]
    return np.array(ends, dtype=np.float64).reshape(-1, 2, 2), hints[of[lines]]
