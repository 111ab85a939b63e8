"""The layer loop, compiled: some layers at a time, from section rings to diagrams in long arrays.

For each layer: flip to its height, walk its rings, count cells, give births, and, only where one
of these has changed the graph, cut it anew; otherwise only the vertices have moved.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.core.types import NamedTuple as TupleType

from v3dcad.geometry.clipping.interior import CROSSED, CUT, MOST, VERTICES, WHOLE
from v3dcad.geometry.clipping.planar_graph import place_vertices, write_edges
from v3dcad.geometry.clipping.ring_walk import EDGE, INTO, OPEN, SEGMENT, walk_rings
from v3dcad.geometry.clipping.update import count_cells, renew_cut
from v3dcad.geometry.compiled.arrays import FLOAT_ROWS, INT_ROWS, INTS, ROW, ROWS, WORD
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED
from v3dcad.geometry.graphs.dynamic_spanning_tree import TREE, renew_tree, write_tree
from v3dcad.geometry.power_diagram.event_queue import EVERYTHING, LAST, MOTION, STRUTS, TOUCHED
from v3dcad.geometry.power_diagram.kinetic_triangulation import advance
from v3dcad.geometry.power_diagram.triangle_mesh import MESH, POINTS
from v3dcad.structure.births import give_births
from v3dcad.structure.holes import SHORTLIST
from v3dcad.structure.rim import RIM
from v3dcad.structure.spacing import SQUARES
from v3dcad.structure.sweep.ring_arrays import RINGS

DONE, NEEDS_ROOM, JAMMED, EPOCH_OVER, OPEN_WALK, PAGES_FULL, WALKS_FULL = range(7)
"""How a run ended: after its last layer, for want of room or with a jam (as `advance` says), before
a layer of the next epoch, at one whose rings could not be walked, or at one that there was no room
for in the run's arrays or in `Walks`."""

STATUS, LAYERS, ROOM = range(3)
"""What a run's `outcome` holds: how it ended, how many layers it made, and for how many points, or
rows of its arrays, it needs room."""

POINT_COUNT, CELLS, GRAPH, VERTEX_ROW, EDGE_ROW, PAIR_ROW, TREE_ROW = range(7)
"""Columns of a run's `rows`. Of a layer: how many points there were, sentinels among them; how many
cells; which graph is its own; where its vertices begin. Of a graph: where its edges begin, up to
where they join each pair of neighbours once, and where its tree begins."""


class Run(NamedTuple):
    """What a run of the layer loop makes. Arrays of all layers one behind the other."""

    outcome: Any
    """(3,) int64"""
    rows: Any
    """(layers + 1, 7) int64"""
    vertices: Any
    """(v, 2) float64 mm"""
    edges: Any
    """(e, 2) int64"""
    sites: Any
    """(e, 2) int64"""
    tree: Any
    """(k, 2) int64"""


class Walks(NamedTuple):
    """Room for the walks round a layer's rings, and round those of the layer before."""

    crossings: Any
    """(2, c, 4) int32"""
    at: Any
    """(2, c) float64"""
    next_on: Any
    """(c,) int32"""
    begun_in: Any
    """(rings,) int32: the cell that each ring of all layers begins in"""
    seen: Any
    """(p,) int32, zeros: in which cut a point's cell was last seen"""


RUN = TupleType([INTS, INT_ROWS, FLOAT_ROWS, INT_ROWS, INT_ROWS, INT_ROWS], Run)
WALKS = TupleType([types.int32[:, :, ::1], FLOAT_ROWS, ROW, ROW, ROW], Walks)


def pages(layers: int, some: int) -> Run:
    """Room for a run over so many layers with some vertices in all."""
    many = some + some // 2
    return Run(
        outcome=np.zeros(3, np.int64),
        rows=np.zeros((layers + 1, 7), np.int64),
        vertices=np.empty((some, 2)),
        edges=np.empty((many, 2), np.int64),
        sites=np.empty((many, 2), np.int64),
        tree=np.empty((some, 2), np.int64),
    )


def walks(crossings: int, rings: int, points: int) -> Walks:
    """Room for so many crossings a layer."""
    return Walks(
        crossings=np.empty((2, crossings, 4), np.int32),
        at=np.empty((2, crossings)),
        next_on=np.empty(crossings, np.int32),
        begun_in=np.empty(rings, np.int32),
        seen=np.zeros(points, np.int32),
    )


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
    types.void(
        MESH, MOTION, CUT, TREE, SQUARES, SHORTLIST, RIM, INTS, RINGS, INTS, WALKS, RUN,
        *[types.float64] * 5,
    ),
    **UNCOUNTED,
)  # fmt: skip
def run(  # type: ignore[no-untyped-def]
    mesh, motion, cut, tree, squares, shortlist, rim, site_of, rings, times, walks, made, left,
    low, pitch, reach, full_cell,
):  # fmt: skip
    """Make the layers at ascending whole `times` (layers,), as far as there is room.

    `cut` and `tree` are those of the layer before; newborns from outside are noted in `rim`.
    `site_of` (p,) gives each point's site; (`left`, `low`), mm, and `pitch` say where the grid
    lies. Births are given where the area per cell is above `full_cell`, mm² (infinite: none), at a
    distance of `reach` grid steps per unit of growth; once at a time.
    """
    outcome, rows, vertices, edges = made.outcome, made.rows, made.vertices, made.edges
    crossings, before, at, at_before = (
        walks.crossings[0], walks.crossings[1], walks.at[0], walks.at[1]
    )  # fmt: skip
    next_on, seen, token = walks.next_on, walks.seen, 0
    after_before, begun_before = rings.after[:0], walks.begun_in[:0]
    graph, count, count_before, live_cells = -1, 0, 0, 0
    for layer in range(len(times)):
        if times[layer] > motion.state[LAST]:
            outcome[STATUS] = EPOCH_OVER
            break
        outcome[STATUS] = advance(mesh, motion, times[layer])
        if outcome[STATUS] != DONE:
            break
        rings_from, rings_to = rings.layers[layer], rings.layers[layer + 1]
        first, last = rings.starts[rings_from], rings.starts[rings_to]
        corners, stepped = rings.corners[first:last], rings.stepped[first:last]
        after, starts = rings.after[first:last], rings.starts[rings_from : rings_to + 1]
        begun_in, fresh, walked = walks.begun_in[rings_from:rings_to], False, True
        while True:
            if walked:
                count = walk_rings(mesh, stepped, starts, after, begun_in, crossings, at)
                if count < 0:
                    outcome[STATUS] = OPEN_WALK if count == OPEN else WALKS_FULL
                    break
            if (
                not walked
                or graph < 0
                or motion.state[TOUCHED] != 0
                or not _same_numbers(after_before, after)
                or not _same_numbers(begun_before, begun_in)
                or not _same_crossings(before, count_before, crossings, count)
            ):
                fresh = True
                renew_cut(mesh, motion, cut, site_of, crossings, count, next_on, walked)
                token += 1
                live_cells = count_cells(cut, begun_in, crossings, count, seen, token)
            # No place has two newborns, however small the first layer's cells were.
            wanted = np.ceil(rings.areas[layer] / full_cell - 1e-9) - live_cells
            wanted = int(min(wanted, float(cut.state[VERTICES] + count)))
            given = motion.born[mesh.count[POINTS] - 1] == times[layer]
            if given or wanted <= 0:
                break
            if (
                mesh.count[POINTS] + wanted > len(mesh.points)
                or len(motion.spans) - motion.state[STRUTS] < 8 * wanted + 64
            ):
                outcome[STATUS], outcome[ROOM] = NEEDS_ROOM, wanted
                break
            born = give_births(
                mesh, motion, cut, squares, shortlist, rim, crossings, count, wanted, reach
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
            row = rows[graph, EDGE_ROW]
            room = 2 * cut.state[MOST] * cut.state[CROSSED] + len(corners) + 2 * count
            room += cut.state[WHOLE]
            if row + room > len(edges):
                outcome[STATUS], outcome[ROOM] = PAGES_FULL, room
                break
            rows[graph, PAIR_ROW], rows[graph + 1, EDGE_ROW] = write_edges(
                mesh, cut, site_of, stepped, starts, after, begun_in, crossings, at, count,
                next_on, edges, made.sites, row,
            )  # fmt: skip
            renew_tree(mesh, cut, tree)
            row = rows[graph, TREE_ROW]
            if row + mesh.count[POINTS] > len(made.tree):
                outcome[STATUS], outcome[ROOM] = PAGES_FULL, mesh.count[POINTS]
                break
            rows[graph + 1, TREE_ROW] = write_tree(mesh, tree, site_of, made.tree, row)
            after_before, begun_before = after, begun_in
        row, room = rows[layer, VERTEX_ROW], cut.state[VERTICES] + len(corners) + count
        if row + room > len(vertices):
            outcome[STATUS], outcome[ROOM] = PAGES_FULL, room
            break
        rows[layer + 1, VERTEX_ROW] = place_vertices(
            cut.struts, cut.state[VERTICES], times[layer], corners, after, crossings, at, count,
            left, low, pitch, vertices, row,
        )  # fmt: skip
        before, crossings, count_before = crossings, before, count
        at_before, at = at, at_before
        rows[layer, POINT_COUNT] = mesh.count[POINTS]
        rows[layer, CELLS], rows[layer, GRAPH] = live_cells, graph
        outcome[LAYERS] = layer + 1
