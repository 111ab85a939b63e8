"""Power diagrams by qhull and GEOS: slow, simple, and nothing in common with the engine."""

from __future__ import annotations

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import minimum_spanning_tree
from scipy.spatial import ConvexHull, KDTree

from v3dcad.model import OUTSIDE, Diagram, Floats, Ints, Section


def section_area(section: Section) -> shapely.Geometry:
    """The section as one shapely polygon or multipolygon (even-odd over its rings)."""
    lines = shapely.multilinestrings(
        [shapely.linestrings(np.vstack([ring, ring[:1]])) for ring in section.rings]
    )
    return shapely.build_area(lines)


def power_diagram(sites: Floats, weights: Floats, section: Section) -> Diagram:
    """The power diagram of sites (n, 2), mm, with weights (n,), mm², inside a section.

    The distance of a point to a site is d² − w. The diagram is the lower hull of the sites
    lifted to x² + y² − w (Aurenhammer, "Power diagrams", SIAM J. Comput. 1987).
    """
    if not section.rings:
        pairs = np.empty((0, 2), dtype=np.int64)
        return Diagram(np.empty((0, 2)), pairs, pairs, pairs)
    area = section_area(section)
    shapely.prepare(area)
    rings = shapely.boundary(area)
    lines = shapely.unary_union([rings, shapely.multilinestrings(_bisectors(sites, weights, area))])
    ends = np.vstack(
        [np.stack([c[:-1], c[1:]], axis=1) for c in map(shapely.get_coordinates, lines.geoms)]
    )
    middle = ends.mean(axis=1)
    along = ends[:, 1] - ends[:, 0]
    to_left = np.column_stack([-along[:, 1], along[:, 0]]) * 1e-6
    left_in = shapely.contains_xy(area, middle + to_left)
    right_in = shapely.contains_xy(area, middle - to_left)
    backwards = right_in & ~left_in
    ends[backwards] = ends[backwards, ::-1]
    to_left[backwards] *= -1
    boundary = left_in ^ right_in
    kept = left_in | right_in
    ends, middle, to_left, boundary = (part[kept] for part in (ends, middle, to_left, boundary))
    left = _owner(sites, weights, middle + to_left)
    right = np.where(boundary, OUTSIDE, _owner(sites, weights, middle - to_left))
    swapped = right > left
    ends[swapped] = ends[swapped, ::-1]
    pairs = np.sort(np.column_stack([right, left]), axis=1)
    vertices, edges = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
    inner = pairs[~boundary]
    return Diagram(
        vertices, edges.reshape(-1, 2), pairs, np.unique(inner[inner[:, 0] != inner[:, 1]], axis=0)
    )


def _bisectors(sites: Floats, weights: Floats, area: shapely.Geometry) -> Floats:
    """Edges (e, 2, 2) of the whole diagram, among them all that meet the area."""
    low, high = np.reshape(shapely.bounds(area), (2, 2))
    centre = (low + high) / 2
    reach = 64 * (np.abs(sites - centre).max() + (high - low).max() + np.sqrt(np.ptp(weights)))
    # Far sites all around make every cell bounded and every small or collinear input a plain one.
    far = centre + reach * np.array([[-1, -1.1], [1, -1], [1.1, 1], [-1, 1.2]])
    points = np.vstack([sites, far]) - centre
    heavy = np.concatenate([weights, np.full(4, weights.max())])
    hull = ConvexHull(np.column_stack([points, (points**2).sum(axis=1) - heavy]))
    lower = hull.equations[:, 2] < -1e-12
    normal = hull.equations[:, :3]
    centres = centre - normal[:, :2] / (2 * normal[:, 2:3])
    edges = [
        (centres[t], centres[u])
        for t in np.nonzero(lower)[0]
        for u in hull.neighbors[t]
        if t < u and lower[u]
    ]
    return np.array(edges)


def _owner(sites: Floats, weights: Floats, points: Floats) -> Ints:
    """(k,) the site whose cell holds each point (k, 2)."""
    # In three dimensions, with √(w_max − w) as height, power distance is plain distance.
    heights = np.sqrt(weights.max() - weights)
    tree = KDTree(np.column_stack([sites, heights]))
    return np.asarray(tree.query(np.column_stack([points, np.zeros(len(points))]))[1])


def area_of(section):
    """The section as a shapely area (even-odd over its rings)."""
    rings = [shapely.linestrings(np.vstack([ring, ring[:1]])) for ring in section.rings]
    return shapely.build_area(shapely.multilinestrings(rings))


def power_edges(sites, weights):
    """Pairs (m, 2) and edges (m, 2, 2) of a whole power diagram: the lifted sites' lower hull.

    Four far sites keep the edges finite.
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
    across = number[hull.neighbors[lower]]
    pairs, edges = [], []
    for k in range(3):
        own = np.nonzero(across[:, k] > np.arange(len(lower)))[0]
        pairs.append(np.sort(corners[own][:, [(k + 1) % 3, (k + 2) % 3]], axis=1))
        edges.append(np.stack([vertices[own], vertices[across[own, k]]], axis=1))
    pairs, edges = np.concatenate(pairs), np.concatenate(edges)
    inner = pairs[:, 1] < len(sites)
    return pairs[inner], edges[inner]


def cut_edges(sites, weights, section):
    """Neighbours (m, 2) and their edges inside a section, as shapely lines."""
    area = area_of(section)
    shapely.prepare(area)
    pairs, edges = power_edges(sites, weights)
    lines = shapely.linestrings(edges)
    whole = shapely.contains_properly(area, lines)
    cut = np.where(whole, lines, None)
    cut[~whole] = shapely.intersection(area, lines[~whole])
    kept = shapely.length(cut) > 0
    return pairs[kept], cut[kept]


def spanning_tree(sites, pairs):
    """The minimum spanning tree's pairs."""
    lengths = np.hypot(*(sites[pairs[:, 0]] - sites[pairs[:, 1]]).T)
    graph = coo_array((lengths, pairs.T), (len(sites), len(sites))).tocsr()
    tree = minimum_spanning_tree(graph).tocoo()
    return np.sort(np.column_stack([tree.row, tree.col]), axis=1)


def layer(sites, weights, section):
    """What the engine makes of a layer, the slow way: neighbours, edges, tree."""
    pairs, lines = cut_edges(sites, weights, section)
    return pairs, shapely.get_coordinates(lines), spanning_tree(sites, pairs)


def cells(sites, weights, section):
    """Each site's part of the section, as shapely areas: half-planes against all other sites."""
    area = area_of(section)
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
            polygon = _half_plane(polygon, bound - polygon @ normal)
        found.append(
            shapely.intersection(shapely.polygons(polygon), area)
            if len(polygon) > 2
            else shapely.Polygon()
        )
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
