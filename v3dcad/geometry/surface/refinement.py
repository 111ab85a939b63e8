"""Adding nodes to a `SurfaceMesh` until the height along every edge is monotone."""

from __future__ import annotations

from dataclasses import replace
from heapq import heappop, heappush
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from v3dcad.errors import GeometryError
from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstIntArray,
    FloatRows,
    FloatStack,
    IntArray,
    IntRows,
)
from v3dcad.geometry.compiled.options import ALLOCATING, ENTRY, INTERNAL, compiled
from v3dcad.geometry.surface.curves import curve_at
from v3dcad.geometry.surface.mesh import SurfaceMesh, depth, project, turning_point, turning_points
from v3dcad.geometry.surface.surfaces import surface_at
from v3dcad.model import Floats, Ints

MAX_SPLITS_PER_EDGE = 16
"""Splits per edge that the mesh had: a bound for surfaces that ripple without end."""


def refined(mesh: SurfaceMesh, triangles: Ints, parameters: Floats) -> SurfaceMesh:
    """The mesh with new nodes at parameters (k, 2) in its triangles (k,), and all edges monotone.

    `GeometryError` where a face ripples so much that this does not end.
    """
    turns = turning_points(
        mesh.coefficients, mesh.surfaces, mesh.edge_faces, mesh.edge_curves, mesh.edge_spans
    )
    turning = np.flatnonzero(turns[:, 1] > 0)
    if not len(triangles) and not len(turning):
        return mesh
    order = np.argsort(mesh.sides.ravel(), kind="stable")
    owners = (order[np.count_nonzero(mesh.sides < 0) :] // 3).reshape(-1, 2)
    room = 64 + 4 * (len(triangles) + len(turning))
    while room <= max(MAX_SPLITS_PER_EDGE * len(mesh.edge_nodes), 64):
        tables = _tables(mesh, owners, room)
        counts = len(mesh.nodes), len(mesh.triangles), len(mesh.edge_nodes)
        splits = _refine(tables, counts, room, triangles, parameters, turning, turns[turning])
        if splits >= 0:
            return _taken(mesh, tables, splits)
        room *= 4
    raise GeometryError("a face of the part ripples too finely to be sliced: simplify the surface")


class _Tables(NamedTuple):
    """The arrays of a `SurfaceMesh`, those that grow with room for more rows: a split adds one
    node, two triangles and three edges. Owners (e, 2) are the triangles beside each edge.
    """

    nodes: FloatRows
    triangles: IntRows
    corners: FloatStack
    faces: IntArray
    sides: IntRows
    edge_nodes: IntRows
    edge_faces: IntArray
    edge_curves: IntArray
    edge_spans: FloatRows
    owners: IntRows
    coefficients: ConstFloatArray
    surfaces: ConstIntArray


Counts = tuple[int, int, int]
"""How many nodes, triangles and edges of the tables are in use."""


class _Split(NamedTuple):
    """A split of an edge at a new node, after a share of its way.

    `edge` becomes its part from the node `first` to the new one, `rest` the part after it.
    """

    edge: int
    share: float
    node: int
    first: int
    rest: int


ROWS_PER_SPLIT = {
    "nodes": 1,
    "triangles": 2,
    "corners": 2,
    "faces": 2,
    "sides": 2,
    "edge_nodes": 3,
    "edge_faces": 3,
    "edge_curves": 3,
    "edge_spans": 3,
}
"""Rows that a split adds to each of the mesh's tables."""


def _tables(mesh: SurfaceMesh, owners: Ints, room: int) -> _Tables:
    """The mesh's arrays with room for a number of splits."""
    grown = {
        name: _with_room(getattr(mesh, name), rows * room) for name, rows in ROWS_PER_SPLIT.items()
    }
    arrays = mesh.arrays()
    return _Tables(
        **grown,
        owners=_with_room(owners, ROWS_PER_SPLIT["edge_nodes"] * room),
        coefficients=arrays.coefficients,
        surfaces=arrays.surfaces,
    )


def _taken(mesh: SurfaceMesh, tables: _Tables, splits: int) -> SurfaceMesh:
    """The mesh with what a number of splits added."""
    return replace(
        mesh,
        **{
            name: getattr(tables, name)[: len(getattr(mesh, name)) + rows * splits]
            for name, rows in ROWS_PER_SPLIT.items()
        },
    )


def _with_room(rows: NDArray[Any], more: int) -> NDArray[Any]:
    """The rows in an array that has room for more of them."""
    whole = np.empty((len(rows) + more, *rows.shape[1:]), rows.dtype)
    whole[: len(rows)] = rows
    return whole


_Corner = tuple[int, float, float, int]
"""A corner of a triangle: its node, its u and v, and the edge from there to the next."""


@compiled(INTERNAL)
def _corner(mesh: _Tables, triangle: int, corner: int) -> _Corner:
    u, v = mesh.corners[triangle, corner, 0], mesh.corners[triangle, corner, 1]
    return mesh.triangles[triangle, corner], u, v, mesh.sides[triangle, corner]


@compiled(INTERNAL)
def _set_edge(
    mesh: _Tables,
    edge: int,
    nodes: tuple[int, int],
    face: int,
    curve: int,
    span: tuple[float, float, float, float],
) -> None:
    mesh.edge_nodes[edge, 0], mesh.edge_nodes[edge, 1] = nodes
    mesh.edge_faces[edge], mesh.edge_curves[edge] = face, curve
    mesh.edge_spans[edge, 0], mesh.edge_spans[edge, 1] = span[0], span[1]
    mesh.edge_spans[edge, 2], mesh.edge_spans[edge, 3] = span[2], span[3]


@compiled(INTERNAL)
def _set_triangle(
    mesh: _Tables, triangle: int, face: int, corners: tuple[_Corner, _Corner, _Corner]
) -> None:
    mesh.faces[triangle] = face
    for k in range(3):
        mesh.triangles[triangle, k], u, v, mesh.sides[triangle, k] = corners[k]
        mesh.corners[triangle, k, 0], mesh.corners[triangle, k, 1] = u, v


@compiled(INTERNAL)
def _replace_owner(mesh: _Tables, edge: int, old: int, new: int) -> None:
    for k in range(2 if edge >= 0 else 0):
        if mesh.owners[edge, k] == old:
            mesh.owners[edge, k] = new


@compiled(INTERNAL)
def _insert(
    mesh: _Tables, parent: int, u: float, v: float, node: int, triangle: int, edge: int
) -> None:
    """Divide a triangle into three at (u, v), where `node` is; rows from `triangle` and `edge` on
    become the two new ones and the three spokes.
    """
    face = mesh.faces[parent]
    for k in (1, 2, 0):  # the child that takes the parent's rows comes last
        after = (k + 1) % 3
        child = parent if k == 0 else triangle + k - 1
        before = parent if k == 1 else triangle + (k + 1) % 3
        first, first_u, first_v, side = _corner(mesh, parent, k)
        last, last_u, last_v, _ = _corner(mesh, parent, after)
        _set_edge(mesh, edge + k, (node, first), face, -1, (u, v, first_u, first_v))
        corners = (
            (node, u, v, edge + k),
            (first, first_u, first_v, side),
            (last, last_u, last_v, edge + after),
        )
        _set_triangle(mesh, child, face, corners)
        _replace_owner(mesh, side, parent, child)
        mesh.owners[edge + k, 0], mesh.owners[edge + k, 1] = before, child


@compiled(INTERNAL)
def _set_node(mesh: _Tables, node: int, face: int, u: float, v: float) -> None:
    point, _, _ = surface_at(mesh.coefficients, mesh.surfaces[face], u, v)
    mesh.nodes[node, 0], mesh.nodes[node, 1], mesh.nodes[node, 2] = point


@compiled(ALLOCATING)
def _enqueue(waiting: list[tuple[float, int, float]], mesh: _Tables, edge: int) -> None:
    """Enter an edge into the queue of edges to be split, if it is not monotone."""
    surface = mesh.surfaces[mesh.edge_faces[edge]]
    share, rise = turning_point(
        mesh.coefficients, surface, mesh.edge_curves[edge], mesh.edge_spans[edge]
    )
    if rise > 0:
        heappush(waiting, (-rise, edge, share))


@compiled(INTERNAL)
def _cut_edge(mesh: _Tables, split: _Split) -> None:
    """Place a split's node, and divide its edge there."""
    edge, share, node, _, rest = split
    face, curve, last = mesh.edge_faces[edge], mesh.edge_curves[edge], mesh.edge_nodes[edge, 1]
    a, b = mesh.edge_spans[edge, 0], mesh.edge_spans[edge, 1]
    c, d = mesh.edge_spans[edge, 2], mesh.edge_spans[edge, 3]
    if curve >= 0:
        at = a + share * (b - a)
        x, y, z, _, _, _ = curve_at(mesh.coefficients, curve, at)
        mesh.nodes[node, 0], mesh.nodes[node, 1], mesh.nodes[node, 2] = x, y, z
        mesh.edge_spans[edge, 1] = at
        _set_edge(mesh, rest, (node, last), face, curve, (at, b, 0.0, 0.0))
    else:
        u, v = a + share * (c - a), b + share * (d - b)
        _set_node(mesh, node, face, u, v)
        mesh.edge_spans[edge, 2], mesh.edge_spans[edge, 3] = u, v
        _set_edge(mesh, rest, (node, last), face, curve, (u, v, c, d))
    mesh.edge_nodes[edge, 1] = node


@compiled(INTERNAL)
def _bisect(mesh: _Tables, split: _Split, triangle: int, beyond: int, middle: int) -> bool:
    """Cut a triangle from a split's node to the opposite corner; `middle` is the new edge.

    `beyond` is the new triangle. It takes the part along `rest` if the triangle passes the edge in
    the edge's own direction, which is returned, else the part along `edge`.
    """
    edge, share, node, first, rest = split
    face = mesh.faces[triangle]
    k = 0
    while k < 2 and mesh.sides[triangle, k] != edge:
        k += 1
    after, before = (k + 1) % 3, (k + 2) % 3
    a, a_u, a_v, _ = _corner(mesh, triangle, k)
    b, b_u, b_v, side_bc = _corner(mesh, triangle, after)
    c, c_u, c_v, side_ca = _corner(mesh, triangle, before)
    forward = a == first
    portion = share if forward else 1 - share
    u, v = a_u + portion * (b_u - a_u), a_v + portion * (b_v - a_v)
    if mesh.edge_curves[edge] >= 0:
        u, v = project(mesh.coefficients, mesh.surfaces[face], mesh.nodes[node], u, v)
    _set_edge(mesh, middle, (node, c), face, -1, (u, v, c_u, c_v))
    near, far = (edge, rest) if forward else (rest, edge)
    corners = (a, a_u, a_v, near), (node, u, v, middle), (c, c_u, c_v, side_ca)
    _set_triangle(mesh, triangle, face, corners)
    corners = (node, u, v, far), (b, b_u, b_v, side_bc), (c, c_u, c_v, middle)
    _set_triangle(mesh, beyond, face, corners)
    mesh.owners[middle, 0], mesh.owners[middle, 1] = triangle, beyond
    _replace_owner(mesh, side_bc, triangle, beyond)
    return forward


@compiled(INTERNAL)
def _piece_at(
    mesh: _Tables, seed: int, u: float, v: float, pieces: ConstIntArray, known: int, stop: int
) -> int:
    """The piece of a seed's triangle, which may have been divided, that (u, v) lies deepest in.

    Triangles known … stop are pieces of the triangles `pieces`.
    """
    found, deepest = seed, depth(mesh.corners[seed], u, v)
    for piece in range(known, stop):
        if pieces[piece - known] == seed:
            inside = depth(mesh.corners[piece], u, v)
            if inside > deepest:
                found, deepest = piece, inside
    return found


@compiled(ENTRY)
def _refine(
    mesh: _Tables,
    counts: Counts,
    room: int,
    seeds: ConstIntArray,
    parameters: ConstFloatRows,
    turning: ConstIntArray,
    turns: ConstFloatRows,
) -> int:
    """Insert nodes at parameters (k, 2) in triangles `seeds` (k,), then split edges until all are
    monotone, beginning with `turning` (m,), which turn as `turning_points` says (m, 2).

    `counts` are the rows in use, and there is room for `room` splits. Returns the number of
    splits, −1 where there is too little room.
    """
    waiting = [(0.0, 0, 0.0)]
    waiting.pop()
    first_node, first_triangle, first_edge = counts
    node, triangle_count, edge_count = counts
    pieces = np.empty(2 * len(seeds), np.int64)
    for k in range(len(seeds)):
        if node - first_node == room:
            return -1
        u, v = parameters[k, 0], parameters[k, 1]
        parent = _piece_at(mesh, seeds[k], u, v, pieces, first_triangle, triangle_count)
        for piece in range(triangle_count, triangle_count + 2):
            pieces[piece - first_triangle] = seeds[k]
        _insert(mesh, parent, u, v, node, triangle_count, edge_count)
        _set_node(mesh, node, mesh.faces[parent], u, v)
        node, triangle_count, edge_count = node + 1, triangle_count + 2, edge_count + 3
    for edge in range(first_edge, edge_count):
        _enqueue(waiting, mesh, edge)
    for k in range(len(turning)):
        heappush(waiting, (-turns[k, 1], turning[k], turns[k, 0]))
    while len(waiting):
        if node - first_node == room:
            return -1
        # The highest turn first: a crest is traced from edge to edge before what lies beside it.
        _, edge, share = heappop(waiting)
        split = _Split(edge, share, node, mesh.edge_nodes[edge, 0], edge_count)
        _cut_edge(mesh, split)
        beside = (mesh.owners[edge, 0], mesh.owners[edge, 1])
        for k in range(2):
            beyond = triangle_count + k
            forward = _bisect(mesh, split, beside[k], beyond, split.rest + 1 + k)
            mesh.owners[edge, k] = beside[k] if forward else beyond
            mesh.owners[split.rest, k] = beyond if forward else beside[k]
        _enqueue(waiting, mesh, edge)
        node, triangle_count, edge_count = node + 1, triangle_count + 2, edge_count + 3
        for new in range(split.rest, edge_count):
            _enqueue(waiting, mesh, new)
    return node - first_node
