"""A mesh that knows the true surface: its sections have exactly the true section's topology.

Every mesh edge is a stretch of a B-rep edge or a straight stretch in a face's parameters, so
that between its nodes it is a curve on the true surface. Refined until

* every point of a face where its height is critical (crest, pit, saddle) is a node, and
* the height along every mesh edge is monotone,

the boundary of each (curved) triangle rises on one side and falls on the other, and no level
line closes inside it: every plane meets it in one stretch, from the edge where it descends to
the edge where it rises, or not at all (Morse theory, piece by piece). The mesh may be coarse,
and nothing is missed however thin.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from heapq import heappop, heappush

import numpy as np
from numba import njit

from v3dcad.errors import GeometryError
from v3dcad.geometry.curves import LINE, curve_at
from v3dcad.geometry.surfaces import PLANE, surface_at
from v3dcad.model import Floats, Ints, Value

NEGLIGIBLE = 1e-10
"""mm: a turn of an edge that rises less than this above its ends is not one."""

MOST_SPLITS = 200
"""Splits per edge that the mesh had: a bound for surfaces that ripple without end."""


@dataclass(frozen=True, eq=False, slots=True)
class SurfaceMesh(Value):
    """Triangles on true surfaces. Only numbers: it travels between processes as it is."""

    heap: Floats
    """the geometry of all curves and surfaces, see `curves` and `surfaces`"""
    surfaces: Ints
    """(f,) place of each face's surface in the heap"""
    nodes: Floats
    """(n, 3) mm"""
    triangles: Ints
    """(t, 3) node ids; two are equal at a pole"""
    corners: Floats
    """(t, 3, 2) parameters of each triangle's corners on its face's surface"""
    faces: Ints
    """(t,)"""
    sides: Ints
    """(t, 3) the mesh edge from corner j to corner j + 1; −1 for a side shrunk to a pole"""
    edge_nodes: Ints
    """(e, 2)"""
    edge_faces: Ints
    """(e,) a face on which the edge lies"""
    edge_curves: Ints
    """(e,) place of its curve in the heap, if it lies on an edge of the B-rep, else −1"""
    edge_spans: Floats
    """(e, 4) the curve's parameters at both nodes, or u, v at the first and u, v at the second"""


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


class _Refiner:
    """The mesh as lists, while it is being refined."""

    def __init__(self, mesh: SurfaceMesh) -> None:
        self.mesh = mesh
        self.nodes = mesh.nodes.tolist()
        self.triangles = mesh.triangles.tolist()
        self.corners = mesh.corners.tolist()
        self.faces = mesh.faces.tolist()
        self.sides = mesh.sides.tolist()
        self.edge_nodes = mesh.edge_nodes.tolist()
        self.edge_faces = mesh.edge_faces.tolist()
        self.edge_curves = mesh.edge_curves.tolist()
        self.edge_spans = mesh.edge_spans.tolist()
        self.waiting: list[tuple[float, int, float]] = []
        self.pieces: dict[int, list[int]] = {}
        self.owners: list[list[int]] = [[] for _ in self.edge_nodes]
        for triangle, sides in enumerate(self.sides):
            for edge in sides:
                if edge >= 0:
                    self.owners[edge].append(triangle)

    def result(self) -> SurfaceMesh:
        return replace(
            self.mesh,
            nodes=np.array(self.nodes),
            triangles=np.array(self.triangles),
            corners=np.array(self.corners),
            faces=np.array(self.faces),
            sides=np.array(self.sides),
            edge_nodes=np.array(self.edge_nodes),
            edge_faces=np.array(self.edge_faces),
            edge_curves=np.array(self.edge_curves),
            edge_spans=np.array(self.edge_spans),
        )

    def insert(self, triangle: int, u: float, v: float) -> None:
        """A new node inside a triangle, which becomes three; those may be divided again."""
        pieces = self.pieces.setdefault(triangle, [triangle])
        triangle = max(pieces, key=lambda piece: depth(np.array(self.corners[piece]), u, v))
        face, sides = self.faces[triangle], self.sides[triangle]
        nodes, corners = self.triangles[triangle], self.corners[triangle]
        node = self._node(surface_at(self.mesh.heap, self.mesh.surfaces[face], u, v)[0])
        spokes = [self._edge(node, nodes[k], face, [u, v, *corners[k]]) for k in range(3)]
        for k, child in enumerate([triangle, self._triangle(face), self._triangle(face)]):
            after = (k + 1) % 3
            self._disown(sides[k], triangle)
            self.triangles[child] = [node, nodes[k], nodes[after]]
            self.corners[child] = [[u, v], corners[k], corners[after]]
            self.sides[child] = [spokes[k], sides[k], spokes[after]]
            for side in self.sides[child]:
                self._own(side, child)
            if k:
                pieces.append(child)

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
        for triangle in self.owners[edge].copy():
            self._bisect(triangle, edge, rest, node, first, share, on_curve=curve >= 0)

    def _bisect(
        self,
        triangle: int,
        edge: int,
        rest: int,
        node: int,
        first: int,
        share: float,
        on_curve: bool,
    ) -> None:
        """Cut a triangle from the new node on its side to the opposite corner."""
        mesh, face = self.mesh, self.faces[triangle]
        k = self.sides[triangle].index(edge)
        order = (k, (k + 1) % 3, (k + 2) % 3)
        a, b, c = (self.triangles[triangle][j] for j in order)
        at_a, at_b, at_c = (self.corners[triangle][j] for j in order)
        _, side_bc, side_ca = (self.sides[triangle][j] for j in order)
        forward = a == first
        portion = share if forward else 1 - share
        u, v = (at_a[j] + portion * (at_b[j] - at_a[j]) for j in range(2))
        if on_curve:
            point = np.array(self.nodes[node])
            u, v = project(mesh.heap, mesh.surfaces[face], point, u, v)
        beyond = self._triangle(face)
        middle = self._edge(node, c, face, [u, v, *at_c])
        near, far = (edge, rest) if forward else (rest, edge)
        self.triangles[triangle], self.triangles[beyond] = [a, node, c], [node, b, c]
        self.corners[triangle] = [at_a, [u, v], at_c]
        self.corners[beyond] = [[u, v], at_b, at_c]
        self.sides[triangle], self.sides[beyond] = [near, middle, side_ca], [far, side_bc, middle]
        self._disown(edge, triangle)
        self._disown(side_bc, triangle)
        self._own(near, triangle)
        self._own(middle, triangle)
        for side in (far, side_bc, middle):
            self._own(side, beyond)

    def _node(self, point: Floats) -> int:
        self.nodes.append([float(x) for x in point])
        return len(self.nodes) - 1

    def _triangle(self, face: int) -> int:
        self.triangles.append([0, 0, 0])
        self.corners.append([[0.0, 0.0]] * 3)
        self.sides.append([-1, -1, -1])
        self.faces.append(face)
        return len(self.faces) - 1

    def _edge(self, first: int, last: int, face: int, span: list[float], curve: int = -1) -> int:
        self.edge_nodes.append([first, last])
        self.edge_faces.append(face)
        self.edge_curves.append(curve)
        self.edge_spans.append(span)
        self.owners.append([])
        self._look(len(self.edge_nodes) - 1)
        return len(self.edge_nodes) - 1

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

    def _own(self, edge: int, triangle: int) -> None:
        if edge >= 0:
            self.owners[edge].append(triangle)

    def _disown(self, edge: int, triangle: int) -> None:
        if edge >= 0:
            self.owners[edge].remove(triangle)


@njit(cache=True, nogil=True, error_model="numpy")
def depth(corners, u, v):  # type: ignore[no-untyped-def]
    """The least barycentric coordinate of (u, v) in a triangle (3, 2); −inf if it is flat."""
    a, b, c = corners[0], corners[1], corners[2]
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    if area == 0:
        return -np.inf
    beside_b = ((u - a[0]) * (c[1] - a[1]) - (v - a[1]) * (c[0] - a[0])) / area
    beside_c = ((b[0] - a[0]) * (v - a[1]) - (b[1] - a[1]) * (u - a[0])) / area
    return min(beside_b, beside_c, 1 - beside_b - beside_c)


@njit(cache=True, nogil=True, error_model="numpy")
def along_edge(heap, surface, curve, span, share):  # type: ignore[no-untyped-def]
    """Point at a share of the way along a mesh edge, and its z slope: x, y, z, dz/dshare."""
    if curve >= 0:
        step = span[1] - span[0]
        point = curve_at(heap, curve, span[0] + share * step)
        return point[0], point[1], point[2], point[5] * step
    u_step, v_step = span[2] - span[0], span[3] - span[1]
    s = surface_at(heap, surface, span[0] + share * u_step, span[1] + share * v_step)
    return s[0, 0], s[0, 1], s[0, 2], s[1, 2] * u_step + s[2, 2] * v_step


@njit(cache=True, nogil=True, error_model="numpy")
def turning_points(heap, surfaces, faces, curves, spans):  # type: ignore[no-untyped-def]
    """(e, 2) `turning_point` of every edge."""
    turns = np.empty((len(faces), 2))
    for edge in range(len(faces)):
        turns[edge] = turning_point(heap, surfaces[faces[edge]], curves[edge], spans[edge])
    return turns


@njit(cache=True, nogil=True, error_model="numpy")
def turning_point(heap, surface, curve, span):  # type: ignore[no-untyped-def]
    """Share of the way at which an edge's height turns the most, and by how much above or below
    its nearer end (mm); 0 and 0 if it is monotone.
    """
    straight = heap[curve] == LINE if curve >= 0 else heap[surface] == PLANE
    if straight:
        return 0.0, 0.0
    pieces = 8
    start = along_edge(heap, surface, curve, span, 0.0)
    stop = along_edge(heap, surface, curve, span, 1.0)
    best, found = 0.0, 0.0
    before = start[3]
    for piece in range(pieces):
        slope = along_edge(heap, surface, curve, span, (piece + 1) / pieces)[3]
        if before * slope < 0:
            low, high = piece / pieces, (piece + 1) / pieces
            for _ in range(48):
                middle = (low + high) / 2
                if along_edge(heap, surface, curve, span, middle)[3] * slope < 0:
                    low = middle
                else:
                    high = middle
            z = along_edge(heap, surface, curve, span, low)[2]
            rise = min(abs(z - start[2]), abs(z - stop[2]))
            if rise > max(best, NEGLIGIBLE):
                best, found = rise, low
        before = slope
    return found, best


@njit(cache=True, nogil=True, error_model="numpy")
def project(heap, surface, point, u, v):  # type: ignore[no-untyped-def]
    """Parameters of the point of a surface next to a point, by Gauss–Newton from (u, v)."""
    for _ in range(20):
        s = surface_at(heap, surface, u, v)
        gap = point - s[0]
        uu, uv, vv = s[1] @ s[1], s[1] @ s[2], s[2] @ s[2]
        determinant = uu * vv - uv * uv
        if determinant <= 1e-14 * uu * vv:
            break
        a, b = s[1] @ gap, s[2] @ gap
        u_step = (vv * a - uv * b) / determinant
        v_step = (uu * b - uv * a) / determinant
        u, v = u + u_step, v + v_step
        if uu * u_step * u_step + vv * v_step * v_step < 1e-26:
            break
    return u, v
