"""What can be filled: files, shapes and meshes as a `Part`."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from v3dcad.arguments import above_zero, numbers, place
from v3dcad.errors import FormatError, GeometryError, SettingError
from v3dcad.formats.content import other_content
from v3dcad.formats.mesh.stl import normals, read_stl
from v3dcad.model import Floats, Layer, Mesh, Part, Placement, Section, part_words
from v3dcad.settings import UNITS
from v3dcad.sources import library_of, mesh_in, shapes_in
from v3dcad.words import counted

if TYPE_CHECKING:
    from v3dcad.kernel.part import SolidPart

STEP, BREP, ONT = (".step", ".stp"), (".brep", ".brp"), (".ont",)
STL, THREEMF, OBJ = (".stl",), (".3mf",), (".obj",)

HERE = Placement.none()


@dataclass(frozen=True, eq=False, slots=True)
class MeshPart:
    """A part whose surface is triangles."""

    name: str
    surface: Mesh
    findings: tuple[str, ...] = ()
    """what the user should know of how the file was read"""
    placement: Placement = HERE
    """how it came to where it is from where its source lies"""
    overlap: float = 0.0
    """mm³, by how much what the surface winds around, as often as it does, exceeds the part"""
    library: str = ""
    """the CAD library that its shapes are given back to"""

    def __repr__(self) -> str:
        return f"<MeshPart {part_words(self)}: {counted(len(self.surface.triangles), 'triangle')}>"

    @property
    def bounds(self) -> Floats:
        """(2, 3) least and greatest coordinates, mm."""
        points = self.surface.vertices[self.surface.triangles.ravel()]
        return np.stack([points.min(axis=0), points.max(axis=0)])

    def contents(self) -> dict[str, str]:
        """What it is made of, as lines to show."""
        corners = self.surface.vertices[self.surface.triangles] - self.bounds[0]
        volume = float(np.linalg.det(corners).sum()) / 6 - self.overlap
        return {"triangles": f"{len(self.surface.triangles)}", "volume": f"{volume:.6g} mm³"}

    def normal(self, face: int) -> Floats:
        """(3,) outward unit normal of a triangle, by its number from 0."""
        chosen = place("up", face, len(self.surface.triangles), "mesh's triangles")
        unit: Floats = normals(self.surface.vertices[self.surface.triangles[[chosen]]])[0]
        return unit

    def face_mesh(self, faces: tuple[int, ...]) -> Mesh:
        """Some triangles, by their numbers from 0."""
        count = len(self.surface.triangles)
        chosen = [place("face", face, count, "mesh's triangles") for face in faces]
        return Mesh(self.surface.vertices, self.surface.triangles[chosen])

    def placed(self, placement: Placement) -> MeshPart:
        """The same triangles, moved."""
        if placement.is_still():
            return self
        moved = Mesh(placement.to_bed(self.surface.vertices), self.surface.triangles)
        return replace(self, surface=moved, placement=self.placement.then(placement))

    def sections(
        self,
        heights: Floats,
        chord_tolerance: float = 0.0,
        executor: Executor | None = None,
    ) -> Sequence[Section]:
        """Sections of the triangles at ascending heights (mm), exact; bodies that meet are one."""
        from v3dcad.geometry.mesh.section import section_mesh
        from v3dcad.geometry.section_union import united

        found = section_mesh(self.surface, numbers("heights", heights), executor)
        return united(found, chord_tolerance, _bodies_meet(self.surface))

    def exact(self, layer: Layer) -> Layer:
        """The layer as it is: contours of triangles are exact."""
        return layer

    def mesh(self) -> Mesh:
        """The triangles themselves."""
        return self.surface


@lru_cache(maxsize=4)
def _bodies_meet(surface: Mesh) -> bool:
    """Whether the boxes of two of a mesh's bodies touch or overlap, cavities aside."""
    from v3dcad.geometry.mesh.bodies import bodies_of, body_bounds, signed_volumes
    from v3dcad.geometry.section_union import meeting

    body = bodies_of(surface.triangles)
    solid = signed_volumes(surface.vertices, surface.triangles, body) > 0
    low, high = body_bounds(surface.vertices, surface.triangles, body)
    return len(meeting(low[solid], high[solid])) > 0


SMALL, LARGE = 3.0, 3000.0
"""mm: shorter or longer parts are told, since their unit may be another one."""


def part_from(
    source: Any,
    *,
    repair: bool = False,
    as_brep: bool = False,
    unit: str | None = None,
    scale: float = 1.0,
) -> Part:
    """The part in a file (STEP, STL, 3MF, OBJ, BREP), a shape, or a mesh; a part as it is.

    Shapes are those of OCP, build123d and CadQuery: solids, closed shells, compounds, builders,
    Workplanes, assemblies and lists of them. A mesh is one of trimesh, or a pair of vertices
    (v, 3), mm, and triangles (t, 3). Meshes have to be closed: `repair` closes their holes, and
    findings say what it patched. `as_brep` makes a B-rep with plane faces of a mesh. `unit`, one of
    `settings.UNITS`, is what coordinates are counted in that state no unit (STL, OBJ, BREP, shapes,
    arrays), mm if nobody says; `scale` makes the part larger, about the source's origin. A part
    under 3 mm or over 3 m is told, in its findings, where neither is given. Raises
    `FormatError` for a file that cannot be read, `KernelError` for a shape without a solid,
    `SettingError` for arrays of another shape and for a unit where the file states one,
    `GeometryError` for a mesh that is not closed or too large for a B-rep, and for anything else.
    """
    if hasattr(source, "sections"):
        if unit is not None or scale != 1:
            raise SettingError("scale", "a part is in mm already: give what it was made from")
        return cast(Part, source)
    found = _part_of(source, repair, _factor(source, unit, scale))
    if as_brep and isinstance(found, MeshPart):
        from v3dcad.kernel.mesh_solid import solid_of_mesh

        found = solid_of_mesh(found.surface, found.name, found.findings)
    if unit is None and scale == 1:
        unsure = _size_findings(float(np.ptp(found.bounds, axis=0).max()), _states_unit(source))
        found = replace(found, findings=(*found.findings, *unsure))
    return found


def _states_unit(source: Any) -> bool:
    """Whether a file says what its coordinates are counted in."""
    return isinstance(source, (str, Path)) and Path(source).suffix.lower() in (*STEP, *THREEMF)


def _factor(source: Any, unit: str | None, scale: float) -> float:
    """How many mm one step of a source's coordinates is; `SettingError` where it cannot be."""
    factor = above_zero("scale", scale, "")
    if unit is None:
        return factor
    if unit not in UNITS:
        raise SettingError("unit", f"--unit {unit}: give {' or '.join(UNITS)}")
    if _states_unit(source):
        kind = Path(source).suffix
        raise SettingError(
            "unit", f"--unit {unit}: a {kind} file states its unit; leave it out, or give a scale"
        )
    return factor * UNITS[unit]


def _size_findings(length: float, states_unit: bool) -> list[str]:
    """What to tell of a part of a length, mm, whose unit may be another one."""
    if SMALL <= length <= LARGE:
        return []
    if states_unit:
        change = "--scale 0.001 makes it smaller" if length > LARGE else "--scale makes it larger"
        return [f"{length:.4g} mm long, as its file states: {change}"]
    if length > LARGE:
        return [f"{length:.4g} mm long: in another unit? --scale 0.001 makes it smaller"]
    return [f"{length:.4g} mm long: in inches? --unit inch"]


def _part_of(source: Any, repair: bool, factor: float) -> SolidPart | MeshPart:
    if isinstance(source, (str, Path)):
        return _part_in(Path(source), repair, factor)
    mesh = mesh_in(source)
    if mesh is not None:
        return _mesh_part("mesh", mesh, repair, factor)
    shapes = list(shapes_in(source))
    from v3dcad.kernel.part import solid_part
    from v3dcad.kernel.shapes import compound, own_copy

    shapes = list(map(own_copy, shapes))
    shape = shapes[0] if len(shapes) == 1 else compound(shapes)
    name = str(getattr(source, "label", None) or "part")
    return replace(solid_part(shape, name, name, factor), library=library_of(source))


def _mesh_part(
    name: str,
    mesh: Mesh,
    repair: bool,
    factor: float,
    read: Sequence[str] = (),
    where: str = "the mesh",
) -> MeshPart:
    """A mesh as a part, once it is known to be closed; `GeometryError` where it is not.

    Its coordinates are multiplied by `factor`.
    """
    from v3dcad.geometry.mesh.check import checked_mesh
    from v3dcad.geometry.mesh_overlap import overlap_volume

    mesh = Mesh(mesh.vertices * factor, mesh.triangles)
    try:
        closed, mended = checked_mesh(mesh, repair=repair)
    except GeometryError as error:
        raise GeometryError(f"{where}: {error.message}") from error
    overlap = overlap_volume(closed)
    if overlap:
        mended.append(
            f"the surface passes through itself: {overlap:.4g} mm³ that it encloses more than once "
            "are filled once"
        )
    return MeshPart(name, closed, (*read, *mended), overlap=overlap)


def _part_in(path: Path, repair: bool, factor: float) -> SolidPart | MeshPart:
    check_readable(path)
    try:
        return _read(path, repair, factor)
    except FormatError as error:
        holds = other_content(path)
        if holds is None:
            raise
        raise FormatError(holds, path=str(path)) from error


def _read(path: Path, repair: bool, factor: float) -> SolidPart | MeshPart:
    ending = path.suffix.lower()
    if ending in STL:
        return _mesh_part(path.stem, read_stl(path), repair, factor, (), str(path))
    if ending in THREEMF:
        from v3dcad.formats.mesh.threemf_reader import read_threemf

        mesh, left_out = read_threemf(path)
        return _mesh_part(path.stem, mesh, repair, factor, left_out, str(path))
    if ending in OBJ:
        from v3dcad.formats.mesh.obj import read_obj

        mesh, left_out = read_obj(path)
        return _mesh_part(path.stem, mesh, repair, factor, left_out, str(path))
    if ending in STEP:
        from v3dcad.kernel.load import load_step

        return load_step(path, factor)
    if ending in BREP:
        from v3dcad.kernel.load import load_brep

        return load_brep(path, factor)
    if ending in ONT:
        raise FormatError("holds a filled part: fill takes it; give the part alone", path=str(path))
    known = ", ".join((*STEP, *STL, *THREEMF, *OBJ, *BREP, *ONT))
    raise FormatError(f"not a kind of file that can be filled; give {known}", path=str(path))


def check_readable(path: Path) -> None:
    """Raise `FormatError` unless the path is a file with something in it that can be read."""
    try:
        with path.open("rb") as file:
            empty = not file.read(1)
    except OSError as error:
        raise FormatError(f"cannot be read ({error.strerror})", path=str(path)) from error
    if empty:
        raise FormatError("the file is empty; export it again", path=str(path))
