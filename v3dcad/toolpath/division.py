"""What each layer's section is divided into: foam, skins, and what of the skins are bridges."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import tee
from typing import NamedTuple

import shapely

from v3dcad.errors import GeometryError
from v3dcad.model import Section
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.bands import NO_BANDS, Bands, bands
from v3dcad.toolpath.bead import bead_spacing
from v3dcad.toolpath.first_layer import cuts
from v3dcad.toolpath.perimeters import inset, opened, outermost_depth
from v3dcad.toolpath.skins import NOTHING, parted, shared, shells, widened

ANCHOR = 3.0
"""Bead spacings by which a bridge goes on over what holds it."""
LEAST_BRIDGE = 2.0
"""Bead spacings: a narrower strip over air is held from both sides."""
LEAST_HELD = 1.1
"""Bead spacings: what lies that far over foam is held by ribs. The rest leans on its neighbours."""


class Division(NamedTuple):
    """A layer's section, what it is divided into inside the perimeters, and how high it is."""

    area: shapely.Geometry
    printed: bool
    """not so below the first layer with something to print"""
    first: bool
    """whether it lies on the bed"""
    level: float
    """mm above the bed, where its beads end"""
    height: float
    """mm from the layer below, or the bed"""
    spacing: float
    """mm between two beads side by side"""
    foam: shapely.Geometry
    """where there are cells"""
    rest: shapely.Geometry
    """skins on what is solid below"""
    over: shapely.Geometry
    """skins over cells or air"""
    bands: Bands
    """where perimeters and skins lie over foam: ribs are to hold them along the bands' sides"""

    def solid(self) -> shapely.Geometry:
        """Perimeters and skins."""
        return shapely.difference(self.area, self.foam)


def divided(sections: Iterable[tuple[int, Section]], settings: PrintSettings) -> Iterator[Division]:
    """Divide sections, each with its layer's number, ascending in z.

    The first one with something to print lies on the bed, as high as the first layer's beads; the
    others are as far above it as their sections are, each filling the height to the one below.
    Skins over cells go on as far as to ribs on both sides. Raises `GeometryError` where sections
    do not ascend. Sections are held as long as skins under faces above ask for.
    """
    kept, ahead = tee(sections)
    found = shells(cuts((section for _, section in ahead), settings), *settings.solid_layers())
    last: Division | None = None
    above, pitch = 0.0, settings.rib_pitch()
    for (index, section), ((area, printed), skin) in zip(kept, found, strict=True):
        if not printed:
            yield Division(area, False, True, 0, 0, 0, NOTHING, NOTHING, NOTHING, NO_BANDS)
            continue
        above = above if last else settings.first_layer_height - section.z
        height = section.z + above - (last.level if last else 0.0)
        if height <= 0:
            raise GeometryError(
                f"its section at {section.z:g} mm is not above the one below; "
                "give layers in ascending order",
                layer=index,
            )
        spacing = bead_spacing(settings, height)
        inner = inset(area, perimeter_depths(settings, spacing)[-1] + spacing / 2)
        foam, skin = parted(inner, skin, spacing)
        held = NO_BANDS
        if last and pitch and foam is not last.foam:
            spans = _over(area, foam, last.foam, spacing)
            if not spans.is_empty:
                foam, skin = widened(inner, foam, bands(spans, pitch).area(), spacing)
                spans = _over(area, foam, last.foam, spacing)
            held = bands(spans, pitch)
        rest, over = skin, NOTHING
        if last and not skin.is_empty:
            rest, over = _resting(skin, last.solid(), spacing)
        level = section.z + above
        last = Division(area, True, not last, level, height, spacing, foam, rest, over, held)
        yield last


def perimeter_depths(settings: PrintSettings, spacing: float) -> list[float]:
    """How deep inside the contour each perimeter's centre line runs, mm, outermost first."""
    return [outermost_depth(settings) + number * spacing for number in range(settings.perimeters)]


def _over(
    area: shapely.Geometry, foam: shapely.Geometry, below: shapely.Geometry, spacing: float
) -> shapely.Geometry:
    """Where an area's perimeters and skins lie over the foam `below` so far that ribs hold them."""
    bare = shared(shapely.difference(area, foam), below)
    return opened(bare, LEAST_HELD * spacing / 2)


def _resting(
    skin: shapely.Geometry, solid: shapely.Geometry, spacing: float
) -> tuple[shapely.Geometry, shapely.Geometry]:
    """What of a skin rests on what is `solid` below, and what is a bridge, ends and all."""
    radius = LEAST_BRIDGE * spacing / 2
    bare = inset(shapely.difference(skin, solid), radius)
    if bare.is_empty:
        return skin, NOTHING
    grown = inset(bare, -radius - ANCHOR * spacing)
    rest = opened(shapely.difference(skin, grown), radius)
    return rest, shapely.difference(skin, rest)
