"""Where a layer is solid: under every face that looks up, and over every face that looks down.

A point is in a skin if the part ends within so many layers above it, or below. Sections are
compared, so it does not matter where on the part that is.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import shapely

from v3dcad.toolpath.perimeters import inset, opened

NOTHING = shapely.Polygon()

ANCHOR = 2.0
"""Bead spacings by which a skin reaches into the foam, to rest on it."""
LEAST_SKIN = 2.0
"""Bead spacings: where a skin is narrower, perimeters close the part."""
LEAST_FOAM = 4.0
"""Bead spacings: where foam is narrower, a skin beside it goes on."""
SLIVER = 1e-4
"""mm: what is thinner, on average, is rounding."""


class Cut(NamedTuple):
    """The area of a layer's section, and whether it is printed: not so below the first."""

    area: shapely.Geometry
    printed: bool


class Shell(NamedTuple):
    """A layer's area and what of it must be solid."""

    cut: Cut
    skin: shapely.Geometry


class _Bare(NamedTuple):
    """A layer's area, and where the part has nothing under it and nothing on it."""

    cut: Cut
    under: shapely.Geometry
    on: shapely.Geometry


def shells(cuts: Iterable[Cut], bottom: int, top: int) -> Iterator[Shell]:
    """Each layer's skin, `bottom` layers thick over faces downward, `top` under upward ones.

    What is not printed counts as air, and so does the bed. A layer is held until `top` more have
    come.
    """
    if not bottom and not top:
        yield from (Shell(cut, NOTHING) for cut in cuts)
        return
    under: deque[shapely.Geometry] = deque(maxlen=bottom)
    waiting: deque[_Bare] = deque()

    def shell() -> Shell:
        on = [bare.on for bare in waiting][:top]
        cut, below, _ = waiting.popleft()
        under.append(below)
        bare = [area for area in (*under, *on) if not area.is_empty]
        return Shell(cut, shared(cut.area, shapely.union_all(bare)) if bare else NOTHING)

    for bare in _bare(cuts):
        waiting.append(bare)
        if len(waiting) >= max(top, 1):
            yield shell()
    while waiting:
        yield shell()


def _bare(cuts: Iterable[Cut]) -> Iterator[_Bare]:
    """What lies bare of each layer, as soon as the next is known."""
    before: Cut | None = None
    under = NOTHING
    for cut in cuts:
        here = cut.area if cut.printed else NOTHING
        below = before.area if before and before.printed else NOTHING
        if before:
            yield _Bare(before, under, _minus(below, here))
        before, under = cut, _minus(here, below)
    if before:
        yield _Bare(before, under, before.area if before.printed else NOTHING)


def _minus(area: shapely.Geometry, other: shapely.Geometry) -> shapely.Geometry:
    """One area without another, but for slivers that sections of one upright wall leave.

    That most walls have the very same section again saves time.
    """
    if area is other or area.equals_exact(other):
        return NOTHING
    parts = shapely.get_parts(shapely.difference(area, other))
    wide = parts[2 * shapely.area(parts) > SLIVER * shapely.length(parts)]
    return shapely.multipolygons(wide) if len(wide) else NOTHING


def shared(area: shapely.Geometry, other: shapely.Geometry) -> shapely.Geometry:
    """What two areas share, without the lines and points where they only touch.

    GEOS cannot intersect an area and such a line, together, with nothing.
    """
    both = shapely.intersection(area, other)
    if both.geom_type != "GeometryCollection":
        return both
    parts = shapely.get_parts(both)
    return shapely.multipolygons(parts[shapely.area(parts) > 0])


def parted(
    inner: shapely.Geometry, skin: shapely.Geometry, spacing: float
) -> tuple[shapely.Geometry, shapely.Geometry]:
    """What of an area inside the perimeters is foam, and what is skin; beads `spacing` mm apart.

    The skin reaches a little into the foam and rests there; strips too narrow go to the other side.
    """
    wanted = opened(shared(skin, inner), LEAST_SKIN * spacing / 2)
    if wanted.is_empty:
        return inner, NOTHING
    return widened(inner, inner, inset(wanted, -ANCHOR * spacing), spacing)


def widened(
    inner: shapely.Geometry, foam: shapely.Geometry, skin: shapely.Geometry, spacing: float
) -> tuple[shapely.Geometry, shapely.Geometry]:
    """What is foam and what is skin inside the perimeters, where some of the foam is skin too."""
    foam = opened(shapely.difference(foam, skin), LEAST_FOAM * spacing / 2)
    foam = shared(foam, inner)
    return foam, opened(shapely.difference(inner, foam), spacing / 4)
