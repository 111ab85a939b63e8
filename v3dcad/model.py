"""The value types that flow from part to printer: frozen, read-only, in mm, mm², mm³, mm/s.

`Part` → `Section` → `Layer` (section, `SiteState`, `Diagram`) → `Toolpath`. Types are compared
by identity; their arrays cannot be written to. `docs` of each field give shape and unit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bytes = NDArray[np.int8]

OUTSIDE = -1
"""The "site" on the far side of an edge that lies on the section's boundary."""

TRAVEL, EXTRUDE, RETRACT, UNRETRACT = range(4)
"""Kinds of a toolpath's points: what the printer does on the way to the point."""

NOTHING, RETRACED, CELLS, PERIMETER, SOLID, BRIM, SKIRT = range(7)
"""Features of a toolpath's points: what is printed, or passed again, on the way to the point."""


class Value:
    """Base of the value types: their arrays are seen through read-only views."""

    __slots__ = ()

    def __post_init__(self) -> None:
        for name in self.__dataclass_fields__:  # type: ignore[attr-defined]
            content = getattr(self, name)
            if isinstance(content, np.ndarray):
                if content.flags.writeable:
                    object.__setattr__(self, name, _read_only(content))
            elif isinstance(content, tuple) and content and isinstance(content[0], np.ndarray):
                object.__setattr__(self, name, tuple(map(_read_only, content)))


def _read_only(array: NDArray[Any]) -> NDArray[Any]:
    view = array.view()
    view.flags.writeable = False
    return view


@dataclass(frozen=True, eq=False, slots=True)
class Mesh(Value):
    """Triangles with shared vertices, outward normals by the right-hand rule."""

    vertices: Floats
    """(v, 3) mm"""
    triangles: Ints
    """(t, 3) vertex ids"""


@dataclass(frozen=True, eq=False, slots=True)
class Placement(Value):
    """The rigid motion from a source to the bed: p ↦ rotation · p + translation."""

    rotation: Floats
    """(3, 3)"""
    translation: Floats
    """(3,) mm"""

    def to_bed(self, points: Floats) -> Floats:
        """The points (n, 3), given where the source lies, in bed coordinates."""
        turned: Floats = points if self._is_shift() else points @ self.rotation.T
        return turned + self.translation

    def to_source(self, points: Floats) -> Floats:
        """The points (n, 3), given in bed coordinates, where the source lies."""
        moved: Floats = points - self.translation
        return moved if self._is_shift() else moved @ self.rotation

    def _is_shift(self) -> bool:
        return bool(np.array_equal(self.rotation, np.eye(3)))


class Run(NamedTuple):
    """A stretch of a ring that lies on one face: points start … stop of ring `ring`.

    `curve` is "line", "circle", "ellipse" or "points"; `parameters` describe the exact curve
    (circle: centre x, y, radius; ellipse: centre x, y, major axis vector x, y, minor/major
    ratio), and are empty otherwise. `stop` may be the ring's length, which means its first point.
    """

    ring: int
    start: int
    stop: int
    curve: str
    face: int
    parameters: tuple[float, ...]


@dataclass(frozen=True, eq=False, slots=True)
class Section(Value):
    """A horizontal plane ∩ the part: rings, outer counter-clockwise, holes clockwise, open."""

    z: float
    """mm above the bed"""
    rings: tuple[Floats, ...]
    """each (k, 2) mm; the material lies on the left of every ring"""
    runs: tuple[Run, ...] = ()
    """which stretch of a ring is which exact curve; empty for triangles"""


class Part(Protocol):
    """A solid that can be sectioned: what the kernel makes of a file or shape."""

    @property
    def name(self) -> str:
        """A short name, such as the file's stem."""

    @property
    def bounds(self) -> Floats:
        """(2, 3) least and greatest coordinates, mm."""

    @property
    def findings(self) -> tuple[str, ...]:
        """What the user should know of how it was read: what was left out or mended."""

    def contents(self) -> dict[str, str]:
        """What it is made of, as lines to show."""

    def placed(self, placement: Placement) -> Part:
        """The same part, moved."""

    def sections(self, heights: Floats) -> Sequence[Section]:
        """Its sections at ascending heights (mm).

        Each is the limit from below, but for the section at the part's base (z = 0), which is
        the limit from above.
        """

    def mesh(self) -> Mesh:
        """Its surface as triangles."""


@dataclass(frozen=True, eq=False, slots=True)
class SiteState(Value):
    """The sites of one layer and what they weigh there."""

    sites: Floats
    """(n, 2) mm"""
    weights: Floats
    """(n,) mm²"""
    growth: Floats
    """(n,) mm² per mm of height"""
    born_at: Floats
    """(n,) mm; 0 for those that were there from the start"""


@dataclass(frozen=True, eq=False, slots=True)
class Diagram(Value):
    """A power diagram cut by a section, as a planar graph; each edge is held once.

    The second site of an edge lies on its left, the first on its right. On the section's
    boundary the first is `OUTSIDE` (−1), so i < j holds for every row of `edge_sites`.
    """

    vertices: Floats
    """(v, 2) mm"""
    edges: Ints
    """(e, 2) vertex ids"""
    edge_sites: Ints
    """(e, 2) site ids, i < j"""
    neighbours: Ints
    """(m, 2) site ids, i < j: pairs that share an edge inside the section"""

    def inner(self) -> NDArray[np.bool_]:
        """(e,) which edges separate two cells (the others lie on the section's boundary)."""
        return np.asarray(self.edge_sites[:, 0] != OUTSIDE)

    def sites(self) -> Ints:
        """(c,) ids of the sites that have a cell, ascending."""
        found: Ints = np.unique(self.edge_sites)
        return np.asarray(found[found != OUTSIDE])

    def lengths(self) -> Floats:
        """(e,) edge lengths, mm."""
        ends = self.vertices[self.edges]
        return np.asarray(np.hypot(*(ends[:, 1] - ends[:, 0]).T))

    def areas(self, count: int) -> Floats:
        """(count,) area of each site's cell inside the section, mm²; 0 where it has none.

        Green's theorem over the edges: each adds to the cell on its left and takes from the
        one on its right.
        """
        if not len(self.edges):
            return np.zeros(count)
        origin = self.vertices.mean(axis=0)
        start, stop = np.moveaxis(self.vertices[self.edges] - origin, 1, 0)
        swept = (start[:, 0] * stop[:, 1] - start[:, 1] * stop[:, 0]) / 2
        left, right = self.edge_sites[:, 1], self.edge_sites[:, 0]
        inner = self.inner()
        gained = np.bincount(left, swept, count)
        return np.asarray(gained - np.bincount(right[inner], swept[inner], count), np.float64)


@dataclass(frozen=True, eq=False, slots=True)
class Layer(Value):
    """One layer of a structure: a section and the diagram that fills it."""

    index: int
    section: Section
    state: SiteState
    diagram: Diagram
    tree: Ints
    """(m, 2) site ids, i < j: a minimum spanning tree of the neighbours by length"""
    area_per_cell: float
    """section area ÷ number of cells, mm²"""

    @property
    def z(self) -> float:
        """Height of the layer's section above the bed, mm."""
        return self.section.z


@dataclass(frozen=True, eq=False, slots=True)
class Toolpath(Value):
    """What the nozzle does, point by point, in bed coordinates."""

    points: Floats
    """(p, 3) mm, where each step ends"""
    kind: Bytes
    """(p,) TRAVEL, EXTRUDE, RETRACT or UNRETRACT"""
    volume: Floats
    """(p,) mm³ of material laid on the way to the point"""
    speed: Floats
    """(p,) mm/s"""
    layer: Ints
    """(p,) index of the layer that the step belongs to"""
    feature: Bytes
    """(p,) CELLS, PERIMETER, SOLID, BRIM or SKIRT where it extrudes, RETRACED on a way already
    extruded, NOTHING elsewhere"""
    centre: Floats
    """(p, 2) mm, centre of the circle that the step follows; NaN where it is straight"""


@dataclass(frozen=True, eq=False, slots=True)
class Recipe(Value):
    """What an `.ont` file holds: all that is needed to make a structure again."""

    offset: float
    """mm² per layer"""
    layer_height: float
    """mm"""
    sites: Floats
    """(n, 3) mm"""
    boundary: Mesh
    name: str


def concatenated(toolpaths: Sequence[Toolpath]) -> Toolpath:
    """One toolpath after the other, as one."""
    parts: Any = [
        np.concatenate([getattr(path, field.name) for path in toolpaths])
        for field in fields(Toolpath)
    ]
    return Toolpath(*parts)
