"""The layer loop, compiled: some layers at a time, from section rings to diagrams in long arrays.

For each layer: flip to its height, let sites enter whose cells have opened, walk its rings, and,
only where one of these has changed the graph, clip it anew; otherwise only the vertices have moved.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.clipping.interior import Cut
from v3dcad.geometry.clipping.planar_graph import Edges, Frame, place_vertices, write_edges
from v3dcad.geometry.clipping.ring_walk import (
    EDGE,
    OPEN,
    SEGMENT,
    Crossings,
    LayerRings,
    walk_rings,
)
from v3dcad.geometry.clipping.update import count_cells, renew_cut
from v3dcad.geometry.compiled.arrays import (
    ConstIntArray,
    FloatArray,
    FloatRows,
    Int32Array,
    Int32Rows,
    Int32Stack,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INTERNAL, UNCOUNTED, compiled
from v3dcad.geometry.compiled.records import Record
from v3dcad.geometry.power_diagram.ending import Ending
from v3dcad.geometry.power_diagram.event_queue import Motion
from v3dcad.geometry.power_diagram.kinetic_triangulation import advance, enter
from v3dcad.geometry.power_diagram.triangle_mesh import Triangulation
from v3dcad.structure.sweep.ring_arrays import Rings

CELLS, GRAPH, VERTEX_ROW, EDGE_ROW, PAIR_ROW = range(5)
"""Columns of a run's `rows`. Of a layer: how many cells it has; which graph is its own; where its
vertices begin. Of a graph: where its edges begin, and up to where they join each pair of neighbours
once."""


class Outcome(Record):
    """What a run of the layer loop has come to."""

    ending: int
    """an `Ending`"""
    layers: int
    """how many layers it made"""
    room: int
    """how many rows of its arrays the next layer needs"""


class Output(NamedTuple):
    """What a run of the layer loop makes. Arrays of all layers one behind the other."""

    outcome: Outcome
    rows: IntRows
    """(layers + 1, 5)"""
    vertices: FloatRows
    """(v, 2) mm"""
    edges: IntRows
    """(e, 2)"""
    sites: IntRows
    """(e, 2)"""


class Queue(NamedTuple):
    """The points of a triangulation that are yet to enter it."""

    opens: IntArray
    """(p,) the time from which a point may have a cell, ascending for those yet to enter"""
    closes: IntArray
    """(p,) the time after which it has none"""
    hidden: Int32Array
    """(p,) points that may have a cell, but were hidden by those that entered last"""
    length: IntArray
    """(1,) how many these are"""


class Walks(NamedTuple):
    """Room for the walks round a layer's rings, and what those of the layer before crossed."""

    crossings: Int32Stack
    """(2, c, 4)"""
    at: FloatArray
    """(c,)"""
    next_on: Int32Array
    """(c,)"""
    begun_in: IntArray
    """(rings,) the cell that each ring of all layers begins in"""
    seen: Int32Array
    """(p,) zeros: in which cut a point's cell was last seen"""


def output(layers: int, vertices: int) -> Output:
    """Room for a run over some layers with some vertices in all."""
    edges = vertices + vertices // 2
    return Output(
        outcome=Outcome.of(),
        rows=np.zeros((layers + 1, 5), np.int64),
        vertices=np.empty((vertices, 2)),
        edges=np.empty((edges, 2), np.int64),
        sites=np.empty((edges, 2), np.int64),
    )


def walks(crossings: int, rings: int, points: int) -> Walks:
    """Room for a number of crossings a layer."""
    return Walks(
        crossings=np.empty((2, crossings, 4), np.int32),
        at=np.empty(crossings),
        next_on=np.empty(crossings, np.int32),
        begun_in=np.empty(rings, np.int64),
        seen=np.zeros(points, np.int32),
    )


@compiled(INTERNAL)
def _same_numbers(before: IntArray, now: IntArray) -> bool:
    if len(before) != len(now):
        return False
    for place in range(len(now)):  # noqa: SIM110
        if before[place] != now[place]:
            return False
    return True


@linked(INTERNAL)
def _same_crossings(before: Int32Rows, count_before: int, now: Int32Rows, count: int) -> bool:
    """Whether rings cross the same edges; so they pass the same cells if they begin in them."""
    if count != count_before:
        return False
    for crossing in range(count):
        if (
            before[crossing, EDGE] != now[crossing, EDGE]
            or before[crossing, SEGMENT] != now[crossing, SEGMENT]
        ):
            return False
    return True


@linked(INTERNAL)
def enter_opened(mesh: Triangulation, motion: Motion, queue: Queue, time: int) -> None:
    """Insert the points whose cells have opened by a time, at which the triangulation is.

    Cells are convex in space: a point that flips have hidden has no cell ever after. One that
    others hide on entering may have one later, since it may have been there too early.
    """
    hidden, last = queue.hidden, len(queue.opens)
    mesh.counts.hidden = 0
    while mesh.counts.points < last and queue.opens[mesh.counts.points] <= time:
        hidden[queue.length[0]] = mesh.counts.points
        queue.length[0] += 1
        mesh.counts.points += 1
    triangle = mesh.triangle_of[0]
    for place in range(queue.length[0]):
        if queue.closes[hidden[place]] >= time:
            triangle = enter(mesh, motion, hidden[place], triangle)
    queue.length[0] = mesh.counts.hidden
    for place in range(mesh.counts.hidden):
        hidden[place] = mesh.hidden[place]


@compiled(UNCOUNTED)
def run(
    mesh: Triangulation,
    motion: Motion,
    queue: Queue,
    cut: Cut,
    rings: Rings,
    times: ConstIntArray,
    walks: Walks,
    made: Output,
    frame: Frame,
) -> None:
    """Make the layers at ascending whole `times` (layers,), as far as there is room.

    `cut` is that of the layer before; `frame` says where the grid lies.
    """
    outcome, rows, vertices = made.outcome, made.rows, made.vertices
    edges = Edges(made.edges, made.sites)
    crossings, before = walks.crossings[0], walks.crossings[1]
    after_before, begun_before = rings.after[:0], walks.begun_in[:0]
    graph, count, count_before, live_cells, token = -1, 0, 0, 0, 0
    for layer in range(len(times)):
        outcome.ending = advance(mesh, motion, times[layer])
        if outcome.ending != Ending.DONE:
            break
        enter_opened(mesh, motion, queue, times[layer])
        rings_from, rings_to = rings.layers[layer], rings.layers[layer + 1]
        first, last = rings.starts[rings_from], rings.starts[rings_to]
        corners, stepped = rings.corners[first:last], rings.stepped[first:last]
        after, starts = rings.after[first:last], rings.starts[rings_from : rings_to + 1]
        begun_in = walks.begun_in[rings_from:rings_to]
        layer_rings = LayerRings(stepped, after, starts)
        walk = Crossings(crossings, walks.at, walks.next_on, begun_in)
        count = walk_rings(mesh, layer_rings, walk)
        if count < 0:
            outcome.ending = Ending.RING_OPEN if count == OPEN else Ending.CROSSINGS_FULL
            break
        if (
            graph < 0
            or motion.state.touched != 0
            or not _same_numbers(after_before, after)
            or not _same_numbers(begun_before, begun_in)
            or not _same_crossings(before, count_before, crossings, count)
        ):
            renew_cut(mesh, motion, cut, walk, count)
            token += 1
            live_cells = count_cells(cut, walk, count, walks.seen, token)
            graph += 1
            row = rows[graph, EDGE_ROW]
            room = 2 * cut.state.highest_winding * cut.state.crossed + len(corners) + 2 * count
            room += cut.state.whole
            if row + room > len(edges.ends):
                outcome.ending, outcome.room = Ending.OUTPUT_FULL, room
                break
            rows[graph, PAIR_ROW], rows[graph + 1, EDGE_ROW] = write_edges(
                mesh, cut, layer_rings, walk, count, edges, row
            )
            after_before, begun_before = after, begun_in
        row, room = rows[layer, VERTEX_ROW], cut.state.vertices + len(corners) + count
        if row + room > len(vertices):
            outcome.ending, outcome.room = Ending.OUTPUT_FULL, room
            break
        rows[layer + 1, VERTEX_ROW] = place_vertices(
            cut, times[layer], corners, after, walk, count, frame, vertices, row
        )
        before, crossings, count_before = crossings, before, count
        rows[layer, CELLS], rows[layer, GRAPH] = live_cells, graph
        outcome.layers = layer + 1
