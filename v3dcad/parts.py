"""What can be filled: files, shapes and meshes as a `Part`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from v3dcad.errors import FormatError, GeometryError
from v3dcad.formats.stl import read_stl, welded
from v3dcad.model import Floats, Mesh, Part, Placement, Recipe, Section

STEP, BREP, STL, ONT = (".step", ".stp"), (".brep", ".brp"), (".stl",), (".ont",)


@dataclass(frozen=True, eq=False, slots=True)
class MeshPart:
    """A part whose surface is triangles."""

    name: str
    surface: Mesh
    findings: tuple[str, ...] = ()
    """what the user should know of how the file was read"""

    @property
    def bounds(self) -> Floats:
        """(2, 3) least and greatest coordinates, mm."""
        points = self.surface.vertices[self.surface.triangles.ravel()]
        return np.stack([points.min(axis=0), points.max(axis=0)])

    def contents(self) -> dict[str, str]:
        """What it is made of, as lines to show."""
        corners = self.surface.vertices[self.surface.triangles] - self.bounds[0]
        volume = float(np.linalg.det(corners).sum()) / 6
        return {"triangles": f"{len(self.surface.triangles)}", "volume": f"{volume:.6g} mm³"}

    def placed(self, placement: Placement) -> MeshPart:
        """The same triangles, moved."""
        moved = Mesh(placement.to_bed(self.surface.vertices), self.surface.triangles)
        return MeshPart(self.name, moved, self.findings)

    def sections(self, heights: Floats) -> Sequence[Section]:
        """Sections of the triangles at each height (mm)."""
        from v3dcad.geometry.mesh_section import section_mesh

        return section_mesh(self.surface, heights)

    def mesh(self) -> Mesh:
        """The triangles themselves."""
        return self.surface


def part_from(source: Any) -> Part:
    """The part in a file (STEP, STL, BREP), an OCCT, build123d or CadQuery shape, or a mesh.

    A mesh is a pair of vertices (v, 3), mm, and triangles (t, 3). Raises `FormatError` for a
    file that cannot be read, `KernelError` for a shape without a solid, `GeometryError` for
    anything else.
    """
    if isinstance(source, (str, Path)):
        return _part_in(Path(source))
    if isinstance(source, MeshPart):
        return source
    if isinstance(source, Mesh):
        return MeshPart("mesh", source)
    if isinstance(source, tuple) and len(source) == 2:
        vertices, triangles = np.asarray(source[0], np.float64), np.asarray(source[1], np.int64)
        return MeshPart("mesh", welded(vertices[triangles], "the mesh"))
    if hasattr(source, "vals"):
        from v3dcad.kernel.shapes import compound

        source = compound(value.wrapped for value in source.vals())
    shape = getattr(source, "wrapped", source)
    if not hasattr(shape, "TShape"):
        raise GeometryError(
            f"{type(source).__name__} cannot be filled: give a path, a shape, or (vertices, faces)"
        )
    from v3dcad.kernel.part import solid_part

    name = getattr(source, "label", "") or "part"
    return solid_part(shape, name, name)


def _part_in(path: Path) -> Part:
    check_readable(path)
    ending = path.suffix.lower()
    if ending in STL:
        mesh = read_stl(path)
        return MeshPart(path.stem, mesh)
    if ending in STEP:
        from v3dcad.kernel.load import load_step

        return load_step(path)
    if ending in BREP:
        from v3dcad.kernel.load import load_brep

        return load_brep(path)
    raise FormatError(
        f"not a kind of file that can be filled; give {', '.join((*STEP, *STL, *BREP, *ONT))}",
        path=str(path),
    )


def check_readable(path: Path) -> None:
    """Raise `FormatError` unless the path is a file with something in it that can be read."""
    try:
        with path.open("rb") as file:
            empty = not file.read(1)
    except OSError as error:
        raise FormatError(f"cannot be read ({error.strerror})", path=str(path)) from error
    if empty:
        raise FormatError("the file is empty; export it again", path=str(path))


def read_recipe(path: Path) -> Recipe:
    """The recipe in an `.ont` file."""
    from v3dcad.formats.ont import read_ont

    check_readable(path)
    return read_ont(path)


def describe(path: Path) -> dict[str, str]:
    """What a part or an `.ont` file holds, as lines to show."""
    if path.suffix.lower() == ".ont":
        recipe = read_recipe(path)
        held = {
            "kind": ".ont",
            "offset": f"{recipe.offset:g} mm² a layer",
            "layer height": f"{recipe.layer_height:g} mm",
            "sites": f"{len(recipe.sites)}",
        }
        part: Part = MeshPart(recipe.name, recipe.boundary)
    else:
        part = part_from(path)
        held = {"kind": "triangles" if isinstance(part, MeshPart) else "B-rep"}
    low, high = part.bounds
    corners = [", ".join(f"{value:.6g}" for value in corner) for corner in (low, high)]
    return {
        "name": part.name,
        **held,
        "size": " × ".join(f"{value:.6g}" for value in high - low) + " mm",
        "from, to": f"({corners[0]}), ({corners[1]}) mm",
        **part.contents(),
        **{f"note {k}": finding for k, finding in enumerate(part.findings, start=1)},
    }
