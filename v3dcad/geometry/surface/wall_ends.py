"""Where walls end on the true surface: their ends, cut at the chords of contours, moved there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from v3dcad.geometry.compiled.arrays import ConstFloatArray, ConstFloatRows, FloatRows
from v3dcad.geometry.compiled.options import ENTRY, INTERNAL, compiled
from v3dcad.geometry.surface.contour_curves import Stretch, contours
from v3dcad.geometry.surface.mesh import SurfaceMesh, project
from v3dcad.geometry.surface.surfaces import step_to_line, surface_at
from v3dcad.model import CurveRun, Floats, Layer, Section

MAX_STARTS = 6
"""Points that Newton's method is started from."""

MAX_END_SHIFT = 0.1
"""mm; an end that would have to go farther stays: its wall runs along the surface."""


def exact_ends(layer: Layer, mesh: SurfaceMesh) -> Layer:
    """The layer with the ends of walls on its curved contours moved along them to the surface.

    `mesh` is the one that the layer's section was made from. Only runs of points need it: lines
    are exact, and circles and ellipses are known exactly. The moved ends become points of the
    rings, so that curves laid through these pass through the ends.
    """
    diagram, z = layer.diagram, layer.z
    walls = diagram.edges[diagram.inner()]
    behind = dict(np.concatenate([walls, walls[:, ::-1]]).tolist())
    found = contours(layer.section, diagram)
    points = diagram.vertices.copy()
    ends: dict[int, list[int]] = {}
    for contour in found:
        for stretch, following in zip(contour, contour[1:] + contour[:1], strict=True):
            end = stretch.chain[-1]
            if stretch.run.curve == "points" and stretch.run == following.run and end in behind:
                ends.setdefault(stretch.run.face, []).append(end)
    if not ends:
        return layer
    for face, ids in ends.items():
        ways = points[ids] - diagram.vertices[[behind[end] for end in ids]]
        corners = mesh.faces == face
        points[ids] = _on_surface(
            mesh.coefficients,
            mesh.surfaces[face],
            mesh.nodes[mesh.triangles[corners]].reshape(-1, 3),
            mesh.corners[corners].reshape(-1, 2),
            z,
            points[ids],
            ways,
        )
    rings, runs = [], []
    for number, contour in enumerate(found):
        ring, of_ring = _ring(number, contour, points)
        rings.append(ring)
        runs += of_ring
    section = Section(z, tuple(rings), tuple(runs))
    return replace(layer, section=section, diagram=replace(diagram, vertices=points))


def _ring(number: int, contour: list[Stretch], points: Floats) -> tuple[Floats, list[CurveRun]]:
    """A contour as a ring of points (k, 2) that begins where a run does, and its runs."""
    turns = (k for k in range(len(contour)) if contour[k].run != contour[k - 1].run)
    first = next(turns, 0)
    ids: list[int] = []
    runs: list[CurveRun] = []
    before: CurveRun | None = None
    for chain, run in contour[first:] + contour[:first]:
        start = runs.pop().start if run == before else len(ids)
        ids += chain[:-1]
        runs.append(run._replace(ring=number, start=start, stop=len(ids)))
        before = run
    return points[ids], runs


@compiled(INTERNAL)
def _solved(
    coefficients: ConstFloatArray,
    surface: int,
    height: float,
    end: ConstFloatArray,
    way: ConstFloatArray,
    u: float,
    v: float,
) -> tuple[float, float, float, float, bool]:
    """Newton's method on z(u, v) = height and (x, y) on the line.

    Returns u, v, x, y, and whether it converged.
    """
    length = np.hypot(way[0], way[1])
    across_x, across_y = -way[1] / length, way[0] / length
    for _ in range(20):
        s = surface_at(coefficients, surface, u, v)
        rise = s[0][2] - height
        aside = (s[0][0] - end[0]) * across_x + (s[0][1] - end[1]) * across_y
        if max(abs(rise), abs(aside)) < 1e-12:
            break
        solvable, u_step, v_step = step_to_line(s, rise, aside, across_x, across_y)
        if not solvable:
            break
        u -= u_step
        v -= v_step
    s = surface_at(coefficients, surface, u, v)
    aside = (s[0][0] - end[0]) * across_x + (s[0][1] - end[1]) * across_y
    settled = abs(s[0][2] - height) < 1e-9 and abs(aside) < 1e-9
    return u, v, s[0][0], s[0][1], settled


@compiled(ENTRY)
def _on_surface(
    coefficients: ConstFloatArray,
    surface: int,
    nodes: ConstFloatRows,
    corners: ConstFloatRows,
    height: float,
    ends: ConstFloatRows,
    ways: ConstFloatRows,
) -> FloatRows:
    """Ends (k, 2) moved along lines (k, 2) to where z(u, v) = height, by Newton's method.

    It starts from the nearest of the face's mesh corners (their points and parameters), and from
    the next ones where the result is off the face: along a seam corners lie on both of its sides.
    """
    moved = ends.copy()
    low_u = low_v = np.inf
    high_u = high_v = -np.inf
    for corner in range(len(corners)):
        low_u, high_u = min(low_u, corners[corner, 0]), max(high_u, corners[corner, 0])
        low_v, high_v = min(low_v, corners[corner, 1]), max(high_v, corners[corner, 1])
    slack_u, slack_v = 1e-9 * (high_u - low_u), 1e-9 * (high_v - low_v)
    distances = np.empty(len(nodes))
    point = np.empty(3)
    for k in range(len(ends)):
        point[0], point[1], point[2] = ends[k, 0], ends[k, 1], height
        for corner in range(len(nodes)):
            distances[corner] = 0.0
            for axis in range(3):
                distances[corner] += (nodes[corner, axis] - point[axis]) ** 2
        for _ in range(MAX_STARTS):
            nearest = 0
            for corner in range(1, len(nodes)):
                if distances[corner] < distances[nearest]:
                    nearest = corner
            start_u, start_v = corners[nearest, 0], corners[nearest, 1]
            u, v = project(coefficients, surface, point, start_u, start_v)
            u, v, x, y, settled = _solved(coefficients, surface, height, ends[k], ways[k], u, v)
            on_face = (
                low_u - slack_u <= u <= high_u + slack_u
                and low_v - slack_v <= v <= high_v + slack_v
            )
            if settled and on_face and np.hypot(x - ends[k, 0], y - ends[k, 1]) < MAX_END_SHIFT:
                moved[k, 0], moved[k, 1] = x, y
                break
            for corner in range(len(nodes)):  # not from here again
                if corners[corner, 0] == start_u and corners[corner, 1] == start_v:
                    distances[corner] = np.inf
    return moved
