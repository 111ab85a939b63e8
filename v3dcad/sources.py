"""What Python code gives as a part: its shapes or its mesh, and the library that it comes from.

No CAD library is imported here: whoever gives its objects has loaded it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

from v3dcad.arguments import rows, whole_rows
from v3dcad.errors import GeometryError
from v3dcad.model import Mesh

LIBRARIES = ("build123d", "cadquery")
"""CAD libraries whose objects hold shapes of OCP, and to which shapes are given back."""

MESH = ("vertices", "faces")
"""What a mesh of trimesh has; of build123d and CadQuery they are methods."""


def mesh_in(source: Any) -> Mesh | None:
    """The triangles of a mesh of trimesh, or of a pair (vertices, triangles); None for shapes.

    Raises `SettingError` unless vertices are (v, 3) numbers and triangles (t, 3) whole numbers.
    """
    if hasattr(source, "to_mesh"):  # a scene of trimesh
        source = source.to_mesh()
    if isinstance(source, Mesh):
        source = source.vertices, source.triangles
    elif all(hasattr(source, name) and not callable(getattr(source, name)) for name in MESH):
        source = source.vertices, source.faces
    if not isinstance(source, tuple) or len(source) != 2 or any(map(_holds_shapes, source)):
        return None
    vertices, triangles = source
    return Mesh(
        rows("vertices", vertices, "x, y, z"),
        whole_rows("triangles", triangles, "a, b, c"),
    )


def shapes_in(source: Any) -> Iterator[Any]:
    """The shapes of OCP in an object of build123d or CadQuery, or in a list of such objects.

    A builder stands for what is built so far; a Workplane for the solids on its stack, or the one
    before it in its chain, as CadQuery's own operations have it. `GeometryError` for what holds
    no shape.
    """
    if hasattr(source, "TShape"):
        yield source
    elif isinstance(source, (list, tuple)):
        for one in source:
            yield from shapes_in(one)
    elif hasattr(source, "findSolid"):  # a Workplane of CadQuery
        for one in solids_on(source):
            yield from shapes_in(one)
    elif hasattr(source, "toCompound"):  # an assembly of CadQuery
        yield source.toCompound().wrapped
    elif hasattr(source, "part"):  # a builder of build123d
        if source.part is None:
            raise GeometryError(f"{type(source).__name__} has built nothing yet: build a solid")
        yield from shapes_in(source.part)
    else:
        yield _wrapped(source)


def solids_on(plane: Any) -> list[Any]:
    """What holds solids on a Workplane's stack, or before it in its chain; else all on the stack.

    As CadQuery's own operations find the solid that `.faces(">Z").workplane()` works on.
    """
    values: list[Any] = plane.vals()
    solids = [value for value in values if hasattr(value, "Solids") and value.Solids()]
    if solids:
        return solids
    try:
        return [plane.findSolid()]
    except ValueError:
        return values


def library_of(source: Any) -> str:
    """Which of `LIBRARIES` an object comes from, or the first of a list; "" for none."""
    if isinstance(source, (list, tuple)):
        return next(filter(None, map(library_of, source)), "")
    roots = {cls.__module__.split(".")[0] for cls in type(source).__mro__}
    return next((name for name in LIBRARIES if name in roots), "")


def given_back(shape: Any, library: str) -> Any:
    """A shape of OCP as an object of a library that is loaded; as it is for ""."""
    return sys.modules[library].Shape.cast(shape) if library else shape


def bare(shape: Any) -> Any:
    """The shape of OCP in what `given_back` gave."""
    return getattr(shape, "wrapped", shape)


def _holds_shapes(source: Any) -> bool:
    return any(hasattr(source, name) for name in ("TShape", "wrapped", "findSolid", "part"))


def _wrapped(source: Any) -> Any:
    kind = type(source).__name__
    try:
        shape = getattr(source, "wrapped", None)
    except AssertionError:  # build123d, of a shape without anything in it
        shape = None
    if hasattr(shape, "TShape"):
        return shape
    if shape is None and library_of(source):
        raise GeometryError(f"this {kind} holds no shape that can be filled: give a solid")
    raise GeometryError(
        f"{kind} cannot be filled: give a path, a solid, a list of solids, a mesh of trimesh, or "
        "(vertices, triangles)"
    )
