"""What lies on the bed: the first layer with something to print, its brim, and how it stands."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import islice, tee, zip_longest

import numpy as np
import shapely

from v3dcad.geometry.section_area import section_area
from v3dcad.model import Floats, Section
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.perimeters import inset, outermost_depth
from v3dcad.toolpath.skins import Cut

AUTO_BRIM = 5.0
"""mm: the brim of a part that stands on little."""
LITTLE_AREA, LITTLE_WIDTH = 100.0, 10.0
"""mm² and mm: less than these on the bed is little."""
RESOLUTION = 5e-4
"""mm: half of the last decimal that G-code has."""
TOPPLES = 5.0
"""A part this many times as high as its stand is wide does not stand safely."""
OVERHANGS = 0.05
"""Nor does one that stands on so small a share of its largest section."""


def cuts(sections: Iterable[Section], settings: PrintSettings) -> Iterator[Cut]:
    """The areas of sections, ascending in z.

    They are printed from the first one on that has room for a bead: a part that stands on a point
    or a line may begin with sections that have none. Where the first layer is higher than others,
    it takes in some more, so that the part comes out as high as it is, as nearly as whole layers
    let it. Corners of fine meshes that G-code could not tell from a straight line are left out; by
    them, most of the time would be lost. Sections of upright walls are the same again, and so is
    the cut then, which saves time all along.
    """
    last: Section | None = None
    cut = Cut(shapely.Polygon(), printed=False)
    begun: float | None = None  # z of the first section with room
    ahead, following = tee(sections)
    for section, above in zip_longest(ahead, islice(following, 1, None)):
        if last is None or not section.same_rings(last):
            area = section_area(section).simplify(RESOLUTION)
            last, cut = section, Cut(area, cut.printed)
        if not cut.printed:
            if begun is None and not inset(cut.area, outermost_depth(settings)).is_empty:
                begun = section.z
            if begun is not None:
                rise = above.z - section.z if above and above.z > section.z else math.inf
                short = settings.first_layer_height - (section.z - begun + rise)
                cut = cut._replace(printed=short < rise / 2 + RESOLUTION)
        yield cut


def brim_width(area: shapely.Geometry, settings: PrintSettings) -> float:
    """Mm of brim around a first layer: what is asked for; "auto" where it stands on little."""
    if not isinstance(settings.brim_width, str):
        return settings.brim_width
    little = area.area < LITTLE_AREA or stand_width(area) < LITTLE_WIDTH
    return AUTO_BRIM if little else 0.0


def stand_width(area: shapely.Geometry) -> float:
    """The least width of an area's convex hull, mm: across it the part topples most easily.

    The narrowest strip around a convex polygon lies along one of its sides.
    """
    hull = shapely.convex_hull(area)
    if hull.geom_type != "Polygon":
        return 0.0
    points = shapely.get_coordinates(hull)
    sides: Floats = np.diff(points, axis=0)
    normals = np.column_stack([-sides[:, 1], sides[:, 0]]) / np.hypot(*sides.T)[:, None]
    return float(np.ptp(points @ normals.T, axis=0).min())


def stands_badly(area: float, width: float, height: float, largest: float) -> bool:
    """Whether a part of a `height` (mm) may come loose or topple.

    It touches the bed with `area` (mm²), `width` wide (mm); its `largest` section is in mm².
    """
    return height > TOPPLES * width or area < OVERHANGS * largest
