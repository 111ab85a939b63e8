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

MAX_SPLITS_PER_EDGE = 64
"""Splits per edge that the mesh had: a bound for surfaces that ripple without end."""


def refined(mesh: SurfaceMesh, triangles: Ints, parameters: Floats) -> SurfaceMesh:
    """The mesh with new nodes at parameters (k, 2) in its triangles (k,), and all edges monotone.

    `GeometryError` where a face ripples so much that this does not end.
    """
    turns = turning_points(
        mesh.coefficients, mesh.surfaces, mesh.edge_faces, mesh.edge_curves, mesh.edge_spans
    )
    turning = np.flatnonzero(turns[:, 1] > 0)
    order = np.argsort(mesh.sides.ravel(), kind="stable")
    owners = (order[np.count_nonzero(mesh.sides < 0) :] // 3).reshape(-1, 2)
    room = 64 + 4 * (len(triangles) + len(turning))
    while room <= max(MAX_SPLITS_PER_EDGE * len(mesh.edge_nodes), 64):
        tables = _tables(mesh, owners, room)
        splits = _refine(
            mesh.coefficients,
            mesh.surfaces,
            tables,
            len(mesh.nodes),
            len(mesh.triangles),
            len(mesh.edge_nodes),
            room,
            triangles,
            parameters,
            turning,
            turns[turning],
        )
        if splits >= 0:
            return _taken(mesh, tables, splits)
        room *= 4
    raise GeometryError("a face of the part ripples too finely to be sliced: simplify the surface")


class _Tables(NamedTuple):
    """The arrays of a `SurfaceMesh` that grow, with room for more rows: a split adds one node, two
    triangles and three edges. Owners (e, 2) are the triangles beside each edge.
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


ROWS_PER_SPLIT = (1, 2, 2, 2, 2, 3, 3, 3, 3, 3)
"""Rows that a split adds to each of the tables."""


def _tables(mesh: SurfaceMesh, owners: Ints, room: int) -> _Tables:
    """The mesh's arrays with room for so many splits."""
    rows = [getattr(mesh, name) for name in _Tables._fields[:-1]] + [owners]
    return _Tables(*(_with_room(*each, room) for each in zip(rows, ROWS_PER_SPLIT, strict=True)))


def _taken(mesh: SurfaceMesh, tables: _Tables, splits: int) -> SurfaceMesh:
    """The mesh with what was added by so many splits."""
    found = zip(_Tables._fields[:-1], ROWS_PER_SPLIT[:-1], strict=True)
    return replace(
        mesh,
        **{
            name: getattr(tables, name)[: len(getattr(mesh, name)) + rows * splits]
            for name, rows in found
        },
    )


def _with_room(rows: NDArray[Any], more: int, times: int) -> NDArray[Any]:
    """The rows in an array that has room for more of them."""
    whole = np.empty((len(rows) + more * times, *rows.shape[1:]), rows.dtype)
    whole[: len(rows)] = rows
    return whole


@compiled(INTERNAL)
def _corner(mesh: _Tables, triangle: int, corner: int) -> tuple[int, float, float, int]:
    """The node of a triangle's corner, its u and v, and the edge from there to the next."""
    u, v = mesh.corners[triangle, corner, 0], mesh.corners[triangle, corner, 1]
    return mesh.triangles[triangle, corner], u, v, mesh.sides[triangle, corner]


@compiled(INTERNAL)
def _set_edge(
    mesh: _Tables,
    edge: int,
    first: int,
    last: int,
    face: int,
    curve: int,
    a: float,
    b: float,
    c: float,
    d: float,
) -> None:
    mesh.edge_nodes[edge, 0], mesh.edge_nodes[edge, 1] = first, last
    mesh.edge_faces[edge], mesh.edge_curves[edge] = face, curve
    mesh.edge_spans[edge, 0], mesh.edge_spans[edge, 1] = a, b
    mesh.edge_spans[edge, 2], mesh.edge_spans[edge, 3] = c, d


@compiled(INTERNAL)
def _set_triangle(
    mesh: _Tables,
    triangle: int,
    face: int,
    corners: tuple[
        tuple[int, float, float, int], tuple[int, float, float, int], tuple[int, float, float, int]
    ],
) -> None:
    """Each corner as `_corner` tells it."""
    mesh.faces[triangle] = face
    for k in range(3):
        mesh.triangles[triangle, k], u, v, mesh.sides[triangle, k] = corners[k]
        mesh.corners[triangle, k, 0], mesh.corners[triangle, k, 1] = u, v


@compiled(INTERNAL)
def _hand_over(mesh: _Tables, edge: int, giver: int, taker: int) -> None:
    for k in range(2 if edge >= 0 else 0):
        if mesh.owners[edge, k] == giver:
            mesh.owners[edge, k] = taker


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
        _set_edge(mesh, edge + k, node, first, face, -1, u, v, first_u, first_v)
        corners = (
            (node, u, v, edge + k),
            (first, first_u, first_v, side),
            (last, last_u, last_v, edge + after),
        )
        _set_triangle(mesh, child, face, corners)
        _hand_over(mesh, side, parent, child)
        mesh.owners[edge + k, 0], mesh.owners[edge + k, 1] = before, child


@compiled(INTERNAL)
def _set_node(
    mesh: _Tables, node: int, coefficients: ConstFloatArray, surface: int, u: float, v: float
) -> None:
    point, _, _ = surface_at(coefficients, surface, u, v)
    mesh.nodes[node, 0], mesh.nodes[node, 1], mesh.nodes[node, 2] = point


@compiled(ALLOCATING)
def _look(
    waiting: list[tuple[float, int, float]],
    coefficients: ConstFloatArray,
    surfaces: ConstIntArray,
    mesh: _Tables,
    edge: int,
) -> None:
    """Have an edge split if it is not monotone."""
    surface = surfaces[mesh.edge_faces[edge]]
    share, rise = turning_point(coefficients, surface, mesh.edge_curves[edge], mesh.edge_spans[edge])
    if rise > 0:
        heappush(waiting, (-rise, edge, share))


@compiled(INTERNAL)
def _cut_edge(
    coefficients: ConstFloatArray,
    surfaces: ConstIntArray,
    mesh: _Tables,
    edge: int,
    share: float,
    node: int,
    rest: int,
) -> None:
    """Cut an edge at a share of its way, where `node` is to be; `rest` becomes what follows."""
    face, curve, last = mesh.edge_faces[edge], mesh.edge_curves[edge], mesh.edge_nodes[edge, 1]
    a, b = mesh.edge_spans[edge, 0], mesh.edge_spans[edge, 1]
    c, d = mesh.edge_spans[edge, 2], mesh.edge_spans[edge, 3]
    if curve >= 0:
        at = a + share * (b - a)
        x, y, z, _, _, _ = curve_at(coefficients, curve, at)
        mesh.nodes[node, 0], mesh.nodes[node, 1], mesh.nodes[node, 2] = x, y, z
        mesh.edge_spans[edge, 1] = at
        _set_edge(mesh, rest, node, last, face, curve, at, b, 0.0, 0.0)
    else:
        u, v = a + share * (c - a), b + share * (d - b)
        _set_node(mesh, node, coefficients, surfaces[face], u, v)
        mesh.edge_spans[edge, 2], mesh.edge_spans[edge, 3] = u, v
        _set_edge(mesh, rest, node, last, face, curve, u, v, c, d)
    mesh.edge_nodes[edge, 1] = node


@compiled(INTERNAL)
def _bisect(
    coefficients: ConstFloatArray,
    surfaces: ConstIntArray,
    mesh: _Tables,
    triangle: int,
    edge: int,
    rest: int,
    node: int,
    first: int,
    share: float,
    beyond: int,
    middle: int,
) -> bool:
    """Cut a triangle from the new node on its side `edge` to the opposite corner.

    The part along `rest` becomes `beyond` if the triangle goes along the edge as the edge does,
    which is returned, else the part along `edge` does.
    """
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
        u, v = project(coefficients, surfaces[face], mesh.nodes[node], u, v)
    _set_edge(mesh, middle, node, c, face, -1, u, v, c_u, c_v)
    near, far = (edge, rest) if forward else (rest, edge)
    corners = (a, a_u, a_v, near), (node, u, v, middle), (c, c_u, c_v, side_ca)
    _set_triangle(mesh, triangle, face, corners)
    corners = (node, u, v, far), (b, b_u, b_v, side_bc), (c, c_u, c_v, middle)
    _set_triangle(mesh, beyond, face, corners)
    mesh.owners[middle, 0], mesh.owners[middle, 1] = triangle, beyond
    _hand_over(mesh, side_bc, triangle, beyond)
    return forward


@compiled(ENTRY)
def _refine(
    coefficients: ConstFloatArray,
    surfaces: ConstIntArray,
    mesh: _Tables,
    node: int,
    triangle_count: int,
    edge_count: int,
    room: int,
    seeds: ConstIntArray,
    parameters: ConstFloatRows,
    turning: ConstIntArray,
    turns: ConstFloatRows,
) -> int:
    """Insert the seeds and split edges as long as one turns, in `_Tables` with room for more rows.

    `node`, `triangle_count` and `edge_count` say how many rows they have. Returns how often
    something was divided, −1 where there is too little room.
    """
    waiting = [(0.0, 0, 0.0)]
    waiting.pop()
    known, first_edge, first_node = triangle_count, edge_count, node
    seed_of = np.empty(2 * len(seeds), np.int64)
    for seed in range(len(seeds)):
        if node - first_node == room:
            return -1
        u, v = parameters[seed, 0], parameters[seed, 1]
        # The triangle may have been divided already: the piece that the node lies in.
        parent, deepest = seeds[seed], depth(mesh.corners[seeds[seed]], u, v)
        for piece in range(known, triangle_count):
            if seed_of[piece - known] == seeds[seed]:
                inside = depth(mesh.corners[piece], u, v)
                if inside > deepest:
                    parent, deepest = piece, inside
        for piece in range(triangle_count - known, triangle_count - known + 2):
            seed_of[piece] = seeds[seed]
        _insert(mesh, parent, u, v, node, triangle_count, edge_count)
        _set_node(mesh, node, coefficients, surfaces[mesh.faces[parent]], u, v)
        node, triangle_count, edge_count = node + 1, triangle_count + 2, edge_count + 3
    for edge in range(first_edge, edge_count):
        _look(waiting, coefficients, surfaces, mesh, edge)
    for k in range(len(turning)):
        heappush(waiting, (-turns[k, 1], turning[k], turns[k, 0]))
    while len(waiting):
        if node - first_node == room:
            return -1
        # The highest turn first: a crest is traced from edge to edge before what lies beside it.
        _, edge, share = heappop(waiting)
        first, rest = mesh.edge_nodes[edge, 0], edge_count
        _cut_edge(coefficients, surfaces, mesh, edge, share, node, rest)
        beside = (mesh.owners[edge, 0], mesh.owners[edge, 1])
        for k in range(2):
            beyond, middle = triangle_count + k, rest + 1 + k
            forward = _bisect(
                coefficients, surfaces, mesh, beside[k], edge, rest, node, first, share, beyond, middle
            )
            mesh.owners[edge, k] = beside[k] if forward else beyond
            mesh.owners[rest, k] = beyond if forward else beside[k]
        _look(waiting, coefficients, surfaces, mesh, edge)
        node, triangle_count, edge_count = node + 1, triangle_count + 2, edge_count + 3
        for new in range(rest, edge_count):
            _look(waiting, coefficients, surfaces, mesh, new)
    return node - first_node
