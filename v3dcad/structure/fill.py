"""Fill sections with a foam: its layers, and what they are slices of."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from v3dcad.arguments import rows
from v3dcad.errors import GeometryError
from v3dcad.geometry.solid.facets import Facets
from v3dcad.model import Checksum, Diagram, Floats, Ints, Layer, Section
from v3dcad.settings import FillSettings
from v3dcad.structure.checksum import foam_checksum
from v3dcad.structure.foam.choice import foam_for
from v3dcad.structure.foam.sites import FoamSites, SlicedSites
from v3dcad.structure.foam.space import Space, space_of
from v3dcad.structure.lazy_layers import LayerSequence
from v3dcad.structure.sweep.kinetic_sweep import Sliced, Sweep
from v3dcad.structure.thesis.loop import ThesisFilling, thesis_filling
from v3dcad.structure.walls import StrutAxes, Walls

AT_ONCE = 256
"""Most layers that are computed in one go, and"""
VERTICES_AT_ONCE = 1 << 16
"""about how many vertices: few enough to stay in the processor's cache and to be the same memory
again and again, whatever the number of layers."""

ROUNDING = 1e-9
"""By which share a height may lie over the top."""


def fill_sections(
    sections: Sequence[Section],
    sites: Floats | None,
    settings: FillSettings,
    box: Floats | None = None,
) -> Filling | ThesisFilling:
    """Fill sections (ascending in z) with the cells of a foam, or by the thesis's method.

    `sites` (n, 3), mm, bed coordinates, are points in space, (n, 2) columns; None takes those that
    the settings say. `box` (2, 2) are the corners of the part's base rectangle, mm: by default of
    the box around all rings, whose last bits another way of cutting the same part may change.

    Raises `GeometryError` for a site or section that cannot be computed with (faulty rings are
    found when their layer is), `SettingError` for settings that do not fit the part, and for sites
    with a wall that leans more than `settings.max_overhang`.
    """
    refuse_heights(sections)
    refuse_rings(sections)
    bare = not any(section.rings for section in sections)
    if bare and (len(sections) or box is None):
        raise GeometryError("no section has a ring: there is nothing to fill")
    if box is None:
        box = rings_box(sections)
    else:
        box = rows("box", box, "x, y")
        if len(box) != 2:
            raise GeometryError(f"the base rectangle has two corners, not {len(box)}: box (2, 2)")
        if not np.isfinite(box).all():
            raise GeometryError("the corners of the base rectangle are not finite numbers")
    if settings.method == "thesis":
        return thesis_filling(sections, sites, settings, box)
    top = (sections[-1].z if sections else 0.0) + settings.layer_height
    foam, settled = foam_for(np.append(box[0], 0.0), np.append(box[1], top), sites, settings)
    return Filling(sections, foam, settled, box, top)


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
    """Sections filled with the slices of one Voronoi diagram in space."""

    def __init__(
        self,
        sections: Sequence[Section],
        foam: FoamSites,
        settings: FillSettings,
        box: Floats,
        top: float,
    ) -> None:
        """Fill sections (ascending in z) with the cells of a foam's sites.

        `box` (2, 2), mm, are the corners of the part's base rectangle; the foam's cells are known
        over it from 0 to `top`, mm.
        """
        self.sections, self.foam, self.settings = sections, foam, settings
        self.grid = foam.grid
        self.box = np.array([box[0], [box[1, 0], box[0, 1]], box[1], [box[0, 0], box[1, 1]]])
        """the base rectangle: corners (4, 2), mm"""
        self.sites = foam.millimetres()
        """(n, 3) mm: the sites, those around the part among them, as snapped to the grid"""
        self.sites.flags.writeable = False
        self._top = top
        self._swept, self._block = foam.swept(), foam.block()
        self._heights = np.array([section.z for section in sections], np.float64)

    @property
    def layers(self) -> Layers:
        """The layers, one for each section."""
        return Layers(self)

    def checksum(self, layers: Iterable[Layer]) -> Checksum:
        """The check sum of the filling's layers; goes through them once."""
        return foam_checksum(layers, self.foam)

    def space(self, low: float, high: float) -> Space:
        """The cells' walls and struts in the base rectangle between two heights, mm."""
        corners = np.array([[*self.box[0], low], [*self.box[2], high]])
        return space_of(self.foam, corners)

    @property
    def walls(self) -> Walls:
        """The facets between cells, from the first to the last layer, cut by the base rectangle."""
        return self.space(*self._extent()).walls()

    @property
    def strut_axes(self) -> StrutAxes:
        """The lines where three cells meet, cut like the walls."""
        return self.space(*self._extent()).strut_axes()

    def facets(self, box: Floats) -> Facets:
        """The walls with shared corners in a box (2, 3), mm."""
        return space_of(self.foam, box).facets()

    def _extent(self) -> tuple[float, float]:
        if not len(self._heights):
            return 0.0, 0.0
        return float(self._heights[0]), float(self._heights[-1])

    def at(self, z: float, section: Section | None = None) -> Diagram:
        """The diagram at any height z, mm, cut by a section's rings or else the base rectangle."""
        section = Section(z, (self.box,) if section is None else section.rings)
        refuse_rings([section])
        return self.slice(section, 0).diagram

    def sites_at(self, points: Floats) -> Ints:
        """(k,) the site in whose cell each of the points (k, 3), mm, lies, inside a part or not.

        It is the nearest one where heights are divided by the stretch. Raises `GeometryError` for
        points that are not finite.
        """
        if not np.isfinite(points).all():
            raise GeometryError("the points' coordinates are not finite numbers")
        return self.foam.nearest(points)

    def slice(self, section: Section, index: int) -> Layer:
        """The layer with a given index of any section over the base rectangle, by itself.

        Raises `GeometryError` for a height below the bed, or over a layer's above the last layer.
        """
        if not math.isfinite(section.z):
            raise GeometryError("its height is not a finite number")
        if not 0 <= section.z <= self._top * (1 + ROUNDING):
            raise GeometryError(
                f"z = {section.z:g} mm lies outside the foam: give a height from 0 to "
                f"{self._top:g} mm"
            )
        times = self.foam.times(np.array([section.z]))
        sweep = Sweep(self.grid, self._swept, times, self._block)
        return self._layer(index, section, next(sweep.run([section], 0)), int(times[0]))

    def climb(self) -> Iterator[Layer]:
        """The layers from the first to the last, one at a time."""
        sections, index = self.sections, 0
        times = self.foam.times(self._heights)
        sweep = Sweep(self.grid, self._swept, times, self._block)
        some = 1
        while index < len(sections):
            chunk = sections[index : index + some]
            for layer, sliced in enumerate(sweep.run(chunk, index), index):
                some = VERTICES_AT_ONCE // (len(sliced[0].vertices) + 1)
                yield self._layer(layer, sections[layer], sliced, int(times[layer]))
            index, some = index + len(chunk), max(1, min(AT_ONCE, some))

    def _layer(self, index: int, section: Section, sliced: Sliced, time: int) -> Layer:
        diagram, area_per_cell = sliced
        state = SlicedSites(self.foam, self.sites, time)
        return Layer(index, section, state, diagram, area_per_cell)


def refuse_heights(sections: Sequence[Section]) -> None:
    """Raise `GeometryError` unless heights of sections are finite, ascending, and not below 0."""
    heights = np.array([section.z for section in sections])
    for layer in np.nonzero(~np.isfinite(heights))[0]:
        raise GeometryError("its height is not a finite number", layer=int(layer))
    for layer in np.nonzero(heights < 0)[0]:
        raise GeometryError("it lies below z = 0: place the part on the bed", layer=int(layer))
    for layer in np.nonzero(np.diff(heights) <= 0)[0]:
        raise GeometryError(
            "it does not lie above the layer before: sort the sections by z", layer=int(layer) + 1
        )


def refuse_rings(sections: Sequence[Section]) -> None:
    """Raise `GeometryError` for the first section with a ring that cannot be walked."""
    for start in range(0, len(sections), AT_ONCE):
        chunk = sections[start : start + AT_ONCE]
        for layer, section in enumerate(chunk, start):
            if any(ring.ndim != 2 or ring.shape[1] != 2 for ring in section.rings):
                raise GeometryError("one of its rings is not made of rows of x, y", layer=layer)
            if any(len(ring) < 3 for ring in section.rings):
                raise GeometryError("one of its rings has fewer than three corners", layer=layer)
        rings = [ring for section in chunk for ring in section.rings]
        if rings and not np.isfinite(np.concatenate(rings)).all():
            for layer, section in enumerate(chunk, start):
                if not all(np.isfinite(ring).all() for ring in section.rings):
                    raise GeometryError("its rings are not finite numbers", layer=layer)


def rings_box(sections: Sequence[Section]) -> Floats:
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
