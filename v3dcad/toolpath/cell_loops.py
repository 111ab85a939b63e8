"""The loops that a layer is printed from: two beads for each wall, one in either cell."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from v3dcad.model import Floats, Ints, Layer, Value
from v3dcad.toolpath.convex_inset import inset_cells
from v3dcad.toolpath.perimeters import inset, rings

LEAST_RADIUS = 0.55
"""Cells into which no circle of so many bead spacings fits are left out."""
GRID = 1e-6
"""mm: cells that grow are joined on this grid."""
LEAST_LENGTH = 2.0
"""Loops shorter than so many bead spacings are left out."""


@dataclass(frozen=True, eq=False, slots=True)
class Loops(Value):
    """Closed lines that do not meet."""

    points: Floats
    """(p, 2) mm; those of loop k are first[k] … first[k + 1]"""
    first: Ints
    """(l + 1,)"""
    owner: Ints
    """(l,) the site in whose cell a loop lies; −1 − depth for a perimeter"""

    @classmethod
    def of(cls, lines: list[Floats], owners: list[int], shortest: float = 0.0) -> Loops:
        """Loops by their rings (k, 2), without points nearer than `shortest` (mm) to the last."""
        least = _steps(lines, np.minimum)
        lines = [
            _thinned(line, shortest) if step < shortest else line
            for line, step in zip(lines, least.tolist(), strict=True)
        ]
        sizes = [len(line) for line in lines]
        return cls(
            np.concatenate([np.empty((0, 2)), *lines]),
            np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64),
            np.array(owners, dtype=np.int64),
        )

    def ring(self, loop: int) -> Floats:
        """The points (k, 2) of one loop."""
        return self.points[self.first[loop] : self.first[loop + 1]]


def cell_loops(
    layer: Layer, within: shapely.Geometry, spacing: float
) -> tuple[list[Floats], list[int]]:
    """The rings (k, 2), mm, of all cells' loops, and the site of each.

    A loop lies half a bead spacing (mm) inside its cell's walls and inside the area `within`. Loops
    run counter-clockwise, those around holes clockwise. A cell too small for a loop is left
    out; its area goes to its neighbours by power distance, as if its site were absent.
    """
    cells = layer.diagram.cells()
    core = inset(within, spacing / 2)
    whole = _whole_cells(layer, cells, within)
    outlines = [cells[site][0] for site in whole]
    corners = np.concatenate([np.empty((0, 2)), *outlines])
    first = np.cumsum([0, *map(len, outlines)])
    fits = np.diff(inset_cells(corners, first, LEAST_RADIUS * spacing)[1]) > 0

    others = sorted(set(cells) - set(whole))
    small = [site for site, fit in zip(whole, fits.tolist(), strict=True) if not fit]
    polygons = {site: _polygon(cells[site]) for site in others}
    small += _too_small(polygons, within, LEAST_RADIUS * spacing)
    polygons, gone = _shared_out(polygons, cells, small, layer)

    points, begins = inset_cells(corners, first, spacing / 2)
    loops: list[tuple[int, Floats]] = [
        (site, points[begins[k] : begins[k + 1]])
        for k, site in enumerate(whole)
        if site not in polygons and site not in gone and begins[k + 1] > begins[k]
    ]
    kept = sorted(polygons)
    shapes = inset_each([polygons[site] for site in kept], spacing / 2)
    for site, shape in zip(kept, shapely.intersection(shapes, core), strict=True):
        for part in shapely.get_parts(shape):
            if part.geom_type == "Polygon" and not part.is_empty:
                clean = shapely.remove_repeated_points(part, 1e-6)
                loops += [(site, ring) for ring in rings(clean)]
    length = _steps([ring for _, ring in loops], np.add)
    loops = [
        loop
        for loop, mm in zip(loops, length.tolist(), strict=True)
        if mm >= LEAST_LENGTH * spacing
    ]
    loops.sort(key=lambda loop: loop[0])
    return [ring for _, ring in loops], [site for site, _ in loops]


def inset_each(shapes: list[shapely.Geometry], distance: float) -> NDArray[np.object_]:
    """Each shape drawn in by a distance (mm), corners kept."""
    return np.asarray(shapely.buffer(np.array(shapes, dtype=object), -distance, join_style="mitre"))


def _whole_cells(
    layer: Layer, cells: dict[int, list[Floats]], within: shapely.Geometry
) -> list[int]:
    """Sites of the convex cells that lie inside the area."""
    diagram = layer.diagram
    rim = set(diagram.edge_sites[~diagram.inner(), 1].tolist())
    inner = [site for site, rings in cells.items() if site not in rim and len(rings) == 1]
    if not inner:
        return []
    outlines = [cells[site][0] for site in inner]
    sizes = np.array([len(ring) for ring in outlines])
    points = np.concatenate(outlines)
    first = np.cumsum(sizes) - sizes
    place = np.arange(len(points)) - np.repeat(first, sizes)
    start, size = np.repeat(first, sizes), np.repeat(sizes, sizes)
    arriving = points - points[start + (place - 1) % size]
    leaving = points[start + (place + 1) % size] - points
    turn = arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0]
    # Rounding turns a corner that is nearly straight by a little.
    convex = np.minimum.reduceat(turn, first) > -1e-7
    shapely.prepare(within)
    # Corners inside are not enough: a round hole may bulge through an edge.
    shapes = shapely.polygons(
        shapely.linearrings(points, indices=np.repeat(np.arange(len(sizes)), sizes))
    )
    fine = convex & shapely.covers(within, shapes)
    return [site for site, one in zip(inner, fine.tolist(), strict=True) if one]


def _polygon(rings: list[Floats]) -> shapely.Geometry:
    """A cell as an area; its holes run clockwise."""
    if len(rings) == 1:
        return shapely.Polygon(rings[0])
    shapes = [shapely.Polygon(ring) for ring in rings]
    outer = [shape for shape in shapes if shape.exterior.is_ccw]
    holes = [shape for shape in shapes if not shape.exterior.is_ccw]
    return shapely.union_all(outer).difference(shapely.union_all(holes))


def _too_small(
    polygons: dict[int, shapely.Geometry], within: shapely.Geometry, radius: float
) -> list[int]:
    """Sites whose cell reaches into the area and holds no circle of this radius there."""
    if not polygons:
        return []
    shapes = list(polygons.values())
    hold = shapely.intersection(inset_each(shapes, radius), inset(within, radius))
    small = shapely.is_empty(hold) & shapely.intersects(np.array(shapes, dtype=object), within)
    return [site for site, one in zip(polygons, small.tolist(), strict=True) if one]


def _shared_out(
    polygons: dict[int, shapely.Geometry],
    cells: dict[int, list[Floats]],
    small: list[int],
    layer: Layer,
) -> tuple[dict[int, shapely.Geometry], set[int]]:
    """The polygons with those of all cells that grew as small ones went, and the sites gone.

    The smallest cell goes first. Its area goes to its neighbours, each part to the nearest by
    power; neighbours that are small themselves inherit only where there are no others.
    """
    polygons, gone = dict(polygons), set[int]()
    if not small:
        return polygons, gone
    sites, weights = layer.state.sites, layer.state.weights
    beside: dict[int, set[int]] = {}
    for one, other in layer.diagram.neighbours.tolist():
        beside.setdefault(one, set()).add(other)
        beside.setdefault(other, set()).add(one)
    for site in small:
        polygons[site] = _polygon(cells[site])
    left = set(small)
    for site in sorted(small, key=lambda site: (polygons[site].area, site)):
        around = sorted(beside.get(site, ()))
        heirs = [heir for heir in around if heir not in left] or around
        if not heirs:
            continue
        estate = polygons.pop(site)
        left.discard(site)
        gone.add(site)
        for heir in heirs:
            share = estate
            for other in heirs:
                if other != heir:
                    share = share.intersection(_nearer(sites, weights, heir, other, estate))
            if share.area > 1e-9:
                own = polygons[heir] if heir in polygons else _polygon(cells[heir])
                # Grown by a grid's step, so that both become one.
                share = share.buffer(GRID, join_style="mitre")
                polygons[heir] = _flat(shapely.union_all([_flat(own), share], grid_size=GRID))
        for heir in around:
            beside[heir] = (beside[heir] | set(heirs)) - {heir, site}
    return polygons, gone


def _nearer(
    sites: Floats, weights: Floats, site: int, other: int, around: shapely.Geometry
) -> shapely.Geometry:
    """Where a site is nearer by power than another, as far as 1 m about an area."""
    here, there = sites[site, :2], sites[other, :2]
    apart = np.hypot(*(there - here))
    across = (there - here) / apart
    along = np.array([-across[1], across[0]])
    power = (there @ there - weights[other]) - (here @ here - weights[site])
    middle = shapely.get_coordinates(around.centroid)[0]
    foot = middle + (power / (2 * apart) - middle @ across) * across
    far = 1000.0
    left, right = foot + far * along, foot - far * along
    return shapely.Polygon([left, right, right - far * across, left - far * across][::-1])


def _flat(shape: shapely.Geometry) -> shapely.Geometry:
    """The polygons of a shape alone."""
    if shape.geom_type == "Polygon":
        return shape
    parts = shapely.get_parts(shape)
    return shapely.MultiPolygon([part for part in parts if part.geom_type == "Polygon"])


def _steps(lines: list[Floats], reduction: np.ufunc) -> Floats:
    """(l,) mm: the lengths of each closed line's segments, reduced to one number."""
    if not lines:
        return np.zeros(0)
    first = np.cumsum([0, *map(len, lines)])
    points = np.concatenate(lines)
    after = np.arange(1, len(points) + 1)
    after[first[1:] - 1] = first[:-1]
    return np.asarray(reduction.reduceat(np.hypot(*(points[after] - points).T), first[:-1]))


def _thinned(ring: Floats, shortest: float) -> Floats:
    """A ring without the points nearer than `shortest` (mm) to the one kept before."""
    places = ring.tolist()
    kept = [0]
    for k in range(1, len(places)):
        if math.dist(places[k], places[kept[-1]]) >= shortest:
            kept.append(k)
    while len(kept) > 3 and math.dist(places[kept[-1]], places[0]) < shortest:
        kept.pop()
    return ring[kept] if len(kept) >= 3 else ring
