"""The oracle: a power diagram by qhull's lifted hull, noded against the rings by GEOS."""

from __future__ import annotations

import numpy as np
import shapely
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
