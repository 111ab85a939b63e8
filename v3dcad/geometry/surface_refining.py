"""Adding nodes to a `SurfaceMesh` until the height along every edge is monotone."""

from __future__ import annotations

from dataclasses import replace
from heapq import heappop, heappush
from typing import Any

import numpy as np
from numpy.typing import NDArray

from v3dcad.errors import GeometryError
from v3dcad.geometry.curves import curve_at
from v3dcad.geometry.surface_mesh import (
    SurfaceMesh,
    depth,
    project,
    turning_point,
    turning_points,
)
from v3dcad.geometry.surfaces import surface_at
from v3dcad.model import Floats, Ints

MOST_SPLITS = 200
"""Splits per edge that the mesh had: a bound for surfaces that ripple without end."""


def refined(mesh: SurfaceMesh, triangles: Ints, parameters: Floats) -> SurfaceMesh:
    """The mesh with new nodes at parameters (k, 2) in its triangles (k,), and all edges monotone.

    `GeometryError` where a face ripples so much that this does not end.
    """
    refiner = _Refiner(mesh)
    for triangle, (u, v) in zip(triangles.tolist(), parameters.tolist(), strict=True):
        refiner.insert(triangle, u, v)
    turns = turning_points(
        mesh.heap, mesh.surfaces, mesh.edge_faces, mesh.edge_curves, mesh.edge_spans
    )
    for edge in np.flatnonzero(turns[:, 1] > 0).tolist():
        refiner.await_split(edge, *turns[edge].tolist())
    if not refiner.waiting:
        return mesh
    limit = MOST_SPLITS * len(mesh.edge_nodes)
    while refiner.waiting:
        # The highest turn first: a crest is traced from edge to edge before what lies beside it.
        _, edge, share = heappop(refiner.waiting)
        refiner.split(edge, share)
        if len(refiner.edge_nodes) > limit:
            raise GeometryError(
                "a face of the part ripples too finely to be sliced: simplify the surface"
            )
    return refiner.result()


class _Rows:
    """An array whose rows can be changed, and added to: few of many, one at a time."""

    def __init__(self, rows: NDArray[Any]) -> None:
        self.rows = rows
        self.count = len(rows)
        self.changed: dict[int, Any] = {}

    def __getitem__(self, index: int) -> Any:
        row = self.changed.get(index)
        return self.rows[index].tolist() if row is None else row

    def __setitem__(self, index: int, row: Any) -> None:
        self.changed[index] = row

    def __len__(self) -> int:
        return self.count

    def add(self, row: Any) -> int:
        """Append a row; returns its index."""
        self.changed[self.count] = row
        self.count += 1
        return self.count - 1

    def result(self) -> NDArray[Any]:
        """The array with all its rows."""
        whole = np.empty((self.count, *self.rows.shape[1:]), self.rows.dtype)
        whole[: len(self.rows)] = self.rows
        if self.changed:
            whole[list(self.changed)] = list(self.changed.values())
        return whole


class _Refiner:
    """The mesh while it is being refined."""

    def __init__(self, mesh: SurfaceMesh) -> None:
        self.mesh = mesh
        self.nodes = _Rows(mesh.nodes)
        self.triangles = _Rows(mesh.triangles)
        self.corners = _Rows(mesh.corners)
        self.faces = _Rows(mesh.faces)
        self.sides = _Rows(mesh.sides)
        self.edge_nodes = _Rows(mesh.edge_nodes)
        self.edge_faces = _Rows(mesh.edge_faces)
        self.edge_curves = _Rows(mesh.edge_curves)
        self.edge_spans = _Rows(mesh.edge_spans)
        order = np.argsort(mesh.sides.ravel(), kind="stable")
        beside = order[np.count_nonzero(mesh.sides < 0) :] // 3
        self.owners = _Rows(beside.reshape(-1, 2))
        self.waiting: list[tuple[float, int, float]] = []
        self.pieces: dict[int, list[int]] = {}

    def result(self) -> SurfaceMesh:
        """The refined mesh."""
        return replace(
            self.mesh,
            nodes=self.nodes.result(),
            triangles=self.triangles.result(),
            corners=self.corners.result(),
            faces=self.faces.result(),
            sides=self.sides.result(),
            edge_nodes=self.edge_nodes.result(),
            edge_faces=self.edge_faces.result(),
            edge_curves=self.edge_curves.result(),
            edge_spans=self.edge_spans.result(),
        )

    def insert(self, triangle: int, u: float, v: float) -> None:
        """A new node inside a triangle, which becomes three; those may be divided again."""
        pieces = self.pieces.setdefault(triangle, [triangle])
        triangle = max(pieces, key=lambda piece: depth(np.array(self.corners[piece]), u, v))
        face, sides = self.faces[triangle], self.sides[triangle]
        nodes, corners = self.triangles[triangle], self.corners[triangle]
        node = self._node(surface_at(self.mesh.heap, self.mesh.surfaces[face], u, v)[0])
        spokes = [self._edge(node, nodes[k], face, [u, v, *corners[k]]) for k in range(3)]
        children = [triangle, self._triangle(face), self._triangle(face)]
        pieces += children[1:]
        for k, child in enumerate(children):
            after, before = (k + 1) % 3, children[k - 1]
            self.triangles[child] = [node, nodes[k], nodes[after]]
            self.corners[child] = [[u, v], corners[k], corners[after]]
            self.sides[child] = [spokes[k], sides[k], spokes[after]]
            self._hand_over(sides[k], triangle, child)
            self.owners[spokes[k]] = [before, child]

    def split(self, edge: int, share: float) -> None:
        """Cut an edge, and the triangles beside it, at a share of the way along it."""
        mesh = self.mesh
        face, curve = self.edge_faces[edge], self.edge_curves[edge]
        first, last = self.edge_nodes[edge]
        span = self.edge_spans[edge]
        if curve >= 0:
            cut = [span[0] + share * (span[1] - span[0])]
            node = self._node(np.array(curve_at(mesh.heap, curve, cut[0])[:3]))
            before, after = [span[0], cut[0], 0.0, 0.0], [cut[0], span[1], 0.0, 0.0]
        else:
            cut = [span[k] + share * (span[k + 2] - span[k]) for k in range(2)]
            node = self._node(surface_at(mesh.heap, mesh.surfaces[face], *cut)[0])
            before, after = [*span[:2], *cut], [*cut, *span[2:]]
        self.edge_nodes[edge] = [first, node]
        self.edge_spans[edge] = before
        self._look(edge)
        rest = self._edge(node, last, face, after, curve)
        halves = [
            self._bisect(triangle, edge, rest, node, first, share) for triangle in self.owners[edge]
        ]
        self.owners[edge], self.owners[rest] = zip(*halves, strict=True)

    def _bisect(
        self, triangle: int, edge: int, rest: int, node: int, first: int, share: float
    ) -> tuple[int, int]:
        """Cut a triangle from the new node on its side to the opposite corner.

        Returns the triangles that now have the edge and the rest of it.
        """
        mesh, face = self.mesh, self.faces[triangle]
        k = self.sides[triangle].index(edge)
        order = (k, (k + 1) % 3, (k + 2) % 3)
        nodes, corners, sides = (
            self.triangles[triangle],
            self.corners[triangle],
            self.sides[triangle],
        )
        a, b, c = (nodes[j] for j in order)
        at_a, at_b, at_c = (corners[j] for j in order)
        _, side_bc, side_ca = (sides[j] for j in order)
        forward = a == first
        portion = share if forward else 1 - share
        u, v = (at_a[j] + portion * (at_b[j] - at_a[j]) for j in range(2))
        if self.edge_curves[edge] >= 0:
            point = np.array(self.nodes[node])
            u, v = project(mesh.heap, mesh.surfaces[face], point, u, v)
        beyond = self._triangle(face)
        middle = self._edge(node, c, face, [u, v, *at_c])
        near, far = (edge, rest) if forward else (rest, edge)
        self.triangles[triangle], self.triangles[beyond] = [a, node, c], [node, b, c]
        self.corners[triangle], self.corners[beyond] = [at_a, [u, v], at_c], [[u, v], at_b, at_c]
        self.sides[triangle], self.sides[beyond] = [near, middle, side_ca], [far, side_bc, middle]
        self.owners[middle] = [triangle, beyond]
        self._hand_over(side_bc, triangle, beyond)
        return (triangle, beyond) if forward else (beyond, triangle)

    def _hand_over(self, edge: int, giver: int, taker: int) -> None:
        if edge >= 0:
            self.owners[edge] = [taker if one == giver else one for one in self.owners[edge]]

    def _node(self, point: Any) -> int:
        return self.nodes.add(point)

    def _triangle(self, face: int) -> int:
        for rows in (self.triangles, self.corners, self.sides):
            rows.add(-1)
        return self.faces.add(face)

    def _edge(self, first: int, last: int, face: int, span: list[float], curve: int = -1) -> int:
        edge = self.edge_nodes.add([first, last])
        self.edge_faces.add(face)
        self.edge_curves.add(curve)
        self.edge_spans.add(span)
        self.owners.add(-1)
        self._look(edge)
        return edge

    def _look(self, edge: int) -> None:
        """Have an edge split if it is not monotone."""
        place = self.mesh.surfaces[self.edge_faces[edge]]
        share, rise = turning_point(
            self.mesh.heap, place, self.edge_curves[edge], np.array(self.edge_spans[edge])
        )
        if rise > 0:
            self.await_split(edge, share, rise)

    def await_split(self, edge: int, share: float, rise: float) -> None:
        """Have an edge split, which turns at a share of its way and rises there."""
        heappush(self.waiting, (-rise, edge, share))
