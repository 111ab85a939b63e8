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
    INT_ROWS,
    INTO,
    INTS,
    ROW,
    ROWS,
    SEGMENT,
    Graph,
    count_cells,
    cut_graph,
    link_corners,
    place_vertices,
    unchain,
    walk_rings,
    wind,
)
from v3dcad.geometry.exact import COMPILED, INTERNAL, WORD
from v3dcad.geometry.kinetics import CHANGES, MOTION, STRUTS, advance
from v3dcad.geometry.tree import COUNT as BRANCHES
from v3dcad.geometry.tree import TREE, renew_tree
from v3dcad.geometry.triangulation import MESH, POINTS, SENTINELS, TRIANGLES
from v3dcad.structure.births import give_births

DONE, NEEDS_ROOM, OVERLAPPING, OPEN_WALK = range(4)
"""How a run ended: after its last layer, for want of room, or at a layer whose rings overlap (run
the wrong way round) or could not be walked."""

STATUS, LAYERS, ROOM = range(3)
"""What a run's `outcome` holds: how it ended, how many layers it made, and for how many points
it needs room."""


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


@njit(INT_ROWS(INT_ROWS, WORD, WORD), **INTERNAL)
def _with_room(pool, used, more):  # type: ignore[no-untyped-def]
    """The pool, or a longer one with its rows in `used`, so that there is room for `more`."""
    if used + more <= len(pool):
        return pool
    longer = np.empty((2 * (used + more), 2), np.int64)
    for row in range(used):
        longer[row, 0], longer[row, 1] = pool[row, 0], pool[row, 1]
    return longer


@njit(types.boolean(INTS, INTS), **INTERNAL)
def _same_numbers(before, now):  # type: ignore[no-untyped-def]
    if len(before) != len(now):
        return False
    for place in range(len(now)):  # noqa: SIM110
        if before[place] != now[place]:
            return False
    return True


@njit(types.boolean(ROW, ROW), **INTERNAL)
def _same_cells(before, now):  # type: ignore[no-untyped-def]
    if len(before) != len(now):
        return False
    for place in range(len(now)):  # noqa: SIM110
        if before[place] != now[place]:
            return False
    return True


@njit(types.boolean(ROWS, WORD, ROWS, WORD), **INTERNAL)
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


@njit(types.float64(FLOAT_ROWS, INTS), **INTERNAL)
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


@njit(RUN(MESH, MOTION, TREE, INTS, INT_ROWS, RINGS, INTS, *[types.float64] * 5), **COMPILED)
def run(  # type: ignore[no-untyped-def]
    mesh, motion, tree, site_of, places, rings, times, left, low, pitch, reach, full_cell
):
    """Make the layers at ascending whole `times` (layers,), as far as there is room.

    `tree` is that of the layer before. `site_of` (p,) gives each point's site, `places` (p, 2)
    each site's place in grid steps; (`left`, `low`), mm, and `pitch` the grid. Births are given
    where the area per cell is above `full_cell`, mm² (infinite: none), at a distance of `reach`
    grid steps per step of growth.
    """
    layers, slots = len(times), len(mesh.triangles)
    outcome = np.zeros(3, np.int64)
    points, cells = np.zeros(layers, np.int64), np.zeros(layers, np.int64)
    graphs, areas = np.zeros(layers, np.int64), np.zeros(layers)
    vertex_rows, edge_rows = np.zeros(layers + 1, np.int64), np.zeros(layers + 1, np.int64)
    neighbour_rows, tree_rows = np.zeros(layers + 1, np.int64), np.zeros(layers + 1, np.int64)
    some = 8 * mesh.count[POINTS] + 2 * len(rings.corners)
    vertices, edges = np.empty((some, 2)), np.empty((some, 2), np.int64)
    sites, neighbours = np.empty((some, 2), np.int64), np.empty((some, 2), np.int64)
    branches, end = np.empty((some, 2), np.int64), np.zeros(2, np.int64)
    keys, struts = np.empty(3 * slots, np.int32), np.empty((slots, 4))
    first_on, next_on = np.full(3 * slots, -1, np.int32), np.empty(64, np.int32)
    inside, seen, token = np.zeros(slots, np.int8), np.zeros(len(mesh.points), np.int32), 0
    crossings, at = np.empty((64, 4), np.int32), np.empty(64)
    before, at_before = np.empty((64, 4), np.int32), np.empty(64)
    starts_before, begun_before = np.empty(0, np.int64), np.empty(0, np.int32)
    changes, graph, count_before, live_cells, inner = -1, -1, 0, 0, 0
    for layer in range(layers):
        if not advance(mesh, motion, times[layer]):
            outcome[STATUS] = NEEDS_ROOM
            break
        rings_from, rings_to = rings.layers[layer], rings.layers[layer + 1]
        first = rings.starts[rings_from]
        corners = rings.corners[first : rings.starts[rings_to]]
        starts, after = (
            np.empty(rings_to - rings_from + 1, np.int64),
            np.empty(len(corners), np.int64),
        )
        for ring in range(len(starts)):
            starts[ring] = rings.starts[rings_from + ring] - first
        link_corners(starts, after)
        areas[layer] = signed_area(corners, starts)
        if areas[layer] < 0:
            outcome[STATUS] = OVERLAPPING
        stepped = np.empty((len(corners), 2))
        for corner in range(len(corners)):
            stepped[corner, 0] = (corners[corner, 0] - left) / pitch
            stepped[corner, 1] = (corners[corner, 1] - low) / pitch
        begun_in = np.empty(len(starts) - 1, np.int32)
        fresh, born, waited = False, 0, False
        while outcome[STATUS] == DONE:
            count, crossings, at = walk_rings(mesh, stepped, starts, after, begun_in, crossings, at)
            if count < 0 or areas[layer] < 0:
                outcome[STATUS] = OPEN_WALK if count < 0 else OVERLAPPING
                break
            fresh = not (
                changes == motion.state[CHANGES]
                and _same_numbers(starts_before, starts)
                and _same_cells(begun_before, begun_in)
                and _same_crossings(before, count_before, crossings, count)
            )
            if fresh:
                if len(next_on) < len(at):
                    next_on = np.empty(len(at), np.int32)
                if not wind(mesh, crossings, count, first_on, next_on, inside):
                    outcome[STATUS] = OVERLAPPING
                    break
                token += 1
                live_cells = count_cells(mesh, begun_in, crossings, count, inside, seen, token)
            wanted = 0
            if not waited:
                wanted = int(np.ceil(areas[layer] / full_cell - 1e-9)) - live_cells
            if wanted <= 0:
                break
            waited = True
            if (
                mesh.count[POINTS] + wanted > len(mesh.points)
                or len(motion.spans) - motion.state[STRUTS] < 8 * wanted + 64
            ):
                outcome[STATUS], outcome[ROOM] = NEEDS_ROOM, wanted
                break
            born = give_births(mesh, motion, inside, wanted, reach, full_cell / pitch / pitch)
            if born == 0:
                break
            for point in range(mesh.count[POINTS] - born, mesh.count[POINTS]):
                places[site_of[point], 0] = mesh.points[point, 0]
                places[site_of[point], 1] = mesh.points[point, 1]
            if fresh:
                unchain(crossings, count, first_on)
            if not advance(mesh, motion, times[layer]):
                outcome[STATUS] = NEEDS_ROOM
        if outcome[STATUS] != DONE:
            break
        if fresh:
            graph += 1
            room = 2 * mesh.count[TRIANGLES] + len(corners) + 2 * count
            edges, sites = _with_room(edges, end[0], room), _with_room(sites, end[0], room)
            neighbours = _with_room(neighbours, end[1], room)
            inner, end[0], end[1] = cut_graph(
                mesh,
                motion,
                site_of,
                stepped,
                starts,
                after,
                begun_in,
                crossings,
                at,
                count,
                first_on,
                next_on,
                inside,
                Graph(edges, sites, neighbours, end, keys, struts),
            )
            unchain(crossings, count, first_on)
            first_pair = neighbour_rows[graph]
            renew_tree(
                tree,
                places,
                neighbours,
                keys[: end[1] - first_pair],
                first_pair,
                mesh.count[POINTS] - SENTINELS,
            )
            row = tree_rows[graph]
            branches = _with_room(branches, row, tree.state[BRANCHES])
            for branch in range(tree.state[BRANCHES]):
                key = tree.branches[branch]
                branches[row, 0], branches[row, 1] = tree.first[key], tree.second[key]
                row += 1
            edge_rows[graph + 1], neighbour_rows[graph + 1], tree_rows[graph + 1] = (
                end[0],
                end[1],
                row,
            )
            changes, starts_before, begun_before = motion.state[CHANGES], starts, begun_in
        row = vertex_rows[layer]
        room = inner + len(corners) + count
        if row + room > len(vertices):
            longer = np.empty((2 * (row + room), 2))
            for vertex in range(row):
                longer[vertex, 0], longer[vertex, 1] = vertices[vertex, 0], vertices[vertex, 1]
            vertices = longer
        vertex_rows[layer + 1] = place_vertices(
            struts,
            inner,
            times[layer],
            corners,
            after,
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
        branches,
        tree_rows,
    )
