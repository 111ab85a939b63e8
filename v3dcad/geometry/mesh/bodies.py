"""The bodies of a triangle mesh: connected, wound alike, and nested in each other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from v3dcad.errors import GeometryError
from v3dcad.geometry.compiled.arrays import (
    ConstFloatArray,
    ConstFloatRows,
    ConstIntRows,
)
from v3dcad.geometry.compiled.options import ENTRY, INLINED, compiled
from v3dcad.model import Floats, Ints, Mesh
from v3dcad.words import counted

Flags = NDArray[np.bool_]

Pairs = list[tuple[int, int, float]]
"""Bodies i < j, counted from 0, and the volume that they share, mm³."""

SHOWN = 5
"""Most pairs of bodies that overlap, or bodies that are apart, which are named one by one."""

TOUCHES = 1e-3
"""mm: what begins no higher above the base stands on it."""


class Sides(NamedTuple):
    """The 3t sides of t triangles, sorted so that sides of one undirected edge are adjacent."""

    triangle: Ints
    """(3t,) whose side it is"""
    ends: Ints
    """(3t, 2) node ids in the triangle's own direction"""
    starts: Ints
    """(e + 1,) where each undirected edge begins"""

    def uses(self) -> Ints:
        """(e,) how many triangles share each edge."""
        return np.diff(self.starts)


def sides_of(triangles: Ints) -> Sides:
    """The sides of triangles (t, 3), by undirected edge."""
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    key = ends.min(axis=1) * (int(triangles.max(initial=-1)) + 1) + ends.max(axis=1)
    order = np.argsort(key, kind="stable")
    first = np.flatnonzero(np.diff(key[order], prepend=-1))
    return Sides(order // 3, ends[order], np.append(first, len(key)))


def sheets_of(triangles: Ints, sides: Sides) -> Ints:
    """(t,) the sheet of each triangle: they are joined across edges that two of them share."""
    pair = sides.starts[:-1][sides.uses() == 2]
    return _components(len(triangles), sides.triangle[pair], sides.triangle[pair + 1])[1]


def bodies_of(triangles: Ints) -> Ints:
    """(t,) the body of each triangle: its sheet, joined with others until their edges balance.

    So bodies that touch in an edge are apart, and of a closed mesh each body is closed.
    """
    sides = sides_of(triangles)
    sheet = sheets_of(triangles, sides)
    uses = sides.uses()
    if uses.max(initial=2) == 2:
        return sheet
    edge = np.repeat(np.arange(len(uses)), uses)
    owner = sheet[sides.triangle]
    way = np.where(sides.ends[:, 0] < sides.ends[:, 1], 1, -1)
    crowded = np.flatnonzero(uses[edge] > 2)
    pairs, which = np.unique(
        np.column_stack([edge[crowded], owner[crowded]]), axis=0, return_inverse=True
    )
    open_there = np.bincount(which.ravel(), way[crowded]) != 0
    ends, owners = pairs[open_there].T
    beside = np.flatnonzero(ends[1:] == ends[:-1])
    return _components(int(sheet.max()) + 1, owners[beside], owners[beside + 1])[1][sheet]


def wound_alike(triangles: Ints) -> tuple[Ints, int]:
    """The triangles (t, 3), some turned so that neighbours wind alike, and how many were turned.

    In each body the lesser part is turned. `GeometryError` for a one-sided surface.
    """
    sides = sides_of(triangles)
    pair = sides.starts[:-1][sides.uses() == 2]
    one, other = sides.triangle[pair], sides.triangle[pair + 1]
    opposed = sides.ends[pair, 0] == sides.ends[pair + 1, 0]
    if not opposed.any():
        return triangles, 0
    count, body = _components(len(triangles), one, other)
    # Each triangle twice, as it is and turned: joined copies wind alike.
    size = len(triangles)
    nodes = np.concatenate([one, one + size])
    partners = np.concatenate([other + size * opposed, other + size * ~opposed])
    _, sheet = _components(2 * size, nodes, partners)
    if np.any(sheet[:size] == sheet[size:]):
        raise GeometryError("the mesh has a one-sided surface, which has no inside")
    first = np.zeros(count, np.int64)
    first[body[::-1]] = np.arange(size)[::-1]
    turned = sheet[:size] != sheet[first[body]]
    most = np.bincount(body, turned, count) * 2 > np.bincount(body, minlength=count)
    turned ^= most[body]
    return np.where(turned[:, None], triangles[:, ::-1], triangles), int(turned.sum())


def _components(size: int, one: Ints, other: Ints) -> tuple[int, Ints]:
    graph = coo_array((np.ones(len(one), np.int8), (one, other)), shape=(size, size))
    count, labels = connected_components(graph, directed=False)
    return int(count), labels.astype(np.int64)


def signed_volumes(vertices: Floats, triangles: Ints, body: Ints) -> Floats:
    """(b,) signed volume of each closed body, mm³; negative where normals point inwards."""
    corners = vertices[triangles] - vertices.mean(axis=0)
    six = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return np.bincount(body, six) / 6


def containers(vertices: Floats, triangles: Ints, body: Ints) -> Flags:
    """(b, b) whether body i holds a corner of body j (then all of it, unless they overlap).

    By the winding number: the solid angle under which j's corner sees i, over 4π.
    """
    count = int(body.max(initial=-1)) + 1
    low, high = body_bounds(vertices, triangles, body)
    box = np.all((low[:, None] <= low) & (high[:, None] >= high), axis=2)
    np.fill_diagonal(box, False)
    inside = np.zeros((count, count), np.bool_)
    order = np.argsort(body, kind="stable")
    starts = np.searchsorted(body[order], np.arange(count + 1))
    for outer, inner in np.argwhere(box):
        point = vertices[triangles[order[starts[inner]], 0]]
        members = triangles[order[starts[outer] : starts[outer + 1]]]
        inside[outer, inner] = abs(_solid_angle(vertices, members, point)) > 2 * np.pi
    return inside


def body_bounds(vertices: Floats, triangles: Ints, body: Ints) -> tuple[Floats, Floats]:
    """(b, 3) least and (b, 3) greatest coordinates of each body, mm."""
    count = int(body.max(initial=-1)) + 1
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    corners = vertices[triangles]
    np.minimum.at(low, body, corners.min(axis=1))
    np.maximum.at(high, body, corners.max(axis=1))
    return low, high


def overlap_findings(bodies: str, pairs: Pairs) -> Iterator[str]:
    """What to report of bodies ("solids") that overlap."""
    for i, j, shared in sorted(pairs, key=lambda pair: -pair[2])[:SHOWN]:
        yield f"{bodies} {i + 1} and {j + 1} overlap by {shared:.4g} mm³: they are filled as one"
    if len(pairs) > SHOWN:
        yield f"{counted(len(pairs) - SHOWN, 'more pair')} of {bodies} overlap by less"


def parts_of(mesh: Mesh) -> Iterator[tuple[float, Floats]]:
    """The volume, mm³, and the box (2, 3), mm, of each body of a closed mesh, cavities aside."""
    body = bodies_of(mesh.triangles)
    boxes = np.stack(body_bounds(mesh.vertices, mesh.triangles, body), axis=1)
    volumes = signed_volumes(mesh.vertices, mesh.triangles, body)
    yield from ((float(volumes[k]), boxes[k]) for k in np.flatnonzero(volumes > 0))


def apart_findings(what: str, parts: Iterable[tuple[float, Floats]], base: float) -> Iterator[str]:
    """What to report of bodies of given volumes, mm³, and boxes (2, 3), mm, that are to be one.

    Those that begin above the height of the base hang in the air.
    """
    others = sorted(parts, key=lambda part: -part[0])[1:]
    if not others:
        return
    shown = []
    for volume, (low, high) in others[:SHOWN]:
        corners = " to ".join("({:.4g}, {:.4g}, {:.4g})".format(*corner) for corner in (low, high))
        above = low[2] - base
        lies = f"{above:.3g} mm up in the air" if above > TOUCHES else "on the bed"
        shown.append(f"{volume:.4g} mm³ at {corners}, {lies}")
    more = f", and {len(others) - SHOWN} more" if len(others) > SHOWN else ""
    yield (
        f"{what} are {len(others) + 1} bodies that hang together nowhere: beside the largest "
        f"{'; '.join(shown)}{more}"
    )


@compiled(INLINED)
def arm(vertices: ConstFloatRows, node: int, point: ConstFloatArray) -> tuple[float, float, float]:
    """The vector from a point (3,) to a vertex: x, y, z."""
    return vertices[node, 0] - point[0], vertices[node, 1] - point[1], vertices[node, 2] - point[2]


@compiled(INLINED)
def _dot(a: tuple[float, float, float], b: tuple[float, float, float]) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled(ENTRY)
def _solid_angle(
    vertices: ConstFloatRows, triangles: ConstIntRows, point: ConstFloatArray
) -> float:
    """Solid angle of triangles seen from a point (van Oosterom and Strackee 1983)."""
    total = 0.0
    for triangle in range(len(triangles)):
        a = arm(vertices, triangles[triangle, 0], point)
        b = arm(vertices, triangles[triangle, 1], point)
        c = arm(vertices, triangles[triangle, 2], point)
        la, lb, lc = np.sqrt(_dot(a, a)), np.sqrt(_dot(b, b)), np.sqrt(_dot(c, c))
        volume = (
            a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        )
        seen = la * lb * lc + _dot(a, b) * lc + _dot(b, c) * la + _dot(c, a) * lb
        total += 2 * np.arctan2(volume, seen)
    return total
