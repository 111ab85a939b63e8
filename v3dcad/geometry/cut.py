"""A power diagram cut by a section's rings, kept from layer to layer.

What neither the flips nor the rings have touched stays as it is. Winding numbers are a potential
on the triangles, whose differences across edges the crossings give: where those of the touched
triangles fit those of all their neighbours, and the outermost is 0, they are the only right ones.

An edge is *whole* where both its ends lie inside and no ring crosses it. Inner vertices and whole
edges are numbered without gaps: the last one moves to where one has gone.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit, types
from numba.core.types import NamedTuple as TupleType

from v3dcad.geometry.exact import INTERNAL, WORD
from v3dcad.geometry.kinetics import EVERYTHING, MOTION, TOUCHED, strut
from v3dcad.geometry.triangulation import ACROSS, MESH, NOTHING, TRIANGLES, edge_to
from v3dcad.geometry.walk import EDGE, FLOAT_ROWS, INTO, INTS, ROW, ROWS, SIDES, WINDING

VERTICES, WHOLE, FILLED, CROSSED, CHANGED, FRESH = range(6)
"""What `Cut.state` counts: inner vertices, whole edges, cells with an inner vertex, edges that are
crossed, and entries of `changed` and of `fresh`."""

TOO_MANY = -1
"""How many entries `fresh` has when there were more than it can hold."""

UNKNOWN = -2


class Cut(NamedTuple):
    """The diagram inside the rings. t, p: slots of triangles and points; edges by their keys."""

    inside: Any
    """(t,) int8: each triangle's winding number"""
    vertex_of: Any
    """(t,) int32: its inner vertex, or −1"""
    corners: Any
    """(t, 4) int32: triangle and cells of each inner vertex"""
    struts: Any
    """(t, 4) float64: how each inner vertex moves"""
    holes: Any
    """(t, 3) float64: the power of each inner vertex, a quadratic in time, steps²"""
    edges: Any
    """(3 t, 2) int32: vertices of each whole edge"""
    sites: Any
    """(3 t, 2) int32: to its right and to its left"""
    halves: Any
    """(3 t, 2) int32: 3 · triangle + edge on both sides; the first is its key"""
    edge_at: Any
    """(3 t,) int32: the whole edge of a half, or −1"""
    first_on: Any
    """(3 t,) int32: the first crossing on the edge with a key, or −1"""
    gain: Any
    """(3 t, 2) int8: what the winding number gains along it; and room for the next"""
    crossed: Any
    """(3 t,) int32: keys of crossed edges"""
    pair_at: Any
    """(3 t,) int64: the cells p < q beside the edge with a key, as p · 2³² + q, where some of it
    lies inside; else 0"""
    before: Any
    """(3 t,) int64: the same before the last changes; −1 where there were none"""
    changed: Any
    """(3 t,) int32: keys with changes"""
    fresh: Any
    """(t,) int32: triangles of new inner vertices, since somebody last emptied this list"""
    filled: Any
    """(p,) int32: how many inner vertices each cell has"""
    state: Any
    """(6,) int64"""


_VERTICES = [SIDES, ROW, ROWS, FLOAT_ROWS, FLOAT_ROWS]
_EDGES = [ROWS, ROWS, ROWS, ROW, ROW, types.int8[:, ::1], ROW, INTS, INTS, ROW]
CUT = TupleType([*_VERTICES, *_EDGES, ROW, ROW, INTS], Cut)


def empty_cut(points: int, triangles: int) -> Cut:
    """A cut of nothing, with room for so many points and triangles."""
    return Cut(
        inside=np.zeros(triangles, np.int8),
        vertex_of=np.full(triangles, -1, np.int32),
        corners=np.empty((triangles, 4), np.int32),
        struts=np.empty((triangles, 4)),
        holes=np.empty((triangles, 3)),
        edges=np.empty((3 * triangles, 2), np.int32),
        sites=np.empty((3 * triangles, 2), np.int32),
        halves=np.empty((3 * triangles, 2), np.int32),
        edge_at=np.full(3 * triangles, -1, np.int32),
        first_on=np.full(3 * triangles, -1, np.int32),
        gain=np.zeros((3 * triangles, 2), np.int8),
        crossed=np.empty(3 * triangles, np.int32),
        pair_at=np.zeros(3 * triangles, np.int64),
        before=np.full(3 * triangles, -1, np.int64),
        changed=np.empty(3 * triangles, np.int32),
        fresh=np.empty(triangles, np.int32),
        filled=np.zeros(points, np.int32),
        state=np.zeros(6, np.int64),
    )


def cut_with_room(cut: Cut, points: int, triangles: int) -> Cut:
    """The same with room for so many points and triangles."""
    longer = empty_cut(points, triangles)
    for name, column in cut._asdict().items():
        getattr(longer, name)[: len(column)] = column
    return longer


@njit(types.boolean(MESH, SIDES, types.int8[:, ::1], ROW, WORD), **INTERNAL)
def _wind(mesh, inside, gain, listed, count):  # type: ignore[no-untyped-def]
    """Find the winding numbers of the listed triangles, which are `UNKNOWN`, from those around.

    Returns whether they fit everywhere, and are 0 or 1.
    """
    triangles, stack = mesh.triangles, mesh.stack
    fits, outermost = True, mesh.triangle_of[0]
    for place in range(count):
        stack[0], waiting = listed[place], 1
        begun = inside[listed[place]] != UNKNOWN
        while waiting > 0:
            waiting -= 1
            triangle = stack[waiting]
            if begun:
                # Settled: once more around, to settle those across and to see whether it fits.
                winding = inside[triangle]
                fits = fits and 0 <= winding <= 1
            else:
                winding = UNKNOWN
            for i in range(3):
                other = triangles[triangle, ACROSS + i]
                if other == NOTHING:
                    continue
                if triangle < other:
                    step = gain[3 * triangle + i, 0]
                else:
                    step = -gain[3 * other + edge_to(triangles, other, triangle), 0]
                if inside[other] == UNKNOWN:
                    if begun:
                        reached = winding + step
                        inside[other] = reached if -2 < reached < 3 else -1
                        stack[waiting] = other
                        waiting += 1
                elif not begun:
                    reached = inside[other] - step
                    inside[triangle] = reached if -2 < reached < 3 else -1
                    stack[0], waiting, begun = triangle, 1, True
                    break
                else:
                    fits = fits and inside[other] == winding + step
    for place in range(count):
        fits = fits and inside[listed[place]] != UNKNOWN
    return fits and inside[outermost] == 0


@njit(types.void(CUT, ROW, WORD), **INTERNAL)
def _drop_edges(cut, halves, count):  # type: ignore[no-untyped-def]
    """Take out the whole edges of some halves; their places get the edges' keys, or −1."""
    edges, sites, sides, edge_at = cut.edges, cut.sites, cut.halves, cut.edge_at
    last = cut.state[WHOLE]
    for place in range(count):
        edge = edge_at[halves[place]]
        halves[place] = -1
        if edge < 0:
            continue
        halves[place] = sides[edge, 0]
        edge_at[sides[edge, 0]] = edge_at[sides[edge, 1]] = -1
        last -= 1
        if edge < last:
            for k in range(2):
                edges[edge, k], sites[edge, k] = edges[last, k], sites[last, k]
                sides[edge, k] = sides[last, k]
                edge_at[sides[edge, k]] = edge
    cut.state[WHOLE] = last


@njit(types.void(CUT, ROW, WORD), **INTERNAL)
def _drop_vertices(cut, doomed, count):  # type: ignore[no-untyped-def]
    """Take out the inner vertices of triangles whose edges have been taken out."""
    vertex_of, corners, struts, holes = cut.vertex_of, cut.corners, cut.struts, cut.holes
    edges, edge_at, filled = cut.edges, cut.edge_at, cut.filled
    last, cells = cut.state[VERTICES], cut.state[FILLED]
    for place in range(count):
        vertex = vertex_of[doomed[place]]
        vertex_of[doomed[place]] = -1
        for k in range(1, 4):
            cell = corners[vertex, k]
            filled[cell] -= 1
            cells -= filled[cell] == 0
        last -= 1
        if vertex == last:
            continue
        moved = corners[last, 0]
        vertex_of[moved] = vertex
        for k in range(4):
            corners[vertex, k], struts[vertex, k] = corners[last, k], struts[last, k]
        for k in range(3):
            holes[vertex, k] = holes[last, k]
            edge = edge_at[3 * moved + k]
            if edge >= 0:
                edges[edge, 0 if edges[edge, 0] == last else 1] = vertex
    cut.state[VERTICES], cut.state[FILLED] = last, cells


@njit(types.void(MESH, MOTION, CUT, ROW, WORD), **INTERNAL)
def _add_vertices(mesh, motion, cut, listed, count):  # type: ignore[no-untyped-def]
    """Number those of the listed triangles that lie inside and have no vertex yet."""
    points, triangles, base, growth = mesh.points, mesh.triangles, motion.base, motion.growth
    vertex_of, corners, struts, holes = cut.vertex_of, cut.corners, cut.struts, cut.holes
    inside, filled, fresh = cut.inside, cut.filled, cut.fresh
    vertex, cells, news = cut.state[VERTICES], cut.state[FILLED], cut.state[FRESH]
    for place in range(count):
        triangle = listed[place]
        if inside[triangle] != 1 or vertex_of[triangle] >= 0:
            continue
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        first = min(a, b, c)
        x, y, vx, vy = strut(points, base, growth, a, b, c)
        struts[vertex, 0], struts[vertex, 1], struts[vertex, 2], struts[vertex, 3] = x, y, vx, vy
        x, y = x - points[first, 0], y - points[first, 1]
        holes[vertex, 0] = x * x + y * y - base[first]
        holes[vertex, 1] = 2 * (x * vx + y * vy) - growth[first]
        holes[vertex, 2] = vx * vx + vy * vy
        corners[vertex, 0] = triangle
        for k in range(3):
            cell = triangles[triangle, k]
            corners[vertex, k + 1] = cell
            cells += filled[cell] == 0
            filled[cell] += 1
        vertex_of[triangle] = vertex
        vertex += 1
        if news == len(fresh):
            news = TOO_MANY
        if news != TOO_MANY:
            fresh[news] = triangle
            news += 1
    cut.state[VERTICES], cut.state[FILLED], cut.state[FRESH] = vertex, cells, news


@njit(types.void(MESH, CUT, INTS, ROW, WORD), **INTERNAL)
def _settle_edges(mesh, cut, site_of, keys, count):  # type: ignore[no-untyped-def]
    """Make the edges with some keys (−1: none) what they should be: whole or not, neighbours or
    not.
    """
    triangles, inside, vertex_of = mesh.triangles, cut.inside, cut.vertex_of
    edges, sites, halves, edge_at = cut.edges, cut.sites, cut.halves, cut.edge_at
    first_on, pair_at, before, changed = cut.first_on, cut.pair_at, cut.before, cut.changed
    edge, listed = cut.state[WHOLE], cut.state[CHANGED]
    for place in range(count):
        key = keys[place]
        if key < 0:
            continue
        triangle, i, pair = key // 3, key % 3, 0
        other = triangles[triangle, ACROSS + i]
        if triangles[triangle, 0] != NOTHING and other > triangle:
            right, left = triangles[triangle, (i + 1) % 3], triangles[triangle, (i + 2) % 3]
            whole = first_on[key] < 0 and inside[triangle] == 1 and inside[other] == 1
            if whole or first_on[key] >= 0:
                pair = (min(right, left) << 32) + max(right, left)
            if whole and edge_at[key] < 0:
                half = 3 * other + edge_to(triangles, other, triangle)
                low, high, backwards = site_of[right], site_of[left], 0
                if low > high:
                    low, high, backwards = high, low, 1
                edges[edge, backwards] = vertex_of[triangle]
                edges[edge, 1 - backwards] = vertex_of[other]
                sites[edge, 0], sites[edge, 1] = low, high
                halves[edge, 0], halves[edge, 1] = key, half
                edge_at[key] = edge_at[half] = edge
                edge += 1
        if pair_at[key] != pair:
            if before[key] < 0:
                before[key] = pair_at[key]
                changed[listed] = key
                listed += 1
            pair_at[key] = pair
    cut.state[WHOLE], cut.state[CHANGED] = edge, listed


@njit(WORD(MESH, CUT, ROWS, WORD, ROW, ROW, WORD), **INTERNAL)
def _chain(mesh, cut, crossings, count, next_on, listed, length):  # type: ignore[no-untyped-def]
    """Chain the crossings on each edge in place of those before; lists the triangles beside edges
    whose gain has changed, and returns how many are listed.
    """
    triangles, inside = mesh.triangles, cut.inside
    first_on, gain, crossed = cut.first_on, cut.gain, cut.crossed
    keys, past = np.empty(cut.state[CROSSED] + count, np.int32), cut.state[CROSSED]
    for place in range(past):
        keys[place] = crossed[place]
        first_on[keys[place]] = -1
    some = 0
    for crossing in range(count):
        key = crossings[crossing, EDGE]
        keys[past + crossing] = key
        gain[key, 1] += crossings[crossing, WINDING]
        next_on[crossing] = first_on[key]
        if first_on[key] < 0:
            crossed[some] = key
            some += 1
        first_on[key] = crossing
    cut.state[CROSSED] = some
    for key in keys:
        if gain[key, 0] != gain[key, 1]:
            gain[key, 0] = gain[key, 1]
            for triangle in (np.int64(key // 3), np.int64(triangles[key // 3, ACROSS + key % 3])):
                if (
                    triangle != NOTHING
                    and triangles[triangle, 0] != NOTHING
                    and inside[triangle] != UNKNOWN
                ):
                    inside[triangle] = UNKNOWN
                    listed[length] = triangle
                    length += 1
    for key in keys:
        gain[key, 1] = 0
    return length


@njit(types.boolean(MESH, MOTION, CUT, INTS, ROWS, WORD, ROW, types.boolean), **INTERNAL)
def renew_cut(mesh, motion, cut, site_of, crossings, count, next_on, walked):  # type: ignore[no-untyped-def]
    """Cut anew what the motion has touched and, if the rings have been `walked` anew, what they
    cross now or crossed before. Returns False where rings overlap or run the wrong way round.
    """
    triangles, inside, vertex_of = mesh.triangles, cut.inside, cut.vertex_of
    crossed, state = cut.crossed, motion.state
    total, past = mesh.count[TRIANGLES], 0
    listed, length = np.empty(2 * total, np.int32), 0
    everything = state[TOUCHED] == EVERYTHING
    for place in range(total if everything else state[TOUCHED]):
        triangle = place if everything else motion.touched[place]
        if inside[triangle] != UNKNOWN:
            inside[triangle] = UNKNOWN
            listed[length] = triangle
            length += 1
    state[TOUCHED], touched = 0, length
    live = 0
    for place in range(touched):  # freed ones have no winding number
        if triangles[listed[place], 0] == NOTHING:
            inside[listed[place]] = 0
    former = np.empty(0, np.int32)
    if walked:
        past = cut.state[CROSSED]
        former = np.empty(past, np.int32)
        for place in range(past):
            former[place] = crossed[place]
        length = _chain(mesh, cut, crossings, count, next_on, listed, length)
    known = np.empty(length, np.int32)
    for place in range(length):
        if triangles[listed[place], 0] != NOTHING:
            known[live] = listed[place]
            live += 1
    if not _wind(mesh, inside, cut.gain, known, live):
        # Some change reaches farther: wind everything from outside.
        length = touched
        seen = np.zeros(total, np.int8)
        for place in range(touched):
            seen[listed[place]] = 1
        everyone, many = np.empty(total, np.int32), 0
        for triangle in range(total):
            if triangles[triangle, 0] != NOTHING:
                inside[triangle] = UNKNOWN
                everyone[many] = triangle
                many += 1
            if seen[triangle] == 0:
                listed[length] = triangle
                length += 1
        inside[mesh.triangle_of[0]] = 0
        if not _wind(mesh, inside, cut.gain, everyone, many):
            return False
    doomed, dying = np.empty(length, np.int32), 0
    halves, dropped = np.empty(3 * length + cut.state[CROSSED], np.int32), 0
    for place in range(length):
        triangle = listed[place]
        if vertex_of[triangle] >= 0 and (place < touched or inside[triangle] != 1):
            doomed[dying] = triangle
            dying += 1
            for i in range(3):
                halves[dropped] = 3 * triangle + i
                dropped += 1
    if walked:
        for place in range(cut.state[CROSSED]):
            halves[dropped] = crossed[place]
            dropped += 1
    _drop_edges(cut, halves, dropped)
    _drop_vertices(cut, doomed, dying)
    _add_vertices(mesh, motion, cut, listed, length)
    keys, many = np.empty(6 * length + dropped + past + cut.state[CROSSED], np.int32), 0
    for place in range(dropped):
        keys[place] = halves[place]
    many = dropped
    for place in range(past):
        keys[many] = former[place]
        many += 1
    for place in range(cut.state[CROSSED] if walked else 0):
        keys[many] = crossed[place]
        many += 1
    for place in range(length):
        triangle = listed[place]
        for i in range(3):
            keys[many] = 3 * triangle + i
            many += 1
            other = triangles[triangle, ACROSS + i]
            if NOTHING < other < triangle and triangles[triangle, 0] != NOTHING:
                keys[many] = 3 * other + edge_to(triangles, other, triangle)
                many += 1
    _settle_edges(mesh, cut, site_of, keys, many)
    return True


@njit(WORD(CUT, ROW, ROWS, WORD, ROW, WORD), **INTERNAL)
def count_cells(cut, begun_in, crossings, count, seen, token):  # type: ignore[no-untyped-def]
    """How many cells have a part inside. Marks those that rings pass in `seen` (p,) with a token
    not used before.
    """
    cells, filled = cut.state[FILLED], cut.filled
    for place in range(len(begun_in) + count):
        ring = place - count
        cell = begun_in[ring] if ring >= 0 else crossings[place, INTO]
        if seen[cell] != token:
            seen[cell] = token
            cells += filled[cell] == 0
    return cells
