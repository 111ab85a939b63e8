"""Fill sections with power diagrams: the structure's layers, and what they are slices of."""

from __future__ import annotations

import math
import warnings
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.graphs.spanning_tree import spanning_tree
from v3dcad.geometry.power_diagram.epochs import FIRST, Epoch
from v3dcad.geometry.power_diagram.event_queue import ALWAYS
from v3dcad.geometry.power_diagram.grid import STEPS, UTMOST, Grid, curve_order
from v3dcad.geometry.power_diagram.regular_triangulation import neighbour_pairs, triangulation
from v3dcad.geometry.section_area import section_area
from v3dcad.geometry.solid.facets import Facets, welded_facets
from v3dcad.model import Diagram, Floats, Ints, Layer, Section, Value
from v3dcad.settings import FillSettings
from v3dcad.structure.growth import PACE, growing, rounded_down, settled_offset
from v3dcad.structure.lazy_layers import LayerSequence
from v3dcad.structure.memory import keep_freed_memory
from v3dcad.structure.sweep.growing_sites import Timed
from v3dcad.structure.sweep.kinetic_sweep import Course, times_of
from v3dcad.structure.thesis.loop import ThesisFilling
from v3dcad.structure.walls import StrutAxes, Tracks, Walls, strut_axes, walls

AT_ONCE = 256
"""Most layers that are computed in one go, and"""
VERTICES_AT_ONCE = 1 << 16
"""about how many vertices: few enough to stay in the processor's cache and to be the same memory
again and again, whatever the number of layers."""


def fill_sections(
    sections: Sequence[Section],
    sites: Floats,
    settings: FillSettings,
    box: Floats | None = None,
) -> Filling | ThesisFilling:
    """Fill sections (ascending in z) with the power diagrams of sites (n, 2), mm.

    At z = 0 all weights are 0, and the spanning tree of the sites' Voronoi diagram picks every
    second of its levels to grow (its root, the first site along a Hilbert curve, stays, so that
    the order in which they are given does not matter): they gain `settings.offset` mm² of weight a
    layer, linear in z.
    Where cells become larger than on the first layer, new ones are born (unless
    `settings.insertion` is off). With `settings.method` "thesis" the thesis's own algorithms make
    the layers. Sites on the same grid point are merged, with a warning.

    The grid lies around `box`, the corners low and high (2, 2), mm, of the part's base rectangle,
    and all sites. Without a box it lies around the rings' points, whose last bits another way of
    cutting the same part may change.

    Raises `GeometryError` for a site or section that cannot be computed with (faulty rings are
    found when their layer is), `SettingError` for an offset that lets walls lean more than
    `settings.max_overhang`.
    """
    sites = np.ascontiguousarray(sites, np.float64).reshape(-1, 2)
    if not len(sites):
        raise GeometryError("there are no sites: give at least one")
    _refuse_rings(sections)
    heights = np.array([section.z for section in sections])
    for layer in np.nonzero(~np.isfinite(heights))[0]:
        raise GeometryError("its height is not a finite number", layer=int(layer))
    for layer in np.nonzero(heights < 0)[0]:
        raise GeometryError("it lies below z = 0: place the part on the bed", layer=int(layer))
    for layer in np.nonzero(np.diff(heights) <= 0)[0]:
        raise GeometryError(
            "it does not lie above the layer before: sort the sections by z", layer=int(layer) + 1
        )
    if box is None:
        box = _bounds(sections)
    elif not np.isfinite(box).all():
        raise GeometryError("the corners of the base rectangle are not finite numbers")
    low, high = _around(sites, box)
    grid = Grid.around(low, high)
    places = grid.snap(sites)
    kept = np.sort(np.unique(places @ (2 * STEPS, 1), return_index=True)[1])
    if len(kept) < len(places):
        warnings.warn(
            f"{len(places) - len(kept)} of {len(places)} sites lie on others "
            f"(within {grid.pitch:.2g} mm) and were merged with them",
            stacklevel=2,
        )
        places = places[kept]
    if settings.method == "thesis":
        return ThesisFilling(sections, places, grid, settings)
    return Filling(sections, places, grid, settings, np.stack([low, high]))


def _around(sites: Floats, box: Floats) -> tuple[Floats, Floats]:
    """The box low, high (2,), mm, around another and all sites that are finite numbers.

    Raises `GeometryError` for one so far outside that the grid around all would be coarse.
    """
    reach = 100 * (box[1] - box[0]).max()
    if reach > 0:
        far = (sites < box[0] - reach) | (sites > box[1] + reach)
        for site in np.nonzero((far & np.isfinite(sites)).any(axis=1))[0]:
            x, y = sites[site]
            raise GeometryError(
                f"({x:g}, {y:g}) mm is more than {reach:g} mm outside the part's base rectangle, "
                f"({box[0, 0]:g}, {box[0, 1]:g}) to ({box[1, 0]:g}, {box[1, 1]:g}) mm: move it "
                "nearer",
                site=int(site),
            )
    sound = sites[np.isfinite(sites).all(axis=1)]
    low = np.minimum(box[0], sound.min(axis=0, initial=np.inf))
    return low, np.maximum(box[1], sound.max(axis=0, initial=-np.inf))


def _refuse_rings(sections: Sequence[Section]) -> None:
    """Raise `GeometryError` for the first section with a ring that cannot be walked."""
    for start in range(0, len(sections), AT_ONCE):
        chunk = sections[start : start + AT_ONCE]
        for layer, section in enumerate(chunk, start):
            if any(len(ring) < 3 for ring in section.rings):
                raise GeometryError("one of its rings has fewer than three corners", layer=layer)
        rings = [ring for section in chunk for ring in section.rings]
        if rings and not np.isfinite(np.concatenate(rings)).all():
            for layer, section in enumerate(chunk, start):
                if not all(np.isfinite(ring).all() for ring in section.rings):
                    raise GeometryError("its rings are not finite numbers", layer=layer)


def _bounds(sections: Sequence[Section]) -> Floats:
    """The corners low and high (2, 2), mm, of the box around all rings; infinite without any."""
    low, high = [np.full(2, np.inf)], [np.full(2, -np.inf)]
    for start in range(0, len(sections), AT_ONCE):
        chunk = sections[start : start + AT_ONCE]
        rings = [ring for section in chunk for ring in section.rings]
        if rings:
            corners = np.concatenate(rings)
            low.append(corners.min(axis=0))
            high.append(corners.max(axis=0))
    return np.stack([np.min(low, axis=0), np.max(high, axis=0)])


@dataclass(frozen=True, eq=False, slots=True)
class History(Value):
    """All that happened on the way up through the layers, in grid units and whole times."""

    sites: Timed
    tracks: Tracks
    """how the vertices moved"""
    epochs: tuple[Epoch, ...]
    """what weights were counted from, one after the other (`epochs.py`)"""


class Layers(LayerSequence):
    """The layers of a filling: made one after the other, and anew for each iteration."""

    def __init__(self, filling: Filling) -> None:
        self._filling = filling

    def __len__(self) -> int:
        return len(self._filling.sections)

    def __iter__(self) -> Iterator[Layer]:
        return self._filling.climb()

    def layer(self, index: int) -> Layer:
        """Layer `index` by itself."""
        return self._filling.slice(self._filling.sections[index], index)


class Filling:
    """Sections filled with the slices of one power diagram in space.

    Sites keep their numbers; newborns get the next ones, in the order of their birth.
    """

    def __init__(
        self,
        sections: Sequence[Section],
        places: Ints,
        grid: Grid,
        settings: FillSettings,
        box: Floats,
    ) -> None:
        self.sections = sections
        self.grid = grid
        self.box = np.array([box[0], [box[1, 0], box[0, 1]], box[1], [box[0, 0], box[1, 1]]])
        """the base rectangle: corners (4, 2), mm, of the box around all sections and sites"""
        order = curve_order(places)
        still = np.zeros(len(places), np.int64)
        places = places[order]
        pairs = neighbour_pairs(triangulation(places, still), np.arange(len(places)))
        grows = growing(len(places), spanning_tree(places, pairs))
        self._heights = np.array([section.z for section in sections], np.float64)
        layers = self._heights.max(initial=0.0) / settings.layer_height
        safe = grid.utmost / layers if layers else math.inf
        offset = settled_offset(settings, grid.millimetres(places), grows, safe)
        if offset > safe:
            raise GeometryError(
                f"--offset {offset:g} takes its weight beyond the safe range of "
                f"±{grid.utmost:g} mm²: give at most {rounded_down(safe)}",
                site=int(order[np.argmax(grows)]),
            )
        self.settings = replace(settings, offset=offset)
        """the settings, with the offset that "auto" stands for"""
        self.growth_step = offset / settings.layer_height / PACE
        """mm² per mm of height that a site gains for each unit of growth"""
        always = np.full(len(places), ALWAYS)
        self._start = Timed(
            places, still, PACE * grows.astype(np.int64), always, np.zeros(len(places)), order
        )
        self._passed: Course | None = None

    @property
    def layers(self) -> Layers:
        """The layers, one for each section."""
        return Layers(self)

    @property
    def sites(self) -> Floats:
        """The sites at the start (n, 2), mm, as snapped to the grid."""
        return self.grid.millimetres(self._start.by_site().places)

    @property
    def births(self) -> Ints:
        """(b, 2) which layer gave birth to which site."""
        sites = self.history.sites
        newborn = np.nonzero(sites.born != ALWAYS)[0]
        times = times_of(self._heights, self.growth_step, self.grid)
        layers = np.searchsorted(times, sites.born[newborn])
        return np.column_stack([layers, sites.site_of[newborn]])

    @cached_property
    def history(self) -> History:
        """What happened on the way up; goes all the way where nobody has yet."""
        if not self.sections:
            nothing = Tracks(np.empty((0, 3), np.int64), np.empty((0, 2)), np.empty((0, 2, 2)), ())
            return History(self._start, nothing, (FIRST,))
        if self._passed is None:
            for _ in self.climb():
                pass
        assert self._passed is not None
        course, self._passed = self._passed, None
        return History(course.sites(), course.tracks(), tuple(course.epochs))

    @property
    def walls(self) -> Walls:
        """The facets between cells, from the first to the last layer, cut by the base rectangle."""
        return self._walls(self.history.tracks, self.history.sites.by_site())

    def _walls(self, tracks: Tracks, sites: Timed) -> Walls:
        places = self.grid.millimetres(sites.places)
        growth = self.growth_step * sites.growth.astype(np.float64)
        return walls(tracks, places, growth, self.box[[0, 2]])

    def facets(self, top: float) -> Facets:
        """The walls with shared corners, from the first layer to a height above the last, mm."""
        course = self._course(self._start, self._heights, top=top)
        for _ in self._climb(course):
            pass
        sites = course.sites().by_site()
        found = self._walls(course.tracks(), sites)
        places = self.grid.millimetres(sites.places)
        return welded_facets(found.sites, found.points, found.starts, places)

    @property
    def strut_axes(self) -> StrutAxes:
        """The lines where three cells meet, cut like the walls."""
        return strut_axes(self.history.tracks, self.box[[0, 2]])

    def at(self, z: float, section: Section | None = None) -> Diagram:
        """The diagram at any height z, mm, cut by a section's rings or else the base rectangle."""
        section = Section(z, (self.box,) if section is None else section.rings)
        _refuse_rings([section])
        return self.slice(section, 0).diagram

    def sites_at(self, points: Floats) -> Ints:
        """(k,) the site in whose cell each of the points (k, 3), mm, lies, inside a part or not.

        The one alive there with the least power distance: squared distance less weight. Raises
        `GeometryError` for points that are not finite, or so high that weights are not whole.
        """
        if not np.isfinite(points).all():
            raise GeometryError("the points' coordinates are not finite numbers")
        sites, square = self.history.sites.by_site(), self.grid.pitch**2
        for height in (points[:, 2].min(initial=0.0), points[:, 2].max(initial=0.0)):
            self._refuse_heavy(sites, height)
        places = self.grid.millimetres(sites.places)
        times = times_of(points[:, 2], self.growth_step, self.grid)
        nearest = []
        for place, time in zip(points[:, :2], times, strict=True):
            weights = square * (sites.base + sites.growth * time)
            power = ((places - place) ** 2).sum(axis=1) - weights
            nearest.append(np.where(sites.born <= time, power, np.inf).argmin())
        return np.array(nearest, np.int64)

    def slice(self, section: Section, index: int) -> Layer:
        """The layer with a given index of any section at any height, computed by itself."""
        sites, epochs = self.history.sites, self.history.epochs
        heights = np.array([section.z])
        self._refuse_heavy(sites, section.z)
        time = times_of(heights, self.growth_step, self.grid)[0]
        alive = int(np.count_nonzero(sites.born <= time))
        begun = bisect_left([epoch.start for epoch in epochs], time)
        epoch = epochs[max(begun - 1, 0)]
        course = self._course(sites.rows(slice(alive)), heights, epoch=epoch)
        layer = next(course.run([section], 0, np.inf))
        return replace(layer, index=index)

    def _refuse_heavy(self, sites: Timed, height: float) -> None:
        """Raise `GeometryError` where sites that there are at a height weigh too much there."""
        time = height * self.growth_step / self.grid.pitch**2
        if not math.isfinite(time):
            raise GeometryError("its height is not a finite number")
        unborn = (sites.born != ALWAYS) & (sites.born > time)
        safe = np.abs(sites.growth * time) <= UTMOST
        for row in np.nonzero(~(safe | unborn))[0]:
            raise GeometryError(
                f"its weight at a height of {height:g} mm is beyond the safe range of "
                f"±{self.grid.utmost:g} mm²: lower the offset or the height",
                site=int(sites.site_of[row]),
            )

    def _course(
        self, sites: Timed, heights: Floats, *, epoch: Epoch = FIRST, top: float | None = None
    ) -> Course:
        slope = math.tan(math.radians(self.settings.max_overhang))
        return Course(
            self.grid, sites, self.growth_step, heights, slope, self.box[[0, 2]],
            epoch=epoch, top=top,
        )  # fmt: skip

    def climb(self) -> Iterator[Layer]:
        """The layers from the first to the last, one at a time."""
        keep_freed_memory()
        if self.sections:
            course = self._course(self._start, self._heights)
            yield from self._climb(course)
            self._passed = course

    def _climb(self, course: Course) -> Iterator[Layer]:
        sections, full_cell, index = self.sections, np.inf, 0
        while index < len(sections):
            # The first layer by itself: what it has of area per cell is the measure for births;
            # where the part stands on less than one cell, what each site has of the base rectangle.
            vertices = 2 * len(self._start.places) + sum(map(len, sections[index].rings))
            some = max(1, min(AT_ONCE, VERTICES_AT_ONCE // vertices)) if index else 1
            for layer in course.run(sections[index : index + some], index, full_cell):
                yield layer
            if index == 0 and self.settings.insertion and self.growth_step > 0:
                share = float(np.prod(self.box[2] - self.box[0])) / len(self._start.places)
                foot = section_area(layer.section).area
                full_cell = layer.area_per_cell if foot > share else share
            index += some
