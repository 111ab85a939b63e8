"""The main path: part → sections → structure → toolpath, and what a user holds of it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, replace
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from v3dcad.arguments import finite, rows
from v3dcad.errors import FormatError, SettingError
from v3dcad.files import written_beside
from v3dcad.forms import Forms
from v3dcad.model import (
    Checksum,
    Diagram,
    Floats,
    Ints,
    Layer,
    Part,
    Placement,
    Progress,
    Recipe,
    Section,
    Toolpath,
    part_words,
    unheard,
)
from v3dcad.pages import Pages
from v3dcad.parts import MeshPart, part_from
from v3dcad.recipes import (
    boundary_form,
    boundary_of,
    changed,
    check_fits_sites,
    given_sites,
    in_space,
    known_settings,
    part_of,
    read_ont,
    sites_of,
)
from v3dcad.report import Print, graded_report, report
from v3dcad.settings import FillSettings, PrintSettings
from v3dcad.signatures import takes_settings
from v3dcad.structure.fill import Filling, fill_sections
from v3dcad.structure.foam.choice import auto_cell_size, graded_stretch, largest_cell_size
from v3dcad.structure.foam.uniform import refuse_larger
from v3dcad.structure.loft import lofted
from v3dcad.structure.overhang import Overhang, overhang
from v3dcad.structure.placement import layer_heights, on_bed
from v3dcad.structure.properties import Properties, properties
from v3dcad.structure.sites import scatter_sites
from v3dcad.structure.thesis.loop import ThesisFilling
from v3dcad.structure.walls import StrutAxes, Walls
from v3dcad.version import VERSION
from v3dcad.views import Views
from v3dcad.words import counted

if TYPE_CHECKING:
    from v3dcad.cell_size import Expected
    from v3dcad.geometry.solid.facets import Facets
    from v3dcad.structure.foam.graded import Graded
    from v3dcad.toolpath.certificate import PrintedOverhang
    from v3dcad.toolpath.report import LayerReport


@dataclass(frozen=True, eq=False, slots=True)
class Structure(Forms, Views, Pages):
    """A filled part: its layers, and the ways to write them.

    Layers, `.ont` and G-code are in bed coordinates; STEP lies where the source lies.
    """

    part: Part
    """as placed on the bed"""
    placement: Placement
    filling: Filling | ThesisFilling
    layers: Sequence[Layer]
    """computed as they are asked for; gone through as often as one likes"""
    given: Floats | None
    """(n, 3) or (n, 2) mm: the sites that a user gave, or that a cell size which differs from place
    to place made; to the last bit"""
    graded: Graded | None = None
    """how such cells differ from what was asked"""
    expected: Expected | None = None
    """what it will take as printed, where its cell size was found for a density or a mass"""

    def __repr__(self) -> str:
        what = f"{counted(len(self.layers), 'layer')}, {self.settings.method}"
        return f"<Structure of {part_words(self.part)}: {what}>"

    @property
    def settings(self) -> FillSettings:
        """What it was filled with; "auto" is the number it stood for."""
        return self.filling.settings

    @property
    def sites(self) -> Floats:
        """(n, 3) mm, bed coordinates: the sites as snapped to the engine's grid, those around the
        part among them. By the thesis's method (n, 2), those at the base.
        """
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
        z = finite("z", z)
        (section,) = self.part.sections(np.array([z]), self.settings.chord_tolerance)
        return self.filling.at(z, section)

    def sites_at(self, points: Floats | Sequence[Sequence[float]]) -> Ints:
        """(k,) numbers of the sites in whose cells points (k, 3), mm, lie, where the source lies.

        Raises `SettingError` for the thesis's method, as `faces` does.
        """
        return self.filling.sites_at(self.placement.to_bed(rows("points", points, "x, y, z")))

    def overhang(self, bead_width: float = PrintSettings().bead_width) -> Overhang:
        """The certificate: how every layer rests on the one below."""
        return overhang(self.layers, bead_width)

    def toolpaths(
        self,
        printing: PrintSettings | None = None,
        report: Callable[[LayerReport], None] | None = None,
    ) -> Iterator[Toolpath]:
        """The nozzle's way on each layer, bed coordinates, as it is gone through.

        `report` hears what each layer comes to. Raises `GeometryError` where beads span more than
        `fail_over`, and where nothing is printed.
        """
        from v3dcad.toolpath.trace import trace

        thesis = self.settings.method == "thesis"
        return trace(self.layers, printing or PrintSettings(), report, thesis=thesis)

    def printed_overhang(self, settings: PrintSettings | None = None) -> PrintedOverhang:
        """The certificate of a print: what of its beads hangs over the layer below, and where.

        Traces all layers. Raises as `toolpaths` does, and `SettingError` where the structure cannot
        be printed so.
        """
        from v3dcad.toolpath.certificate import printed_overhang

        settings = settings or PrintSettings()
        self._check_limits(settings)
        reports: list[LayerReport] = []
        for _ in self.toolpaths(settings, reports.append):
            pass
        return printed_overhang(reports)

    def _check_limits(self, settings: PrintSettings) -> None:
        from v3dcad.limits import check_cells, check_limits

        size = self.settings.cell_size
        largest = self.graded.asked[1] if self.graded is not None else size
        check_cells(largest, self.part.bounds, settings)
        check_limits(self.settings, settings)

    def properties(
        self, wall_width: float = PrintSettings().wall_width(), density: float = 1.24
    ) -> Properties:
        """Volume, mass, centre and inertia of walls as wide (mm) as they are printed.

        `density` is in g/cm³ (PLA's is 1.24).
        """
        height, base = self.settings.layer_span()
        return properties(self.layers, height, wall_width, density, base=base)

    def plastic(self, printing: PrintSettings | None = None) -> Expected:
        """What the part takes as printed, brim and skirt left out, from beads on some layers."""
        from v3dcad.cell_size import expected_print

        return expected_print(self.layers, self.settings, printing or PrintSettings())

    def facets(self, beyond: float = 0.0) -> Facets:
        """The walls between cells in the part's box and `beyond` mm around it, bed coordinates.

        Raises `SettingError` for the thesis's method, whose layers are not slices of such walls.
        """
        margin = finite("beyond", beyond)
        return self.filling.facets(self.part.bounds + margin * np.array([[-1.0], [1.0]]))

    def recipe(self, boundary: str | None = None) -> Recipe:
        """What an `.ont` file needs to make this structure again, with its check sum.

        `boundary` is "exact" (the B-rep, or the triangles, to the last bit) or "stl" (the thesis's
        form: triangles). By default a B-rep is kept exactly, and triangles as STL. The recipe of a
        B-rep "as stl" is that of its tessellation. Sites that the settings make again are left out,
        but for the thesis's method in the thesis's form.
        """
        form = boundary_form(boundary, self.part)
        if form == "stl" and not isinstance(self.part, MeshPart):
            mesh = MeshPart(self.part.name, self.part.mesh())
            tessellated = build(mesh, self.settings, self.given)
            placement = self.placement.then(tessellated.placement)
            return replace(tessellated, placement=placement).recipe(form)
        sites = self.given
        if sites is None and form == "stl" and self.settings.method == "thesis":
            rectangle, settings = self.part.bounds[:, :2], self.settings
            sites = scatter_sites(rectangle, settings.sites, settings.random_seed)
        return Recipe(
            name=self.part.name,
            settings=self.settings,
            sites=None if sites is None else in_space(sites),
            boundary=boundary_of(self.part),
            placement=self.placement,
            checksum=self.checksum(),
            software=f"v3dcad {VERSION}",
        )

    def checksum(self) -> Checksum:
        """The check sum by which the structure is known; goes through all layers."""
        return self.filling.checksum(self.layers)

    def write_ont(self, path: str | Path, boundary: str | None = None) -> None:
        """Write the structure as `.ont`; `boundary` as for `recipe`."""
        from v3dcad.formats.ont.document import ont_text

        form = boundary_form(boundary, self.part)
        with written_beside(Path(path)) as beside:
            text = ont_text(self.recipe(form), form)
            beside.write_text(text, encoding="utf-8", newline="\n")

    def write_gcode(self, path: str | Path, settings: PrintSettings | None = None) -> Print:
        """Write G-code, the part in the middle of the bed, and tell what the print takes.

        Raises `SettingError` where the part is larger than the printer, or settings do not fit each
        other (see `limits.py`).
        """
        from v3dcad.formats.gcode.writer import check_fits, write_gcode
        from v3dcad.toolpath.report import findings

        settings = settings or PrintSettings()
        self._check_limits(settings)
        check_fits(self.part.bounds, settings)
        reports: list[LayerReport] = []
        toolpaths = self.toolpaths(settings, reports.append)
        with (
            written_beside(Path(path)) as beside,
            beside.open("w", encoding="utf-8", newline="\n") as stream,
        ):
            totals = write_gcode(stream, toolpaths, settings, self.thumbnail())
        return Print(totals, reports, findings(reports))

    def findings(self) -> list[str]:
        """What the user should know of how the part was read."""
        return list(self.part.findings)

    def report(
        self, printing: PrintSettings | None = None, printed: Print | None = None
    ) -> dict[str, Any]:
        """Counts, lengths (mm), settings and certificate as plain values for JSON.

        `printed` is what `write_gcode` told, for the same print settings.
        """
        width = (printing or PrintSettings()).bead_width
        told = report(self.part, self.filling, self.layers, self.overhang(width), width, printed)
        if self.graded is not None:
            told["graded"] = graded_report(self.graded)
        if self.expected is not None:
            told["expected"] = asdict(self.expected)
        return told

    def write_report(
        self,
        path: str | Path,
        printing: PrintSettings | None = None,
        printed: Print | None = None,
    ) -> dict[str, Any]:
        """Write `report()` as JSON, and give it back."""
        told = self.report(printing, printed)
        with written_beside(Path(path)) as beside:
            beside.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8", newline="\n")
        return told


def build(
    part: Part,
    settings: FillSettings,
    sites: Floats | None = None,
    executor: Executor | None = None,
    progress: Progress = unheard,
    printing: PrintSettings | None = None,
) -> Structure:
    """Part → sections → structure; opens no port or window, and files only as a cell size names
    them.

    `sites` (n, 3), mm, bed coordinates, or (n, 2) for columns, take the place of those that the
    settings say. An executor computes several sections at a time; `progress` hears of the steps
    in which the sites of cells of many sizes are made. A density or a mass in the settings is that
    of the part as `printing` prints it, by default `PrintSettings()`; the structure's settings then
    have the cell size that it takes. Raises `SettingError` where settings do not fit the part,
    `GeometryError` or `KernelError` where it cannot be cut.
    """
    found = sectioned(part, settings, executor)
    return fill_sectioned(found, settings, sites, progress, printing)


@dataclass(frozen=True, eq=False, slots=True)
class SectionedPart:
    """A part on the bed and those of its sections that are filled."""

    part: Part
    heights: Floats
    """(k,) mm: of all layers"""
    sections: Sequence[Section]
    """one for each layer; where layers are lofted, the first and the last"""


def sectioned(
    part: Part, settings: FillSettings, executor: Executor | None = None
) -> SectionedPart:
    """The first half of `build`: goes by `SectionSettings`, `FillSettings.section_above` and
    `FillSettings.lofts` only.
    """
    part = part.placed(on_bed(part.bounds, settings.base_clearance))
    top, above = float(part.bounds[1, 2]), settings.section_above()
    heights = layer_heights(top, settings.layer_height, above)
    planes = np.unique(heights[[0, -1]]) if settings.lofts else heights
    return SectionedPart(part, heights, part.sections(planes, settings.chord_tolerance, executor))


def fill_sectioned(
    found: SectionedPart,
    settings: FillSettings,
    sites: Floats | None = None,
    progress: Progress = unheard,
    printing: PrintSettings | None = None,
) -> Structure:
    """The second half of `build`, for a part that was cut by the same settings."""
    if sites is not None:
        check_fits_sites(settings, sites)
    part = found.part
    rectangle = part.bounds[:, :2]
    if sites is not None and not _any_inside(sites[:, :2], rectangle):
        low, high = rectangle
        raise SettingError(
            "sites",
            "all sites lie outside the part's base rectangle, "
            f"x {low[0]:g} … {high[0]:g}, y {low[1]:g} … {high[1]:g} mm; move them",
        )

    def layers_by(sized: FillSettings) -> Sequence[Layer]:
        return fill_sectioned(found, sized, None, progress).layers

    from v3dcad.cell_size import with_cell_size

    settings, expected = with_cell_size(
        found.sections, part.bounds, settings, printing or PrintSettings(), layers_by, progress
    )
    graded: Graded | None = None
    differing = None if sites is not None else cells_of(settings, part)
    if differing is not None:
        from v3dcad.structure.foam.graded import graded_sites

        low, high = part.bounds
        sizes, wanted = differing
        graded = graded_sites(sizes, low, high, settings, progress, wanted)
        sites = graded.sites
        settings = replace(
            settings, cell_size="auto", roof_size="off", stretch=graded.stretch, strict=False
        )
    filling = fill_sections(found.sections, sites, settings, rectangle)
    layers: Sequence[Layer] = filling.layers
    if settings.lofts:
        assert isinstance(filling, ThesisFilling)
        layers = lofted(filling, found.heights)
    return Structure(part, part.placement, filling, layers, sites, graded, expected)


def cells_of(
    settings: FillSettings, part: Part
) -> tuple[Callable[[Floats], Floats], Callable[[], Floats] | None] | None:
    """Cell sizes (n,), mm, at places (n, 3), mm, and where sites are wanted (m, 3), mm, if they
    are, in bed coordinates; None where all cells are of one size.
    """
    from v3dcad.fields.roofs import Roofs, widest
    from v3dcad.fields.sources import size_field

    size, roof, roofs = settings.cell_size, settings.roof_size, None
    if size == "auto":
        size = auto_cell_size(np.ptp(part.bounds, axis=0))
    narrow = widest(size) if isinstance(size, float | int) else np.inf
    if not isinstance(roof, str) and narrow > roof:
        roofs = Roofs.of(part.mesh(), roof)
    if isinstance(size, float | int):
        if roofs is None:
            return None
        refuse_larger(size, np.array([largest_cell_size(part.bounds, settings)]))
        everywhere = float(size)
        sizes = size_field(lambda x, y, z: everywhere, part)
    else:
        sizes = size_field(size, part)
    if roofs is None:
        return sizes, None
    from v3dcad.structure.foam.size_grid import SLOPE

    return roofs.finer(sizes, SLOPE, graded_stretch(settings)), roofs.sites


def _any_inside(sites: Floats, rectangle: Floats) -> bool:
    inside = (sites >= rectangle[0]) & (sites <= rectangle[1])
    return bool(inside.all(axis=1).any())


@takes_settings(FillSettings)
def fill(
    source: Any,
    *,
    sites: int | Sequence[Sequence[float]] | Floats | None = None,
    verify: bool = True,
    executor: Executor | None = None,
    progress: Progress = unheard,
    printing: PrintSettings | None = None,
    **settings: Any,
) -> Structure:
    """Fill a part with a foam, or with the thesis's structure.

    `source` is a path (STEP, STL, 3MF, OBJ, BREP, `.ont`), a `Recipe`, a part of `part_from` or
    `place_on_bed`, a shape of build123d, CadQuery or OCP, or a pair (vertices, triangles). `sites`
    are places in mm, bed coordinates, that take the place of those that the settings say: (n, 3)
    with a `stretch` that is a number, or (n, 2) for columns and the thesis's method; for the latter
    also how many to scatter. An executor (of threads, of processes, a cluster's) computes several
    sections at a time. With a `cell_size` that is an expression or a function of x, y, z (n,), mm,
    where the source lies, cells are as large as it says; `progress` hears of the steps in which
    they are made. `printing` says how the part is printed, by default `PrintSettings()`; a
    `density` or a `mass` is that of the print. Further settings are the fields of `FillSettings`.
    What a recipe says is taken from it, unless given here; where nothing is, the structure must
    have the recipe's check sum (`verify=False`: need not). Raises `V3dcadError`s that say what to
    do.
    """
    if isinstance(source, (str, Path)) and Path(source).suffix.lower() == ".ont":
        source = read_ont(source)
    if isinstance(source, Recipe):
        if sites is not None or settings:
            source = changed(source, sites, settings)
        return build_recipe(
            source, verify=verify, executor=executor, progress=progress, printing=printing
        )
    if sites is None or isinstance(sites, Real):
        chosen = known_settings(settings if sites is None else {**settings, "sites": sites})
        return build(part_from(source), chosen, None, executor, progress, printing)
    explicit = given_sites(sites)
    chosen = known_settings(settings, explicit)
    return build(part_from(source), chosen, explicit, executor, progress)


def build_recipe(
    recipe: Recipe,
    *,
    verify: bool = True,
    executor: Executor | None = None,
    progress: Progress = unheard,
    printing: PrintSettings | None = None,
) -> Structure:
    """The structure of a recipe; where a source was moved to the bed, it lies where that lay.

    Raises `FormatError` where the structure is not the one whose check sum the recipe has,
    unless `verify` is off; otherwise as `build`.
    """
    part, sites = part_of(recipe), sites_of(recipe)
    structure = build(part, recipe.settings, sites, executor, progress, printing)
    if verify and recipe.checksum is not None:
        differences = structure.checksum().differences(recipe.checksum)
        if differences:
            raise FormatError(
                f"the structure that it makes is not the one that was written: "
                f"{', '.join(differences)}. Written by {recipe.software}, this is v3dcad "
                f"{VERSION}; --no-verify takes it as it is",
                path=f"{recipe.name}.ont", section="CHECKSUM",
            )  # fmt: skip
    return structure
