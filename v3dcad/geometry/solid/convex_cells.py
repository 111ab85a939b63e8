"""Convex polyhedra, cut by half-spaces."""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np

from v3dcad.arguments import above_zero
from v3dcad.errors import SettingError
from v3dcad.geometry.solid.facets import Facets
from v3dcad.model import Floats, Ints, Mesh


class Polyhedron(NamedTuple):
    """A convex polyhedron; seen from outside the corners of its faces run counter-clockwise."""

    points: Floats
    """(v, 3)"""
    faces: list[list[int]]
    """point ids of each face"""

    def volume(self) -> float:
        """Its volume: the divergence theorem over fans of triangles."""
        corners = self.points[self.triangles()] - self.points[0]
        return float(np.linalg.det(corners).sum()) / 6

    def triangles(self) -> Ints:
        """(t, 3) point ids: each face as a fan."""
        fans = [
            (face[0], face[k], face[k + 1]) for face in self.faces for k in range(1, len(face) - 1)
        ]
        return np.array(fans, np.int64)

    def mesh(self) -> Mesh:
        """Its surface as triangles."""
        return Mesh(self.points, self.triangles())


def box(low: Floats, high: Floats) -> Polyhedron:
    """The box between two corners (3,)."""
    points = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float64)
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Polyhedron(low + points * (high - low), faces)


def cut(solid: Polyhedron, normal: Floats, offset: float) -> Polyhedron | None:
    """The part of a polyhedron in the half-space normal · x ≤ offset; None where there is none.

    A corner on the plane counts as inside, so that every corner has one side and the new face
    always closes; where the plane runs through corners there are edges without length, which
    `welded` removes.
    """
    above = (solid.points @ normal - offset).tolist()
    if max(above) <= 0:
        return solid
    if min(above) > 0:
        return None
    points = solid.points.tolist()
    crossings: dict[tuple[int, int], int] = {}

    def crossing(a: int, b: int) -> int:
        key = (a, b) if a < b else (b, a)
        if key not in crossings:
            a, b = key
            share = above[a] / (above[a] - above[b])
            crossings[key] = len(points)
            points.append([p + share * (q - p) for p, q in zip(points[a], points[b], strict=True)])
        return crossings[key]

    faces, rim = [], {}
    for face in solid.faces:
        kept: list[int] = []
        left = entered = -1
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            if above[a] <= 0:
                kept.append(a)
            if (above[a] <= 0) != (above[b] <= 0):
                kept.append(crossing(a, b))
                if above[a] <= 0:
                    left = kept[-1]
                else:
                    entered = kept[-1]
        if kept:
            faces.append(kept)
        if left >= 0:
            rim[entered] = left
    first = next(iter(rim))
    lid = [first]
    while rim[lid[-1]] != first:
        lid.append(rim[lid[-1]])
    return _compact(np.array(points), [*faces, lid])


def _compact(points: Floats, faces: list[list[int]]) -> Polyhedron:
    """Without the points that no face uses."""
    used, ids = np.unique(np.concatenate(faces), return_inverse=True)
    ends = np.cumsum([len(face) for face in faces])[:-1]
    return Polyhedron(points[used], [part.tolist() for part in np.split(ids, ends)])


def welded(solid: Polyhedron, tolerance: float) -> Polyhedron | None:
    """With corners joined where an edge between them is no longer than the tolerance.

    None where nothing solid is left.
    """
    root = list(range(len(solid.points)))

    def find(point: int) -> int:
        while root[point] != point:
            point = root[point]
        return point

    for face in solid.faces:
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            if np.abs(solid.points[a] - solid.points[b]).max() <= tolerance:
                a, b = sorted((find(a), find(b)))
                root[b] = a
    faces = []
    for face in solid.faces:
        ids = [find(point) for point in face]
        around = [b for a, b in zip(ids[-1:] + ids[:-1], ids, strict=True) if a != b]
        if len(around) > 2:
            faces.append(around)
    return _compact(solid.points, faces) if len(faces) > 3 else None


def hollows(walls: Facets, thickness: float, low: Floats, high: Floats) -> list[Polyhedron]:
    """The cells within the box low … high (3,) less walls of a thickness, mm.

    Warns how many cells close up; raises `SettingError` where all do, and for a thickness of 0.
    """
    above_zero("thickness", thickness)
    cells = inset_cells(walls, thickness / 2, low, high)
    if not cells:
        raise SettingError(
            "thickness", f"thickness {thickness:g} mm closes all cells; give a smaller one"
        )
    _warn_of_closed(len(np.unique(walls.sites)) - len(cells), f"thickness of {thickness:g} mm")
    return list(cells.values())


def check_diameter(walls: Facets, diameter: float, low: Floats, high: Floats) -> None:
    """Warn how many cells within the box low … high (3,) bars of a diameter, mm, close up.

    Raises `SettingError` for a diameter of 0.
    """
    above_zero("diameter", diameter)
    whole, closed = box(low, high), 0
    for planes, middle in _half_spaces(walls, diameter / 2).values():
        # Mostly the middle of a cell shows that it stays open.
        inside = (low < middle).all() and (middle < high).all()
        if not inside or (planes[:, :3] @ middle >= planes[:, 3]).any():
            closed += _cell(planes, whole) is None
    _warn_of_closed(closed, f"diameter of {diameter:g} mm")


def _warn_of_closed(closed: int, size: str) -> None:
    if closed:
        narrow = "1 cell is" if closed == 1 else f"{closed} cells are"
        warnings.warn(f"{narrow} narrower than a {size}, and filled solid", stacklevel=5)


def inset_cells(walls: Facets, inset: float, low: Floats, high: Floats) -> dict[int, Polyhedron]:
    """Each cell with all its walls moved inward by `inset`, mm, within the box low … high (3,).

    Keys are site ids, ascending; cells that close up are left out. A cell is the intersection of
    the half-spaces of its walls, and stays so when they are moved (an offset with mitred edges).
    """
    whole = box(low, high)
    cells = {site: _cell(planes, whole) for site, (planes, _) in _half_spaces(walls, inset).items()}
    return {site: cell for site, cell in cells.items() if cell}


def _half_spaces(walls: Facets, inset: float) -> dict[int, tuple[Floats, Floats]]:
    """By site: the planes (k, 4) of its walls moved inward, normals n with n · x ≤ offset; and the
    mean (3,) of the walls' middles.
    """
    vectors = walls.vectors()
    areas = np.linalg.norm(vectors, axis=1)
    sound = areas > 0
    normals = vectors[sound] / areas[sound, None]
    corners = walls.points[walls.corners]
    on = corners[walls.starts[:-1]][sound]
    middles = np.add.reduceat(corners, walls.starts[:-1]) / np.diff(walls.starts)[:, None]
    offsets = (on * normals).sum(axis=1)
    first, second = walls.sites[sound].T
    owner = np.concatenate([first, second])
    planes = np.column_stack(
        [np.vstack([normals, -normals]), np.concatenate([offsets, -offsets]) - inset]
    )
    order = np.argsort(owner, kind="stable")
    sites, begins = np.unique(owner[order], return_index=True)
    around = np.tile(middles[sound], (2, 1))[order]
    count = np.diff([*begins, len(order)])[:, None]
    middle = np.add.reduceat(around, begins) / count if len(begins) else around
    split = np.split(planes[order], begins[1:])
    return dict(zip(sites.tolist(), zip(split, middle, strict=True), strict=True))


def _cell(planes: Floats, whole: Polyhedron) -> Polyhedron | None:
    """A polyhedron cut by half-spaces (k, 4); None where nothing solid is left."""
    cell: Polyhedron | None = whole
    for plane in planes:
        cell = cut(cell, plane[:3], float(plane[3])) if cell else None
    cell = welded(cell, 1e-6) if cell else None
    return cell if cell and cell.volume() > 0 else None
