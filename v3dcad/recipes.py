"""Recipes (`.ont` files) and the parts in them: read, changed, told; nothing is built here."""

from __future__ import annotations

import difflib
from dataclasses import replace
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np

from v3dcad.arguments import rows
from v3dcad.errors import SettingError
from v3dcad.formats.mesh.stl import welded
from v3dcad.model import Brep, Floats, Mesh, Part, Recipe, size_words
from v3dcad.parts import MeshPart, check_readable
from v3dcad.settings import SIZING, FillSettings, declared, option
from v3dcad.words import point_words

BOUNDARIES = ("stl", "exact")
"""How an `.ont` file may hold the part: as the thesis does, or to the last bit and small."""


def boundary_form(boundary: str | None, part: Part) -> str:
    """The form that was asked for, or else the usual one: B-reps exactly, triangles as STL.

    `SettingError` where there is no such form.
    """
    if boundary is None:
        return "stl" if isinstance(part, MeshPart) else "exact"
    if boundary not in BOUNDARIES:
        raise SettingError("boundary", f"--boundary {boundary}: give stl or exact")
    return boundary


def boundary_of(part: Part) -> Mesh | Brep:
    """A part as a recipe holds it, exactly."""
    if isinstance(part, MeshPart):
        return welded(part.surface.vertices[part.surface.triangles], part.name)
    from v3dcad.kernel.brep_bytes import brep_of

    return brep_of(part)


def part_of(recipe: Recipe) -> Part:
    """The part in a recipe, on the bed; `KernelError` where its B-rep cannot be read."""
    if isinstance(recipe.boundary, Mesh):
        return MeshPart(recipe.name, recipe.boundary, placement=recipe.placement)
    from v3dcad.kernel.brep_bytes import part_in

    return replace(part_in(recipe.boundary, recipe.name), placement=recipe.placement)


def read_ont(path: str | Path) -> Recipe:
    """The recipe in an `.ont` file; `FormatError` with line and section where it is damaged."""
    from v3dcad.formats.ont import document as ont

    check_readable(Path(path))
    return ont.read_ont(Path(path))


def known_settings(chosen: dict[str, Any], sites: Floats | None = None) -> FillSettings:
    """The settings of a call, with sites (n, 2) or (n, 3) if it gives them.

    `SettingError` for a name that is none, or another method's.
    """
    if sites is not None and chosen.get("method") == "thesis":
        chosen = {**chosen, "sites": len(sites)}
    for name in chosen:
        if name not in FillSettings.__dataclass_fields__:
            near = difflib.get_close_matches(name, FillSettings.__dataclass_fields__, n=1)
            hint = f"did you mean {near[0]}?" if near else "help(v3dcad.fill) lists them"
            raise SettingError(name, f"there is no setting {name!r}; {hint}")
    settings = FillSettings(**chosen)
    for name in chosen:
        FillSettings.refuse_other(name, settings.method)
    return settings


def given_sites(sites: Any) -> Floats:
    """Sites that a user gave as an array (n, 2) or (n, 3); `SettingError` for anything else."""
    found = rows("sites", sites, "x, y, z", "x, y for columns")
    if not len(found):
        raise SettingError("sites", "sites: none; give rows of x, y, z, or of x, y for columns")
    return found


def sites_of(recipe: Recipe) -> Floats | None:
    """The sites that a recipe lists, as `build` takes them; None where its settings make them."""
    settings = recipe.settings
    if recipe.sites is None or (settings.method == "foam" and settings.stretch != "columns"):
        return recipe.sites
    return recipe.sites[:, :2]


def changed(recipe: Recipe, sites: Any, settings: dict[str, Any]) -> Recipe:
    """The recipe of another structure, which has no check sum yet.

    Another method, random seed, cell size, density, mass or number of sites makes other sites;
    places (n, 2) or (n, 3) take their place. Raises `SettingError` for settings that do not fit the
    sites, and for a random seed or a roof size without a cell size where a foam's sites are listed.
    """
    kept = sites_of(recipe)
    method = settings.get("method", recipe.settings.method)
    same = method == recipe.settings.method
    sized = any(settings.get(name, "off") != "off" for name in SIZING)
    kept = kept if same else None
    before = {
        name: getattr(recipe.settings, name)
        for name in FillSettings.__dataclass_fields__
        if declared(FillSettings, name).method in ((None, method) if same else (None,))
    }
    before["method"] = method
    if isinstance(sites, Real):
        kept, settings = None, {**settings, "sites": sites}
    elif sites is not None:
        kept = given_sites(sites)
        if method == "thesis":
            before["sites"] = len(kept)
        else:
            before["cell_size"] = before["stretch"] = "auto"
    elif {"random_seed", "roof_size"} & settings.keys() or sized:
        if kept is not None and method == "foam" and not sized:
            name = next(name for name in ("random_seed", "roof_size") if name in settings)
            raise SettingError(
                name,
                f"{option(name)}: the file lists its sites, and not the cell size that made them; "
                "give --cell-size too, or leave it out",
            )
        kept = None
    if sized:
        before["cell_size"] = "auto"  # what is given says how large cells are
    chosen = known_settings({**before, **settings})
    if kept is not None:
        check_fits_sites(chosen, kept)
        if kept.shape[1] == 2:
            chosen = chosen if method == "thesis" else replace(chosen, stretch="columns")
            kept = in_space(kept)
    return replace(recipe, settings=chosen, sites=kept, checksum=None)


def in_space(sites: Floats) -> Floats:
    """Sites as an `.ont` file lists them, (n, 3); those of a plane lie at height 0."""
    if sites.shape[1] == 3:
        return sites
    return np.column_stack([sites, np.zeros(len(sites))])


def check_fits_sites(settings: FillSettings, sites: Floats) -> None:
    """Raise `SettingError` where sites (n, 2) or (n, 3) are given and settings do not fit them."""
    in_plane = sites.shape[1] == 2
    if settings.method == "thesis":
        if not in_plane:
            raise SettingError("sites", "--method thesis takes sites as rows of x, y")
        return
    for name in (*SIZING, "roof_size"):
        value = getattr(settings, name)
        if value not in ("auto", "off"):
            raise SettingError(
                name,
                f"{option(name)} {value}: sites are given, which say where the cells are; leave "
                "one of the two out",
            )
    if in_plane and not isinstance(settings.stretch, str):
        raise SettingError(
            "stretch", f"--stretch {settings.stretch:g}: sites of x, y are columns; give their z, "
            "or leave it out",
        )  # fmt: skip
    if not in_plane and isinstance(settings.stretch, str):
        raise SettingError(
            "stretch", f"--stretch {settings.stretch}: sites in space need a number; give it"
        )


def told(recipe: Recipe) -> dict[str, str]:
    """What a recipe says besides its part, as lines to show."""
    settings, usual = recipe.settings, FillSettings(method=recipe.settings.method)
    others = {
        name.replace("_", " "): f"{getattr(settings, name)}"
        for name in FillSettings.__dataclass_fields__
        if name not in ("method", "cell_size", "stretch", "offset", "layer_height", "sites")
        and getattr(settings, name) != getattr(usual, name)
    }
    if settings.method == "thesis":
        held = "scattered again from the random seed" if recipe.sites is None else "listed"
        kind = {
            "offset": f"{float(settings.offset):g} mm² a layer",
            "sites": f"{settings.sites}, {held}",
        }
    else:
        kind = {"cell size": f"{settings.cell_size} mm", "stretch": f"{settings.stretch}"}
        if recipe.sites is not None:
            kind = {"sites": f"{len(recipe.sites)}, listed", "stretch": f"{settings.stretch}"}
    return {
        "kind": ".ont",
        "written by": recipe.software or "another program, in the thesis's form",
        "boundary": "triangles" if isinstance(recipe.boundary, Mesh) else "B-rep",
        "method": settings.method,
        **kind,
        "layer height": f"{settings.layer_height:g} mm",
        **others,
        "check sum": "none" if recipe.checksum is None else f"{recipe.checksum.sha256[:16]}…",
    }


def describe_ont(path: Path) -> dict[str, str]:
    """What an `.ont` file holds, as lines to show."""
    recipe = read_ont(path)
    return describe(part_of(recipe), told(recipe))


def describe(part: Part, held: dict[str, str] | None = None) -> dict[str, str]:
    """What a part is, as lines to show; `held` is what is said of it first."""
    if held is None:
        held = {"kind": "triangles" if isinstance(part, MeshPart) else "B-rep"}
    low, high = part.bounds
    return {
        "name": part.name,
        **held,
        "size": size_words(part),
        "from, to": f"{point_words(low)}, {point_words(high)} mm",
        **part.contents(),
        **{f"note {k}": finding for k, finding in enumerate(part.findings, start=1)},
    }
