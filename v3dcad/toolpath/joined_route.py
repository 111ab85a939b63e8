"""A layer in closed strokes: outer perimeters unbroken, all the rest one curve for each region."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import shapely

from v3dcad.geometry import arcs
from v3dcad.geometry.loops.corners import links_rounded
from v3dcad.geometry.loops.joining import Linked, joined
from v3dcad.geometry.loops.loops import Loops
from v3dcad.model import CELLS, INNER_PERIMETER, PERIMETER, Floats, Ints, Layer
from v3dcad.toolpath.cell_loops import cell_loops
from v3dcad.toolpath.graph import PathGraph
from v3dcad.toolpath.perimeters import inset, rings
from v3dcad.toolpath.seam import Seams
from v3dcad.toolpath.stroke import Stroke

STEP_IN = 1.5
"""Bead spacings that the nozzle goes on extruding from an outer perimeter into a curve."""
NEAR = 3.0
"""Bead spacings within which a curve follows a perimeter before the next perimeter does."""


class Closed(NamedTuple):
    """A closed stroke: points (k, 2); feature and centre of the step on from each."""

    points: Floats
    feature: Ints
    centre: Floats


def joined_strokes(
    layer: Layer,
    area: shapely.Geometry,
    foam: shapely.Geometry,
    depths: list[float],
    spacing: float,
    shortest: float,
    outer: PathGraph,
    linked: Linked,
    seams: Seams,
    here: Floats,
) -> Iterator[Stroke]:
    """Strokes of a layer, from near `here` (2,): each outer perimeter with what lies next to it.

    `outer` is the perimeter at depths[0]; the further ones are joined with the loops of the
    cells in the `foam`, beads `spacing` apart (mm). An outer perimeter starts at its seam; from
    there the nozzle steps into the nearest curve.
    """
    lines: list[Floats] = []
    owners: list[int] = []
    for number, depth in enumerate(depths[1:], 1):
        # Neighbours face each other in opposite directions; cells' loops run counter-clockwise.
        against = (len(depths) - number) % 2 == 1
        for ring in rings(inset(area, depth)):
            lines.append(ring[::-1] if against else ring)
            owners.append(-1 - number)
    loops = cell_loops(layer, foam, spacing).and_these(Loops.of(lines, owners))
    curves = joined(loops.thinned(shortest), spacing, linked, shortest)
    curves = links_rounded(curves, shortest)
    left = [
        Closed(
            curves.points[start:stop],
            np.where(curves.owner[start:stop] < 0, INNER_PERIMETER, CELLS),
            np.full((stop - start, 2), np.nan),
        )
        for start, stop in zip(curves.first[:-1], curves.first[1:], strict=True)
    ]
    yield from _in_order(_from_seams(outer, seams), left, spacing, here, shortest)


def _from_seams(outer: PathGraph, seams: Seams) -> list[Closed]:
    """The loops of a graph made of loops, each from its seam on."""
    begins = np.nonzero(outer.edges[:, 1] < outer.edges[:, 0])[0] + 1
    found = []
    for edges in np.split(np.arange(len(outer.edges)), begins[:-1]):
        if not len(edges):
            continue
        points = outer.vertices[outer.edges[edges, 0]]
        seam = seams.corner(points)
        turned = np.roll(edges, -seam)
        found.append(
            Closed(
                np.roll(points, -seam, axis=0),
                np.full(len(edges), PERIMETER),
                outer.centre[turned],
            )
        )
    return found


def _in_order(
    outer: list[Closed], curves: list[Closed], spacing: float, here: Floats, shortest: float
) -> Iterator[Stroke]:
    lines = [shapely.LinearRing(curve.points) for curve in curves]
    while outer or curves:
        stroke: list[Closed] = []
        if outer:
            away = [np.hypot(*(loop.points[0] - here)) for loop in outer]
            stroke.append(_open(outer.pop(int(np.argmin(away)))))
            here = stroke[-1].points[-1]
        while curves:
            gaps = shapely.distance(lines, shapely.Point(here))
            nearest = int(np.argmin(gaps))
            if outer and gaps[nearest] > NEAR * spacing:
                break
            curve = _entered(curves.pop(nearest), lines.pop(nearest), here, shortest)
            if stroke and gaps[nearest] > STEP_IN * spacing:
                yield _stroke(stroke)
                stroke = []
            stroke.append(curve)
            here = curve.points[-1]
        yield _stroke(stroke)


def _open(loop: Closed) -> Closed:
    """A closed stroke that ends with its first point again."""
    return loop._replace(points=np.vstack([loop.points, loop.points[:1]]))


def _entered(curve: Closed, line: shapely.Geometry, here: Floats, shortest: float) -> Closed:
    """A curve from the place on it that is nearest to `here`, and round to it again.

    A corner within `shortest` mm of that place stands for it, so that no shorter step is made.
    """
    along = shapely.line_locate_point(line, shapely.Point(here))
    steps = np.hypot(*(np.roll(curve.points, -1, axis=0) - curve.points).T)
    passed = np.cumsum(steps) - steps
    step = int(np.searchsorted(passed, along, side="right")) - 1
    gone = along - passed[step]
    left = steps[step] - gone
    if min(gone, left) < shortest:
        corner = step if gone <= left else step + 1
        turned = Closed(
            np.roll(curve.points, -corner, axis=0),
            np.roll(curve.feature, -corner),
            np.roll(curve.centre, -corner, axis=0),
        )
        return _open(turned)
    place = shapely.get_coordinates(shapely.line_interpolate_point(line, along))[0]
    points = np.roll(curve.points, -step - 1, axis=0)
    feature = np.roll(curve.feature, -step - 1)
    return Closed(
        np.vstack([place, points, place]),
        np.concatenate([feature[-1:], feature]),
        np.full((len(points) + 1, 2), np.nan),
    )


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
