"""Volume, mass, centre of mass and inertia of a structure as it is printed.

A layer's material is all of the section that lies within half a bead of a wall or within the
perimeters' width of a contour. What is left open is found as a whole, so that the overlap of beads
at junctions counts once, and integrated exactly.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from v3dcad.arguments import above_zero
from v3dcad.geometry.section_area import section_area
from v3dcad.model import Floats, Layer, Value

ARC = 64
"""Chords to a quarter circle, where a void goes round a reflex corner of a contour: each such
corner errs by less than 1e-4 of the bead width squared, mm². All else is exact."""

POLYGON = 3
"""shapely's number for the type"""


@dataclass(frozen=True, eq=False, slots=True)
class Properties(Value):
    """Integral properties of a printed structure, in bed coordinates."""

    volume: float
    """mm³"""
    mass: float
    """g"""
    relative_density: float
    """volume ÷ volume of the part's sections"""
    centre: Floats
    """(3,) mm"""
    inertia: Floats
    """(3, 3) about the centre of mass, g·mm²"""


def properties(
    layers: Iterable[Layer], layer_height: float, bead_width: float, density: float,
    perimeters: int = 1, *, base: float = 0.0,
) -> Properties:  # fmt: skip
    """Integrate over layers, each as high as `layer_height`, mm, from `base` mm over its section.

    Walls are `bead_width` mm wide, contours `perimeters` beads inwards; `density` in g/cm³.
    Raises `SettingError` for a width or density that is not above 0.
    """
    bead_width = above_zero("bead_width", bead_width)
    density = above_zero("density", density, "g/cm³")
    moments = np.zeros((2, 10))
    for layer in layers:
        if layer.section.rings:
            area = section_area(layer.section)
            solid = _plane_moments(area)
            hollow = _plane_moments(_voids(layer, area, bead_width, perimeters))
            for row, plane in enumerate((solid - hollow, solid)):
                moments[row] += _slab_moments(plane, layer.z + base, layer_height)
    volume, x, y, z, xx, yy, zz, xy, xz, yz = moments[0]
    if volume <= 0:
        return Properties(0.0, 0.0, 0.0, np.zeros(3), np.zeros((3, 3)))
    centre = np.array([x, y, z]) / volume
    spread = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) - volume * np.outer(
        centre, centre
    )
    grams = density / 1000
    return Properties(
        volume=float(volume),
        mass=float(volume * grams),
        relative_density=float(volume / moments[1, 0]),
        centre=centre,
        inertia=(np.trace(spread) * np.eye(3) - spread) * grams,
    )


def _voids(
    layer: Layer, area: shapely.Geometry, bead_width: float, perimeters: int
) -> shapely.Geometry:
    """What the beads leave open in a layer: of each cell what is far from its walls and contours.

    Beads on the contour inside `perimeters` beads of it change nothing, so that a cell's whole
    outline can be drawn in by half a bead.
    """
    core = shapely.buffer(area, -perimeters * bead_width, quad_segs=ARC)
    open_cells = shapely.buffer(_outlines(layer), -bead_width / 2, quad_segs=ARC)
    shapely.prepare(core)
    crossing = ~shapely.contains_properly(core, open_cells)
    open_cells[crossing] = shapely.intersection(core, open_cells[crossing])
    return shapely.geometrycollections(open_cells)


def _outlines(layer: Layer) -> NDArray[np.object_]:
    """The cells (c,) of a layer as polygons, or several."""
    cells = layer.diagram.cells()
    whole = [rings[0] for rings in cells.values() if len(rings) == 1]
    points = np.concatenate(whole) if whole else np.empty((0, 2))
    of = np.repeat(np.arange(len(whole)), [len(ring) for ring in whole])
    polygons = shapely.polygons(shapely.linearrings(points, indices=of)) if whole else []
    pieces = [
        shapely.build_area(shapely.MultiLineString([np.vstack([ring, ring[:1]]) for ring in rings]))
        for rings in cells.values()
        if len(rings) > 1
    ]
    return np.array([*polygons, *pieces], np.object_)


def _plane_moments(area: shapely.Geometry) -> Floats:
    """∫ 1, x, y, x², y², xy over polygons, by Green's theorem over their rings."""
    total = np.zeros(6)
    parts = shapely.get_parts(shapely.get_parts(area))  # of a collection of multipolygons
    rings = shapely.get_rings(shapely.orient_polygons(parts[shapely.get_type_id(parts) == POLYGON]))
    points, of = shapely.get_coordinates(rings, return_index=True)
    if not len(points):
        return total
    same = of[1:] == of[:-1]
    (x0, y0), (x1, y1) = points[:-1][same].T, points[1:][same].T
    cross = x0 * y1 - x1 * y0
    total[0] = cross.sum() / 2
    total[1] = ((x0 + x1) * cross).sum() / 6
    total[2] = ((y0 + y1) * cross).sum() / 6
    total[3] = ((x0 * x0 + x0 * x1 + x1 * x1) * cross).sum() / 12
    total[4] = ((y0 * y0 + y0 * y1 + y1 * y1) * cross).sum() / 12
    total[5] = ((2 * x0 * y0 + x0 * y1 + x1 * y0 + 2 * x1 * y1) * cross).sum() / 24
    return total


def _slab_moments(plane: Floats, z: float, height: float) -> Floats:
    """∫ 1, x, y, z, x², y², z², xy, xz, yz over a plane figure from z up to z + height."""
    area, x, y, xx, yy, xy = plane * height
    middle = z + height / 2
    zz = area * (middle**2 + height**2 / 12)
    return np.array([area, x, y, area * middle, xx, yy, zz, xy, x * middle, y * middle])
