"""The layer loop, compiled: some layers at a time, from section rings to diagrams in long arrays.

For each layer: flip to its height, walk its rings, count cells, give births, and, only where one
of these has changed the graph, cut it anew; otherwise only the vertices have moved.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.clipping.interior import Cut
from v3dcad.geometry.clipping.planar_graph import Edges, Frame, place_vertices, write_edges
from v3dcad.geometry.clipping.ring_walk import (
    EDGE,
    INTO,
    OPEN,
    SEGMENT,
    Crossings,
    LayerRings,
    walk_rings,
)
from v3dcad.geometry.clipping.update import count_cells, renew_cut
from v3dcad.geometry.compiled.arrays import (
    ConstIntArray,
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
from v3dcad.geometry.graphs.dynamic_spanning_tree import Tree, renew_tree, write_tree
from v3dcad.geometry.power_diagram.ending import Ending
from v3dcad.geometry.power_diagram.event_queue import (
    EVERYTHING,
    Motion,
)
from v3dcad.geometry.power_diagram.kinetic_triangulation import advance
from v3dcad.geometry.power_diagram.triangle_mesh import Triangulation
from v3dcad.structure.births import give_births
from v3dcad.structure.holes import Shortlist
from v3dcad.structure.rim import Rim
from v3dcad.structure.spacing import Squares
from v3dcad.structure.sweep.ring_arrays import Rings

POINT_COUNT, CELLS, GRAPH, VERTEX_ROW, EDGE_ROW, PAIR_ROW, TREE_ROW = range(7)
"""Columns of a run's `rows`. Of a layer: how many points there were, sentinels among them; how many
cells; which graph is its own; where its vertices begin. Of a graph: where its edges begin, up to
where they join each pair of neighbours once, and where its tree begins."""


class Outcome(Record):
    """What a run of the layer loop has come to."""

    ending: int
    """an `Ending`"""
    layers: int
    """how many layers it made"""
    room: int
    """for how many points, or rows of its arrays, it needs room"""


class Run(NamedTuple):
    """What a run of the layer loop makes. Arrays of all layers one behind the other."""

    outcome: Outcome
    rows: IntRows
    """(layers + 1, 7) int64"""
    vertices: FloatRows
    """(v, 2) float64 mm"""
    edges: IntRows
    """(e, 2) int64"""
    sites: IntRows
    """(e, 2) int64"""
    tree: IntRows
    """(k, 2) int64"""


class Walks(NamedTuple):
    """Room for the walks round a layer's rings, and round those of the layer before."""

    crossings: Int32Stack
    """(2, c, 4) int32"""
    at: FloatRows
    """(2, c) float64"""
    next_on: Int32Array
    """(c,) int32"""
    begun_in: IntArray
    """(rings,) int64: the cell that each ring of all layers begins in"""
    seen: Int32Array
    """(p,) int32, zeros: in which cut a point's cell was last seen"""


def pages(layers: int, some: int) -> Run:
    """Room for a run over so many layers with some vertices in all."""
    many = some + some // 2
    return Run(
        outcome=Outcome.of(),
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


@linked(INTERNAL)
def _touches(mesh: Triangulation, motion: Motion, seen: Int32Array, token: int) -> bool:
    """Whether a touched triangle is at a cell that rings pass."""
    if motion.state.touched == EVERYTHING:
        return True
    for place in range(motion.state.touched):
        triangle = motion.touched[place]
        for k in range(3):
            cell = mesh.triangles[triangle, k]
            if cell >= 0 and seen[cell] == token:
                return True
    return False


@compiled(UNCOUNTED)
def run(
    mesh: Triangulation,
    motion: Motion,
    cut: Cut,
    tree: Tree,
    squares: Squares,
    shortlist: Shortlist,
    rim: Rim,
    site_of: ConstIntArray,
    rings: Rings,
    times: ConstIntArray,
    walks: Walks,
    made: Run,
    frame: Frame,
    reach: float,
    full_cell: float,
) -> None:
    """Make the layers at ascending whole `times` (layers,), as far as there is room.

    `cut` and `tree` are those of the layer before; newborns from outside are noted in `rim`.
    `site_of` (p,) gives each point's site, `frame` says where the grid lies. Births are given where
    the area per cell is above `full_cell`, mm² (infinite: none), at a distance of `reach` grid
    steps per unit of growth; once at a time.
    """
    outcome, rows, vertices = made.outcome, made.rows, made.vertices
    edges = Edges(made.edges, made.sites)
    crossings, before, at, at_before = (
        walks.crossings[0], walks.crossings[1], walks.at[0], walks.at[1]
    )  # fmt: skip
    seen, token = walks.seen, 0
    after_before, begun_before = rings.after[:0], walks.begun_in[:0]
    graph, count, count_before, live_cells = -1, 0, 0, 0
    for layer in range(len(times)):
        if times[layer] > motion.state.last:
            outcome.ending = Ending.EPOCH_OVER
            break
        outcome.ending = advance(mesh, motion, times[layer])
        if outcome.ending != Ending.DONE:
            break
        rings_from, rings_to = rings.layers[layer], rings.layers[layer + 1]
        first, last = rings.starts[rings_from], rings.starts[rings_to]
        corners, stepped = rings.corners[first:last], rings.stepped[first:last]
        after, starts = rings.after[first:last], rings.starts[rings_from : rings_to + 1]
        begun_in, fresh, walked = walks.begun_in[rings_from:rings_to], False, True
        layer_rings = LayerRings(stepped, after, starts)
        walk = Crossings(crossings, at, walks.next_on, begun_in)
        while True:
            if walked:
                count = walk_rings(mesh, layer_rings, walk)
                if count < 0:
                    outcome.ending = Ending.RING_OPEN if count == OPEN else Ending.CROSSINGS_FULL
                    break
            if (
                not walked
                or graph < 0
                or motion.state.touched != 0
                or not _same_numbers(after_before, after)
                or not _same_numbers(begun_before, begun_in)
                or not _same_crossings(before, count_before, crossings, count)
            ):
                fresh = True
                renew_cut(mesh, motion, cut, site_of, walk, count, walked)
                token += 1
                live_cells = count_cells(cut, walk, count, seen, token)
            # No place has two newborns, however small the first layer's cells were.
            wanted = np.ceil(rings.areas[layer] / full_cell - 1e-9) - live_cells
            wanted = int(min(wanted, float(cut.state.vertices + count)))
            given = motion.born[mesh.counts.points - 1] == times[layer]
            if given or wanted <= 0:
                break
            if (
                mesh.counts.points + wanted > len(mesh.points)
                or len(motion.spans) - motion.state.struts < 8 * wanted + 64
            ):
                outcome.ending, outcome.room = Ending.POINTS_FULL, wanted
                break
            born = give_births(
                mesh, motion, cut, squares, shortlist, rim, crossings, count, wanted, reach
            )
            if born == 0:
                break
            outcome.ending = advance(mesh, motion, times[layer])
            if outcome.ending != Ending.DONE:
                break
            walked = not fresh or _touches(mesh, motion, seen, token)
        if outcome.ending != Ending.DONE:
            break
        if fresh:
            graph += 1
            row = rows[graph, EDGE_ROW]
            room = 2 * cut.state.highest_winding * cut.state.crossed + len(corners) + 2 * count
            room += cut.state.whole
            if row + room > len(edges.ends):
                outcome.ending, outcome.room = Ending.OUTPUT_FULL, room
                break
            rows[graph, PAIR_ROW], rows[graph + 1, EDGE_ROW] = write_edges(
                mesh, cut, site_of, layer_rings, walk, count, edges, row
            )
            renew_tree(mesh, cut, tree)
            row = rows[graph, TREE_ROW]
            if row + mesh.counts.points > len(made.tree):
                outcome.ending, outcome.room = Ending.OUTPUT_FULL, mesh.counts.points
                break
            rows[graph + 1, TREE_ROW] = write_tree(mesh, tree, site_of, made.tree, row)
            after_before, begun_before = after, begun_in
        row, room = rows[layer, VERTEX_ROW], cut.state.vertices + len(corners) + count
        if row + room > len(vertices):
            outcome.ending, outcome.room = Ending.OUTPUT_FULL, room
            break
        rows[layer + 1, VERTEX_ROW] = place_vertices(
            cut, times[layer], corners, after, walk, count, frame, vertices, row
        )
        before, crossings, count_before = crossings, before, count
        at_before, at = at, at_before
        rows[layer, POINT_COUNT] = mesh.counts.points
        rows[layer, CELLS], rows[layer, GRAPH] = live_cells, graph
        outcome.layers = layer + 1
