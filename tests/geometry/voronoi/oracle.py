"""scipy's Voronoi diagram as an oracle: walls, their corners, and cells."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull, Voronoi


def scattered(count, seed, steps=1 << 20):
    """Distinct whole sites (n, 3) in a cube of so many steps."""
    rng = np.random.default_rng(seed)
    return rng.permutation(np.unique(rng.integers(0, steps, (count, 3)), axis=0))


def walls(places):
    """The corners of each bounded wall, by its two sites, ascending."""
    diagram = Voronoi(places)
    return {
        tuple(sorted(pair)): diagram.vertices[ridge]
        for pair, ridge in zip(diagram.ridge_points.tolist(), diagram.ridge_vertices, strict=True)
        if -1 not in ridge
    }


def volumes(places, wanted):
    """The volumes of bounded cells."""
    diagram = Voronoi(places)
    regions = [diagram.regions[diagram.point_region[site]] for site in wanted]
    return np.array([ConvexHull(diagram.vertices[region]).volume for region in regions])


def steepest(places, low, high):
    """The greatest |Δz|² / |Δxy|² of walls with a corner well within a box."""
    worst = 0.0
    for (i, j), corners in walls(places).items():
        if ((corners > low) & (corners < high)).all(axis=1).any():
            x, y, z = (places[j] - places[i]).tolist()
            worst = max(worst, z * z / (x * x + y * y) if x or y else np.inf)
    return worst
