"""What an expression can name besides x, y and z: distances, tables, images, stresses."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.fields.distance import distance_to
from v3dcad.fields.expression import Source, field_of
from v3dcad.fields.image import image_field
from v3dcad.fields.scattered import interpolated
from v3dcad.fields.stress import read_stress
from v3dcad.fields.table import read_table, read_triangles
from v3dcad.model import Floats, Part
from v3dcad.settings import Field

BEYOND = 0.5
"""Points that leave more of the part's length, along an axis, uncovered do not belong to it."""


SMALLEST, LARGEST = 1e-6, 1e6
"""mm: beyond these no cell size is meant."""


def size_field(cell_size: str | Field, part: Part) -> Callable[[Floats], Floats]:
    """Cell sizes (n,), mm, at places (n, 3), mm, for a part on the bed, in bed coordinates.

    `cell_size` is an expression, see `field_of`, or a function, both in the coordinates of the
    part's source. Raises `SettingError` where it cannot be computed with.
    """
    if isinstance(cell_size, str):
        cell_size = field_of(cell_size, sources_of(part.placed(part.placement.inverse())))
    field, placement = in_range(cell_size), part.placement
    return lambda places: field(*np.ascontiguousarray(placement.to_source(places).T))


def sources_of(part: Part) -> Mapping[str, Source]:
    """The fields that an expression can call, in the coordinates of the part.

    surface(), faces(n, …) and distance(file): the distance from the part's surface, from faces by
    their numbers, or from the triangles of an STL file, mm. table(file, column): values at points.
    image(file, …, view): grey, from 0 to 1. stress(file): von Mises stress.
    """

    def surface() -> Field:
        return distance_to(part.mesh())

    def faces(*numbers: Any) -> Field:
        if not numbers or not all(type(number) is int for number in numbers):
            raise SettingError("cell_size", "faces: give numbers of faces, from 0")
        return distance_to(part.face_mesh(tuple(numbers)))

    def distance(file: Any) -> Field:
        return distance_to(read_triangles(_path("distance", file)))

    def table(file: Any, column: Any = None) -> Field:
        if not isinstance(column, str | None):
            raise SettingError("cell_size", "table: give the column's name, in quotes")
        points, values = read_table(_path("table", file), column)
        _refuse_elsewhere("table", points, part.bounds)
        return interpolated(points, values)

    def image(*files: Any, view: Any = "top") -> Field:
        if not files:
            raise SettingError("cell_size", "image: give a file")
        return image_field([_path("image", file) for file in files], view, part.bounds)

    def stress(file: Any) -> Field:
        points, values = read_stress(_path("stress", file))
        _refuse_elsewhere("stress", points, part.bounds)
        return interpolated(points, values)

    return {
        "surface": surface, "faces": faces, "distance": distance,
        "table": table, "image": image, "stress": stress,
    }  # fmt: skip


def in_range(field: Field) -> Field:
    """A field that is checked whenever it is asked for sizes.

    Raises `SettingError`, with the place, where a size is no number from `SMALLEST` to `LARGEST`.
    """

    def checked(x: Floats, y: Floats, z: Floats) -> Floats:
        try:
            sizes = np.asarray(field(x, y, z), np.float64)
            sizes = np.broadcast_to(sizes, np.shape(x)).astype(np.float64)
        except (TypeError, ValueError) as error:
            raise SettingError(
                "cell_size", f"the cell size takes x, y, z (n,) and gives sizes (n,), mm: {error}"
            ) from error
        wrong = np.flatnonzero(~((sizes >= SMALLEST) & (sizes <= LARGEST)))
        if len(wrong):
            at = wrong[0]
            raise SettingError(
                "cell_size",
                f"the cell size is {sizes[at]:g} mm at ({x[at]:.4g}, {y[at]:.4g}, {z[at]:.4g}) mm; "
                f"it has to be from {SMALLEST:g} to {LARGEST:g} in all of the part's box",
            )
        return sizes

    return checked


def _path(name: str, file: Any) -> Path:
    if not isinstance(file, str) or "\0" in file:
        raise SettingError("cell_size", f"{name}: give a file, in quotes")
    return Path(file)


def _refuse_elsewhere(name: str, points: Floats, bounds: Floats) -> None:
    """Raise `SettingError` for points that leave much of the part's box uncovered."""
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.maximum(np.ptp(bounds, axis=0), 1e-300)
    # A table of a plane or a line says nothing along the other axes.
    spread = high > low
    covered = np.minimum(high, bounds[1]) - np.maximum(low, bounds[0])
    for axis in np.flatnonzero(spread & (covered < (1 - BEYOND) * size)):
        raise SettingError(
            "cell_size",
            f"{name}: its points run from {low[axis]:.4g} to {high[axis]:.4g} mm along "
            f"{'xyz'[axis]}, the part from {bounds[0, axis]:.4g} to {bounds[1, axis]:.4g}; are "
            "both in mm, and in one place?",
        )
