"""The layer loop, compiled: some layers at a time, from section rings to diagrams in long arrays.

For each layer: flip to its height, walk its rings, count cells, give births, and, only where one
of these has changed the graph, cut it anew; otherwise only the vertices have moved.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.core.types import NamedTuple as TupleType

from v3dcad.geometry.clip import (
    EDGE,
    FLOAT_ROWS,
    FLOATS,
    INTO,
    ROWS,
    SEGMENT,
    count_cells,
    cut_graph,
    place_vertices,
    unchain,
    walk_rings,
    wind,
)
from v3dcad.geometry.exact import COMPILED, WORD
from v3dcad.geometry.kinetics import CHANGES, MOTION, STRUTS, advance
from v3dcad.geometry.tree import spanning_tree
from v3dcad.geometry.triangulation import MESH, POINTS, SENTINELS
from v3dcad.structure.births import give_births

DONE, NEEDS_ROOM, OVERLAPPING, OPEN_WALK = range(4)
"""How a run ended: after its last layer, for want of room, or at a layer whose rings overlap (run
the wrong way round) or could not be walked."""

STATUS, LAYERS, ROOM = range(3)
"""What a run's `outcome` holds: how it ended, how many layers it made, and for how many points
it needs room."""

INTS, INT_ROWS = types.int64[::1], types.int64[:, ::1]


class Rings(NamedTuple):
    """The rings of some layers' sections."""

    corners: Any
    """(r, 2) float64 mm"""
    starts: Any
    """(rings + 1,) int64: where each ring begins"""
    layers: Any
    """(layers + 1,) int64: where each layer's rings begin"""


class Run(NamedTuple):
    """What a run of the layer loop made. Arrays of all layers one behind the other."""

    outcome: Any
    """(3,) int64"""
    points: Any
    """(layers,) int64: how many points there were, sentinels among them"""
    cells: Any
    """(layers,) int64"""
    areas: Any
    """(layers,) float64: the sections' areas, mm²"""
    graphs: Any
    """(layers,) int64: which graph is the layer's"""
    vertices: Any
    """(v, 2) float64 mm"""
    vertex_rows: Any
    """(layers + 1,) int64"""
    edges: Any
    """(e, 2) int64"""
    sites: Any
    """(e, 2) int64"""
    edge_rows: Any
    """(graphs + 1,) int64"""
    neighbours: Any
    """(m, 2) int64"""
    neighbour_rows: Any
    """(graphs + 1,) int64"""
    tree: Any
    """(k, 2) int64"""
    tree_rows: Any
    """(graphs + 1,) int64"""


RINGS = TupleType([FLOAT_ROWS, INTS, INTS], Rings)
_ROWS_OF_GRAPHS = [INT_ROWS, INT_ROWS, INTS, INT_ROWS, INTS, INT_ROWS, INTS]
RUN = TupleType([INTS, INTS, INTS, FLOATS, INTS, FLOAT_ROWS, INTS, *_ROWS_OF_GRAPHS], Run)


@njit(INT_ROWS(INT_ROWS, WORD, INT_ROWS), **COMPILED)
def _append(pool, length, rows):  # type: ignore[no-untyped-def]
    """Write rows into a pool from `length` on; returns the pool, longer where it was too short."""
    if length + len(rows) > len(pool):
        longer = np.empty((2 * (length + len(rows)), 2), np.int64)
        longer[:length] = pool[:length]
        pool = longer
    for row in range(len(rows)):
        pool[length + row, 0], pool[length + row, 1] = rows[row, 0], rows[row, 1]
    return pool


@njit(types.boolean(ROWS, WORD, ROWS, WORD), **COMPILED)
def _same_crossings(before, count_before, now, count):  # type: ignore[no-untyped-def]
    if count != count_before:
        return False
    for crossing in range(count):
        if (
            before[crossing, EDGE] != now[crossing, EDGE]
            or before[crossing, SEGMENT] != now[crossing, SEGMENT]
            or before[crossing, INTO] != now[crossing, INTO]
        ):
            return False
    return True


@njit(types.float64(FLOAT_ROWS, INTS), **COMPILED)
def signed_area(corners, starts):  # type: ignore[no-untyped-def]
    """Area between rings, mm²: positive where outer rings run counter-clockwise."""
    double = 0.0
    for ring in range(len(starts) - 1):
        first = starts[ring]
        for corner in range(first + 1, starts[ring + 1] - 1):
            px, py = corners[corner, 0] - corners[first, 0], corners[corner, 1] - corners[first, 1]
            qx, qy = (
                corners[corner + 1, 0] - corners[first, 0],
                corners[corner + 1, 1] - corners[first, 1],
            )
            double += px * qy - py * qx
    return double / 2


@njit(
    RUN(MESH, MOTION, INTS, INTS, RINGS, INTS, *[types.float64] * 5),
    **COMPILED,
)
def run(  # type: ignore[no-untyped-def]
    mesh, motion, site_of, point_of, rings, times, left, low, pitch, reach, full_cell
):
    """Make the layers at ascending whole `times` (layers,), as far as there is room.

    `site_of` (p,) gives each point's site and `point_of` each site's point; (`left`, `low`), mm,
    and `pitch` the grid. Births are given where the area per cell is above `full_cell`, mm²
    (infinite: none), at a distance of `reach` grid steps per step of growth.
    """
    layers = len(times)
    outcome = np.zeros(3, np.int64)
    points, cells = np.zeros(layers, np.int64), np.zeros(layers, np.int64)
    graphs = np.zeros(layers, np.int64)
    areas = np.zeros(layers)
    vertex_rows = np.zeros(layers + 1, np.int64)
    edge_rows, tree_rows = np.zeros(layers + 1, np.int64), np.zeros(layers + 1, np.int64)
    neighbour_rows = np.zeros(layers + 1, np.int64)
    live = mesh.count[POINTS]
    vertices = np.empty((layers * 2 * live + 2 * len(rings.corners), 2))
    edges, sites = np.empty((4 * live, 2), np.int64), np.empty((4 * live, 2), np.int64)
    neighbours, tree = np.empty((4 * live, 2), np.int64), np.empty((live, 2), np.int64)
    slots = len(mesh.triangles)
    first_on = np.full(3 * slots, -1, np.int32)
    inside = np.zeros(slots, np.int8)
    seen, token = np.zeros(len(mesh.points), np.int32), 0
    crossings, at = np.empty((64, 4), np.int32), np.empty(64)
    before, at_before = np.empty((64, 4), np.int32), np.empty(64)
    next_on = np.empty(64, np.int32)
    count_before, changes, graph, live_cells = -1, -1, -1, 0
    begun_before, starts_before = np.empty(0, np.int32), np.empty(0, np.int64)
    struts = np.empty((0, 4))
    for layer in range(layers):
        if not advance(mesh, motion, times[layer]):
            outcome[STATUS] = NEEDS_ROOM
            break
        ring_starts = rings.starts[rings.layers[layer] : rings.layers[layer + 1] + 1]
        corners = rings.corners[ring_starts[0] : ring_starts[-1]]
        starts = ring_starts - ring_starts[0]
        areas[layer] = signed_area(corners, starts)
        stepped = np.empty_like(corners)
        for corner in range(len(corners)):
            stepped[corner, 0] = (corners[corner, 0] - left) / pitch
            stepped[corner, 1] = (corners[corner, 1] - low) / pitch
        begun_in = np.empty(len(starts) - 1, np.int32)
        born, failed = 0, False
        while True:
            count, crossings, at = walk_rings(mesh, stepped, starts, begun_in, crossings, at)
            if count < 0:
                outcome[STATUS], failed = OPEN_WALK, True
                break
            fresh = (
                changes != motion.state[CHANGES]
                or not np.array_equal(starts, starts_before)
                or not np.array_equal(begun_in, begun_before)
                or not _same_crossings(before, count_before, crossings, count)
            )
            if fresh:
                if len(next_on) < len(at):
                    next_on = np.empty(len(at), np.int32)
                sound = wind(mesh, crossings, count, first_on, next_on, inside)
                if not sound or areas[layer] < 0:
                    outcome[STATUS], failed = OVERLAPPING, True
                    break
                token += 1
                live_cells = count_cells(mesh, begun_in, crossings, count, inside, seen, token)
            wanted = 0
            if born == 0 and areas[layer] > 0:
                wanted = int(np.ceil(areas[layer] / full_cell - 1e-9)) - live_cells
            if wanted <= 0:
                break
            room = mesh.count[POINTS] + wanted
            if (
                room > len(mesh.points)
                or len(motion.spans) - motion.state[STRUTS] < 8 * wanted + 64
            ):
                outcome[STATUS], outcome[ROOM] = NEEDS_ROOM, wanted
                failed = True
                break
            born = give_births(mesh, motion, inside, wanted, reach, full_cell / pitch / pitch)
            if born == 0:
                break
            if fresh:
                unchain(crossings, count, first_on)
            if not advance(mesh, motion, times[layer]):
                outcome[STATUS], failed = NEEDS_ROOM, True
                break
        if failed:
            break
        if fresh:
            graph += 1
            struts, cut_edges, cut_sites, pairs = cut_graph(
                mesh,
                motion,
                site_of,
                stepped,
                starts,
                begun_in,
                crossings,
                at,
                count,
                first_on,
                next_on,
                inside,
            )
            unchain(crossings, count, first_on)
            squared = np.empty(len(pairs), np.int64)
            for pair in range(len(pairs)):
                p, q = point_of[pairs[pair, 0]], point_of[pairs[pair, 1]]
                dx = mesh.points[p, 0] - mesh.points[q, 0]
                dy = mesh.points[p, 1] - mesh.points[q, 1]
                squared[pair] = dx * dx + dy * dy
            branches = spanning_tree(pairs, squared, mesh.count[POINTS] - SENTINELS)
            edges = _append(edges, edge_rows[graph], cut_edges)
            sites = _append(sites, edge_rows[graph], cut_sites)
            neighbours = _append(neighbours, neighbour_rows[graph], pairs)
            tree = _append(tree, tree_rows[graph], branches)
            edge_rows[graph + 1] = edge_rows[graph] + len(cut_edges)
            neighbour_rows[graph + 1] = neighbour_rows[graph] + len(pairs)
            tree_rows[graph + 1] = tree_rows[graph] + len(branches)
            changes, starts_before, begun_before = motion.state[CHANGES], starts, begun_in
        row = vertex_rows[layer]
        needed = row + len(struts) + len(corners) + count
        if needed > len(vertices):
            longer = np.empty((2 * needed, 2))
            longer[:row] = vertices[:row]
            vertices = longer
        vertex_rows[layer + 1] = place_vertices(
            struts,
            times[layer],
            corners,
            starts,
            crossings,
            at,
            count,
            left,
            low,
            pitch,
            vertices,
            row,
        )
        before, crossings, count_before = crossings, before, count
        at_before, at = at, at_before
        points[layer], cells[layer], graphs[layer] = mesh.count[POINTS], live_cells, graph
        outcome[LAYERS] = layer + 1
    return Run(
        outcome,
        points,
        cells,
        areas,
        graphs,
        vertices,
        vertex_rows,
        edges,
        sites,
        edge_rows,
        neighbours,
        neighbour_rows,
        tree,
        tree_rows,
    )
