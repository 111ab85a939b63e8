"""The main path: part → sections → structure → toolpath, and what a user holds of it."""

from __future__ import annotations

import io
import json
from collections.abc import Collection, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.files import written_beside
from v3dcad.model import Diagram, Floats, Layer, Part, Placement, Recipe
from v3dcad.parts import MeshPart, part_from, read_recipe
from v3dcad.report import Print, report
from v3dcad.settings import FillSettings, PrintSettings
from v3dcad.structure.fill import Filling, fill_sections
from v3dcad.structure.loft import lofted
from v3dcad.structure.overhang import Overhang, overhang
from v3dcad.structure.place import layer_heights, on_bed
from v3dcad.structure.properties import Properties, properties
from v3dcad.structure.sites import scatter_sites
from v3dcad.structure.thesis.loop import ThesisFilling
from v3dcad.structure.walls import StrutAxes, Walls


@dataclass(frozen=True, eq=False, slots=True)
class Structure:
    """A filled part: its layers, and the ways to write them.

    Layers, `.ont` and G-code are in bed coordinates; STEP lies where the source lies.
    """

    part: Part
    """as placed on the bed"""
    placement: Placement
    filling: Filling | ThesisFilling
    layers: Sequence[Layer]
    """computed as they are asked for; gone through as often as one likes"""

    @property
    def settings(self) -> FillSettings:
        """What it was filled with; an offset of "auto" is the number it stood for."""
        return self.filling.settings

    @property
    def sites(self) -> Floats:
        """(n, 2) mm: the sites at the base, as snapped to the engine's grid."""
        return self.filling.sites

    @property
    def walls(self) -> Walls:
        """The walls of the structure in space: planar facets within the base rectangle."""
        return self.filling.walls

    @property
    def strut_axes(self) -> StrutAxes:
        """The lines where three walls meet, within the base rectangle."""
        return self.filling.strut_axes

    def at(self, z: float) -> Diagram:
        """The diagram at any height z, mm, not only at those of layers, cut by the part there."""
        (section,) = self.part.sections(np.array([z]))
        return self.filling.at(z, section)

    def overhang(self, bead_width: float = PrintSettings().bead_width) -> Overhang:
        """The certificate: how every layer rests on the one below."""
        return overhang(self.layers, bead_width)

    def properties(
        self, bead_width: float = PrintSettings().bead_width, density: float = 1.24
    ) -> Properties:
        """Volume, mass, centre and inertia as printed; `density` in g/cm³ (PLA's is 1.24)."""
        return properties(self.layers, self.settings.layer_height, bead_width, density)

    def recipe(self) -> Recipe:
        """What an `.ont` file needs to make this structure again."""
        sites = np.column_stack([self.sites, np.zeros(len(self.sites))])
        return Recipe(
            float(self.settings.offset),
            self.settings.layer_height,
            sites,
            self.part.mesh(),
            self.part.name,
        )

    def write_ont(self, path: str | Path) -> None:
        """Write the structure as `.ont`, the thesis's form; a B-rep's boundary as its mesh."""
        from v3dcad.formats.ont import ont_text

        with written_beside(Path(path)) as beside:
            beside.write_text(ont_text(self.recipe()), encoding="utf-8", newline="\n")

    def write_gcode(self, path: str | Path, settings: PrintSettings | None = None) -> Print:
        """Write G-code, the part in the middle of the bed, and tell what the print takes.

        Raises `SettingError` where the part is larger than the printer.
        """
        from v3dcad.formats.gcode import check_fits, write_gcode
        from v3dcad.toolpath.beads import trace
        from v3dcad.toolpath.report import LayerReport, findings

        settings = settings or PrintSettings()
        check_fits(self.part.bounds, settings)
        reports: list[LayerReport] = []
        toolpaths = trace(self.layers, settings, reports.append)
        with written_beside(Path(path)) as beside, beside.open("w", newline="\n") as stream:
            totals = write_gcode(stream, toolpaths, settings, self._thumbnail())
        return Print(totals, reports, findings(reports))

    def _thumbnail(self) -> bytes:
        from v3dcad.view.picture import draw

        picture = io.BytesIO()
        draw(self.layers, picture, shown=40, pixels=220)
        return picture.getvalue()

    def write_step(self, path: str | Path) -> None:
        """Write the wires of all layers as STEP, one named compound a layer."""
        from v3dcad.kernel.step import write_step
        from v3dcad.kernel.wires import layer_wires

        shapes = (
            (f"layer {layer.index} z {layer.z:g}", layer_wires(layer, self.placement))
            for layer in self.layers
        )
        with written_beside(Path(path)) as beside:
            write_step(shapes, beside, self.part.name)

    def write_png(self, path: str | Path) -> None:
        """Draw the layers in perspective."""
        from v3dcad.view.picture import draw

        with written_beside(Path(path)) as beside:
            draw(self.layers, beside)

    def findings(self, written: Collection[str] = ()) -> list[str]:
        """What the user should know of how the part was read and what was written of it."""
        found = list(self.part.findings)
        if "ont" in written and not isinstance(self.part, MeshPart):
            found.append("the .ont file holds the part's tessellation, not its exact surface")
        return found

    def report(
        self, printing: PrintSettings | None = None, printed: Print | None = None
    ) -> dict[str, Any]:
        """Counts, lengths (mm), settings and certificate as plain values for JSON.

        `printed` is what `write_gcode` told, for the same print settings.
        """
        width = (printing or PrintSettings()).bead_width
        return report(self.part, self.filling, self.layers, self.overhang(width), width, printed)

    def write_report(
        self,
        path: str | Path,
        printing: PrintSettings | None = None,
        printed: Print | None = None,
    ) -> dict[str, Any]:
        """Write `report()` as JSON, and give it back."""
        told = self.report(printing, printed)
        with written_beside(Path(path)) as beside:
            beside.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
        return told


def build(
    part: Part,
    settings: FillSettings,
    sites: Floats | None = None,
    executor: Executor | None = None,
) -> Structure:
    """Part → sections → structure; opens no file, port or window.

    `sites` (n, 2), mm in bed coordinates, take the place of the scatter. An executor computes
    several sections at a time. Raises `SettingError` where settings do not fit the part,
    `GeometryError` or `KernelError` where it cannot be cut.
    """
    part = part.placed(on_bed(part.bounds, settings.base_clearance))
    placement = part.placement
    rectangle = part.bounds[:, :2]
    if sites is None:
        sites = scatter_sites(rectangle, settings.sites, settings.random_seed)
    elif not ((sites >= rectangle[0]) & (sites <= rectangle[1])).all(axis=1).any():
        low, high = rectangle
        raise SettingError(
            "sites",
            "all sites lie outside the part's base rectangle, "
            f"x {low[0]:g} … {high[0]:g}, y {low[1]:g} … {high[1]:g} mm; move them",
        )
    heights = layer_heights(float(part.bounds[1, 2]), settings.layer_height)
    lofts = settings.method == "thesis" and settings.interpolate
    planes = np.unique(heights[[0, -1]]) if lofts else heights
    sections = part.sections(planes, settings.chord_tolerance, executor)
    filling = fill_sections(sections, sites, settings)
    if lofts:
        assert isinstance(filling, ThesisFilling)
        return Structure(part, placement, filling, lofted(filling, heights))
    return Structure(part, placement, filling, filling.layers)


def fill(
    source: Any,
    *,
    sites: int | Sequence[Sequence[float]] | Floats | None = None,
    executor: Executor | None = None,
    **settings: Any,
) -> Structure:
    """Fill a part with a Voronoi structure.

    `source` is a path (STEP, STL, 3MF, OBJ, BREP, `.ont`), a part of `part_from` or
    `place_on_bed`, a shape of build123d, CadQuery or OCP, or a pair (vertices, triangles). `sites`
    is how many to scatter, or their places (n, 2) in mm, bed coordinates. An executor (of
    threads, of processes, a cluster's) computes several sections at a time. Further settings are
    the fields of `FillSettings`. What an `.ont` file says is taken from it, unless given here.
    Raises `V3dcadError`s that say what to do.
    """
    if isinstance(source, (str, Path)) and Path(source).suffix.lower() == ".ont":
        return _fill_recipe(Path(source), sites, executor, settings)
    if sites is None or isinstance(sites, int):
        chosen = _settings(settings if sites is None else {**settings, "sites": sites})
        return build(part_from(source), chosen, None, executor)
    explicit = np.asarray(sites, dtype=np.float64).reshape(-1, 2)
    chosen = _settings({**settings, "sites": len(explicit)})
    return build(part_from(source), chosen, explicit, executor)


def _fill_recipe(
    path: Path, sites: Any, executor: Executor | None, settings: dict[str, Any]
) -> Structure:
    recipe = read_recipe(path)
    known = {"offset": recipe.offset, "layer_height": recipe.layer_height}
    if sites is None:
        sites = recipe.sites[:, :2]
    part = MeshPart(recipe.name, recipe.boundary)
    return fill(part, sites=sites, executor=executor, **{**known, **settings})


def _settings(chosen: dict[str, Any]) -> FillSettings:
    for name in chosen:
        if name not in FillSettings.__dataclass_fields__:
            raise SettingError(name, f"there is no setting {name!r}")
    return FillSettings(**chosen)
