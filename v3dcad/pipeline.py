"""The main path: part → sections → structure → toolpath, and what a user holds of it."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from v3dcad.errors import SettingError
from v3dcad.files import written_beside
from v3dcad.forms import Forms
from v3dcad.model import Floats, Layer, Part, Placement, Recipe, Section, Toolpath
from v3dcad.parts import MeshPart, check_readable, part_from
from v3dcad.settings import FillSettings, PrintSettings
from v3dcad.structure.density import density
from v3dcad.structure.fill import Filling, fill_sections
from v3dcad.structure.place import layer_heights, on_bed
from v3dcad.structure.sites import scatter_sites

if TYPE_CHECKING:
    from v3dcad.geometry.facets import Facets


@dataclass(frozen=True, eq=False, slots=True)
class Structure(Forms):
    """A filled part: its layers, and the ways to write them.

    Layers, `.ont` and G-code are in bed coordinates; STEP lies where the source lies.
    """

    part: Part
    """as placed on the bed"""
    placement: Placement
    settings: FillSettings
    filling: Filling
    layers: Sequence[Layer]
    """computed as they are asked for; gone through as often as one likes"""

    @property
    def sites(self) -> Floats:
        """(n, 2) mm: the sites at the base, as snapped to the engine's grid."""
        return self.filling.sites

    def facets(self) -> Facets:
        """The walls between cells in space, bed coordinates, from the base to above the top."""
        from v3dcad.geometry.facets import welded_facets

        if self.settings.method == "thesis":
            raise SettingError(
                "method",
                "the thesis's method moves inserted cells from layer to layer, so that they have "
                "no plane walls in space: use method='continuous', or wires and beads",
            )
        # An empty section above the top lets the walls go on from the last layer to there.
        above = Section(float(self.part.bounds[1, 2]) + 1.0, ())
        filling = fill_sections([*self.filling.sections, above], self.sites, self.settings)
        walls, everyone = filling.walls, filling.history.sites.by_site()
        places = filling.grid.millimetres(everyone.places)
        return welded_facets(walls.sites, walls.points, walls.starts, places)

    def recipe(self) -> Recipe:
        """What an `.ont` file needs to make this structure again."""
        sites = np.column_stack([self.sites, np.zeros(len(self.sites))])
        return Recipe(
            self.settings.offset,
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

    def trace(self, settings: PrintSettings) -> Iterator[Toolpath]:
        """The toolpath of each layer."""
        from v3dcad.toolpath.beads import trace

        return trace(self.layers, settings)

    def write_gcode(self, path: str | Path, settings: PrintSettings | None = None) -> None:
        """Write G-code for a Marlin printer, the part in the middle of the bed.

        Raises `SettingError` where the part is larger than the bed.
        """
        from v3dcad.formats.gcode import check_fits, write_gcode

        settings = settings or PrintSettings()
        check_fits(self.part.bounds, settings)
        with written_beside(Path(path)) as beside, beside.open("w", newline="\n") as stream:
            write_gcode(stream, self.trace(settings), settings)

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

    def report(self) -> dict[str, Any]:
        """Counts, lengths (mm) and settings, as plain values for JSON."""
        rows = [_layer_report(layer) for layer in self.layers]
        return {
            "part": self.part.name,
            "size_mm": np.ptp(self.part.bounds, axis=0).tolist(),
            "findings": list(self.part.findings),
            "settings": {
                name: getattr(self.settings, name) for name in FillSettings.__dataclass_fields__
            },
            "layers": len(rows),
            "cells": max(row["cells"] for row in rows),
            "walls": sum(row["walls"] for row in rows),
            "wall_length_mm": sum(row["wall_length_mm"] for row in rows),
            "contour_length_mm": sum(row["contour_length_mm"] for row in rows),
            "by_layer": rows,
        }

    def write_report(self, path: str | Path) -> None:
        """Write `report()` as JSON."""
        with written_beside(Path(path)) as beside:
            beside.write_text(json.dumps(self.report(), indent=1) + "\n", encoding="utf-8")


def _layer_report(layer: Layer) -> dict[str, Any]:
    diagram = layer.diagram
    lengths, inner = diagram.lengths(), diagram.inner()
    return {
        "layer": layer.index,
        "z_mm": layer.z,
        "cells": len(diagram.sites()),
        "walls": len(diagram.neighbours),
        "wall_length_mm": float(lengths[inner].sum()),
        "contour_length_mm": float(lengths[~inner].sum()),
        "area_per_cell_mm2": layer.area_per_cell,
    }


def build(part: Part, settings: FillSettings, sites: Floats | density | None = None) -> Structure:
    """Part → sections → structure; opens no file, port or window.

    `sites` (n, 2), mm in bed coordinates, or their density take the place of the scatter. Raises
    `SettingError` where settings do not fit the part, `GeometryError` or `KernelError` where it
    cannot be cut.
    """
    placement = on_bed(part.bounds)
    part = part.placed(placement)
    rectangle = part.bounds[:, :2]
    if sites is None:
        sites = scatter_sites(rectangle, settings.sites, settings.random_seed)
    elif isinstance(sites, density):
        sites = sites.scatter(rectangle, settings.random_seed)
    elif not ((sites >= rectangle[0]) & (sites <= rectangle[1])).all(axis=1).any():
        low, high = rectangle
        raise SettingError(
            "sites",
            "all sites lie outside the part's base rectangle, "
            f"x {low[0]:g} … {high[0]:g}, y {low[1]:g} … {high[1]:g} mm; move them",
        )
    sections = part.sections(layer_heights(float(part.bounds[1, 2]), settings.layer_height))
    filling = fill_sections(sections, sites, settings)
    return Structure(part, placement, settings, filling, filling.layers)


def fill(
    source: Any,
    *,
    sites: int | Sequence[Sequence[float]] | Floats | density | None = None,
    **settings: Any,
) -> Structure:
    """Fill a part with a Voronoi structure.

    `source` is a path (STEP, STL, BREP, `.ont`), a shape of build123d, CadQuery or OCP, or a
    pair (vertices, triangles). `sites` is how many to scatter, their places (n, 2) in mm, bed
    coordinates, or their `density`. Further settings are the fields of `FillSettings`. What an
    `.ont` file says is taken from it, unless given here. Raises `V3dcadError`s that say what to do.
    """
    if isinstance(source, (str, Path)) and Path(source).suffix.lower() == ".ont":
        return _fill_recipe(Path(source), sites, settings)
    if sites is None or isinstance(sites, int):
        chosen = _settings(settings if sites is None else {**settings, "sites": sites})
        return build(part_from(source), chosen)
    if isinstance(sites, density):
        return build(part_from(source), _settings(settings), sites)
    explicit = np.asarray(sites, dtype=np.float64).reshape(-1, 2)
    return build(part_from(source), _settings({**settings, "sites": len(explicit)}), explicit)


def _fill_recipe(path: Path, sites: Any, settings: dict[str, Any]) -> Structure:
    recipe = read_recipe(path)
    known = {"offset": recipe.offset, "layer_height": recipe.layer_height}
    if sites is None:
        sites = recipe.sites[:, :2]
    return fill(MeshPart(recipe.name, recipe.boundary), sites=sites, **{**known, **settings})


def read_recipe(path: Path) -> Recipe:
    """The recipe in an `.ont` file."""
    from v3dcad.formats.ont import read_ont

    check_readable(path)
    return read_ont(path)


def _settings(chosen: dict[str, Any]) -> FillSettings:
    for name in chosen:
        if name not in FillSettings.__dataclass_fields__:
            raise SettingError(name, f"there is no setting {name!r}")
    return FillSettings(**chosen)


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
