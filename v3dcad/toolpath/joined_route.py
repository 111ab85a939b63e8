"""A layer in closed strokes: outer perimeters unbroken, all the rest one curve for each region."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from v3dcad.geometry import arcs
from v3dcad.geometry.loops.corners import corners_cut
from v3dcad.geometry.loops.curves import GRID, Curves, nearest_step, opened
from v3dcad.geometry.loops.joining import joined
from v3dcad.geometry.loops.links import Linked
from v3dcad.geometry.loops.loops import Loops
from v3dcad.model import CELLS, INNER_PERIMETER, PERIMETER, Floats, Ints, Layer
from v3dcad.toolpath.division import Division
from v3dcad.toolpath.graph import PathGraph
from v3dcad.toolpath.perimeters import inset, rings
from v3dcad.toolpath.ribs import Ribs
from v3dcad.toolpath.seam import Seams
from v3dcad.toolpath.stroke import Stroke

STEP_IN = 1.5
"""Bead spacings that the nozzle goes on extruding from an outer perimeter into a curve."""
NEAR = 3.0
"""Bead spacings within which a curve follows a perimeter before the next perimeter does."""


class Closed(NamedTuple):
    """A closed line: points (k, 2); feature and centre of the step on from each."""

    points: Floats
    feature: Ints
    centre: Floats


def joined_curves(
    layer: Layer,
    division: Division,
    depths: Sequence[float],
    linked: Linked,
    shortest: float,
    ribs: Ribs,
) -> Curves:
    """The perimeters at some depths (mm, outermost first) and the cells of the foam, joined.

    Cells have `ribs` under skins. No step is shorter than `shortest` (mm) where that can be.
    """
    area, spacing = division.area, division.spacing
    lines: list[Floats] = []
    owners: list[int] = []
    for number, depth in enumerate(depths):
        # Neighbours face each other in opposite directions; cells' loops run counter-clockwise.
        against = (len(depths) - number) % 2 == 1
        for ring in rings(inset(area, depth)):
            lines.append(ring[::-1] if against else ring)
            owners.append(-1 - number)
    loops = ribs.loops(layer, division).and_these(Loops.of(lines, owners))
    curves = joined(loops.thinned(max(shortest, GRID)), spacing, linked, shortest)
    return corners_cut(curves, spacing, shortest)


def in_order(
    outer: list[Closed], curves: Curves, spacing: float, here: Floats, shortest: float
) -> Iterator[Stroke]:
    """Strokes from near `here` (2,): each outer perimeter with the curves that lie next to it.

    A perimeter starts where it is given to; from there the nozzle steps into the nearest curve.
    """
    left = _Left(curves)
    while outer or left:
        stroke: list[Closed] = []
        if outer:
            away = [np.hypot(*(loop.points[0] - here)) for loop in outer]
            stroke.append(_open(outer.pop(int(np.argmin(away)))))
            here = stroke[-1].points[-1]
        while left:
            step, share, gap = left.nearest(here)
            if outer and gap > NEAR * spacing:
                break
            if stroke and gap > STEP_IN * spacing:
                yield _stroke(stroke)
                stroke = []
            stroke.append(left.entered(step, share, shortest))
            here = stroke[-1].points[-1]
        yield _stroke(stroke)


def from_seams(outer: PathGraph, seams: Seams) -> list[Closed]:
    """The loops of a graph made of loops, each from its seam on."""
    ends = np.flatnonzero(outer.edges[:, 1] < outer.edges[:, 0]) + 1
    found = []
    for low, high in pairwise([0, *ends.tolist()]):
        points = outer.vertices[outer.edges[low:high, 0]]
        turned = np.roll(np.arange(high - low), -seams.corner(points))
        feature = np.full(high - low, PERIMETER)
        found.append(Closed(points[turned], feature, outer.centre[low:high][turned]))
    return found


class _Left:
    """Closed curves that are still to be printed."""

    def __init__(self, curves: Curves) -> None:
        self._curves = curves
        self._done = np.zeros(len(curves.first) - 1, np.bool_)

    def __bool__(self) -> bool:
        return not bool(self._done.all())

    def nearest(self, here: Floats) -> tuple[int, float, float]:
        """Which step comes nearest to a place: the share of it that lies before, and how near."""
        x, y = here.tolist()
        return nearest_step(self._curves.points, self._curves.first, self._done, x, y)

    def entered(self, step: int, share: float, shortest: float) -> Closed:
        """Take a curve, from a place on it and round to it again.

        A corner within `shortest` mm of that place stands for it, so that no shorter step is made.
        """
        curve = int(np.searchsorted(self._curves.first, step, side="right")) - 1
        own = slice(*self._curves.first[curve : curve + 2].tolist())
        self._done[curve] = True
        room = own.stop - own.start + 1
        points, owner = np.empty((room + 1, 2)), np.empty(room, np.int64)
        size = opened(
            self._curves.points[own],
            self._curves.owner[own],
            step - own.start,
            share,
            shortest,
            points,
            owner,
        )
        feature = np.where(owner[:size] < 0, INNER_PERIMETER, CELLS)
        return Closed(points[: size + 1], feature, np.full((size, 2), np.nan))


def _open(loop: Closed) -> Closed:
    """A closed stroke that ends with its first point again."""
    return loop._replace(points=np.vstack([loop.points, loop.points[:1]]))


def _stroke(parts: list[Closed]) -> Stroke:
    """One stroke of several open parts; the steps between them are extruded, too."""
    points = np.concatenate([part.points for part in parts])
    feature = [parts[0].feature]
    centre = [parts[0].centre]
    for part in parts[1:]:
        feature += [part.feature[:1], part.feature]
        centre += [np.full((1, 2), np.nan), part.centre]
    centres = np.concatenate(centre)
    start, stop = points[:-1], points[1:]
    return Stroke(
        points,
        np.concatenate(feature).astype(np.int8),
        arcs.lengths(start, stop, centres),
        centres,
    )
