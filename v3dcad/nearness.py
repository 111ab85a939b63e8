"""Cell sizes by the distance from faces that a script holds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from v3dcad.arguments import above_zero
from v3dcad.errors import SettingError
from v3dcad.model import Floats
from v3dcad.settings import Field

SAG, TURN = 0.05, 0.3
"""mm and radians: how far triangles may be from a face."""


def distance_to(faces: Any) -> Field:
    """The distance from faces, mm: a function of x, y, z (n,), mm, where the faces lie.

    `faces` is a face, or any other shape, of build123d, CadQuery or OCP, a `Workplane`, or a list
    of them. Raises `SettingError` for anything else, and where there is no face.
    """
    from v3dcad.fields import distance
    from v3dcad.kernel.faces import faces_mesh

    surface = faces_mesh(_shapes_in(faces), SAG, TURN)
    if not len(surface.triangles):
        raise SettingError("cell_size", "there is no face to be near to: give at least one")
    return distance.distance_to(surface)


def near_faces(
    faces: Any, size: float, far: float, within: float, *, smooth: bool = False
) -> Field:
    """A cell size: `size` at faces, `far` from a distance of `within` on, all mm.

    It grows evenly between, or `smooth`ly at both ends. Takes and raises what `distance_to` does,
    and raises `SettingError` unless all three are numbers above 0.
    """
    from v3dcad.fields import expression

    for name, value in (("size", size), ("far", far), ("within", within)):
        above_zero(name, value)
    distance = distance_to(faces)
    rise = expression.smooth if smooth else expression.ramp

    def field(x: Floats, y: Floats, z: Floats) -> Floats:
        return rise(np.asarray(distance(x, y, z)), 0.0, within, size, far)

    return field


def _shapes_in(faces: Any) -> Iterator[Any]:
    """The OCP shapes in what a user gives."""
    if hasattr(faces, "vals"):
        faces = faces.vals()
    shape = getattr(faces, "wrapped", faces)
    if hasattr(shape, "TShape"):
        yield shape
    elif isinstance(faces, (list, tuple)):
        for one in faces:
            yield from _shapes_in(one)
    else:
        raise SettingError(
            "cell_size",
            f"{type(faces).__name__} is no face: give faces of build123d, CadQuery or OCP, or a "
            "list of them",
        )
