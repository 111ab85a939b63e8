"""The layer loop, compiled: some layers at a time, from section rings to diagrams in long arrays.

For each layer: flip to its height, walk its rings, count cells, give births, and, only where one
of these has changed the graph, cut it anew; otherwise only the vertices have moved.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.core.types import NamedTuple as TupleType

from v3dcad.geometry.agenda import EVERYTHING, LAST, MOTION, STRUTS, TOUCHED
from v3dcad.geometry.cut import count_cells, renew_cut
from v3dcad.geometry.exact import COMPILED, INTERNAL, WORD
from v3dcad.geometry.flips import MESH, POINTS
from v3dcad.geometry.graph import place_vertices, write_edges
from v3dcad.geometry.inside import CROSSED, CUT, MOST, VERTICES, WHOLE
from v3dcad.geometry.kinetics import advance
from v3dcad.geometry.linking import linked
from v3dcad.geometry.tree import TREE, renew_tree, write_tree
from v3dcad.geometry.walk import (
    EDGE,
    FLOAT_ROWS,
    FLOATS,
    INT_ROWS,
    INTO,
    INTS,
    ROW,
    ROWS,
    SEGMENT,
    link_corners,
    walk_rings,
)
from v3dcad.structure.births import SQUARES, give_births
from v3dcad.structure.holes import SHORTLIST

DONE, NEEDS_ROOM, JAMMED, EPOCH_OVER, OPEN_WALK = range(5)
"""How a run ended: after its last layer, for want of room or with a jam (as `advance` says), before
a layer of the next epoch, or at one whose rings could not be walked."""

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
    pair_rows: Any
    """(graphs,) int64: up to where edges join each pair of neighbours once"""
    tree: Any
    """(k, 2) int64"""
    tree_rows: Any
    """(graphs + 1,) int64"""


RINGS = TupleType([FLOAT_ROWS, INTS, INTS], Rings)
_ROWS_OF_GRAPHS = [INT_ROWS, INT_ROWS, INTS, INTS, INT_ROWS, INTS]
RUN = TupleType([INTS, INTS, INTS, FLOATS, INTS, FLOAT_ROWS, INTS, *_ROWS_OF_GRAPHS], Run)


@linked(INT_ROWS(INT_ROWS, WORD, WORD), **INTERNAL)
def _with_room(pool, used, more):  # type: ignore[no-untyped-def]
    """The pool, or a longer one with its rows in `used`, so that there is room for `more`."""
    if used + more <= len(pool):
        return pool
    longer = np.empty((2 * (used + more), 2), np.int64)
    for row in range(used):
        longer[row, 0], longer[row, 1] = pool[row, 0], pool[row, 1]
    return longer


@njit([types.boolean(INTS, INTS), types.boolean(ROW, ROW)], **INTERNAL)
def _same_numbers(before, now):  # type: ignore[no-untyped-def]
    if len(before) != len(now):
        return False
    for place in range(len(now)):  # noqa: SIM110
        if before[place] != now[place]:
            return False
    return True


@linked(types.boolean(ROWS, WORD, ROWS, WORD), **INTERNAL)
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


@linked(types.float64(FLOAT_ROWS, INTS), **INTERNAL)
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


@linked(types.boolean(MESH, MOTION, ROW, WORD), **INTERNAL)
def _touches(mesh, motion, seen, token):  # type: ignore[no-untyped-def]
    """Whether a touched triangle is at a cell that rings pass."""
    if motion.state[TOUCHED] == EVERYTHING:
        return True
    for place in range(motion.state[TOUCHED]):
        triangle = motion.touched[place]
        for k in range(3):
            cell = mesh.triangles[triangle, k]
            if cell >= 0 and seen[cell] == token:
                return True
    return False


@njit(
    RUN(MESH, MOTION, CUT, TREE, SQUARES, SHORTLIST, INTS, RINGS, INTS, *[types.float64] * 5),
    **COMPILED,
)
def run(  # type: ignore[no-untyped-def]
    mesh, motion, cut, tree, squares, shortlist, site_of, rings, times, left, low, pitch, reach,
    full_cell,
):  # fmt: skip
    """Make the layers at ascending whole `times` (layers,), as far as there is room.

    `cut` and `tree` are those of the layer before. `site_of` (p,) gives each point's site;
    (`left`, `low`), mm, and `pitch` say where the grid lies. Births are given where the area per
    cell is above `full_cell`, mm² (infinite: none), at a distance of `reach` grid steps per step
    of growth.
    """
    layers = len(times)
    outcome = np.zeros(3, np.int64)
    points, cells = np.zeros(layers, np.int64), np.zeros(layers, np.int64)
    graphs, areas = np.zeros(layers, np.int64), np.zeros(layers)
    vertex_rows, edge_rows = np.zeros(layers + 1, np.int64), np.zeros(layers + 1, np.int64)
    pair_rows, tree_rows = np.zeros(layers + 1, np.int64), np.zeros(layers + 1, np.int64)
    # As much room as before, and a little more; else arrays grow as they fill.
    some = layers * (cut.state[VERTICES] + 2 * cut.state[CROSSED] + 64) + 2 * len(rings.corners)
    many = some + some // 2
    vertices, edges = np.empty((some, 2)), np.empty((many, 2), np.int64)
    sites, branches = np.empty((many, 2), np.int64), np.empty((some, 2), np.int64)
    next_on, seen, token = np.empty(64, np.int32), np.zeros(len(mesh.points), np.int32), 0
    crossings, at = np.empty((64, 4), np.int32), np.empty(64)
    before, at_before = np.empty((64, 4), np.int32), np.empty(64)
    starts_before, begun_before = np.empty(0, np.int64), np.empty(0, np.int32)
    graph, count, count_before, live_cells = -1, 0, 0, 0
    for layer in range(layers):
        if times[layer] > motion.state[LAST]:
            outcome[STATUS] = EPOCH_OVER
            break
        outcome[STATUS] = advance(mesh, motion, times[layer])
        if outcome[STATUS] != DONE:
            break
        rings_from, rings_to = rings.layers[layer], rings.layers[layer + 1]
        first = rings.starts[rings_from]
        corners = rings.corners[first : rings.starts[rings_to]]
        starts = rings.starts[rings_from : rings_to + 1] - first
        after, stepped = np.empty(len(corners), np.int64), np.empty((len(corners), 2))
        link_corners(corners, starts, left, low, pitch, after, stepped)
        areas[layer] = signed_area(corners, starts)
        begun_in = np.empty(len(starts) - 1, np.int32)
        fresh, born, walked = False, 0, True
        while True:
            if walked:
                count, crossings, at = walk_rings(
                    mesh, stepped, starts, after, begun_in, crossings, at
                )
                if count < 0:
                    outcome[STATUS] = OPEN_WALK
                    break
            if (
                born > 0
                or graph < 0
                or motion.state[TOUCHED] != 0
                or not _same_numbers(starts_before, starts)
                or not _same_numbers(begun_before, begun_in)
                or not _same_crossings(before, count_before, crossings, count)
            ):
                fresh = True
                if len(next_on) < len(at):
                    next_on = np.empty(len(at), np.int32)
                renew_cut(mesh, motion, cut, site_of, crossings, count, next_on, walked)
                token += 1
                live_cells = count_cells(cut, begun_in, crossings, count, seen, token)
            wanted = int(np.ceil(areas[layer] / full_cell - 1e-9)) - live_cells
            if born > 0 or wanted <= 0:
                break
            if (
                mesh.count[POINTS] + wanted > len(mesh.points)
                or len(motion.spans) - motion.state[STRUTS] < 8 * wanted + 64
            ):
                outcome[STATUS], outcome[ROOM] = NEEDS_ROOM, wanted
                break
            born = give_births(
                mesh, motion, cut, squares, shortlist, wanted, reach, full_cell / pitch / pitch
            )
            if born == 0:
                break
            outcome[STATUS] = advance(mesh, motion, times[layer])
            if outcome[STATUS] != DONE:
                break
            walked = not fresh or _touches(mesh, motion, seen, token)
        if outcome[STATUS] != DONE:
            break
        if fresh:
            graph += 1
            row = edge_rows[graph]
            room = 2 * cut.state[MOST] * cut.state[CROSSED] + len(corners) + 2 * count
            room += cut.state[WHOLE]
            edges, sites = _with_room(edges, row, room), _with_room(sites, row, room)
            pair_rows[graph], edge_rows[graph + 1] = write_edges(
                mesh, cut, site_of, stepped, starts, after, begun_in, crossings, at, count,
                next_on, edges, sites, row,
            )  # fmt: skip
            renew_tree(mesh, cut, tree)
            row = tree_rows[graph]
            branches = _with_room(branches, row, mesh.count[POINTS])
            tree_rows[graph + 1] = write_tree(mesh, tree, site_of, branches, row)
            starts_before, begun_before = starts, begun_in
        row = vertex_rows[layer]
        room = cut.state[VERTICES] + len(corners) + count
        if row + room > len(vertices):
            longer = np.empty((2 * (row + room), 2))
            for vertex in range(row):
                longer[vertex, 0], longer[vertex, 1] = vertices[vertex, 0], vertices[vertex, 1]
            vertices = longer
        vertex_rows[layer + 1] = place_vertices(
            cut.struts, cut.state[VERTICES], times[layer], corners, after, crossings, at, count,
            left, low, pitch, vertices, row,
        )  # fmt: skip
        before, crossings, count_before = crossings, before, count
        at_before, at = at, at_before
        points[layer], cells[layer], graphs[layer] = mesh.count[POINTS], live_cells, graph
        outcome[LAYERS] = layer + 1
    return Run(
        outcome, points, cells, areas, graphs, vertices, vertex_rows, edges, sites, edge_rows,
        pair_rows, branches, tree_rows,
    )  # fmt: skip
