"""A power diagram cut by a section's rings, kept from layer to layer.

What neither the flips nor the rings have touched stays as it is.
"""

from __future__ import annotations

import numpy as np
from numba import types

from v3dcad.geometry.agenda import EVERYTHING, MOTION, TOUCHED
from v3dcad.geometry.exact import INTERNAL, WORD
from v3dcad.geometry.flips import ACROSS, MESH, NOTHING, ROW, TRIANGLES, edge_to
from v3dcad.geometry.inside import (
    CROSSED,
    CUT,
    FILLED,
    add_vertices,
    drop_edges,
    drop_vertices,
    settle_edges,
)
from v3dcad.geometry.linking import linked
from v3dcad.geometry.walk import INTO, INTS, ROWS
from v3dcad.geometry.winding import UNKNOWN, chain, wind


@linked(types.void(MESH, MOTION, CUT, INTS, ROWS, WORD, ROW, types.boolean), **INTERNAL)
def renew_cut(mesh, motion, cut, site_of, crossings, count, next_on, walked):  # type: ignore[no-untyped-def]
    """Cut anew what the motion has touched and, if the rings have been `walked` anew, what they
    cross now or crossed before.
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
        length = chain(mesh, cut, crossings, count, next_on, listed, length)
    known = np.empty(length, np.int32)
    for place in range(length):
        if triangles[listed[place], 0] != NOTHING:
            known[live] = listed[place]
            live += 1
    if not wind(mesh, inside, cut.gain, known, live):
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
        wind(mesh, inside, cut.gain, everyone, many)
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
    drop_edges(cut, halves, dropped)
    drop_vertices(cut, doomed, dying)
    add_vertices(mesh, motion, cut, listed, length)
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
    settle_edges(mesh, cut, site_of, keys, many)


@linked(WORD(CUT, ROW, ROWS, WORD, ROW, WORD), **INTERNAL)
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
