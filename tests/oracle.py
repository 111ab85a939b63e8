"""Power diagrams by qhull and GEOS: slow, simple, and nothing in common with the engine."""

from __future__ import annotations

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import minimum_spanning_tree
from scipy.spatial import ConvexHull, Voronoi

THIN = 1e-10
"""A cell's part that is thinner behind its contour than this share of the section is none."""


def area_of(section):
    """The section as a shapely area: the faces between its rings that they wind around."""
    between = faces(section.rings)
    inside = shapely.get_coordinates(shapely.point_on_surface(between))
    return shapely.union_all(between[windings(section.rings, inside) > 0])


def faces(rings):
    """The faces between rings, as shapely areas."""
    lines = [shapely.linestrings(np.vstack([ring, ring[:1]])) for ring in rings]
    return shapely.get_parts(shapely.polygonize([shapely.unary_union(lines)]))


def windings(rings, points):
    """(n,) how often rings wind around points (n, 2), by the angles that they sweep."""
    total = np.zeros(len(points))
    for ring in rings:
        way = (ring[None] - points[:, None]) @ np.array([1, 1j])
        total += np.angle(np.roll(way, -1, axis=1) / way).sum(axis=1)
    return np.rint(total / (2 * np.pi)).astype(int)


def power_diagram(sites, weights):
    """A whole power diagram by the lifted sites' lower hull: triangles (t, 3) of sites, their
    vertices (t, 2), and the triangles (t, 3) across.

    Four far sites, the last, keep the cells finite.
    """
    centre, size = sites.mean(axis=0), np.ptp(sites, axis=0).max() + np.sqrt(np.ptp(weights)) + 1e-9
    far = centre + 50 * size * np.array([[-1.0, -1.1], [1.2, -1.0], [1.0, 1.3], [-1.1, 1.0]])
    x, y = (np.vstack([sites, far]) - centre).T
    lifted = x * x + y * y - np.concatenate([weights, np.full(4, weights.min())])
    hull = ConvexHull(np.column_stack([x, y, lifted]))
    lower = np.nonzero(hull.equations[:, 2] < 0)[0]
    number = np.full(len(hull.simplices), -1)
    number[lower] = np.arange(len(lower))
    corners, normal = hull.simplices[lower], hull.equations[lower]
    vertices = centre - normal[:, :2] / (2 * normal[:, 2:3])
    return corners, vertices, number[hull.neighbors[lower]]


def power_edges(count, corners, vertices, across):
    """Pairs (m, 2) of `count` sites and edges (m, 2, 2) of a whole power diagram."""
    pairs, edges = [], []
    for k in range(3):
        own = np.nonzero(across[:, k] > np.arange(len(corners)))[0]
        pairs.append(np.sort(corners[own][:, [(k + 1) % 3, (k + 2) % 3]], axis=1))
        edges.append(np.stack([vertices[own], vertices[across[own, k]]], axis=1))
    pairs, edges = np.concatenate(pairs), np.concatenate(edges)
    inner = pairs[:, 1] < count
    return pairs[inner], edges[inner]


def slice_in_space(sites, stretch, z):
    """Pairs (m, 2) of sites (n, 3) and edges (m, 2, 2): a plane cut through the bounded walls of
    scipy's Voronoi diagram in the space that a stretch makes flatter.
    """
    diagram = Voronoi(sites / [1, 1, stretch])
    pairs, edges = [], []
    for pair, ridge in zip(diagram.ridge_points, diagram.ridge_vertices, strict=True):
        if -1 in ridge:
            continue
        here = diagram.vertices[ridge]
        there = np.roll(here, -1, axis=0)
        crosses = (here[:, 2] <= z / stretch) != (there[:, 2] <= z / stretch)
        if crosses.any():
            here, there = here[crosses], there[crosses]
            share = (z / stretch - here[:, 2]) / (there[:, 2] - here[:, 2])
            edges.append((here + share[:, None] * (there - here))[:, :2])
            pairs.append(np.sort(pair))
    return np.array(pairs), np.array(edges)


def power_cells(count, corners, vertices):
    """The cells of `count` sites in a whole power diagram, as shapely areas: of those that have
    one, in their order.
    """
    owner, place = corners.ravel(), np.repeat(np.arange(len(corners)), 3)
    place, owner = place[owner < count], owner[owner < count]
    corner_count = np.bincount(owner, minlength=count)
    middle = np.column_stack(
        [
            np.bincount(owner, vertices[place, k], count) / np.maximum(corner_count, 1)
            for k in (0, 1)
        ]
    )
    way = vertices[place] - middle[owner]
    order = np.lexsort([np.arctan2(way[:, 1], way[:, 0]), owner])
    number = np.unique(owner[order], return_inverse=True)[1]
    return shapely.polygons(shapely.linearrings(vertices[place[order]], indices=number))


def cut_edges(area, pairs, edges):
    """Neighbours (m, 2) and their edges inside a prepared area, as shapely lines."""
    lines = shapely.linestrings(edges)
    whole = shapely.contains_properly(area, lines)
    cut = np.where(whole, lines, None)
    cut[~whole] = shapely.intersection(area, lines[~whole])
    kept = shapely.length(cut) > 0
    return pairs[kept], cut[kept]


def cut_cells(area, cells):
    """How many cells have a part inside a prepared area, and what each has of its contour."""
    crossed = cells[~shapely.contains_properly(area, cells)]
    parts = shapely.area(shapely.intersection(area, crossed))
    contours = shapely.intersection(shapely.boundary(area), crossed)
    thin = THIN * np.ptp(shapely.bounds(area)) * shapely.length(contours)
    return len(cells) - int((parts <= thin).sum()), contours


def spanning_tree(sites, pairs):
    """The minimum spanning tree's pairs."""
    lengths = np.hypot(*(sites[pairs[:, 0]] - sites[pairs[:, 1]]).T)
    graph = coo_array((lengths, pairs.T), (len(sites), len(sites))).tocsr()
    tree = minimum_spanning_tree(graph).tocoo()
    return np.sort(np.column_stack([tree.row, tree.col]), axis=1)


def layer(sites, weights, section):
    """What the engine makes of a layer, the slow way: neighbours, edges, tree, how many cells
    there are, and whose contour is which.
    """
    area, sites = area_of(section), sites[:, :2]
    shapely.prepare(area)
    corners, vertices, across = power_diagram(sites, weights)
    pairs, edges = power_edges(len(sites), corners, vertices, across)
    pairs, lines = cut_edges(area, pairs, edges)
    count, contours = cut_cells(area, power_cells(len(sites), corners, vertices))
    return pairs, lines, spanning_tree(sites, pairs), count, contours


def cells(sites, weights, section):
    """Each site's part of the section, as shapely areas: half-planes against all other sites.

    Sites may have a height besides x and y, which the weights stand for.
    """
    area, sites = area_of(section), sites[:, :2]
    low, high = np.reshape(shapely.bounds(area), (2, 2))
    reach = (high - low).max()
    frame = [low - reach, (high[0] + reach, low[1] - reach), high + reach]
    frame.append((low[0] - reach, high[1] + reach))
    found = []
    for i in range(len(sites)):
        polygon = np.array(frame)
        for j in range(len(sites)):
            if i == j or not len(polygon):
                continue
            normal = sites[j] - sites[i]
            bound = (sites[j] @ sites[j] - sites[i] @ sites[i] - weights[j] + weights[i]) / 2
            height = bound - polygon @ normal
            if not normal.any() and bound == 0:  # one above the other: the first has the cell
                height += j - i
            polygon = _half_plane(polygon, height)
        # Rounding may leave corners an ulp apart, a spike that GEOS takes amiss; a hull has none.
        hull = shapely.convex_hull(shapely.multipoints(polygon))
        found.append(shapely.intersection(hull, area))
    assert np.isclose(shapely.area(found).sum(), area.area, rtol=1e-9), "the oracle's cells overlap"
    return found


def _half_plane(polygon, height):
    """The part of a convex polygon where height (per corner) is not negative."""
    kept = []
    for k in range(len(polygon)):
        after = (k + 1) % len(polygon)
        if height[k] >= 0:
            kept.append(polygon[k])
        if (height[k] >= 0) != (height[after] >= 0):
            share = height[k] / (height[k] - height[after])
            kept.append(polygon[k] + share * (polygon[after] - polygon[k]))
    return np.array(kept).reshape(-1, 2)
