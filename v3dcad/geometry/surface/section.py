"""Sections of a part's true surfaces: topology from the mesh, geometry from exact roots.

A plane crosses a mesh edge once (see `mesh`): the crossing is the root of the height
along the edge's true curve, bracketed by its nodes. Between two crossings on one face the
section is an exact line or conic where the surface is known to have one, and is otherwise
followed by points on {z(u, v) = h}, halved until every chord is within the tolerance.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    FloatArray,
    FloatRows,
)
from v3dcad.geometry.compiled.options import ENTRY, compiled
from v3dcad.geometry.mesh.section import (
    SNAP,
    Crossings,
    MeshEdges,
    at_base,
    check_heights,
    cross_planes,
    tasks,
)
from v3dcad.geometry.surface.conics import NO_CONIC, conic_at
from v3dcad.geometry.surface.curves import LINE
from v3dcad.geometry.surface.gaps import repaired
from v3dcad.geometry.surface.level_curves import CurveRings, trace
from v3dcad.geometry.surface.mesh import MeshArrays, SurfaceMesh, along_edge
from v3dcad.model import CurveRun, Floats, Ints, Mesh, Section
from v3dcad.settings import SectionSettings

CHORD_TOLERANCE = SectionSettings().chord_tolerance
"""mm: how far a ring's chords may lie from the true section."""

CURVES = ("points", "line", "circle", "ellipse")


def section_surface(
    mesh: SurfaceMesh,
    heights: Floats,
    chord_tolerance: float = CHORD_TOLERANCE,
    executor: Executor | None = None,
) -> Iterator[Section]:
    """Sections at ascending heights (k,), mm; rings within `chord_tolerance` (mm) of the true ones.

    Each is the limit from below, at the part's lowest height from above. Runs say which stretch
    of a ring lies on which face, and as what exact curve. With an executor (of threads, of
    processes, or a cluster's) several planes are computed at a time; results are the same.
    `SettingError` for a tolerance that is not above 0, `GeometryError` where heights do not
    ascend.
    """
    SectionSettings(chord_tolerance=chord_tolerance)  # checks it
    check_heights(heights)
    if executor is None:
        return _cut(mesh, heights, chord_tolerance)
    waiting = [executor.submit(_cut_all, mesh, task, chord_tolerance) for task in tasks(heights)]
    return (section for future in waiting for section in future.result())


def _cut_all(mesh: SurfaceMesh, heights: Floats, chord_tolerance: float) -> list[Section]:
    return list(_cut(mesh, heights, chord_tolerance))


def _cut(mesh: SurfaceMesh, heights: Floats, chord_tolerance: float) -> Iterator[Section]:
    first = 0
    planes_at = at_base(heights, mesh.nodes)
    coarse = Mesh(mesh.nodes, mesh.triangles)
    edges = MeshEdges(mesh.edge_nodes, mesh.sides)
    arrays = mesh.arrays()
    for count, coarse_crossings in cross_planes(coarse, edges, planes_at):
        of_batch = planes_at[first : first + count]
        planes = np.repeat(coarse_crossings.planes, np.diff(coarse_crossings.starts))
        points, shares = _roots(arrays, coarse_crossings, of_batch[planes])
        crossings = coarse_crossings._replace(points=points)
        ring_heights = of_batch[crossings.planes]
        rings = trace(arrays, crossings, shares, ring_heights, chord_tolerance)
        if mesh.gaps.any():
            rings = repaired(arrays, rings, ring_heights)
        yield from _sections(heights[first : first + count], crossings.planes, rings)
        first += count


def _sections(heights: Floats, planes: Ints, found: CurveRings) -> Iterator[Section]:
    """The rings and runs of all planes, whose numbers (r,) ascend, plane by plane."""
    points, starts, runs, parameters = found
    rings = list(zip(starts[:-1].tolist(), starts[1:].tolist(), strict=True))
    first_ring = np.searchsorted(planes, np.arange(len(heights) + 1)).tolist()
    first_run = np.searchsorted(runs[:, 0], first_ring).tolist()
    # Column by column: a list for each row would keep Python's garbage collector busy.
    ring_of, start, stop, curve, face = runs.T.tolist()
    columns = parameters.T.tolist()
    sizes = (0, 0, 3, 5)
    for plane, z in enumerate(heights.tolist()):
        ring_ids = range(first_ring[plane], first_ring[plane + 1])
        kept = [ring for ring in ring_ids if rings[ring][1] > rings[ring][0]]
        number_of = {ring: number for number, ring in enumerate(kept)}
        yield Section(
            z=z,
            rings=tuple(points[slice(*rings[ring])] for ring in kept),
            runs=tuple(
                CurveRun(
                    number_of[ring_of[k]],
                    start[k],
                    stop[k],
                    CURVES[curve[k]],
                    face[k],
                    tuple([column[k] for column in columns[: sizes[curve[k]]]]),
                )
                for k in range(first_run[plane], first_run[plane + 1])
            ),
        )


@compiled(ENTRY)
def _roots(
    mesh: MeshArrays, crossings: Crossings, heights: ConstFloatArray
) -> tuple[FloatRows, FloatArray]:
    """Move crossings (p,) from the mesh's chords to the true curves, at heights (p,), mm.

    Returns points (p, 2), mm, and shares (p,) of the way along the edges.
    """
    coefficients, surfaces, nodes = mesh.coefficients, mesh.surfaces, mesh.nodes
    edge_nodes, edge_faces = mesh.edge_nodes, mesh.edge_faces
    edge_curves, edge_spans = mesh.edge_curves, mesh.edge_spans
    edges = crossings.edges
    points = crossings.points.copy()
    shares = np.empty(len(edges))
    for index in range(len(edges)):
        edge, height = edges[index], heights[index]
        surface, curve = surfaces[edge_faces[edge]], edge_curves[edge]
        first_z = nodes[edge_nodes[edge, 0], 2] - height
        last_z = nodes[edge_nodes[edge, 1], 2] - height
        if abs(first_z) < SNAP:
            shares[index] = 0.0
            continue
        if abs(last_z) < SNAP:
            shares[index] = 1.0
            continue
        share = first_z / (first_z - last_z)
        if curve >= 0:
            done = coefficients[curve] == LINE
        else:
            # Inside a face that is cut in a known curve, points only say which way it goes.
            x, y = points[index, 0], points[index, 1]
            done = conic_at(coefficients, surface, height, x, y).kind != NO_CONIC
        if not done:
            low, high = 0.0, 1.0
            for _ in range(60):
                x, y, z, slope = along_edge(coefficients, surface, curve, edge_spans[edge], share)
                points[index, 0], points[index, 1] = x, y
                rise = z - height
                if rise == 0.0:
                    break
                if (rise < 0) == (first_z < 0):
                    low = share
                else:
                    high = share
                step = rise / slope if slope != 0 else np.inf
                if abs(step) < 1e-16 or high - low < 1e-16:
                    break
                share -= step
                if not low < share < high:
                    share = (low + high) / 2
        shares[index] = share
    return points, shares
