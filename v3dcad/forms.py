"""What a structure is as CAD: wires, walls, cells, thick walls, struts and beads, and their files.

Shapes are those of the library that the part comes from, build123d or CadQuery, or else OCP's
(`TopoDS_Shape`), and lie where the source lies. The kernel is loaded when a form is asked for.
"""

from __future__ import annotations

import warnings
from abc import abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from v3dcad.arguments import above_zero, place
from v3dcad.errors import KernelError, SettingError
from v3dcad.files import written_beside
from v3dcad.model import Floats, Ints, Layer, Mesh, Part, Placement
from v3dcad.settings import FillSettings
from v3dcad.sources import bare, given_back

if TYPE_CHECKING:
    from v3dcad.geometry.solid.facets import Facets
    from v3dcad.kernel.step import Named

FORMS: Mapping[str, tuple[str, ...]] = {
    "wires": (),
    "faces": (),
    "cells": (),
    "solid": ("thickness", "skin"),
    "struts": ("diameter", "cut", "fuse"),
    "beads": ("width", "profile"),
}
"""What `write_step` and `write_brep` know, and what each takes; the first of that it needs."""

MESHES: Mapping[str, tuple[str, ...]] = {
    "walls": (),
    "solid": ("thickness", "skin"),
    "struts": ("diameter", "cut"),
    "beads": ("width",),
}
"""What `write_stl` knows, in the same way; all but the zero-thickness walls are closed meshes."""


MARGIN = 1.0
"""mm by which walls and cells reach beyond the part before they are cut to it."""


class Forms(Protocol):
    """The CAD side of a structure: what it must have, and what it then can be; sizes are in mm.

    `thickness` is that of walls, `skin` (0: none) that of a hull around them, `diameter` that of
    struts, `width` that of beads.
    """

    __slots__ = ()

    part: Part
    placement: Placement
    layers: Sequence[Layer]

    @property
    @abstractmethod
    def settings(self) -> FillSettings:
        """What it was filled with."""

    @abstractmethod
    def facets(self, beyond: float = 0.0) -> Facets:
        """The walls between cells in the part's box and `beyond` mm around it, bed coordinates.

        Raises `SettingError` for the thesis's method: its cells jump from layer to layer.
        """

    @abstractmethod
    def sites_at(self, points: Floats | Sequence[Sequence[float]]) -> Ints:
        """(k,) numbers of the sites in whose cells points (k, 3), mm, lie, where the source lies.

        Raises `SettingError` as `facets` does.
        """

    def wires(self) -> Any:
        """A compound for each layer: contours on their exact curves, walls as lines."""
        from v3dcad.kernel.shapes import compound
        from v3dcad.kernel.wires import layer_wires

        return self._given_back(
            compound(layer_wires(self.part.exact(layer), self.placement) for layer in self.layers)
        )

    def faces(self) -> Any:
        """The walls inside the part as plane faces: shells of faces that share their edges."""
        from v3dcad.kernel.cells import cut_walls
        from v3dcad.kernel.shapes import compound

        return self._given_back(
            compound(cut_walls(self._solid(), self.facets(MARGIN), self.placement))
        )

    def cells(self) -> list[Any]:
        """The cells inside the part as solids, neighbours sharing faces; they add up to it.

        In the order of their sites, as `cells_by_site` has them.
        """
        return [cell for cells in self.cells_by_site().values() for cell in cells]

    def cells_by_site(self) -> dict[int, list[Any]]:
        """The cells of each site, sites ascending; pieces that the part leaves of one from below.

        Sites are numbered as in `sites`.
        """
        from v3dcad.kernel.cells import cut_cells

        cells, centres = cut_cells(self._solid(), self.facets(MARGIN), self.placement)
        # A cell is convex, and so holds the centre of every piece of it.
        sites = self.sites_at(centres)
        found: dict[int, list[Any]] = {}
        for cell in np.lexsort((*centres.T, sites)).tolist():
            found.setdefault(int(sites[cell]), []).append(self._given_back(cells[cell]))
        return found

    def solid(self, thickness: float, skin: float = 0.0) -> Any:
        """The part with walls of a thickness in place of its inside, and a closed skin if asked.

        Warns where it falls into several bodies.
        """
        from v3dcad.kernel.cells import thick_walls
        from v3dcad.kernel.shapes import SOLID, bounds, location, subshapes, volume

        walls = self._thick(thickness)
        shape = thick_walls(self._solid(), walls, self.placement, thickness, skin)
        moved = location(self.placement)
        self._tell_apart(
            (volume(body), bounds(body.Moved(moved))) for body in subshapes(shape, SOLID)
        )
        return self._given_back(shape)

    def struts(self, diameter: float, *, cut: bool = False, fuse: bool = False) -> Any:
        """Cylinders along the lines where cells meet, spheres at their ends, as a compound.

        They reach over the part's surface unless they are `cut` to the part. `fuse` makes one
        solid of them, up to `FUSE_LIMIT` struts. Raises as `fused_bars` does.
        """
        from v3dcad.kernel.shapes import compound
        from v3dcad.kernel.struts import bars, cut_bars, fused_bars

        points, struts = self._axes(diameter)
        made = [fused_bars(points, struts, diameter)] if fuse else bars(points, struts, diameter)
        return self._given_back(compound(cut_bars(made, self._solid()) if cut else made))

    def beads(self, width: float, profile: str = "rounded") -> Any:
        """What is printed, a compound for each layer: a profile swept along every line.

        `profile` is "rounded" or "rectangle", as high as a layer.
        """
        from v3dcad.kernel.shapes import compound

        return self._given_back(compound(bead for _, bead in self._beads(width, profile)))

    def strut_mesh(self, diameter: float, *, cut: bool = False) -> Mesh:
        """The struts and their joints united, as a closed mesh where the source lies.

        They reach over the part's surface unless they are `cut` to the part.
        """
        from v3dcad.geometry.mesh.boolean import intersected
        from v3dcad.geometry.solid.bar_meshes import bar_mesh

        mesh = bar_mesh(*self._axes(diameter), diameter)
        return intersected(mesh, self._at_source(self.part.mesh())) if cut else mesh

    def solid_mesh(self, thickness: float, skin: float = 0.0) -> Mesh:
        """The part with walls of a thickness, and a closed skin if asked, as a closed mesh.

        Of triangles too. Warns where it falls into several bodies.
        """
        from v3dcad.geometry.mesh.bodies import parts_of

        mesh = self._thick_mesh(thickness, skin)
        self._tell_apart(parts_of(mesh))
        return self._at_source(mesh)

    def bead_mesh(self, width: float) -> Mesh:
        """What is printed, the beads of all layers united, as a closed mesh."""
        from v3dcad.geometry.solid.bar_meshes import bead_mesh

        return self._at_source(bead_mesh(self.layers, width, *self.settings.layer_span()))

    def write_step(
        self, path: str | Path, form: str = "wires", *, schema: str = "AP214", **sizes: Any
    ) -> None:
        """Write a form as STEP, mm, with names and colours; the same structure, the same bytes.

        `form` is one of `FORMS`, `sizes` what its method takes. Wires are named by layer and
        height, their straight runs chained (and without colours, which bare curves have none of).
        """
        from v3dcad.formats.curve_step import step_text
        from v3dcad.kernel.step import check_schema, timestamp, write_step
        from v3dcad.kernel.wires import layer_curves

        check_form(form, sizes, FORMS)
        check_schema(schema)
        name = self.part.name
        with written_beside(Path(path)) as beside:
            if form != "wires":
                shapes = self._named(form, sizes)
                write_step(shapes, beside, name, schema=schema, surfaces_only=form == "faces")
                return
            drawings = (
                layer_curves(self.part.exact(layer), self.placement, _title(layer))
                for layer in self.layers
            )
            with beside.open("w", encoding="ascii", newline="\n") as stream:
                stream.writelines(step_text(drawings, name, schema, timestamp()))

    def write_brep(self, path: str | Path, form: str = "wires", **sizes: Any) -> Any:
        """Write a form as BREP, which keeps all that is shared, and give the shape back.

        As `write_step` does else.
        """
        from v3dcad.kernel.shapes import compound
        from v3dcad.kernel.step import write_brep

        check_form(form, sizes, FORMS)
        with written_beside(Path(path)) as beside:
            if form == "wires":
                shape = bare(self.wires())
            else:
                shape = compound(shape for _, shape, _ in self._named(form, sizes))
            write_brep(shape, beside)
        return self._given_back(shape)

    def write_stl(
        self, path: str | Path, form: str = "walls", *, ascii: bool = False, **sizes: Any
    ) -> None:
        """Write a mesh of `MESHES` as STL.

        "walls" are upright strips without thickness, as in the thesis, and no solid; "solid"
        (thickness, skin), "struts" (diameter, cut) and "beads" (width) are united and closed.
        """
        from v3dcad.formats.mesh.stl import ascii_stl, binary_stl

        mesh = self._mesh(form, sizes)
        with written_beside(Path(path)) as beside:
            if ascii:
                beside.write_text(ascii_stl(mesh, self.part.name), encoding="utf-8", newline="\n")
            else:
                beside.write_bytes(binary_stl(mesh))

    def write_3mf(
        self, path: str | Path, form: str = "solid", *, fallback: bool = True, **sizes: Any
    ) -> None:
        """Write 3MF: a closed mesh of `MESHES`, "beams" (diameter), a beam lattice, or a "project".

        A project (thickness) is for slicers, on their bed: the part, its foam a modifier in it.
        Many slicers know no beams, and refuse the file. With `fallback` the beams carry a mesh for
        viewers that know none (slow for many: they are united first).
        """
        from v3dcad.formats.mesh.threemf_project import write_project
        from v3dcad.formats.mesh.threemf_writer import write_beams, write_mesh
        from v3dcad.geometry.solid.bar_meshes import bar_mesh

        with written_beside(Path(path)) as beside:
            if form == "project":
                check_form(form, sizes, {form: ("thickness",)})
                foam = self._thick_mesh(**sizes)
                height = self.settings.layer_height
                write_project(beside, self.part.mesh(), foam, self.part.name, height)
                return
            if form != "beams":
                if form == "walls":
                    raise SettingError("form", "3MF has no walls without thickness; use write_stl")
                write_mesh(beside, self._mesh(form, sizes), self.part.name)
                return
            check_form(form, sizes, {form: ("diameter",)})
            diameter = sizes["diameter"]
            points, struts = self._axes(diameter)
            mesh = bar_mesh(points, struts, diameter) if fallback else None
            write_beams(beside, points, struts, diameter / 2, self.part.name, mesh)

    def write_svg(self, path: str | Path, layer: int = 0) -> None:
        """Draw one layer (negative: from the top) as SVG, 1 unit a millimetre, bed coordinates.

        Raises `SettingError` for a layer that is not there.
        """
        drawn = self.layers[place("svg_layer", layer, len(self.layers), "layers", from_end=True)]
        with written_beside(Path(path)) as beside:
            beside.write_text(drawn.svg(), encoding="utf-8", newline="\n")

    def _named(self, form: str, sizes: dict[str, Any]) -> Iterable[Named]:
        """A form, but for wires, as named shapes; `check_form` has passed it."""
        from v3dcad.kernel.step import TEAL, Named

        if form == "beads":
            return (Named(title, bead) for title, bead in self._beads(**sizes))
        if form == "cells":
            return (
                Named(_numbered(site, piece, len(cells)), bare(cell), TEAL)
                for site, cells in self.cells_by_site().items()
                for piece, cell in enumerate(cells, start=1)
            )
        return [Named(form, bare(getattr(self, form)(**sizes)), TEAL)]

    def _mesh(self, form: str, sizes: dict[str, Any]) -> Mesh:
        from v3dcad.geometry.solid.bar_meshes import wall_strips

        check_form(form, sizes, MESHES)
        if form == "solid":
            return self.solid_mesh(**sizes)
        if form == "struts":
            return self.strut_mesh(**sizes)
        if form == "beads":
            return self.bead_mesh(**sizes)
        return self._at_source(wall_strips(self.layers, *self.settings.layer_span()))

    def _beads(self, width: float, profile: str = "rounded") -> Iterable[tuple[str, Any]]:
        from v3dcad.kernel.beads import layer_beads

        height, base = self.settings.layer_span()
        return (
            (_title(layer), layer_beads(layer, self.placement, width, height, profile, base))
            for layer in self.layers
        )

    def _tell_apart(self, parts: Iterable[tuple[float, Floats]]) -> None:
        """Warn of thick walls that are several bodies, by volumes and boxes in bed coordinates."""
        from v3dcad.geometry.mesh.bodies import apart_findings

        for told in apart_findings("the thick walls", parts, float(self.part.bounds[0, 2])):
            warnings.warn(f"{told}; a skin holds them together", stacklevel=3)

    def _axes(self, diameter: float) -> tuple[Floats, Any]:
        """Points (v, 3), where the source lies, and struts (s, 2) between them.

        Warns how many cells a diameter, mm, closes up.
        """
        from v3dcad.geometry.solid.convex_cells import check_diameter

        facets, (low, high) = self.facets(), self.part.bounds
        check_diameter(facets, diameter, low - MARGIN, high + MARGIN)
        return self.placement.to_source(facets.points), facets.struts()

    def _thick(self, thickness: float) -> Facets:
        """The walls of which something may lie in the part when they are that thick, mm."""
        return self.facets(MARGIN + above_zero("thickness", thickness) / 2)

    def _thick_mesh(self, thickness: float, skin: float = 0.0) -> Mesh:
        """The part with walls of a thickness, and a skin if asked, on the bed."""
        from v3dcad.geometry.mesh.boolean import subtracted
        from v3dcad.geometry.mesh.erosion import eroded
        from v3dcad.geometry.solid.convex_cells import hollows

        low, high = self.part.bounds
        cells = hollows(self._thick(thickness), thickness, low - MARGIN, high + MARGIN)
        body = self.part.mesh()
        core = eroded(body, skin) if skin else None
        return subtracted(body, [cell.mesh() for cell in cells], core)

    def _solid(self) -> Any:
        """The part's solids where the source lies, those that meet united."""
        shape = getattr(self.part, "shape", None)
        if shape is None:
            raise KernelError(
                f"{self.part.name} is made of triangles and has no solid to cut: give STEP or "
                "BREP, or write meshes (write_stl, write_3mf)"
            )
        from v3dcad.kernel.shapes import placed_back
        from v3dcad.kernel.union import one_body

        return placed_back(one_body(shape), self.placement)

    def _given_back(self, shape: Any) -> Any:
        """A shape of OCP as an object of the library that the part comes from."""
        return given_back(shape, self.part.library)

    def _at_source(self, mesh: Mesh) -> Mesh:
        return Mesh(self.placement.to_source(np.asarray(mesh.vertices)), mesh.triangles)


def write_part(part: Part, path: Path) -> None:
    """Write a part as placed on the bed: solids as BREP, a mesh as STL (float32)."""
    shape = getattr(part, "shape", None)
    with written_beside(path) as beside:
        if shape is None:
            from v3dcad.formats.mesh.stl import binary_stl

            beside.write_bytes(binary_stl(part.mesh()))
            return
        from v3dcad.kernel.step import write_brep

        write_brep(shape, beside)


def check_form(form: str, sizes: Mapping[str, Any], forms: Mapping[str, tuple[str, ...]]) -> None:
    """Raise `SettingError` for a form that is none, or for sizes that it does not take, or lacks.

    `forms` are all there are, with what each takes; the first of that it needs.
    """
    if form not in forms:
        raise SettingError("form", f"form {form!r}: give {', '.join(forms)}")
    takes = forms[form]
    for name in sizes:
        if name not in takes:
            what = ", ".join(takes) or "no size"
            raise SettingError(name, f"{form} has no {name}: it takes {what}")
    if takes and takes[0] not in sizes:
        raise SettingError(takes[0], f"{form} needs a {takes[0]}, mm: give {takes[0]}=…")


def _title(layer: Layer) -> str:
    return f"layer {layer.index} z {layer.z:g}"


def _numbered(site: int, piece: int, pieces: int) -> str:
    return f"cell {site}" if pieces == 1 else f"cell {site}, piece {piece} of {pieces}"
