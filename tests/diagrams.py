"""Layers for tests: ordinary Voronoi diagrams cut by shapely, made without v3dcad's engine."""

from __future__ import annotations

import math

import numpy as np
import shapely
from scipy.spatial import Voronoi

from v3dcad.formats.gcode.machine_profile import read_profile
from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.model import CurveRun, Diagram, Floats, Layer, Section
from v3dcad.structure.thesis.sites import PlaneSites

WIDE = {
    name: value
    for name, value in read_profile("thesis").items()
    if name not in ("start_gcode", "end_gcode")
}
"""Print settings of the thesis: one slow bead of 0.8 × 0.2 mm, neither skirt nor prime line."""


def scattered(count: int, half: float, seed: int) -> Floats:
    """(count, 2) sites in the square from -half to half, kept apart by rejection."""
    random = np.random.default_rng(seed)
    side = 2 * half / math.ceil(math.sqrt(count))
    grid = np.stack(np.meshgrid(*[np.arange(-half, half - 1e-9, side)] * 2), axis=-1)
    places = grid.reshape(-1, 2)
    chosen = places[np.sort(random.permutation(len(places))[:count])]
    return chosen + random.uniform(0.15, 0.85, chosen.shape) * side


def voronoi(sites: Floats, section: Section) -> Diagram:
    """The Voronoi diagram of the sites inside a section, in the convention of `Diagram`."""
    area = area_of(section)
    far = 20 * np.abs(section.rings[0]).max()
    guards = far * np.array([[1, 0.1], [-0.1, 1], [-1, -0.1], [0.1, -1]])
    diagram = Voronoi(np.concatenate([sites, guards]))
    ids: dict[tuple[float, float], int] = {}
    edges: list[tuple[int, int]] = []
    beside: list[tuple[int, int]] = []

    def vertex(point: Floats) -> int:
        return ids.setdefault((round(float(point[0]), 9), round(float(point[1]), 9)), len(ids))

    on_rim: list[Floats] = []
    for pair, ridge in zip(diagram.ridge_points, diagram.ridge_vertices, strict=True):
        low, high = sorted(pair.tolist())
        if high >= len(sites) or -1 in ridge:
            continue
        ends = diagram.vertices[ridge]
        if not np.abs(ends).max() < 1e6:
            continue
        across = diagram.points[high] - diagram.points[low]
        along = ends[1] - ends[0]
        if along[0] * across[1] - along[1] * across[0] < 0:
            ends = ends[::-1]
        for part in shapely.get_parts(shapely.intersection(area, shapely.LineString(ends))):
            points = shapely.get_coordinates(part)
            if len(points) < 2:
                continue
            if np.dot(points[-1] - points[0], ends[1] - ends[0]) < 0:
                points = points[::-1]
            edges.append((vertex(points[0]), vertex(points[-1])))
            beside.append((low, high))
            on_rim += [
                point for point in points if area.boundary.distance(shapely.Point(point)) < 1e-9
            ]
    crossings = np.array(on_rim).reshape(-1, 2)
    for ring in section.rings:
        points = _with_points(ring, crossings)
        following = np.roll(points, -1, axis=0)
        middle = (points + following) / 2
        nearest = np.argmin(
            np.hypot(*(middle[:, None] - sites[None]).transpose(2, 0, 1)), axis=1
        ).tolist()
        for start, stop, site in zip(points, following, nearest, strict=True):
            edges.append((vertex(start), vertex(stop)))
            beside.append((-1, site))
    edge_array = np.array(edges, dtype=np.int64).reshape(-1, 2)
    site_array = np.array(beside, dtype=np.int64).reshape(-1, 2)
    inner = site_array[:, 0] >= 0
    return Diagram(
        np.array(list(ids), dtype=np.float64).reshape(-1, 2),
        edge_array,
        site_array,
        np.unique(site_array[inner], axis=0),
    )


def _with_points(ring: Floats, extra: Floats) -> Floats:
    """A ring with those of the extra points that lie on it put in their places."""
    parts = []
    for start, stop in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        side = stop - start
        length = np.hypot(*side)
        along = (extra - start) @ side / length
        off = np.abs((extra - start) @ np.array([-side[1], side[0]])) / length
        on = extra[(off < 1e-8) & (along > 1e-8) & (along < length - 1e-8)]
        parts.append(np.vstack([start, on[np.argsort((on - start) @ side)]]))
    return np.concatenate(parts)


def area_of(section: Section) -> shapely.Geometry:
    """The section's area: outer rings counter-clockwise, holes clockwise."""
    polygons = [shapely.Polygon(ring) for ring in section.rings]
    outer = [p for p in polygons if p.exterior.is_ccw]
    holes = [p for p in polygons if not p.exterior.is_ccw]
    return shapely.union_all(outer).difference(shapely.union_all(holes))


def layer(sites: Floats, section: Section, index: int = 0) -> Layer:
    diagram = voronoi(sites, section)
    count = len(sites)
    grid = Grid.around(np.array([-100.0, -100]), np.array([100.0, 100]))
    state = PlaneSites(grid, sites, np.zeros(count), np.zeros(count))
    return Layer(index, section, state, diagram, area_of(section).area / count)


def square(half: float, z: float = 0.0, hole: float = 0.0) -> Section:
    """A square section, with a square hole if asked for."""
    corners = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    rings = [half * corners] + ([hole * corners[::-1]] if hole else [])
    return Section(z, tuple(rings))


def disc(radius: float, z: float = 0.0, points: int = 96) -> Section:
    """A round section that knows that it is a circle."""
    angle = np.arange(points) / points * 2 * np.pi
    ring = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    return Section(z, (ring,), (CurveRun(0, 0, points, "circle", 0, (0.0, 0.0, radius)),))


def stack(count: int, sites: int = 12, half: float = 10.0, seed: int = 1) -> list[Layer]:
    """Layers 0.2 mm apart of a square block whose sites move a little from one to the next."""
    here = scattered(sites, half, seed)
    return [
        layer(here * (1 - 0.01 * number), square(half, 0.2 * number), number)
        for number in range(count)
    ]
