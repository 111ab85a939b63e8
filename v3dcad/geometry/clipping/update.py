"""A power diagram cut by a section's rings, kept from layer to layer.

What neither the flips nor the rings have touched stays as it is.
"""

from __future__ import annotations

from v3dcad.geometry.clipping.interior import (
    Cut,
    add_vertices,
    drop_edges,
    drop_vertices,
    settle_edges,
)
from v3dcad.geometry.clipping.ring_walk import INTO, Crossings
from v3dcad.geometry.clipping.winding_numbers import UNKNOWN, chain, wind
from v3dcad.geometry.compiled.arrays import Int32Array
from v3dcad.geometry.compiled.linked import linked
from v3dcad.geometry.compiled.options import INTERNAL
from v3dcad.geometry.power_diagram.event_queue import EVERYTHING, Motion
from v3dcad.geometry.power_diagram.triangle_mesh import (
    ABSENT,
    ACROSS,
    Triangulation,
    edge_to,
)


@linked(INTERNAL)
def _wind_everything(mesh: Triangulation, cut: Cut, touched: int, length: int) -> int:
    """Find all winding numbers anew, from outside; lists every triangle, after the `touched` ones
    of the first `length` that are listed, and returns how many they are.
    """
    inside, listed, picked = cut.inside, cut.listed, cut.picked
    for place in range(length):
        inside[listed[place]] = UNKNOWN if place < touched else 0
    length, live = touched, 0
    for triangle in range(mesh.counts.triangles):
        if inside[triangle] != UNKNOWN:
            listed[length] = triangle
            length += 1
        inside[triangle] = 0
        if mesh.triangles[triangle, 0] != ABSENT:
            inside[triangle] = UNKNOWN
            picked[live] = triangle
            live += 1
    inside[mesh.triangle_of[0]] = 0
    wind(mesh, inside, cut.gain, picked, live)
    return length


@linked(INTERNAL)
def renew_cut(
    mesh: Triangulation,
    motion: Motion,
    cut: Cut,
    crossings: Crossings,
    count: int,
) -> None:
    """Clip anew what the motion has touched, and what the rings cross now or crossed before."""
    triangles, inside, vertex_of = mesh.triangles, cut.inside, cut.vertex_of
    listed, picked, keys = cut.listed, cut.picked, cut.keys
    total, state, touched = mesh.counts.triangles, motion.state, 0
    everything = state.touched == EVERYTHING
    for place in range(total if everything else state.touched):
        triangle = place if everything else motion.touched[place]
        if inside[triangle] != UNKNOWN:
            inside[triangle] = UNKNOWN
            listed[touched] = triangle
            touched += 1
    state.touched = 0
    for place in range(touched):  # freed ones have no winding number
        if triangles[listed[place], 0] == ABSENT:
            inside[listed[place]] = 0
    past, live = cut.state.crossed, 0
    length = chain(mesh, cut, crossings, count, touched)
    for place in range(length):
        if triangles[listed[place], 0] != ABSENT:
            picked[live] = listed[place]
            live += 1
    if not wind(mesh, inside, cut.gain, picked, live):
        length = _wind_everything(mesh, cut, touched, length)
    dying, many = 0, 0
    for place in range(length):
        triangle = listed[place]
        if vertex_of[triangle] >= 0 and (place < touched or inside[triangle] != 1):
            picked[dying] = triangle
            dying += 1
            for i in range(3):
                keys[many] = 3 * triangle + i
                many += 1
    crossed = cut.state.crossed
    for place in range(crossed):
        keys[many] = cut.crossed[place]
        many += 1
    drop_edges(cut, keys, many)
    drop_vertices(cut, picked, dying)
    add_vertices(mesh, motion, cut, listed, length)
    settle_edges(mesh, cut, keys, many)
    settle_edges(mesh, cut, cut.former, past)
    settle_edges(mesh, cut, cut.crossed, crossed)
    many = 0
    for place in range(length):
        triangle = listed[place]
        for i in range(3):
            keys[many] = 3 * triangle + i
            many += 1
            other = triangles[triangle, ACROSS + i]
            if ABSENT < other < triangle and triangles[triangle, 0] != ABSENT:
                keys[many] = 3 * other + edge_to(triangles, other, triangle)
                many += 1
    settle_edges(mesh, cut, keys, many)


@linked(INTERNAL)
def count_cells(cut: Cut, crossings: Crossings, count: int, seen: Int32Array, token: int) -> int:
    """How many cells have a part inside. Marks those that rings pass in `seen` (p,) with a token
    not used before.
    """
    cells, filled = cut.state.filled, cut.filled
    begun_in = crossings.begun_in
    for place in range(len(begun_in) + count):
        ring = place - count
        cell = begun_in[ring] if ring >= 0 else crossings.rows[place, INTO]
        if seen[cell] != token:
            seen[cell] = token
            cells += filled[cell] == 0
    return cells
