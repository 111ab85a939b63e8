"""The value types that flow from part to printer: frozen, read-only, in mm, mm², mm³, mm/s.

`Part` → `Section` → `Layer` (section, `SiteState`, `Diagram`) → `Toolpath`. Types are compared
by identity; their arrays cannot be written to. `docs` of each field give shape and unit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from v3dcad.errors import SettingError
from v3dcad.settings import FillSettings
from v3dcad.svg import CONTOUR, ON_SCREEN, WALL, lines_svg, sections_svg
from v3dcad.words import counted

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bytes = NDArray[np.int8]

OUTSIDE = -1
"""The "site" on the far side of an edge that lies on the section's boundary."""

TRAVEL, EXTRUDE, RETRACT, UNRETRACT = range(4)
"""Kinds of a toolpath's points: what the printer does on the way to the point."""

FEATURES = 8
NO_FEATURE, CELLS, PERIMETER, SOLID, BRIM, SKIRT, INNER_PERIMETER, BRIDGE = range(FEATURES)
"""Features of a toolpath's points: what is printed, or passed again, on the way to the point."""

Progress = Callable[[str, int, int], object]
"""Hears of a step of long work, and how much of how much is done in it."""


def unheard(step: str, done: int, of: int) -> None:
    """The progress that nobody listens to."""


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

    def __repr__(self) -> str:
        return f"<Mesh of {counted(len(self.triangles), 'triangle')}>"


@dataclass(frozen=True, eq=False, slots=True)
class Placement(Value):
    """The rigid motion from a source to the bed: p ↦ rotation · p + translation."""

    rotation: Floats
    """(3, 3)"""
    translation: Floats
    """(3,) mm"""

    @classmethod
    def none(cls) -> Placement:
        """No motion at all."""
        return cls(np.eye(3), np.zeros(3))

    def then(self, other: Placement) -> Placement:
        """Both motions, this one first."""
        return Placement(
            other.rotation @ self.rotation, other.rotation @ self.translation + other.translation
        )

    def to_bed(self, points: Floats) -> Floats:
        """The points (n, 3), given where the source lies, in bed coordinates."""
        turned: Floats = points if self.is_shift() else points @ self.rotation.T
        return turned + self.translation

    def to_source(self, points: Floats) -> Floats:
        """The points (n, 3), given in bed coordinates, where the source lies."""
        moved: Floats = points - self.translation
        return moved if self.is_shift() else moved @ self.rotation

    def inverse(self) -> Placement:
        """The motion back."""
        return Placement(self.rotation.T, -(self.translation @ self.rotation))

    def is_shift(self) -> bool:
        """Whether nothing is turned."""
        return bool(np.array_equal(self.rotation, np.eye(3)))

    def is_still(self) -> bool:
        """Whether nothing is moved at all."""
        return self.is_shift() and not self.translation.any()


class CurveRun(NamedTuple):
    """A stretch of a ring on one curve of one face: points start … stop of ring `ring`.

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
    runs: tuple[CurveRun, ...] = ()
    """which stretch of a ring is which exact curve; empty for triangles"""

    def same_rings(self, other: Section) -> bool:
        """Whether another section has the same rings, point by point."""
        return len(self.rings) == len(other.rings) and all(
            map(np.array_equal, self.rings, other.rings)
        )

    def svg(self) -> str:
        """The section as the text of an SVG file, 1 unit a millimetre."""
        return "".join(sections_svg([self]))

    def _repr_svg_(self) -> str:
        """How a notebook shows it."""
        return "".join(sections_svg([self], ON_SCREEN))

    def __repr__(self) -> str:
        points = counted(sum(map(len, self.rings)), "point")
        return f"<Section at z {self.z:g} mm: {counted(len(self.rings), 'ring')}, {points}>"


def part_words(part: Part) -> str:
    """A part in a few words: its name and size."""
    return f"{part.name!r}, {size_words(part)}"


def size_words(part: Part) -> str:
    """A part's size in words, such as "60 × 40 × 48 mm"; hundredths are enough above 1 mm."""
    sides = np.ptp(part.bounds, axis=0).tolist()
    return " × ".join(f"{round(side, 2) if side >= 1 else side:.6g}" for side in sides) + " mm"


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

    @property
    def placement(self) -> Placement:
        """How it came to where it is from where its source lies."""

    @property
    def library(self) -> str:
        """The CAD library that its shapes are given back to (`sources.LIBRARIES`); "" for none."""

    def contents(self) -> dict[str, str]:
        """What it is made of, as lines to show."""

    def normal(self, face: int) -> Floats:
        """(3,) outward unit normal of a plane face, or of a triangle, by its number from 0.

        `SettingError` where there is no such face, or it is not plane.
        """

    def face_mesh(self, faces: tuple[int, ...]) -> Mesh:
        """Some of its faces as triangles, by their numbers from 0; of triangles, these themselves.

        `SettingError` where there is no such face.
        """

    def placed(self, placement: Placement) -> Part:
        """The same part, moved."""

    def sections(
        self, heights: Floats, chord_tolerance: float = ..., executor: Executor | None = None
    ) -> Sequence[Section]:
        """Its sections at ascending heights (mm), rings within `chord_tolerance` (mm).

        Each is the limit from below, but for the section at the part's base, which is the limit
        from above. With an executor several planes are computed at a time; the results are the
        same.
        """

    def exact(self, layer: Layer) -> Layer:
        """A layer of the part whose walls end on the true surface, not on contours' chords."""

    def mesh(self) -> Mesh:
        """Its surface as triangles."""


class SiteState(Protocol):
    """The sites of a structure and what they weigh on one layer, rows by site number.

    Sites without a cell on the layer are among them.
    """

    @property
    def sites(self) -> Floats:
        """(n, 3) mm, bed coordinates; z is 0 for sites that are points of a plane."""

    @property
    def weights(self) -> Floats:
        """(n,) mm², but for what is common to all."""

    @property
    def growth(self) -> Floats:
        """(n,) mm² per mm of height."""

    def present(self) -> Ints:
        """(p,) the sites that may have a cell here, ascending: all that have one are among them."""

    def spanning_tree(self, pairs: Ints) -> Ints:
        """The minimum spanning forest (k, 2) of pairs (m, 2), i < j, by distance in x and y."""


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

    def __repr__(self) -> str:
        edges = counted(len(self.edges), "edge")
        return f"<Diagram of {counted(len(self.sites()), 'cell')}: {edges}>"

    def inner(self) -> NDArray[np.bool_]:
        """(e,) which edges separate two cells (the others lie on the section's boundary)."""
        return np.asarray(self.edge_sites[:, 0] != OUTSIDE)

    def sites(self) -> Ints:
        """(c,) ids of the sites that have a cell, ascending."""
        seen = np.zeros(int(self.edge_sites.max(initial=OUTSIDE)) + 2, np.bool_)
        seen[self.edge_sites] = True  # OUTSIDE, which is -1, is the last one
        return np.asarray(np.flatnonzero(seen[:-1]))

    def lengths(self) -> Floats:
        """(e,) edge lengths, mm."""
        ends = self.vertices[self.edges]
        return np.asarray(np.hypot(*(ends[:, 1] - ends[:, 0]).T))

    def areas(self, count: int) -> Floats:
        """(count,) area of each site's cell inside the section, mm²; 0 where it has none.

        Green's theorem over the edges: each adds to the cell on its left and takes from the
        one on its right. Raises `SettingError` for a count that leaves out a site with a cell.
        """
        least = int(self.edge_sites.max(initial=OUTSIDE)) + 1
        if not isinstance(count, (int, np.integer)) or count < least:
            raise SettingError(
                "count", f"count {count}: give the number of all sites, len(layer.state.sites)"
            )
        if not len(self.edges):
            return np.zeros(count)
        origin = self.vertices.mean(axis=0)
        start, stop = np.moveaxis(self.vertices[self.edges] - origin, 1, 0)
        swept = (start[:, 0] * stop[:, 1] - start[:, 1] * stop[:, 0]) / 2
        left, right = self.edge_sites[:, 1], self.edge_sites[:, 0]
        inner = self.inner()
        gained = np.bincount(left, swept, count)
        return np.asarray(gained - np.bincount(right[inner], swept[inner], count), np.float64)

    def cells(self) -> dict[int, list[Floats]]:
        """The cells as polygons: for each site that has one, ascending, its rings (k, 2), mm.

        Rings are open, and the cell lies on their left: outer ones run counter-clockwise, holes
        clockwise. A cell that the section divides, or that goes round a hole, has several. Where a
        cell touches itself in a vertex, one ring passes there twice or two rings meet.

        Every edge is walked once on each side that has a cell: at a vertex, as many edges of a cell
        end as begin, and each that ends is followed by one that begins.
        """
        inner = self.inner()
        begin = np.concatenate([self.edges[:, 0], self.edges[inner, 1]])
        end = np.concatenate([self.edges[:, 1], self.edges[inner, 0]])
        owner = np.concatenate([self.edge_sites[:, 1], self.edge_sites[inner, 0]])
        ending, beginning = np.lexsort((end, owner)), np.lexsort((begin, owner))
        following = np.empty(len(owner), np.int64)
        following[ending] = beginning
        successors, owners = following.tolist(), owner.tolist()
        walked = [False] * len(owners)
        found: dict[int, list[Floats]] = {}
        for first in beginning.tolist():
            ring = []
            edge = first
            while not walked[edge]:
                walked[edge] = True
                ring.append(edge)
                edge = successors[edge]
            if ring:
                found.setdefault(owners[first], []).append(self.vertices[begin[ring]])
        return found


@dataclass(frozen=True, eq=False, slots=True)
class Layer(Value):
    """One layer of a structure: a section and the diagram that fills it."""

    index: int
    section: Section
    state: SiteState
    diagram: Diagram
    area_per_cell: float
    """section area ÷ number of cells, mm²"""

    def __repr__(self) -> str:
        cells = counted(len(self.diagram.sites()), "cell")
        return f"<Layer {self.index} at z {self.z:g} mm: {cells}>"

    @property
    def tree(self) -> Ints:
        """(m, 2) site ids, i < j: the minimum spanning tree of the neighbours by their distance.

        Computed when it is asked for.
        """
        return self.state.spanning_tree(self.diagram.neighbours)

    def slopes(self, pairs: Ints) -> Floats:
        """(m,) how far the wall between two sites moves per height, for pairs (m, 2) of sites."""
        i, j = pairs.T
        state = self.state
        apart = np.hypot(*(state.sites[i, :2] - state.sites[j, :2]).T)
        return np.asarray(np.abs(state.growth[i] - state.growth[j]) / (2 * apart))

    @property
    def z(self) -> float:
        """Height of the layer's section above the bed, mm."""
        return self.section.z

    def svg(self) -> str:
        """Walls and contours as the text of an SVG file, 1 unit a millimetre."""
        return self._svg(None)

    def _repr_svg_(self) -> str:
        """How a notebook shows it."""
        return self._svg(ON_SCREEN)

    def _svg(self, pixels: float | None) -> str:
        ends, inner = self.diagram.vertices[self.diagram.edges], self.diagram.inner()
        lines = {"walls": (WALL, ends[inner]), "contours": (CONTOUR, ends[~inner])}
        return lines_svg(f"layer {self.index}, z {self.z:g} mm", lines, pixels)


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
    """(p,) CELLS, PERIMETER, INNER_PERIMETER, SOLID, BRIDGE, BRIM or SKIRT where it extrudes,
    NO_FEATURE elsewhere"""
    centre: Floats
    """(p, 2) mm, centre of the circle that the step follows; NaN where it is straight"""

    def __repr__(self) -> str:
        return f"<Toolpath of {counted(len(self.points), 'point')}>"


@dataclass(frozen=True, eq=False, slots=True)
class Brep(Value):
    """Solids as the bytes of the geometry kernel, as placed on the bed."""

    data: bytes
    """OCCT's BinTools format, without triangles"""
    bounds: Floats
    """(2, 3) least and greatest coordinates, mm"""

    def __repr__(self) -> str:
        return f"<Brep of {counted(len(self.data), 'byte')}>"


@dataclass(frozen=True, slots=True, kw_only=True)
class Checksum:
    """What two structures must have in common to be the same; sums are hexadecimal."""

    layers: int
    cells: int
    """sites, those without a cell in the part among them"""
    walls: int
    """neighbours, over all layers"""
    sites: str
    weights: str
    topology: str
    sha256: str
    """of all that the others are made of"""

    COUNTS: ClassVar = ("layers", "cells", "walls")
    DIGITS: ClassVar = {"sites": 8, "weights": 8, "topology": 8, "sha256": 64}

    def as_text(self) -> dict[str, str]:
        """All fields as text, in order."""
        return {name: str(getattr(self, name)) for name in (*self.COUNTS, *self.DIGITS)}

    def differences(self, written: Checksum) -> list[str]:
        """What differs from another, as was written in a file; empty where nothing does."""
        counts = [
            f"{getattr(self, name)} {name} instead of {getattr(written, name)}"
            for name in self.COUNTS
            if getattr(self, name) != getattr(written, name)
        ]
        sums = [name for name in self.DIGITS if getattr(self, name) != getattr(written, name)]
        return counts + [f"other {name}" for name in sums if name != "sha256" or sums == [name]]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Recipe(Value):
    """What an `.ont` file holds: all that is needed to make a structure again."""

    name: str
    settings: FillSettings
    sites: Floats | None
    """(n, 3) mm, bed coordinates; None where settings and boundary scatter them again"""
    boundary: Mesh | Brep
    """the part as placed on the bed"""
    placement: Placement
    """how it came there from where its source lies"""
    checksum: Checksum | None = None
    """of the structure; None where a file has none, as the thesis's"""
    software: str = ""
    """what wrote it; empty for the thesis's form"""

    def __repr__(self) -> str:
        layers = f", {counted(self.checksum.layers, 'layer')}" if self.checksum else ""
        return f"<Recipe of {self.name!r}: {self.settings.method}{layers}>"
