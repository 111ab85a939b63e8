"""`Workplane.voronoiFill(...)`, there once this module is imported."""

from __future__ import annotations

from typing import Any

from v3dcad.adapters.form import shape_of
from v3dcad.errors import GeometryError
from v3dcad.sources import solids_on

try:
    from cadquery import Compound, Shape, Workplane
except ImportError as error:
    # The OCP that build123d brings lacks VTK; where it was installed last, it lies over CadQuery's.
    over = "IVtk" in str(error)
    own = "--force-reinstall --no-deps 'cadquery-ocp>=7.9,<8'"
    line = own if over else "'v3dcad[cadquery]'"
    raise ImportError(f"cadquery cannot be imported ({error}): run `pip install {line}`") from error


def voronoiFill(self: Workplane, form: str = "solid", **settings: Any) -> Workplane:  # noqa: N802
    """Fill each solid on the stack with a Voronoi structure that lies where the solid lies.

    Where faces, edges or points are on it, the solid is filled that they were selected from.

    `form` says what becomes of it: "solid" (walls `thickness` mm thick, a closed `skin` if asked),
    "cells" (each on the stack), "faces", "wires", "struts" (`diameter`, `cut`, `fuse`) or "beads"
    (`width`). All other settings are those of `v3dcad.fill`. Raises `V3dcadError`s.
    """
    solids = solids_on(self)
    if not solids:
        raise GeometryError("this Workplane holds nothing to fill: build a solid before")
    shapes = []
    for value in solids:
        made = Shape.cast(shape_of(value, form, settings)[0])
        shapes += list(made) if form == "cells" and isinstance(made, Compound) else [made]
    return self.newObject(shapes)


Workplane.voronoiFill = voronoiFill
